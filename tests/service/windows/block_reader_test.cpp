#include "service/windows/block_reader.hpp"

#include <map>

#include "tests/service/daemon_fixture.hpp"

namespace reident::test::block_reader_test {
namespace {

class Blocks : public DaemonTest {};

bool are_same(const identification::Matrix& a, const identification::Matrix& b) {
  return a.rows() == b.rows() && a.cols() == b.cols() && a == b;
}

TEST_F(Blocks, SayWhichSamplesCanChangeThem) {
  storage::Database database = open();
  storage::Archive archive{database};
  archive.describe(descriptors());
  archive.append(telemetry(day, 300));
  archive.append(telemetry(day + 310 * second, 890));
  const EquipmentConfig equipment = plant();
  const auto read_all = [&] {
    std::map<storage::Time, BlockSamples> blocks;
    BlockReader reader("SAT", equipment);
    for (storage::Time begin = day; begin < day + 20 * minute; begin += reader.length())
      blocks[begin] = reader.read(archive, begin);
    return blocks;
  };
  const auto before = read_all();
  archive.append(telemetry(day + 300 * second, 10));
  const auto after = read_all();
  const BlockReader reader("SAT", equipment);
  int changed = 0, untouched = 0;
  for (const auto& [begin, block] : after) {
    const bool reads = reader.reads(begin, {day + 300 * second, day + 310 * second});
    const BlockSamples& old = before.at(begin);
    const bool differs =
        block.block.rows != old.block.rows || block.block.believed != old.block.believed ||
        !are_same(block.record.y, old.record.y) || !are_same(block.record.u, old.record.u);
    EXPECT_TRUE(reads || !differs) << (begin - day) / second;
    changed += differs ? 1 : 0;
    untouched += reads ? 0 : 1;
  }
  EXPECT_GE(changed, 1);
  EXPECT_GE(untouched, 20 + 35) << "those before, and those of more than four cycles later";
}

TEST_F(Blocks, AreNotBelievedWhereTheOutputHasNotMovedInAllThatIsChecked) {
  storage::Database database = open();
  storage::Archive archive{database};
  archive.describe(descriptors());
  auto frames = telemetry(day, 1800);
  for (std::size_t k = 600; k < 1200; ++k)
    frames[k].samples[2].value = frames[600].samples[2].value;
  archive.append(frames);
  BlockReader reader("SAT", plant());
  const auto believed = [&](int second_of_day) {
    return reader.read(archive, day + second_of_day * second).block.believed;
  };
  EXPECT_EQ(believed(570), 1);
  for (const int stuck : {630, 900, 1155}) EXPECT_EQ(believed(stuck), 0) << stuck;
  EXPECT_EQ(believed(1500), 1);
}

}  // namespace
}  // namespace reident::test::block_reader_test
