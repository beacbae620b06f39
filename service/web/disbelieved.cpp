#include "service/web/disbelieved.hpp"

#include <algorithm>
#include <functional>
#include <utility>

#include "service/review/evidence.hpp"
#include "service/web/json.hpp"

namespace reident::web {

void DisbelievedSensors::add(const storage::Attempt& attempt) {
  const Json implausible = evidence_of(attempt).value("implausible", Json::object());
  const Json longest = implausible.value("longest", Json::array());
  left_out_ += implausible.value("stretches", longest.size()) - longest.size();
  for (const Json& one : longest) {
    Disbelieved part{
        .spacecraft = attempt.spacecraft,
        .check = one.value("check", ""),
        .relation = one.value("relation", ""),
        .parameters = one.value("parameters", std::vector<std::string>()),
        .range = {one.value("begin_ns", storage::Time{0}), one.value("end_ns", storage::Time{0})},
        .equipment = {attempt.equipment},
        .residual = one.value("residual", double{NAN}),
        .tolerance = one.value("tolerance", double{NAN})};
    const Subject subject{part.spacecraft, part.check, part.relation, part.parameters};
    found_[subject].push_back(std::move(part));
  }
}

std::vector<Disbelieved> DisbelievedSensors::take() && {
  std::vector<Disbelieved> all;
  for (auto& [subject, parts] : found_) {
    std::ranges::sort(parts, {}, [](const Disbelieved& one) { return one.range.begin; });
    const std::size_t first = all.size();
    for (Disbelieved& part : parts) {
      if (all.size() == first || part.range.begin > all.back().range.end + pause_) {
        all.push_back(std::move(part));
        continue;
      }
      Disbelieved& last = all.back();
      last.stretches += part.range.begin > last.range.end ? 1 : 0;
      last.range.end = std::max(last.range.end, part.range.end);
      last.equipment.merge(part.equipment);
      if (std::abs(part.residual) > std::abs(last.residual)) {
        last.residual = part.residual;
        last.tolerance = part.tolerance;
      }
    }
  }
  std::ranges::stable_sort(all, std::ranges::greater(),
                           [](const Disbelieved& one) { return one.range.end; });
  return all;
}

}  // namespace reident::web
