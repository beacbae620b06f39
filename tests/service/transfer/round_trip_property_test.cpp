// What is exported and imported again is the same, to the last bit.
#include <bit>
#include <cmath>

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include "tests/service/transfer/transfer_fixture.hpp"

namespace reident::transfer::round_trip_property_test {
namespace {

using storage::Origin;
using storage::Quality;

/// Any double, the odd ones often.
double any_value() {
  return *rc::gen::oneOf(
      rc::gen::map(rc::gen::arbitrary<std::uint64_t>(),
                   [](std::uint64_t bits) { return std::bit_cast<double>(bits); }),
      rc::gen::map(rc::gen::inRange(-1000, 1000), [](int steps) { return steps * 0.025; }),
      rc::gen::element(0.0, -0.0, std::nan(""), std::numeric_limits<double>::infinity()));
}

std::vector<storage::TelemetryFrame> any_frames() {
  std::vector<storage::TelemetryFrame> frames;
  const auto count = *rc::gen::inRange<std::size_t>(1, 60);
  while (frames.size() < count) {
    storage::TelemetryFrame frame;
    frame.spacecraft = *rc::gen::element<std::string>("SAT-1", "SAT,2", "SAT \"3\"");
    frame.source = *rc::gen::element<std::string>("station", "other\nstation", "import:x.csv");
    frame.origin = *rc::gen::element(Origin::real, Origin::simulated);
    frame.sequence = frames.size();
    frame.generation_time =
        *rc::gen::oneOf(rc::gen::map(rc::gen::inRange(0, 50),
                                     [](int step) {
                                       return storage::Time{1'700'000'000'000'000'000} +
                                              step * storage::Time{500'000'000};
                                     }),
                        rc::gen::arbitrary<storage::Time>());
    for (std::uint32_t id = 1; id <= 3; ++id)
      if (*rc::gen::arbitrary<bool>())
        frame.samples.push_back({id, *rc::gen::elementOf(storage::qualities), any_value()});
    frames.push_back(std::move(frame));
  }
  return frames;
}

RC_GTEST_PROP(RoundTrip, AnImportedExportHoldsTheSameSamples, ()) {
  const test::TemporaryFolder folder;
  storage::Database first(folder / "first.db", storage::Database::Mode::read_write);
  storage::Archive archive(first, {.chunk_samples = 16, .recent_samples = 20});
  for (const char* spacecraft : {"SAT-1", "SAT,2"})
    archive.describe({{test::descriptor(spacecraft, 1, "V_BUS", ""),
                       test::descriptor(spacecraft, 2, "a, \"quoted\" name", "")}});
  archive.append(any_frames());
  if (*rc::gen::arbitrary<bool>()) archive.compact();
  RC_PRE(archive.sample_count() > 0);
  const std::string text = test::exported(first);
  storage::test::write_file(folder / "all.csv", text);

  storage::Database second(folder / "second.db", storage::Database::Mode::read_write);
  ImportOptions options;
  options.file = folder / "all.csv";
  options.reading.force_times = true;  // any times
  const auto report = test::import(
      second, options, {.samples = *rc::gen::inRange<std::uint64_t>(1, 100), .frames = 50});
  RC_ASSERT(report.total.stored == archive.sample_count());
  RC_ASSERT(test::exported(second) == text);

  // Text that is the same could hide values that are not: look at the bits.
  const auto before = storage::all_series(first), after = storage::all_series(second);
  RC_ASSERT(before.size() == after.size());
  for (std::size_t i = 0; i < before.size(); ++i) {
    const auto read = [](const storage::Database& database, const storage::SeriesInfo& one) {
      storage::SampleColumns all;
      storage::SeriesBatches batches(database, one.id, test::everything().range, 1, {});
      for (storage::SampleColumns some; batches.next(some);) all.append(some, 0, some.size());
      return all;
    };
    const auto a = read(first, before[i]), b = read(second, after[i]);
    RC_ASSERT(a.time == b.time);
    RC_ASSERT(a.quality == b.quality);
    for (std::size_t k = 0; k < a.size(); ++k)
      RC_ASSERT((std::isnan(a.value[k]) && std::isnan(b.value[k])) ||
                std::bit_cast<std::uint64_t>(a.value[k]) ==
                    std::bit_cast<std::uint64_t>(b.value[k]));
  }
}

}  // namespace
}  // namespace reident::transfer::round_trip_property_test
