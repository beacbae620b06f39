// Archive::append against a model that is a std::map.
#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>
#include <map>
#include <memory>
#include <random>

#include <gtest/gtest.h>
#include <rapidcheck.h>
#include <rapidcheck/gtest.h>

#include "tests/storage/fixture.hpp"

namespace reident::storage::test::append_property_test {
namespace {

using Identity = std::tuple<std::string, Origin, std::uint32_t, Time>;

struct Kept {
  double value = 0;
  Quality quality = Quality::good;
};

std::uint64_t bits(double value) {
  return std::isnan(value) ? ~std::uint64_t{0} : std::bit_cast<std::uint64_t>(value);
}

/// The rules of archive.hpp in the most direct words.
class Model {
 public:
  AppendReport append(const std::vector<TelemetryFrame>& frames) {
    AppendReport report;
    for (const TelemetryFrame& f : frames)
      for (Sample sample : f.samples) {
        if (!std::isfinite(sample.value)) sample.quality = Quality::invalid, ++report.non_finite;
        add({f.spacecraft, f.origin, sample.parameter, f.generation_time},
            {sample.value, sample.quality}, report);
      }
    return report;
  }
  std::map<Identity, Kept> samples;

 private:
  void add(const Identity& identity, Kept incoming, AppendReport& report) {
    const auto& [spacecraft, origin, parameter, time] = identity;
    const auto found = samples.find(identity);
    if (found == samples.end()) {
      ++report.stored;
      const auto newer = samples.upper_bound(identity);
      if (newer != samples.end()) {
        const auto& [s, o, p, t] = newer->first;
        if (s == spacecraft && o == origin && p == parameter) ++report.late;
      }
      samples[identity] = incoming;
      return;
    }
    ++(bits(found->second.value) == bits(incoming.value) ? report.duplicates : report.conflicts);
    Kept& kept = found->second;
    if (origin == Origin::real && kept.quality == Quality::good &&
        incoming.quality == Quality::good && kept.value != incoming.value)
      kept.quality = Quality::disputed;
    if (kept.quality != Quality::disputed && is_better(incoming.quality, kept.quality))
      kept = incoming;
  }
};

template <typename T>
rc::Gen<std::vector<T>> few(rc::Gen<T> one) {
  return rc::gen::scale(0.3, rc::gen::container<std::vector<T>>(std::move(one)));
}

// Few identities and few values, so that they meet often.
rc::Gen<Sample> samples() {
  return rc::gen::build<Sample>(
      rc::gen::set(&Sample::parameter, rc::gen::inRange(1U, 4U)),
      rc::gen::set(&Sample::quality, rc::gen::elementOf(qualities)),
      rc::gen::set(&Sample::value, rc::gen::element(0.0, -0.0, 1.0, 28.5, std::nan(""),
                                                    std::numeric_limits<double>::infinity())));
}

rc::Gen<TelemetryFrame> frames() {
  return rc::gen::build<TelemetryFrame>(
      rc::gen::set(&TelemetryFrame::spacecraft, rc::gen::element<std::string>("CB4", "CB4A")),
      rc::gen::set(&TelemetryFrame::source, rc::gen::element<std::string>("a", "b")),
      rc::gen::set(&TelemetryFrame::origin, rc::gen::element(Origin::real, Origin::simulated)),
      rc::gen::set(&TelemetryFrame::sequence, rc::gen::inRange<std::uint64_t>(0, 20)),
      rc::gen::set(&TelemetryFrame::generation_time,
                   rc::gen::oneOf(rc::gen::inRange<Time>(0, 12),
                                  rc::gen::element(std::numeric_limits<Time>::min(),
                                                   std::numeric_limits<Time>::max()))),
      rc::gen::set(&TelemetryFrame::samples, few(samples())));
}

std::map<Identity, Kept> contents(const Archive& archive) {
  std::map<Identity, Kept> found;
  for (const std::string& spacecraft : archive.spacecraft())
    for (const Origin origin : {Origin::real, Origin::simulated})
      for (std::uint32_t parameter = 1; parameter < 4; ++parameter) {
        const Series series =
            archive.read(spacecraft, origin, parameter,
                         {std::numeric_limits<Time>::min(), std::numeric_limits<Time>::max()});
        RC_ASSERT(std::is_sorted(series.time.begin(), series.time.end()));
        for (std::size_t i = 0; i < series.time.size(); ++i)
          found[{spacecraft, origin, parameter, series.time[i]}] = {series.value[i],
                                                                    series.quality[i]};
      }
  return found;
}

void same_contents(const Archive& archive, const std::map<Identity, Kept>& expected) {
  const std::map<Identity, Kept> found = contents(archive);
  RC_ASSERT(found.size() == expected.size());
  RC_ASSERT(archive.sample_count() == expected.size());
  for (const auto& [identity, kept] : expected) {
    RC_ASSERT(found.contains(identity));
    RC_ASSERT(bits(found.at(identity).value) == bits(kept.value));
    RC_ASSERT(found.at(identity).quality == kept.quality);
  }
}

/// From compacting with each append to hardly ever.
rc::Gen<ArchiveOptions> options() {
  return rc::gen::build<ArchiveOptions>(
      rc::gen::set(&ArchiveOptions::chunk_samples, rc::gen::inRange<std::size_t>(16, 40)),
      rc::gen::set(&ArchiveOptions::recent_samples, rc::gen::inRange<std::size_t>(1, 60)),
      rc::gen::set(&ArchiveOptions::recent_batches, rc::gen::inRange<std::size_t>(1, 8)));
}

RC_GTEST_PROP(AppendProperty, HoldsWhatTheModelHolds, ()) {
  const TemporaryFolder folder;
  Database database(folder / "a.db", Database::Mode::read_write);
  Archive archive(database, *options());
  Model model;
  const auto batches = *few(few(frames()));
  for (const std::vector<TelemetryFrame>& batch : batches) {
    const AppendReport got = archive.append(batch), expected = model.append(batch);
    RC_ASSERT(got.frames == batch.size());
    RC_ASSERT(got.stored == expected.stored);
    RC_ASSERT(got.duplicates == expected.duplicates);
    RC_ASSERT(got.conflicts == expected.conflicts);
    RC_ASSERT(got.late == expected.late);
    RC_ASSERT(got.non_finite == expected.non_finite);
    same_contents(archive, model.samples);
  }
  archive.compact();
  same_contents(archive, model.samples);
  RC_ASSERT(rows(folder / "a.db", "SELECT count(*) FROM recent") == std::vector<std::string>{"0"});
}

// Long ranges in few series, which fill, split and join chunks.
RC_GTEST_PROP(AppendProperty, LongRangesInAnyOrderStayWhatTheyAre, ()) {
  const TemporaryFolder folder;
  const ArchiveOptions some = *options();
  auto database = std::make_unique<Database>(folder / "a.db", Database::Mode::read_write);
  auto archive = std::make_unique<Archive>(*database, some);
  Model model;
  const auto ranges = *rc::gen::container<std::vector<std::pair<Time, Time>>>(
      rc::gen::pair(rc::gen::inRange<Time>(0, 300), rc::gen::inRange<Time>(1, 90)));
  for (const auto& [begin, length] : ranges) {
    std::vector<TelemetryFrame> batch;
    for (Time t = begin; t < begin + length; ++t)
      batch.push_back(frame(static_cast<std::uint64_t>(t), t,
                            {{1, qualities[static_cast<std::size_t>(length) % qualities.size()],
                              static_cast<double>(length)},
                             {2, Quality::good, static_cast<double>(t % 7)}}));
    if (length % 3 == 0) std::reverse(batch.begin(), batch.end());
    archive->append(batch);
    model.append(batch);
    if (length % 5 == 0) {
      archive.reset();
      database.reset();
      database = std::make_unique<Database>(folder / "a.db", Database::Mode::read_write);
      archive = std::make_unique<Archive>(*database, some);
    }
  }
  same_contents(*archive, model.samples);
  archive->compact();
  same_contents(*archive, model.samples);
  RC_ASSERT(rows(folder / "a.db",
                 "SELECT count(*) FROM chunk AS a JOIN chunk AS b USING (series) WHERE "
                 "a.first_time < b.first_time AND a.last_time >= b.first_time;"
                 "SELECT sum(chunk.samples) FROM chunk; "
                 "SELECT count(*) FROM chunk_data WHERE id NOT IN (SELECT data FROM chunk)") ==
            (std::vector<std::string>{
                "0", model.samples.empty() ? "NULL" : std::to_string(model.samples.size()), "0"}));
}

RC_GTEST_PROP(AppendProperty, DistinctSamplesMayArriveInAnyOrderAndAnyBatches, ()) {
  std::vector<TelemetryFrame> distinct;
  Model model;
  for (TelemetryFrame& f : *few(frames())) {
    std::vector<Sample> fresh;
    for (const Sample& sample : f.samples)
      if (!model.samples.contains({f.spacecraft, f.origin, sample.parameter, f.generation_time})) {
        fresh.push_back(sample);
        TelemetryFrame single = f;
        single.samples = {sample};
        model.append({single});
      }
    f.samples = fresh;
    distinct.push_back(f);
  }
  const TemporaryFolder folder;
  Database database(folder / "a.db", Database::Mode::read_write);
  Archive archive(database);
  std::mt19937 random(*rc::gen::arbitrary<std::uint32_t>());
  std::shuffle(distinct.begin(), distinct.end(), random);
  const std::span<const TelemetryFrame> shuffled(distinct);
  for (std::size_t first = 0; first < shuffled.size();) {
    const std::size_t count = std::min(shuffled.size() - first, std::size_t{1 + random() % 4});
    archive.append(shuffled.subspan(first, count));
    first += count;
  }
  same_contents(archive, model.samples);
}

RC_GTEST_PROP(AppendProperty, ABatchAppendedTwiceChangesNothing, ()) {
  const TemporaryFolder folder;
  Database database(folder / "a.db", Database::Mode::read_write);
  Archive archive(database);
  const auto batch = *few(frames());
  archive.append(batch);
  const std::map<Identity, Kept> before = contents(archive);
  const AppendReport again = archive.append(batch);
  RC_ASSERT(again.stored == 0U);
  RC_ASSERT(again.touched.empty());
  same_contents(archive, before);
}

RC_GTEST_PROP(AppendProperty, EveryChangeBelowTheSealLiesInAMark, ()) {
  const TemporaryFolder folder;
  Database database(folder / "a.db", Database::Mode::read_write);
  Archive archive(database);
  archive.append(*few(frames()));
  const std::map<Identity, Kept> before = contents(archive);
  const Time seal = *rc::gen::inRange<Time>(0, 12);
  for (const char* spacecraft : {"CB4", "CB4A"}) archive.seal(spacecraft, seal);
  const auto batches = *few(few(frames()));
  for (const std::vector<TelemetryFrame>& batch : batches) archive.append(batch);
  for (const auto& [identity, kept] : contents(archive)) {
    const auto& [spacecraft, origin, parameter, time] = identity;
    const auto old = before.find(identity);
    const bool changed = old == before.end() || bits(old->second.value) != bits(kept.value) ||
                         old->second.quality != kept.quality;
    if (!changed || time >= seal) continue;
    const std::vector<LateRange> late = archive.late_ranges(spacecraft);
    RC_ASSERT(std::any_of(late.begin(), late.end(),
                          [&, o = origin, p = parameter, t = time](const LateRange& range) {
                            return range.origin == o && range.parameter == p &&
                                   range.range.begin <= t && t < range.range.end;
                          }));
  }
}

RC_GTEST_PROP(AppendProperty, SealedTimeCanBeReadAsItWasBeforeAnyBatch, ()) {
  const TemporaryFolder folder;
  Database database(folder / "a.db", Database::Mode::read_write);
  Archive archive(database, *options());
  for (const char* spacecraft : {"CB4", "CB4A"})
    archive.seal(spacecraft, std::numeric_limits<Time>::max());
  std::vector<std::pair<std::int64_t, std::map<Identity, Kept>>> states;
  auto batches = *few(few(frames()));
  for (std::vector<TelemetryFrame>& batch : batches) {
    std::erase_if(batch, [](const TelemetryFrame& f) {  // a seal ends before it
      return f.generation_time == std::numeric_limits<Time>::max();
    });
    const std::map<Identity, Kept> was = contents(archive);
    if (archive.append(batch).touched.empty()) continue;
    const auto last = rows(folder / "a.db", "SELECT max(batch) FROM revision");
    states.emplace_back(std::stoll(last.at(0)), was);
  }
  for (const auto& [batch, was] : states) {
    const std::map<Identity, Kept> found = contents(archive.before(batch));
    RC_ASSERT(found.size() == was.size());
    for (const auto& [identity, kept] : was) {
      RC_ASSERT(bits(found.at(identity).value) == bits(kept.value));
      RC_ASSERT(found.at(identity).quality == kept.quality);
    }
  }
}

}  // namespace
}  // namespace reident::storage::test::append_property_test
