#include "storage/care/completeness.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <limits>
#include <map>

#include <fmt/format.h>

#include "service/cli/config_options.hpp"
#include "service/cli/history_access.hpp"
#include "service/cli/output/far_telemetry.hpp"
#include "service/cli/output/stored_version.hpp"
#include "service/cli/output/table.hpp"
#include "service/cli/output/throughput.hpp"
#include "service/cli/time_options.hpp"
#include "service/cli/verb.hpp"
#include "service/support/progress.hpp"
#include "service/support/text.hpp"
#include "service/support/time_text.hpp"
#include "service/windows/window_data.hpp"

namespace reident::cli::completeness_verb {
namespace {

using nlohmann::ordered_json;
using storage::BinCounts;
using storage::SeriesInfo;
using storage::Time;
using storage::TimeBins;

constexpr Time second_ns = 1'000'000'000;
constexpr Time hour_ns = 3600 * second_ns;
constexpr Time day_ns = 24 * hour_ns;
constexpr std::size_t most_bins = 100'000;
constexpr int bar_width = 20;

struct Arguments {
  HistoryAccessOptions access;
  std::optional<std::string> spacecraft, equipment;
  std::vector<std::string> parameters;
  TimeOptions time;
  std::string by = "day";
  bool detail = false;
  bool json = false;
};

/// A spacecraft's telemetry, or its simulator's.
struct Group {
  std::string spacecraft;
  storage::Origin origin = storage::Origin::real;
  std::vector<SeriesInfo> series;
  std::vector<std::vector<BinCounts>> counts;  // of each series
  std::vector<std::uint64_t> frames_missing;   // sequence numbers, of each bin

  BinCounts sum(std::size_t bin) const {
    BinCounts all;
    std::uint64_t gaps = 0;
    for (const auto& of_series : counts) {
      all += of_series[bin];
      gaps = std::max(gaps, of_series[bin].gaps);
    }
    all.gaps = gaps;  // one in many parameters is one: those of the parameter with the most
    return all;
  }
  std::vector<FarTelemetry> far(const TimeBins& bins) const {
    std::vector<std::uint64_t> came;
    for (std::size_t bin = 0; bin < bins.count(); ++bin) came.push_back(sum(bin).came);
    return far_telemetry(bins, came);
  }
};

/// What is asked for, by name.
struct Wanted {
  std::optional<std::string> spacecraft;
  std::vector<std::string> parameters;
};

std::optional<Refusal> add_equipment(const Arguments& arguments, Wanted& wanted) {
  if (!arguments.equipment) return std::nullopt;
  auto chosen = chosen_config(arguments.access.database.config);
  if (auto* refusal = std::get_if<Refusal>(&chosen)) return std::move(*refusal);
  const auto& config = std::get<std::optional<Config>>(chosen);
  if (!config)
    return Refusal{
        fmt::format("--equipment needs the configuration that lists its parameters: "
                    "there is no {} here, name one with --config FILE",
                    default_config_file)};
  const auto parsed = parse_subject(*arguments.equipment);
  if (const auto* refusal = std::get_if<Refusal>(&parsed)) return *refusal;
  Subject subject = std::get<Subject>(parsed);
  if (subject.spacecraft.empty()) subject.spacecraft = wanted.spacecraft.value_or("");
  std::vector<std::string> names;
  for (const SpacecraftConfig& spacecraft : config->spacecraft)
    for (const EquipmentConfig& equipment : spacecraft.equipment) {
      names.push_back(spacecraft.name + "/" + equipment.name);
      if (equipment.name != subject.equipment ||
          (!subject.spacecraft.empty() && spacecraft.name != subject.spacecraft))
        continue;
      wanted = {spacecraft.name, parameters_of(equipment)};
      return std::nullopt;
    }
  return Refusal{fmt::format("the configuration has no equipment {}; it has {}",
                             *arguments.equipment, joined(names))};
}

std::variant<std::vector<Group>, Refusal> groups_of(const history::TelemetryReader& telemetry,
                                                    const Wanted& wanted) {
  std::vector<Group> groups;
  std::vector<std::string> spacecraft;
  const auto& names = wanted.parameters;
  for (SeriesInfo& one : telemetry.series()) {
    if (spacecraft.empty() || spacecraft.back() != one.spacecraft)
      spacecraft.push_back(one.spacecraft);
    if ((wanted.spacecraft && one.spacecraft != *wanted.spacecraft) ||
        (!names.empty() && std::find(names.begin(), names.end(), one.name) == names.end()))
      continue;
    if (groups.empty() || groups.back().spacecraft != one.spacecraft ||
        groups.back().origin != one.origin)
      groups.push_back({one.spacecraft, one.origin, {}, {}, {}});
    groups.back().series.push_back(std::move(one));
  }
  if (!groups.empty()) return groups;
  if (spacecraft.empty()) return Refusal{"there is no telemetry in the archive"};
  return Refusal{fmt::format("the archive has no telemetry of {}{}; its spacecraft: {}",
                             wanted.spacecraft.value_or("any spacecraft"),
                             names.empty() ? "" : " called " + joined(names), joined(spacecraft))};
}

std::variant<TimeBins, Refusal> bins_of(const std::vector<Group>& groups,
                                        const Arguments& arguments) {
  storage::TimeRange all{std::numeric_limits<Time>::max(), std::numeric_limits<Time>::min()};
  for (const Group& group : groups)
    for (const SeriesInfo& one : group.series)
      all = {std::min(all.begin, one.first), std::max(all.end, one.last)};
  if (all.end < std::numeric_limits<Time>::max()) ++all.end;
  const auto range = chosen_range(arguments.time, all);
  if (const auto* refusal = std::get_if<Refusal>(&range)) return *refusal;
  const TimeBins bins(std::get<storage::TimeRange>(range),
                      arguments.by == "hour" ? hour_ns : day_ns);
  if (bins.count() <= most_bins) return bins;
  return Refusal{
      fmt::format("{} to {} has {} {}s, at most {} are shown; narrow it with --from and "
                  "--to",
                  time_text(bins.range().begin), time_text(bins.range().end), bins.count(),
                  arguments.by, most_bins)};
}

void count_frames(const std::vector<storage::SequenceGap>& gaps, const TimeBins& bins,
                  Group& group) {
  group.frames_missing.assign(bins.count(), 0);
  for (const storage::SequenceGap& gap : gaps) {
    if (gap.spacecraft != group.spacecraft || gap.origin != group.origin ||
        gap.before < bins.range().begin || gap.before >= bins.range().end)
      continue;
    std::uint64_t& missing = group.frames_missing[bins.of(gap.before)];
    const std::uint64_t more = gap.last - gap.first;
    missing = more >= std::numeric_limits<std::uint64_t>::max() - missing
                  ? std::numeric_limits<std::uint64_t>::max()
                  : missing + more + 1;
  }
}

void count(const history::TelemetryReader& telemetry, const TimeBins& bins,
           std::vector<Group>& groups) {
  const auto gaps = telemetry.sequence_gaps();
  std::size_t all = 0, done = 0;
  for (const Group& group : groups) all += group.series.size();
  Progress bar;
  for (Group& group : groups) {
    Time until = std::numeric_limits<Time>::min();
    for (const SeriesInfo& one : group.series) until = std::max(until, one.last);
    for (const SeriesInfo& one : group.series) {
      group.counts.push_back(telemetry.completeness(one, bins, until));
      bar.update(static_cast<double>(++done) / static_cast<double>(all),
                 fmt::format("{} of {} parameters", done, all));
    }
    count_frames(gaps, bins, group);
  }
}

/// Rounded down: 100 where nothing is missing, and nowhere else.
double percent(const BinCounts& counts) {
  if (counts.expected() == 0) return 0;
  constexpr double hundredths = 10'000;
  const double share = static_cast<double>(counts.came) / static_cast<double>(counts.expected());
  return std::floor(hundredths * share) / 100;
}

std::string bar_of(const BinCounts& counts) {
  const int filled = static_cast<int>(percent(counts) / 100 * bar_width);
  return std::string(static_cast<std::size_t>(filled), '#') +
         std::string(static_cast<std::size_t>(bar_width - filled), '.');
}

std::string longest_text(const BinCounts& counts) {
  if (counts.gaps == 0) return "-";
  return rough_duration(static_cast<double>(counts.longest_gap) / static_cast<double>(second_ns));
}

std::string begin_text(const TimeBins& bins, std::size_t bin, const std::string& by) {
  const std::string text = time_text(bins.at(bin).begin);
  constexpr std::size_t date = 10, date_and_hour = 13;
  return by == "hour" ? text.substr(0, date_and_hour) + "h" : text.substr(0, date);
}

std::vector<std::string> cells_of(const std::string& what, const BinCounts& counts) {
  const bool none = counts.expected() == 0;
  return {what,
          fmt::format("{}", counts.came),
          fmt::format("{}", counts.expected()),
          none ? "-" : fmt::format("{:.2f}", percent(counts)),
          none ? "" : bar_of(counts),
          fmt::format("{}", counts.gaps),
          longest_text(counts)};
}

constexpr auto right = Table::Align::right;

void print_text(const Group& group, const TimeBins& bins, const Arguments& arguments) {
  fmt::print("{} ({}), {} parameters, samples by {} (UTC)\n", group.spacecraft,
             storage::name(group.origin), group.series.size(), arguments.by);
  Table table({{arguments.by},
               {"came", right},
               {"expected", right},
               {"%", right},
               {""},
               {"gaps", right},
               {"longest", right},
               {"frames missing", right}});
  BinCounts all;
  std::uint64_t frames = 0;
  const auto add = [&](const std::string& what, const BinCounts& counts, std::uint64_t missing) {
    auto cells = cells_of(what, counts);
    cells.push_back(fmt::format("{}", missing));
    table.add(std::move(cells));
  };
  for (std::size_t bin = 0; bin < bins.count(); ++bin) {
    const BinCounts counts = group.sum(bin);
    add(begin_text(bins, bin, arguments.by), counts, group.frames_missing[bin]);
    all += counts;
    frames += group.frames_missing[bin];
  }
  add("all", all, frames);
  fmt::print("{}", table.text(0));
  for (const FarTelemetry& far : group.far(bins)) fmt::print("{}\n", sentence(far));
  if (!arguments.detail) return;
  Table detail({{"parameter"},
                {"came", right},
                {"expected", right},
                {"%", right},
                {""},
                {"gaps", right},
                {"longest", right}});
  for (std::size_t i = 0; i < group.series.size(); ++i) {
    BinCounts counts;
    for (const BinCounts& one : group.counts[i]) counts += one;
    detail.add(cells_of(group.series[i].name, counts));
  }
  fmt::print("\n{}", detail.text(0));
}

ordered_json json_of(const BinCounts& counts) {
  return {
      {"came", counts.came},
      {"expected", counts.expected()},
      {"percent", counts.expected() == 0 ? ordered_json() : ordered_json(percent(counts))},
      {"gaps", counts.gaps},
      {"longest_gap_s", static_cast<double>(counts.longest_gap) / static_cast<double>(second_ns)}};
}

ordered_json json_of(const Group& group, const TimeBins& bins, bool detail) {
  const auto list = [&](const auto& counts_of) {
    ordered_json all = ordered_json::array();
    for (std::size_t bin = 0; bin < bins.count(); ++bin) {
      ordered_json one = {{"begin", time_text(bins.at(bin).begin)},
                          {"end", time_text(bins.at(bin).end)}};
      one.update(counts_of(bin));
      all.push_back(std::move(one));
    }
    return all;
  };
  ordered_json object = {{"spacecraft", group.spacecraft},
                         {"origin", storage::name(group.origin)},
                         {"bins", list([&](std::size_t bin) {
                            ordered_json one = json_of(group.sum(bin));
                            one["frames_missing"] = group.frames_missing[bin];
                            return one;
                          })}};
  object["far_from_the_rest"] = ordered_json::array();
  for (const FarTelemetry& far : group.far(bins))
    object["far_from_the_rest"].push_back({{"begin", time_text(far.range.begin)},
                                           {"end", time_text(far.range.end)},
                                           {"samples", far.samples}});
  if (!detail) return object;
  object["parameters"] = ordered_json::array();
  for (std::size_t i = 0; i < group.series.size(); ++i)
    object["parameters"].push_back(
        {{"parameter", group.series[i].name},
         {"bins", list([&](std::size_t bin) { return json_of(group.counts[i][bin]); })}});
  return object;
}

void print_json(const std::vector<Group>& groups, const TimeBins& bins,
                const Arguments& arguments) {
  ordered_json list = ordered_json::array();
  for (const Group& group : groups) list.push_back(json_of(group, bins, arguments.detail));
  const ordered_json object = {{"by", arguments.by},
                               {"from", time_text(bins.range().begin)},
                               {"to", time_text(bins.range().end)},
                               {"telemetry", list}};
  fmt::print("{}\n", object.dump(2, ' ', false, ordered_json::error_handler_t::replace));
}

int run(const Arguments& arguments) {
  Wanted wanted{arguments.spacecraft, arguments.parameters};
  if (const auto refusal = add_equipment(arguments, wanted)) return refuse(*refusal);
  return with_readers(arguments.access, [&](const Readers& readers) {
    auto found = groups_of(readers.telemetry, wanted);
    if (const auto* refusal = std::get_if<Refusal>(&found)) return refuse(*refusal);
    auto& groups = std::get<std::vector<Group>>(found);
    const auto bins = bins_of(groups, arguments);
    if (const auto* refusal = std::get_if<Refusal>(&bins)) return refuse(*refusal);
    count(readers.telemetry, std::get<TimeBins>(bins), groups);
    if (arguments.json) {
      print_json(groups, std::get<TimeBins>(bins), arguments);
      return static_cast<int>(exit_done);
    }
    for (const Group& group : groups) {
      if (&group != &groups.front()) fmt::print("\n");
      print_text(group, std::get<TimeBins>(bins), arguments);
    }
    return static_cast<int>(exit_done);
  });
}

std::function<int()> declare(CLI::App& command) {
  const auto arguments = std::make_shared<Arguments>();
  add_archive_options(command, arguments->access);
  command.add_option("--spacecraft", arguments->spacecraft, "this one alone (all)");
  CLI::Option* parameters =
      command.add_option("--parameter", arguments->parameters, "these alone (all)");
  command
      .add_option("--equipment", arguments->equipment,
                  "the parameters of EQUIPMENT or SPACECRAFT/EQUIPMENT alone")
      ->excludes(parameters);
  add_time_options(command, arguments->time, "samples");
  command.add_option("--by", arguments->by, "day or hour, of UTC")
      ->check(CLI::IsMember({"day", "hour"}))
      ->capture_default_str();
  command.add_flag("--parameters", arguments->detail, "a table of the parameters as well");
  command.add_flag("--json", arguments->json, "one JSON object");
  command.footer(
      "Missing are the samples that would stand in the gaps of each parameter, by its own step.\n"
      "A gap counts on the day on which it begins, once where it is in many parameters; what is "
      "missing on the days where it would stand; frames are missing by their sequence numbers. "
      "Works while reidentd writes.\n"
      "Example:\n"
      "  reident completeness reident.db --spacecraft SAT-1 --from 2026-03-01 --by hour");
  return [arguments] { return run(*arguments); };
}

const VerbRegistration registered(
    {"completeness", "Count for each day the samples that came and those that are missing",
     WorksOn::history, declare});

}  // namespace

}  // namespace reident::cli::completeness_verb
