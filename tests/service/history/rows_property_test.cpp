// Every row comes back from JSON text as it was, to the last bit.
#include <algorithm>
#include <cmath>
#include <limits>
#include <tuple>

#include <gtest/gtest.h>
#include <rapidcheck.h>
#include <rapidcheck/gtest.h>

#include "service/history/rows.hpp"

namespace reident::history::rows_property_test {
namespace {

using storage::Time;

std::string any_bytes() {
  return *rc::gen::container<std::string>(rc::gen::arbitrary<char>());
}

std::string any_document() {
  switch (*rc::gen::inRange(0, 4)) {
    case 0:
      return any_bytes();
    case 1:
      return R"({"a": 1.50, "a": "spaced, twice and with a needless zero"})";
    case 2:
      return R"(["not an object"])";
    default:
      return Json{{"value", *rc::gen::arbitrary<double>()},
                  {"count", *rc::gen::arbitrary<std::int64_t>()},
                  {"text", any_bytes()}}
          .dump(-1, ' ', false, Json::error_handler_t::replace);
  }
}

double any_number() {
  constexpr double inf = std::numeric_limits<double>::infinity();
  return *rc::gen::oneOf(
      rc::gen::arbitrary<double>(),
      rc::gen::element(std::nan(""), inf, -inf, -0.0, 5e-324, 1.7976931348623157e308, 0.1));
}

Time any_time() {
  return *rc::gen::oneOf(
      rc::gen::arbitrary<Time>(),
      rc::gen::element(std::numeric_limits<Time>::min(), std::numeric_limits<Time>::max()));
}

template <typename T>
std::optional<T> sometimes(T value) {
  return *rc::gen::arbitrary<bool>() ? std::optional(std::move(value)) : std::nullopt;
}

/// Bits of a number, one for all that are not a number.
std::uint64_t bits(double number) {
  if (std::isnan(number)) return 1;
  std::uint64_t value = 0;
  std::memcpy(&value, &number, sizeof value);
  return value;
}

/// Through the text of the row.
template <typename Row>
Row there_and_back(const Json& row) {
  Row again{};
  read_row(Json::parse(row.dump()), again);
  return again;
}

auto members(const storage::Attempt& a) {
  return std::tie(a.id, a.spacecraft, a.equipment, a.window.begin, a.window.end, a.trigger, a.time,
                  a.outcome, a.reason, a.version, a.evidence_json, a.configuration_digest,
                  a.program_version);
}

auto members(const storage::Version& v) {
  return std::tie(v.spacecraft, v.equipment, v.number, v.attempt, v.window.begin, v.window.end,
                  v.created, v.model_json, v.digest, v.status, v.parent, v.provenance_json,
                  v.samples_digest);
}

auto members(const storage::Decision& d) {
  return std::tie(d.id, d.spacecraft, d.equipment, d.version, d.kind, d.actor, d.reason, d.time);
}

storage::Decision any_decision() {
  storage::Decision decision;
  decision.id = *rc::gen::arbitrary<std::int64_t>();
  decision.spacecraft = any_bytes();
  decision.equipment = any_bytes();
  decision.version = *rc::gen::arbitrary<std::int64_t>();
  decision.kind = static_cast<storage::DecisionKind>(*rc::gen::inRange(0, 5));
  decision.actor = any_bytes();
  decision.reason = any_bytes();
  decision.time = any_time();
  return decision;
}

RC_GTEST_PROP(HistoryRows, AnAttemptComesBack, ()) {
  storage::Attempt attempt;
  attempt.id = *rc::gen::arbitrary<std::int64_t>();
  attempt.spacecraft = any_bytes();
  attempt.equipment = any_bytes();
  attempt.window = {any_time(), any_time()};
  attempt.trigger = any_bytes();
  attempt.time = any_time();
  attempt.outcome = any_bytes();
  attempt.reason = any_bytes();
  attempt.version = sometimes(*rc::gen::arbitrary<std::int64_t>());
  attempt.evidence_json = any_document();
  attempt.configuration_digest = any_bytes();
  attempt.program_version = any_bytes();
  const auto again = there_and_back<storage::Attempt>(row_of(attempt));
  RC_ASSERT(members(again) == members(attempt));
}

RC_GTEST_PROP(HistoryRows, AVersionComesBack, ()) {
  storage::Version version;
  version.spacecraft = any_bytes();
  version.equipment = any_bytes();
  version.number = *rc::gen::arbitrary<std::int64_t>();
  version.attempt = *rc::gen::arbitrary<std::int64_t>();
  version.window = {any_time(), any_time()};
  version.created = any_time();
  version.model_json = any_document();
  version.digest = any_bytes();
  version.status = any_bytes();
  version.parent = sometimes(*rc::gen::arbitrary<std::int64_t>());
  version.provenance_json = any_document();
  version.samples_digest = any_bytes();
  const auto again = there_and_back<storage::Version>(row_of(version));
  RC_ASSERT(members(again) == members(version));
  version.model_json.clear();
  version.provenance_json.clear();
  const auto summary = there_and_back<storage::Version>(summary_row_of(version));
  RC_ASSERT(members(summary) == members(version));
}

RC_GTEST_PROP(HistoryRows, DecisionsChampionsAndHoldsComeBack, ()) {
  const storage::Decision decision = any_decision();
  const auto again = there_and_back<storage::Decision>(row_of(decision));
  RC_ASSERT(members(again) == members(decision));

  const ChampionRow champion{{any_bytes(), any_bytes()}, sometimes(decision)};
  const auto reign = there_and_back<ChampionRow>(row_of(champion));
  RC_ASSERT(reign.name == champion.name);
  RC_ASSERT(reign.decision.has_value() == champion.decision.has_value());
  if (reign.decision) RC_ASSERT(members(*reign.decision) == members(decision));

  const EquipmentRow equipment{{any_bytes(), any_bytes()},
                               sometimes(storage::Hold{any_bytes(), any_bytes(), any_time()})};
  const auto held = there_and_back<EquipmentRow>(row_of(equipment));
  RC_ASSERT(held.name == equipment.name);
  RC_ASSERT(held.hold.has_value() == equipment.hold.has_value());
  if (held.hold)
    RC_ASSERT(std::tie(held.hold->actor, held.hold->reason, held.hold->since) ==
              std::tie(equipment.hold->actor, equipment.hold->reason, equipment.hold->since));
}

std::vector<double> any_numbers() {
  std::vector<double> numbers(*rc::gen::inRange<std::size_t>(0, 4));
  for (double& number : numbers) number = any_number();
  return numbers;
}

bool same(const std::vector<double>& a, const std::vector<double>& b) {
  return std::equal(a.begin(), a.end(), b.begin(), b.end(),
                    [](double one, double other) { return bits(one) == bits(other); });
}

RC_GTEST_PROP(HistoryRows, BlocksAndScoresComeBack, ()) {
  const storage::Block block{{any_time(), any_time()},
                             *rc::gen::arbitrary<std::int64_t>(),
                             any_number(),
                             any_numbers(),
                             any_numbers(),
                             any_numbers(),
                             any_numbers(),
                             any_numbers()};
  const auto again = there_and_back<storage::Block>(row_of(block));
  RC_ASSERT(again.range == block.range);
  RC_ASSERT(again.rows == block.rows);
  RC_ASSERT(bits(again.believed) == bits(block.believed));
  RC_ASSERT(same(again.output_mean, block.output_mean));
  RC_ASSERT(same(again.output_square, block.output_square));
  RC_ASSERT(same(again.input_low, block.input_low));
  RC_ASSERT(same(again.input_high, block.input_high));
  RC_ASSERT(same(again.baseline_square, block.baseline_square));

  const storage::BlockScore score{*rc::gen::arbitrary<std::int64_t>(),
                                  any_time(),
                                  *rc::gen::arbitrary<std::int64_t>(),
                                  any_numbers(),
                                  any_numbers(),
                                  any_numbers(),
                                  {},
                                  any_numbers()};
  const auto back = there_and_back<storage::BlockScore>(row_of(score));
  RC_ASSERT(std::tie(back.version, back.begin, back.rows) ==
            std::tie(score.version, score.begin, score.rows));
  RC_ASSERT(same(back.mean, score.mean));
  RC_ASSERT(same(back.square, score.square));
  RC_ASSERT(same(back.noise, score.noise));
  RC_ASSERT(same(back.bias_effects, score.bias_effects));
}

RC_GTEST_PROP(HistoryRows, SamplesComeBack, ()) {
  storage::SampleColumns samples;
  const auto size = *rc::gen::inRange<std::size_t>(1, 20);
  const bool uniform = *rc::gen::arbitrary<bool>();
  const storage::Quality quality = *rc::gen::elementOf(storage::qualities);
  for (std::size_t i = 0; i < size; ++i)
    samples.push_back(any_time(),
                      {any_number(), uniform ? quality : *rc::gen::elementOf(storage::qualities),
                       uniform ? 7 : *rc::gen::arbitrary<std::int64_t>()});
  const auto again = there_and_back<storage::SampleColumns>(row_of(samples, 0, size));
  RC_ASSERT(again.time == samples.time);
  RC_ASSERT(again.quality == samples.quality);
  RC_ASSERT(again.source == samples.source);
  for (std::size_t i = 0; i < size; ++i) RC_ASSERT(bits(again.value[i]) == bits(samples.value[i]));
}

TEST(HistoryRows, SamplesOfEachQualityComeBackAndOtherNumbersAreRefused) {
  const storage::Held held{1.5, storage::Quality::good, 7};
  Json row;
  for (const storage::Quality quality : storage::qualities) {
    storage::SampleColumns samples;
    samples.push_back(10, {held.value, quality, held.source});
    row = row_of(samples, 0, 1);
    EXPECT_EQ(row.at("quality"), storage::wire_value(quality));
    EXPECT_EQ(there_and_back<storage::SampleColumns>(row).quality.at(0), quality);
  }
  for (const int number : {-1, static_cast<int>(storage::qualities.size()), 256}) {
    row["quality"] = number;
    EXPECT_THROW(there_and_back<storage::SampleColumns>(row), std::exception) << number;
  }
}

RC_GTEST_PROP(HistoryRows, WhatDescribesTelemetryComesBack, ()) {
  const storage::ParameterDescriptor parameter{
      any_bytes(),
      *rc::gen::arbitrary<std::uint32_t>(),
      any_bytes(),
      any_bytes(),
      any_bytes(),
      *rc::gen::element(storage::ParameterKind::analog, storage::ParameterKind::digital),
      sometimes(*rc::gen::arbitrary<double>()),
      sometimes(*rc::gen::arbitrary<double>())};
  RC_ASSERT(there_and_back<storage::ParameterDescriptor>(row_of(parameter)) == parameter);

  const storage::SeriesInfo series{
      *rc::gen::arbitrary<std::int64_t>(),
      any_bytes(),
      *rc::gen::element(storage::Origin::real, storage::Origin::simulated),
      *rc::gen::arbitrary<std::uint32_t>(),
      any_bytes(),
      *rc::gen::arbitrary<std::uint64_t>(),
      any_time(),
      any_time()};
  const auto same = there_and_back<storage::SeriesInfo>(row_of(series));
  RC_ASSERT(std::tie(same.id, same.spacecraft, same.origin, same.parameter, same.name, same.samples,
                     same.first, same.last) == std::tie(series.id, series.spacecraft, series.origin,
                                                        series.parameter, series.name,
                                                        series.samples, series.first, series.last));

  const std::pair<std::int64_t, std::string> source{*rc::gen::arbitrary<std::int64_t>(),
                                                    any_bytes()};
  RC_ASSERT((there_and_back<std::pair<std::int64_t, std::string>>(row_of(source)) == source));
}

RC_GTEST_PROP(HistoryRows, CountsAndGapsComeBack, ()) {
  CountsRow counts{*rc::gen::arbitrary<std::size_t>(), {}};
  for (int i = *rc::gen::inRange(0, 9); i > 0; --i)
    counts.counts.push_back({*rc::gen::arbitrary<std::uint64_t>(),
                             *rc::gen::arbitrary<std::uint64_t>(),
                             *rc::gen::arbitrary<std::uint64_t>(), any_time()});
  const auto again = there_and_back<CountsRow>(row_of(counts));
  RC_ASSERT(again.first == counts.first);
  RC_ASSERT(again.counts.size() == counts.counts.size());
  for (std::size_t i = 0; i < counts.counts.size(); ++i) {
    const storage::BinCounts &a = again.counts[i], &b = counts.counts[i];
    RC_ASSERT(std::tie(a.came, a.missing, a.gaps, a.longest_gap) ==
              std::tie(b.came, b.missing, b.gaps, b.longest_gap));
  }

  const storage::SequenceGap gap{any_bytes(),
                                 any_bytes(),
                                 storage::Origin::simulated,
                                 *rc::gen::arbitrary<std::uint64_t>(),
                                 *rc::gen::arbitrary<std::uint64_t>(),
                                 any_time(),
                                 any_time()};
  const auto same = there_and_back<storage::SequenceGap>(row_of(gap));
  RC_ASSERT(std::tie(same.spacecraft, same.source, same.origin, same.first, same.last, same.before,
                     same.after) == std::tie(gap.spacecraft, gap.source, gap.origin, gap.first,
                                             gap.last, gap.before, gap.after));
}

TEST(HistoryRows, ADocumentThatJsonWritesTheSameStandsAsAnObject) {
  storage::Attempt attempt;
  attempt.evidence_json = R"({"mrse_percent":2.5})";
  EXPECT_EQ(row_of(attempt)["evidence"]["mrse_percent"], 2.5);
}

TEST(HistoryRows, ARowOfAnotherKindIsRefused) {
  const Json source = row_of(std::pair<std::int64_t, std::string>(1, "station"));
  storage::Attempt attempt;
  EXPECT_ANY_THROW(read_row(source, attempt));
  storage::SampleColumns samples;
  EXPECT_ANY_THROW(read_row(Json{{"times_ns", {1, 2}}, {"values", {1}}}, samples));
}

}  // namespace
}  // namespace reident::history::rows_property_test
