#include "service/windows/packed_rows.hpp"

#include <cstring>
#include <limits>

#include <gtest/gtest.h>

namespace reident::test::packed_rows_test {
namespace {

using identification::Index;
using identification::Matrix;
using identification::Record;
using identification::TickRange;

bool same_bits(const Matrix& a, const Matrix& b) {
  return a.rows() == b.rows() && a.cols() == b.cols() &&
         std::memcmp(a.data(), b.data(), sizeof(double) * static_cast<std::size_t>(a.size())) == 0;
}

/// Channels with one value, few, as many as a byte tells apart, one more, and none that comes
/// twice; a hole behind 300 rows.
Record record() {
  Matrix u(600, 4), y(600, 2);
  for (Index row = 0; row < 600; ++row) {
    u.row(row) << 7.5, 0.1 * double(row % 9), double(row % 256), double(row % 257);
    y.row(row) << 1.0 / double(row + 1), (row % 2 == 0 ? 0.0 : -0.0);
  }
  y(5, 1) = std::numeric_limits<double>::quiet_NaN();
  return {0.5, u, y, {{0, 300, 1000}, {300, 600, 1400}}};
}

TEST(PackedRows, GiveTheRowsToTheLastBit) {
  const Record all = record();
  for (const TickRange ticks : {TickRange{1000, 1700}, {1010, 1500}, {1100, 1200}, {1350, 1360}}) {
    const PackedRows packed(all, ticks);
    for (const std::int64_t from : {ticks.begin, ticks.begin + 7, ticks.end - 2, ticks.end}) {
      const Record expected = rows_at(all, {from, ticks.end});
      const Index rows = packed.rows_from(from);
      Record found = packed.blank(rows + 2);
      found.u.setZero();
      found.y.setZero();
      packed.unpack(from, found, 1);
      ASSERT_EQ(rows, expected.rows());
      EXPECT_EQ(found.period_s, 0.5);
      EXPECT_TRUE(same_bits(Matrix(found.u.middleRows(1, rows)), expected.u)) << from;
      EXPECT_TRUE(same_bits(Matrix(found.y.middleRows(1, rows)), expected.y)) << from;
      EXPECT_TRUE(found.u.row(0).isZero(0) && found.u.row(rows + 1).isZero(0));
      for (auto& segment : found.segments) --segment.begin, --segment.end;
      EXPECT_EQ(found.segments, expected.segments);
    }
  }
}

TEST(PackedRows, JoinSegmentsThatGoOn) {
  const Record all = record();
  Record found = PackedRows(all, {1000, 1700}).blank(600);
  PackedRows(all, {1000, 1100}).unpack(0, found, 0);
  PackedRows(all, {1100, 1300}).unpack(0, found, 100);
  PackedRows(all, {1400, 1700}).unpack(0, found, 300);
  EXPECT_EQ(found.segments, all.segments);
  EXPECT_TRUE(same_bits(found.u, all.u));
}

}  // namespace
}  // namespace reident::test::packed_rows_test
