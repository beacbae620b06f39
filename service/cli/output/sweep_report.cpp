#include "service/cli/output/sweep_report.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

#include <fmt/format.h>

#include "service/cli/output/table.hpp"
#include "service/support/time_text.hpp"

namespace reident::cli {
namespace {

using nlohmann::ordered_json;

std::string number(const ordered_json& value) {
  return value.is_number() ? fmt::format("{:.4g}", value.get<double>()) : "-";
}

/// What would have been over what was; 1 where either is not known.
double ratio(const ordered_json& equipment) {
  const ordered_json& common = equipment.at("common");
  const ordered_json& would = common.at("would_mrse_percent");
  const ordered_json& was = common.at("was_mrse_percent");
  if (!would.is_number() || !was.is_number()) return 1;
  return would.get<double>() / was.get<double>();
}

/// On the cycles that both know; a side's own where there is none.
std::string regret_of(const ordered_json& equipment, const std::string& side) {
  const ordered_json& common = equipment.at("common").at(side + "_regret");
  return number(common.is_number() ? common : equipment.at(side).at("regret"));
}

std::string versions_of(const ordered_json& side) {
  std::size_t versions = 0;
  for (const ordered_json& one : side.at("publications"))
    if (one.at("version") != 0) ++versions;
  return fmt::format("{}", versions);
}

std::string first_of(const ordered_json& side) {
  for (const ordered_json& one : side.at("publications"))
    if (one.at("version") != 0) return time_text(one.at("since_ns")).substr(0, 16);
  return "-";
}

std::string note_of(const ordered_json& equipment) {
  std::string note = equipment.at("note").get<std::string>();
  if (first_of(equipment.at("would")) != "-") return note;
  if (!note.empty()) note += "; ";
  return note + "would publish nothing: " + equipment.value("outcomes", "");
}

std::string name_of(const ordered_json& spacecraft, const ordered_json& equipment) {
  return fmt::format("{}/{}", spacecraft.at("name").get<std::string>(),
                     equipment.at("equipment").get<std::string>());
}

}  // namespace

std::string sweep_table(const ordered_json& report, std::size_t rows, std::size_t width) {
  struct Line {
    double change;
    std::vector<std::string> cells;
  };
  std::vector<Line> lines;
  for (const ordered_json& spacecraft : report.at("spacecraft"))
    for (const ordered_json& one : spacecraft.at("equipment")) {
      const ordered_json &would = one.at("would"), &was = one.at("was"), &common = one.at("common");
      lines.push_back({std::abs(std::log(ratio(one))),
                       {name_of(spacecraft, one), versions_of(was), versions_of(would),
                        first_of(was), first_of(would), number(common.at("was_mrse_percent")),
                        number(common.at("would_mrse_percent")), regret_of(one, "was"),
                        regret_of(one, "would"), note_of(one)}});
    }
  std::ranges::stable_sort(lines, std::ranges::greater(), &Line::change);
  constexpr auto right = Table::Align::right;
  Table table({{"equipment"},
               {"versions: was", right},
               {"would", right},
               {"first: was"},
               {"would"},
               {"error %: was", right},
               {"would", right},
               {"regret: was", right},
               {"would", right},
               {""}});
  const std::size_t shown = rows == 0 ? lines.size() : std::min(rows, lines.size());
  for (std::size_t i = 0; i < shown; ++i) table.add(lines[i].cells);
  std::string text = table.text(width);
  if (shown < lines.size())
    text += fmt::format("and {} more; --long lists all\n", lines.size() - shown);
  return text + fmt::format(
                    "{} windows of {} equipment: errors would be less for {}, more for {}; "
                    "error ratio {}, regret {} instead of {}\n",
                    report.at("windows").get<std::size_t>(),
                    report.at("equipment").get<std::size_t>(),
                    report.at("better").get<std::size_t>(), report.at("worse").get<std::size_t>(),
                    number(report.at("error_ratio")), number(report.at("would_regret")),
                    number(report.at("was_regret")));
}

std::string sweep_publications(const ordered_json& report, std::size_t width) {
  Table table({{"equipment"}, {"telemetry since (UTC)"}, {""}, {"version"}});
  for (const ordered_json& spacecraft : report.at("spacecraft"))
    for (const ordered_json& one : spacecraft.at("equipment")) {
      std::vector<std::pair<std::int64_t, std::vector<std::string>>> lines;
      for (const char* side : {"was", "would"})
        for (const ordered_json& publication : one.at(side).at("publications")) {
          const auto since = publication.at("since_ns").get<std::int64_t>();
          const auto version = publication.at("version").get<std::int64_t>();
          lines.push_back({since,
                           {name_of(spacecraft, one), time_text(since), side,
                            version == 0 ? "none" : fmt::format("{}", version)}});
        }
      std::ranges::stable_sort(lines, {}, &decltype(lines)::value_type::first);
      for (auto& [since, cells] : lines) table.add(std::move(cells));
    }
  return table.text(width);
}

}  // namespace reident::cli
