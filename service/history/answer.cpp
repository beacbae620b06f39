#include "service/history/answer.hpp"

#include <algorithm>
#include <array>
#include <stdexcept>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "service/dds/wire.hpp"
#include "service/history/subjects.hpp"
#include "service/support/text.hpp"
#include "storage/registry/registry.hpp"

namespace reident::history {
namespace {

struct Subject {
  std::string_view name;
  AnswerSubject answer;
  bool is_of_registry;
};

constexpr std::array subjects{
    Subject{"equipment", equipment_page, true},
    Subject{"attempts", attempts_page, true},
    Subject{"versions", versions_page, true},
    Subject{"model", models_page, true},
    Subject{"decisions", decisions_page, true},
    Subject{"champion", champions_page, true},
    Subject{"overview", overview_page, true},
    Subject{"waiting", waiting_page, true},
    Subject{"alarms", alarms_page, false},
    Subject{"simulators", simulators_page, false},
    Subject{"blocks", blocks_page, true},
    Subject{"scores", scores_page, true},
    Subject{"parameters", parameters_page, false},
    Subject{"series", series_page, false},
    Subject{"sources", sources_page, false},
    Subject{"sequence_gaps", sequence_gaps_page, false},
    Subject{"samples", samples_page, false},
    Subject{"completeness", completeness_page, false},
};

const Subject& subject_of(const HistoryQuery& query) {
  const auto found = std::find_if(subjects.begin(), subjects.end(),
                                  [&](const Subject& one) { return one.name == query.subject; });
  if (found != subjects.end()) return *found;
  std::vector<std::string> names;
  for (const Subject& subject : subjects) names.emplace_back(subject.name);
  throw std::invalid_argument(
      fmt::format("there is no subject '{:.60}'; ask for one of {}", query.subject, joined(names)));
}

void check_name(const char* field, const std::string& name) {
  if (name.size() > dds::max_name_bytes)
    throw std::invalid_argument(fmt::format("{} has {} bytes; a name has at most {}", field,
                                            name.size(), dds::max_name_bytes));
  if (std::any_of(name.begin(), name.end(),
                  [](char c) { return static_cast<unsigned char>(c) < 0x20 || c == 0x7f; }))
    throw std::invalid_argument(
        fmt::format("{} has a control character; write the name without it", field));
}

void check_numbers(const HistoryQuery& query) {
  if (query.page_size < 1 || query.page_size > max_page_rows)
    throw std::invalid_argument(fmt::format("page_size is {}; ask for 1 to {} rows a page",
                                            query.page_size, max_page_rows));
  if (query.range.end < query.range.begin)
    throw std::invalid_argument("the range ends before it begins; swap begin_ns and end_ns");
  if (query.version < 0)
    throw std::invalid_argument(fmt::format(
        "version is {}; versions count from 1, and 0 selects every one", query.version));
}

/// A name that nobody knows is rather a mistake than an empty history.
void check_equipment(storage::Database& database, const HistoryQuery& query) {
  if (query.spacecraft.empty() && query.equipment.empty()) return;
  std::vector<std::string> known;
  for (const auto& [spacecraft, equipment] : storage::Registry(database).equipment()) {
    if ((query.spacecraft.empty() || query.spacecraft == spacecraft) &&
        (query.equipment.empty() || query.equipment == equipment))
      return;
    known.push_back(spacecraft + "/" + equipment);
  }
  const auto or_any = [](const std::string& name) { return name.empty() ? "(any)" : name; };
  throw std::invalid_argument(fmt::format("nothing is known about {}/{}; the service has {}",
                                          or_any(query.spacecraft), or_any(query.equipment),
                                          known.empty() ? "nothing yet" : joined(known)));
}

}  // namespace

std::variant<HistoryPage, BadQuestion> answer(storage::Database& database,
                                              const HistoryQuery& query) {
  try {
    const Subject& subject = subject_of(query);
    check_name("spacecraft", query.spacecraft);
    check_name("equipment", query.equipment);
    check_numbers(query);
    if (subject.is_of_registry) check_equipment(database, query);
    return subject.answer(database, query);
  } catch (const std::invalid_argument& mistake) {
    return BadQuestion{mistake.what()};
  } catch (const nlohmann::json::exception&) {
    // Sealed like one of ours, with a key that no page of ours has.
    return BadQuestion{"the cursor is damaged; begin again with an empty one"};
  }
}

}  // namespace reident::history
