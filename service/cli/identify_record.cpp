#include "service/cli/identify_record.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include <fmt/format.h>

#include "identification/samples/grid.hpp"
#include "identification/samples/tick_ranges.hpp"
#include "service/support/floor_divide.hpp"
#include "service/support/time_text.hpp"
#include "service/windows/ticks.hpp"

namespace reident::cli {
namespace {

using identification::Index;
using identification::Record;

// The daemon's default: a sample serves this many periods.
constexpr std::int64_t sample_hold_periods = 3;
constexpr double held_worth_a_word = 0.01;  // of the samples
constexpr double complete_enough = 0.5;     // of the ticks, below which the gaps are worth a word
// Between parts, more than a run goes on through however many rows there are (hole_bridging.hpp).
std::int64_t ticks_apart(const IdentifyTable& table) {
  return static_cast<std::int64_t>(table.rows) / 100 + 100;
}

/// What a column says: its samples without the blanks.
struct Samples {
  std::vector<std::int64_t> time_ns;
  std::vector<double> value;
  std::vector<std::size_t> part;

  void add(std::int64_t time, double sample, std::size_t in_part) {
    time_ns.push_back(time);
    value.push_back(sample);
    part.push_back(in_part);
  }
};

/// `time_ns` are those of the rows.
std::vector<Samples> samples_of(const IdentifyTable& table,
                                const std::vector<std::int64_t>& time_ns) {
  std::vector<Samples> samples(table.columns.size());
  for (std::size_t c = 0; c < samples.size(); ++c)
    for (std::size_t row = 0; row < table.rows; ++row) {
      if (table.columns[c].is_blank[row] != 0) continue;
      samples[c].add(time_ns[row], table.columns[c].value[row], table.part[row]);
    }
  return samples;
}

std::vector<std::int64_t> steps_of(const std::vector<std::int64_t>& time_ns,
                                   const std::vector<std::size_t>& part) {
  std::vector<std::int64_t> steps;
  for (std::size_t i = 1; i < time_ns.size(); ++i)
    if (part[i] == part[i - 1] && time_ns[i] > time_ns[i - 1])
      steps.push_back(time_ns[i] - time_ns[i - 1]);
  return steps;
}

std::int64_t quantile(std::vector<std::int64_t> values, double share) {
  const auto at = static_cast<std::ptrdiff_t>(share * static_cast<double>(values.size() - 1));
  std::nth_element(values.begin(), values.begin() + at, values.end());
  return values[static_cast<std::size_t>(at)];
}

/// The column that comes most seldom, and its usual step.
struct Slowest {
  std::string name;  // that of the time column where all come equally often
  std::int64_t step_ns = 0;
};

std::variant<Slowest, Refusal> slowest_of(const IdentifyTable& table, const GridRequest& request) {
  if (steps_of(table.time_ns, table.part).empty())
    return Refusal{fmt::format(
        "--time {} never moves; name a column that holds the time of each row", request.time_name)};
  const auto samples = samples_of(table, table.time_ns);
  Slowest slowest;
  bool differ = false;
  for (std::size_t c = 0; c < samples.size(); ++c) {
    const auto steps = steps_of(samples[c].time_ns, samples[c].part);
    if (steps.empty())
      return Refusal{fmt::format("column {} has {} samples at different times; a model needs many",
                                 table.names[c], samples[c].time_ns.empty() ? 0 : 1)};
    const std::int64_t step = usual_step(steps);
    differ = differ || (c > 0 && step != slowest.step_ns);
    if (step > slowest.step_ns) slowest = {table.names[c], step};
  }
  if (!differ) slowest.name = request.time_name;
  return slowest;
}

std::string hold_text(std::int64_t ns) {
  const std::int64_t second = 1'000'000'000;
  return ns < second ? duration_text(ns) : duration_text((ns + second - 1) / second * second);
}

std::variant<std::int64_t, Refusal> period_of(const GridRequest& request, const Slowest& slowest,
                                              std::string_view hold_advice,
                                              std::vector<std::string>& warnings) {
  if (!request.period_s) {
    warnings.push_back(fmt::format(
        "the rows were put on a grid of {}, the usual step of {}{}; --period chooses another",
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
        fmt::format("--period {} is too short for {}, whose usual step is {}: a sample serves {} "
                    "periods; make it at "
                    "least {}{}",
                    *request.period_s, slowest.name, duration_text(slowest.step_ns),
                    sample_hold_periods, hold_text(least), hold_advice)};
  constexpr std::int64_t hardly_any = 1000;  // one row in so many is repeated
  if (period < slowest.step_ns - slowest.step_ns / hardly_any && !request.hold_ns)
    warnings.push_back(fmt::format(
        "--period {} is shorter than {}, the usual step of {}: its values are repeated, and the "
        "model has the repeats in it",
        *request.period_s, duration_text(slowest.step_ns), slowest.name));
  return period;
}

/// Times of the rows on one axis, whose ticks are the multiples of the period.
struct Placed {
  std::vector<std::int64_t> time_ns;
  std::int64_t phase_ns = 0;  // of the first part: how far behind the multiples its ticks stand
  std::int64_t end_ns = 0;    // behind the last tick, whose values are all that came of it
};

/// Each part gets its own phase, unless one is given, and comes long behind the one before.
Placed place_rows(const IdentifyTable& table, std::int64_t period_ns,
                  std::optional<std::int64_t> phase_ns) {
  Placed placed{table.time_ns};
  const std::int64_t apart_ns = ticks_apart(table) * period_ns;
  for (std::size_t begin = 0; begin < table.rows;) {
    std::size_t end = begin;
    std::vector<std::vector<std::int64_t>> channels(table.columns.size());
    for (; end < table.rows && table.part[end] == table.part[begin]; ++end)
      for (std::size_t c = 0; c < channels.size(); ++c)
        if (table.columns[c].is_blank[end] == 0) channels[c].push_back(table.time_ns[end]);
    const std::int64_t phase = phase_ns.value_or(suitable_phase(channels, period_ns));
    std::int64_t shift = -phase;
    if (begin == 0)
      placed.phase_ns = phase;
    else
      shift += floor_divide(placed.time_ns[begin - 1] + apart_ns - table.time_ns[begin] + phase,
                            period_ns) *
               period_ns;
    for (std::size_t row = begin; row < end; ++row) placed.time_ns[row] += shift;
    placed.end_ns = placed.time_ns[end - 1] + phase + 1;
    begin = end;
  }
  return placed;
}

/// Gaps of the column whose values reach least far.
struct Gaps {
  std::string name;
  std::int64_t longest_ns = 0, mends_ns = 0;
};

Gaps gaps_of(const IdentifyTable& table) {
  const auto samples = samples_of(table, table.time_ns);
  Gaps worst;
  for (std::size_t c = 0; c < samples.size(); ++c) {
    auto gaps = steps_of(samples[c].time_ns, samples[c].part);
    if (gaps.empty()) continue;
    if (samples[c].part.back() == table.part.back())
      gaps.push_back(table.time_ns.back() - samples[c].time_ns.back() + 1);
    const std::int64_t longest = *std::max_element(gaps.begin(), gaps.end());
    if (longest <= worst.longest_ns) continue;
    // A gap that is far longer than the others is lost telemetry.
    const std::int64_t usual = quantile(gaps, 0.9);
    worst = {table.names[c], longest, longest > 10 * usual ? quantile(gaps, 0.98) : longest};
  }
  return worst;
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
        age = column.is_blank[row] != 0 && table.part[row] == table.part[row - 1] ? age + 1 : 0;
        if (age > 0 && age < held) column.value[row] = column.value[row - 1];
      }
  }
  std::vector<std::size_t> kept;
  const auto tick_of = [&](std::size_t row) {
    return static_cast<std::int64_t>(row) +
           static_cast<std::int64_t>(table.part[row]) * ticks_apart(table);
  };
  GridRecord made;
  Record& record = made.record;
  record.period_s = period_s;
  for (std::size_t row = 0; row < table.rows; ++row) {
    made.tick_of_row.push_back(tick_of(row));
    if (!std::all_of(table.columns.begin(), table.columns.end(),
                     [row](const auto& column) { return std::isfinite(column.value[row]); }))
      continue;
    const auto at = static_cast<Index>(kept.size());
    if (kept.empty() || kept.back() + 1 != row || table.part[row] != table.part[row - 1])
      record.segments.push_back({at, at, tick_of(row)});
    record.segments.back().end = at + 1;
    kept.push_back(row);
  }
  made.tick_of_row.push_back(tick_of(table.rows - 1) + 1);
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

/// The ticks from the first row of each part to its last.
std::int64_t ticks_of_parts(const IdentifyTable& table,
                            const std::vector<std::int64_t>& tick_of_row) {
  std::int64_t ticks = 0;
  for (std::size_t row = 0; row < table.rows; ++row) {
    if (row + 1 == table.rows || table.part[row + 1] != table.part[row])
      ticks += tick_of_row[row] + 1;
    if (row == 0 || table.part[row - 1] != table.part[row]) ticks -= tick_of_row[row];
  }
  return ticks;
}

/// Ticks behind the last row of a part, at which its values would be held.
identification::TickSet ticks_between_parts(const IdentifyTable& table,
                                            const std::vector<std::int64_t>& tick_of_row) {
  identification::TickSet between;
  for (std::size_t row = 1; row < table.rows; ++row)
    if (table.part[row] != table.part[row - 1])
      between.push_back({tick_of_row[row - 1] + 1, tick_of_row[row]});
  return between;
}

/// Whether a column comes when it changes. Then steps from one tick to the next leave out the small
/// ones, which are as frequent as larger ones in what comes as it is: those within a dead band, or
/// those of less than the least step, a quantum, which are half as many as are of it.
bool comes_on_change(const Samples& samples, std::int64_t period_ns) {
  std::vector<double> steps;
  for (std::size_t i = 1; i < samples.value.size(); ++i)
    if (samples.part[i] == samples.part[i - 1] &&
        samples.time_ns[i] - samples.time_ns[i - 1] <= period_ns + period_ns / 2)
      steps.push_back(std::abs(samples.value[i] - samples.value[i - 1]));
  std::sort(steps.begin(), steps.end());
  const auto up_to = [&](double step) {
    return std::upper_bound(steps.begin(), steps.end(), step) - steps.begin();
  };
  const std::ptrdiff_t none = up_to(0);
  if (none == std::ssize(steps)) return false;
  const std::ptrdiff_t least = up_to(1.5 * steps[static_cast<std::size_t>(none)]) - none;
  const double median = steps[steps.size() / 2];
  return (least >= 10 && 8 * none < least) || 16 * up_to(median / 4) < std::ssize(steps);
}

/// Ends the hold of each sample of a column that speaks at every tick, unless it comes on change,
/// where the next one is due and does not come. Says of both how often it did not.
void mark_what_did_not_come(const IdentifyTable& table, std::vector<Samples>& samples,
                            std::int64_t period_ns, std::vector<std::string>& warnings) {
  for (std::size_t c = 0; c < samples.size(); ++c) {
    const auto steps = steps_of(samples[c].time_ns, samples[c].part);
    if (quantile(steps, 0.5) > period_ns) continue;
    const bool on_change = comes_on_change(samples[c], period_ns);
    Samples marked;
    std::size_t late = 0;
    for (std::size_t i = 0; i < samples[c].value.size(); ++i) {
      const std::int64_t due = marked.time_ns.empty() ? 0 : marked.time_ns.back() + period_ns;
      const bool is_late = i > 0 && samples[c].part[i] == samples[c].part[i - 1] &&
                           samples[c].time_ns[i] > due + period_ns / 2;
      late += is_late;
      if (is_late && !on_change)
        marked.add(due, std::numeric_limits<double>::quiet_NaN(), samples[c].part[i]);
      marked.add(samples[c].time_ns[i], samples[c].value[i], samples[c].part[i]);
    }
    if (static_cast<double>(late) > held_worth_a_word * static_cast<double>(steps.size()))
      warnings.push_back(fmt::format(
          "column {} is silent {} times where its next sample was due, and {}", table.names[c],
          late,
          on_change ? fmt::format("the value before serves on; --hold {} leaves such ticks out",
                                  duration_text(period_ns))
                    : fmt::format("such ticks are left out; --hold {} lets the value before serve",
                                  duration_text(sample_hold_periods * period_ns))));
    samples[c] = std::move(marked);
  }
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
  const Placed placed = place_rows(table, period_ns, request.phase_ns);
  made.phase_ns = placed.phase_ns;
  if (placed.phase_ns != 0 && !request.phase_ns)
    made.warnings.push_back(fmt::format(
        "ticks stand {0} behind the multiples of {1}, where all columns have come, as "
        "in a service (--phase 0s, or phase = \"0s\" there, puts them on the multiples)",
        duration_text(placed.phase_ns), duration_text(period_ns)));
  auto samples = samples_of(table, placed.time_ns);
  if (!request.hold_ns) mark_what_did_not_come(table, samples, period_ns, made.warnings);
  const std::vector<std::uint8_t> usable(2 * table.rows, 1);  // not finite counts as unusable
  std::vector<identification::ChannelSamples> channels;
  for (const Samples& column : samples)
    channels.push_back(
        {column.time_ns, column.value, std::span(usable).first(column.value.size())});
  const std::span all(channels);
  const std::int64_t begin = placed.time_ns.front(), end = placed.end_ns;
  made.record =
      make_record(all.first(inputs), all.subspan(inputs), begin, end, {period_ns, hold_ns});
  const auto tick_at_or_after = [&](std::int64_t time) { return -floor_divide(-time, period_ns); };
  for (const std::int64_t time : placed.time_ns) made.tick_of_row.push_back(tick_at_or_after(time));
  made.tick_of_row.push_back(tick_at_or_after(end));
  made.record = without(std::move(made.record), ticks_between_parts(table, made.tick_of_row));
  const auto ticks = static_cast<double>(ticks_of_parts(table, made.tick_of_row));
  const auto complete = static_cast<double>(made.record.rows());
  if (gaps.mends_ns > hold_ns && complete < complete_enough * ticks)
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
