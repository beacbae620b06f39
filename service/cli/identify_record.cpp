#include "service/cli/identify_record.hpp"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "identification/samples/grid.hpp"
#include "service/support/floor_divide.hpp"
#include "service/support/time_text.hpp"

namespace reident::cli {
namespace {

using identification::Index;
using identification::Record;

// The daemon's default: a sample serves this many periods.
constexpr std::int64_t sample_hold_periods = 3;
constexpr double complete_enough = 0.5;  // of the ticks, below which the gaps are worth a word
constexpr std::size_t phases_tried = 200;

/// What a column says: its samples without the blanks.
struct Samples {
  std::vector<std::int64_t> time_ns;
  std::vector<double> value;
};

std::vector<Samples> samples_of(const IdentifyTable& table, std::int64_t phase_ns) {
  std::vector<Samples> samples(table.columns.size());
  for (std::size_t c = 0; c < samples.size(); ++c)
    for (std::size_t row = 0; row < table.rows; ++row) {
      if (table.columns[c].is_blank[row] != 0) continue;
      samples[c].time_ns.push_back(table.time_ns[row] - phase_ns);
      samples[c].value.push_back(table.columns[c].value[row]);
    }
  return samples;
}

std::vector<std::int64_t> steps_of(const std::vector<std::int64_t>& time_ns) {
  std::vector<std::int64_t> steps;
  for (std::size_t i = 1; i < time_ns.size(); ++i)
    if (time_ns[i] > time_ns[i - 1]) steps.push_back(time_ns[i] - time_ns[i - 1]);
  return steps;
}

std::int64_t quantile(std::vector<std::int64_t> values, double share) {
  const auto at = static_cast<std::ptrdiff_t>(share * static_cast<double>(values.size() - 1));
  std::nth_element(values.begin(), values.begin() + at, values.end());
  return values[static_cast<std::size_t>(at)];
}

std::int64_t median(std::vector<std::int64_t> values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

/// The column that comes most seldom, and its usual step.
struct Slowest {
  std::string name;  // that of the time column where all come equally often
  std::int64_t step_ns = 0;
};

std::variant<Slowest, Refusal> slowest_of(const IdentifyTable& table, const GridRequest& request) {
  if (steps_of(table.time_ns).empty())
    return Refusal{fmt::format(
        "--time {} never moves; name a column that holds the time of each row", request.time_name)};
  const auto samples = samples_of(table, 0);
  Slowest slowest;
  bool differ = false;
  for (std::size_t c = 0; c < samples.size(); ++c) {
    const auto steps = steps_of(samples[c].time_ns);
    if (steps.empty())
      return Refusal{fmt::format("column {} has {} samples at different times; a model needs many",
                                 table.names[c], samples[c].time_ns.empty() ? 0 : 1)};
    const std::int64_t step = median(steps);
    differ = differ || (c > 0 && step != slowest.step_ns);
    if (step > slowest.step_ns) slowest = {table.names[c], step};
  }
  if (!differ) slowest.name = request.time_name;
  return slowest;
}

std::variant<std::int64_t, Refusal> period_of(const GridRequest& request, const Slowest& slowest,
                                              std::string_view hold_advice,
                                              std::vector<std::string>& warnings) {
  if (!request.period_s) {
    warnings.push_back(fmt::format(
        "the rows were put on a grid of {}, the median step of {}{}; --period chooses another",
        duration_text(slowest.step_ns), slowest.name,
        slowest.name == request.time_name
            ? ""
            : ", the slowest column (--hold lets its samples serve a shorter period)"));
    return slowest.step_ns;
  }
  const auto period = static_cast<std::int64_t>(std::llround(*request.period_s * 1e9));
  const std::int64_t least = (slowest.step_ns + sample_hold_periods - 1) / sample_hold_periods;
  if (period < least && !request.hold_ns)
    return Refusal{
        fmt::format("--period {} is too short for {}, whose median step is {}: a sample serves {} "
                    "periods; make it at "
                    "least {}{}",
                    *request.period_s, slowest.name, duration_text(slowest.step_ns),
                    sample_hold_periods, duration_text(least), hold_advice)};
  return period;
}

/// How far behind the multiples of a period ticks stand best: so that the values at a tick are as
/// young as possible. 0 where all columns speak at the same times.
std::int64_t phase_of(const IdentifyTable& table, std::int64_t period_ns) {
  bool apart = false;
  for (const auto& column : table.columns)
    apart = apart || column.is_blank != table.columns.front().is_blank;
  if (!apart) return 0;
  const auto samples = samples_of(table, 0);
  std::vector<std::vector<std::int64_t>> phases(samples.size());
  for (std::size_t c = 0; c < samples.size(); ++c) {
    const std::size_t every = std::max<std::size_t>(1, samples[c].time_ns.size() / phases_tried);
    for (std::size_t i = 0; i < samples[c].time_ns.size(); i += every)
      phases[c].push_back(samples[c].time_ns[i] -
                          floor_divide(samples[c].time_ns[i], period_ns) * period_ns);
  }
  const auto age_at = [&](std::int64_t phase) {
    double sum = 0;
    for (const auto& channel : phases) {
      double age = 0;
      for (const std::int64_t at : channel)
        age += static_cast<double>(phase >= at ? phase - at : phase - at + period_ns);
      sum += age / static_cast<double>(channel.size());
    }
    return sum;
  };
  std::int64_t best = 0;
  double least = age_at(0);
  const double worth =
      0.1 * static_cast<double>(period_ns);  // less is not worth ticks that stand elsewhere
  for (const auto& channel : phases)
    for (const std::int64_t phase : channel)
      if (const double age = age_at(phase); age < least - (best == 0 ? worth : 0)) {
        best = phase;
        least = age;
      }
  return best;
}

/// Gaps of the column whose values reach least far.
struct Gaps {
  std::string name;
  std::int64_t longest_ns = 0, mends_ns = 0;
};

Gaps gaps_of(const IdentifyTable& table) {
  const auto samples = samples_of(table, 0);
  Gaps worst;
  for (std::size_t c = 0; c < samples.size(); ++c) {
    auto gaps = steps_of(samples[c].time_ns);
    if (gaps.empty()) continue;
    gaps.push_back(table.time_ns.back() - samples[c].time_ns.back() + 1);
    const std::int64_t longest = *std::max_element(gaps.begin(), gaps.end());
    if (longest <= worst.longest_ns) continue;
    // A gap that is far longer than the others is lost telemetry.
    const std::int64_t usual = quantile(gaps, 0.9);
    worst = {table.names[c], longest, longest > 10 * usual ? quantile(gaps, 0.98) : longest};
  }
  return worst;
}

std::string hold_text(std::int64_t ns) {
  const std::int64_t second = 1'000'000'000;
  return ns < second ? duration_text(ns) : duration_text((ns + second - 1) / second * second);
}

/// Rows one period apart; a row with a cell that holds no number is a hole.
GridRecord rows_as_ticks(const IdentifyTable& asked, std::size_t inputs,
                         const GridRequest& request) {
  IdentifyTable table = asked;
  const double period_s = request.period_s.value_or(1);
  if (request.hold_ns) {
    const auto held =
        static_cast<std::size_t>(static_cast<double>(*request.hold_ns) * 1e-9 / period_s);
    for (auto& column : table.columns)
      for (std::size_t row = 1, age = 0; row < table.rows; ++row) {
        age = column.is_blank[row] != 0 ? age + 1 : 0;
        if (age > 0 && age < held) column.value[row] = column.value[row - 1];
      }
  }
  std::vector<std::size_t> kept;
  GridRecord made;
  Record& record = made.record;
  record.period_s = period_s;
  for (std::size_t row = 0; row < table.rows; ++row) {
    made.tick_of_row.push_back(static_cast<std::int64_t>(row));
    if (!std::all_of(table.columns.begin(), table.columns.end(),
                     [row](const auto& column) { return std::isfinite(column.value[row]); }))
      continue;
    const auto at = static_cast<Index>(kept.size());
    if (kept.empty() || kept.back() + 1 != row)
      record.segments.push_back({at, at, static_cast<std::int64_t>(row)});
    record.segments.back().end = at + 1;
    kept.push_back(row);
  }
  made.tick_of_row.push_back(static_cast<std::int64_t>(table.rows));
  const auto rows = static_cast<Index>(kept.size());
  record.u.resize(rows, static_cast<Index>(inputs));
  record.y.resize(rows, static_cast<Index>(table.columns.size() - inputs));
  for (std::size_t c = 0; c < table.columns.size(); ++c)
    for (Index r = 0; r < rows; ++r) {
      const double value = table.columns[c].value[kept[static_cast<std::size_t>(r)]];
      if (c < inputs)
        record.u(r, static_cast<Index>(c)) = value;
      else
        record.y(r, static_cast<Index>(c - inputs)) = value;
    }
  if (const std::size_t lost = table.rows - kept.size(); lost != 0)
    made.warnings.push_back(
        fmt::format("{} of {} rows have a missing or non-numeric cell and were left out; the "
                    "record is split there",
                    lost, table.rows));
  return made;
}

}  // namespace

std::variant<GridRecord, Refusal> put_on_grid(const IdentifyTable& table, std::size_t inputs,
                                              const GridRequest& request) {
  if (table.time_ns.empty()) return rows_as_ticks(table, inputs, request);
  GridRecord made;
  const auto slowest = slowest_of(table, request);
  if (const auto* refusal = std::get_if<Refusal>(&slowest)) return *refusal;
  const Gaps gaps = gaps_of(table);
  const std::string mend = fmt::format("--hold {}", hold_text(gaps.mends_ns));
  const auto period = period_of(
      request, std::get<Slowest>(slowest),
      fmt::format(", or let samples serve longer: {} has gaps of up to {}, {} reaches across them",
                  gaps.name, hold_text(gaps.longest_ns), mend),
      made.warnings);
  if (const auto* refusal = std::get_if<Refusal>(&period)) return *refusal;
  const auto period_ns = std::get<std::int64_t>(period);
  const std::int64_t hold_ns = request.hold_ns.value_or(sample_hold_periods * period_ns);
  const std::int64_t phase_ns = phase_of(table, period_ns);
  if (phase_ns != 0)
    made.warnings.push_back(
        fmt::format("the columns have rows of their own: ticks stand {} behind the multiples of "
                    "{}, where the last of them has come",
                    duration_text(phase_ns), duration_text(period_ns)));
  const auto samples = samples_of(table, phase_ns);
  const std::vector<std::uint8_t> usable(table.rows, 1);
  std::vector<identification::ChannelSamples> channels;
  for (const Samples& column : samples)
    channels.push_back(
        {column.time_ns, column.value, std::span(usable).first(column.value.size())});
  const std::span all(channels);
  const std::int64_t begin = table.time_ns.front() - phase_ns,
                     end = table.time_ns.back() - phase_ns + 1;
  made.record =
      make_record(all.first(inputs), all.subspan(inputs), begin, end, {period_ns, hold_ns});
  const auto tick_at_or_after = [&](std::int64_t time) { return -floor_divide(-time, period_ns); };
  for (const std::int64_t time : table.time_ns)
    made.tick_of_row.push_back(tick_at_or_after(time - phase_ns));
  made.tick_of_row.push_back(tick_at_or_after(end));
  const auto ticks = static_cast<double>(made.tick_of_row.back() - made.tick_of_row.front());
  const auto complete = static_cast<double>(made.record.rows());
  if (gaps.longest_ns > hold_ns && complete < complete_enough * ticks)
    made.advice = fmt::format(
        "{} of {} ticks of {} are complete: {} has gaps of up to {}, and a sample serves {}; "
        "{} reaches across them",
        complete, ticks, duration_text(period_ns), gaps.name, hold_text(gaps.longest_ns),
        duration_text(hold_ns), mend);
  std::size_t lost = 0;
  for (std::size_t row = 0; row < table.rows; ++row)
    lost += std::any_of(table.columns.begin(), table.columns.end(),
                        [row](const auto& column) {
                          return column.is_blank[row] == 0 && !std::isfinite(column.value[row]);
                        })
                ? 1U
                : 0U;
  if (lost != 0)
    made.warnings.push_back(
        fmt::format("{} of {} rows have a missing or non-numeric cell and were left out; the "
                    "record is split there",
                    lost, table.rows));
  if (!made.advice.empty()) made.warnings.push_back(made.advice);
  return made;
}

}  // namespace reident::cli
