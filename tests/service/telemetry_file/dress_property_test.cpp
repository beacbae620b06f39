// Any dialect of a written-out record gives the record's bits.
#include <fstream>

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include "service/telemetry_file/telemetry_file.hpp"
#include "tests/service/telemetry_file/dress.hpp"
#include "tests/support/temporary_folder.hpp"

namespace reident::telemetry_file::dress_property_test {
namespace {

test::Rows any_rows() {
  test::Rows rows;
  const auto count = *rc::gen::inRange(12, 60);
  const std::int64_t step_s = *rc::gen::element(1, 10, 60, 3600);
  std::int64_t time_s = *rc::gen::inRange<std::int64_t>(1'500'000'000, 1'750'000'000);
  for (int row = 0; row < count; ++row, time_s += step_s) {
    rows.time_ns.push_back(time_s * 1'000'000'000);
    rows.u.push_back(*rc::gen::inRange(-40'000'000, 40'000'000) / 10'000.0 + 0.00001);
    rows.y.push_back(*rc::gen::inRange(0, 1'000'000) / 1000.0);
  }
  return rows;
}

test::Dress any_dress() {
  test::Dress dress;
  dress.separator = *rc::gen::element(',', ';', '\t', '|');
  dress.decimal = *rc::gen::element('.', ',');
  dress.thousands = *rc::gen::element('\0', '\0', dress.decimal == '.' ? ',' : '.', ' ', '\'');
  dress.quotes = *rc::gen::element(false, false, true);
  dress.sep_line = *rc::gen::element(false, false, true);
  dress.metadata = *rc::gen::inRange(0, 4);
  dress.comment = *rc::gen::element<std::string>("", "#", "%", "//");
  dress.units = *rc::gen::arbitrary<bool>();
  dress.line_end = *rc::gen::element<std::string>("\n", "\r\n", "\r");
  dress.text = *rc::gen::element(test::Dress::Text::utf8, test::Dress::Text::utf8_mark,
                                 test::Dress::Text::utf16le, test::Dress::Text::utf16be,
                                 test::Dress::Text::latin1);
  dress.time = static_cast<test::TimeForm>(*rc::gen::inRange(0, test::time_forms));
  dress.last_line_end = *rc::gen::element(true, true, false);
  dress.trailing_separator = *rc::gen::element(false, false, true);
  return dress;
}

RC_GTEST_PROP(Dress, OfAnyKindGivesTheRecordBitForBit, ()) {
  const auto rows = any_rows();
  const auto dress = any_dress();
  const reident::test::TemporaryFolder folder;
  const std::string bytes = test::dressed(rows, dress);
  std::ofstream(folder / "t.csv", std::ios::binary) << bytes;
  RC_LOG() << bytes.substr(0, 600) << "\n";
  ReadingOptions options;
  options.latest_ns = 1'800'000'000'000'000'000;
  auto opened = TelemetryFile::open(folder / "t.csv", options);
  if (const auto* error = std::get_if<Error>(&opened)) RC_FAIL(error->message);
  auto& file = std::get<TelemetryFile>(opened);
  if (const auto error = file.find_time()) RC_FAIL(error->message);
  RC_LOG() << file.found() << "\n";
  const auto u = file.find(
                 "u (\xC2\xB5"
                 "A)"),
             y = file.find("y");
  RC_ASSERT(std::holds_alternative<std::size_t>(u) && std::holds_alternative<std::size_t>(y));
  for (std::size_t row = 0; row < rows.time_ns.size(); ++row) {
    const auto step = file.next();
    if (step == TelemetryFile::Step::error) RC_FAIL(file.error().message);
    if (step == TelemetryFile::Step::end && !dress.last_line_end) {  // its last number looks cut
      RC_ASSERT(row + 1 == rows.time_ns.size() && !file.remarks().empty());
      return;
    }
    RC_ASSERT(step == TelemetryFile::Step::row);
    RC_ASSERT(file.time_ns() == rows.time_ns[row]);
    RC_ASSERT(file.cell(std::get<std::size_t>(u)).value == rows.u[row]);
    RC_ASSERT(file.cell(std::get<std::size_t>(y)).value == rows.y[row]);
  }
  RC_ASSERT(file.next() == TelemetryFile::Step::end);
  if (dress.units) RC_ASSERT(file.unit(std::get<std::size_t>(y)) == "V");
}

}  // namespace
}  // namespace reident::telemetry_file::dress_property_test
