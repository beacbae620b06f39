#include "service/satcs/reference/life_text.hpp"

#include <algorithm>
#include <charconv>

#include <fmt/format.h>

#include "service/satcs/event_time.hpp"
#include "service/support/csv.hpp"

namespace reident::satcs {

using reference::LifeEvent;
using reference::LifeKind;

std::string life_kind_names() {
  std::string names;
  for (const LifeKind kind : reference::life_kinds()) {
    if (!names.empty()) names += ", ";
    names += reference::name(kind);
  }
  return names;
}

std::variant<LifeEvent, LifeError> parse_life_event(std::string_view text, storage::Time start) {
  const auto wrong = [text](const std::string& what) {
    return LifeError{fmt::format("'{}': {}", text, what)};
  };
  const auto at = text.find('@');
  if (at == std::string_view::npos) {
    return wrong("is not KIND@TIME[/TIME][*MAGNITUDE][#UNIT], such as capacity_fade@+1d/+20d*0.2");
  }
  const auto kinds = reference::life_kinds();
  const auto kind = std::find_if(kinds.begin(), kinds.end(), [&](LifeKind one) {
    return reference::name(one) == text.substr(0, at);
  });
  if (kind == kinds.end()) {
    return wrong(fmt::format("there is no event '{}'; the events are: {}", text.substr(0, at),
                             life_kind_names()));
  }
  std::string_view begin = text.substr(at + 1);
  LifeEvent event = reference::usual(*kind, 0, 0);
  if (const auto unit = cut_after_last(begin, '#')) {
    const auto [end, error] =
        std::from_chars(unit->data(), unit->data() + unit->size(), event.unit);
    if (error != std::errc{} || end != unit->data() + unit->size()) {
      return wrong(fmt::format("'{}' is not the number of a unit", *unit));
    }
  }
  if (const auto magnitude = cut_after_last(begin, '*')) {
    const auto number = csv::to_number(*magnitude);
    if (!number) return wrong(fmt::format("'{}' is not a number", *magnitude));
    event.magnitude = *number;
  }
  const auto end = cut_after_last(begin, '/');
  for (const auto& [moment, time] :
       {std::pair{begin, &event.begin}, std::pair{end.value_or(begin), &event.end}}) {
    const auto parsed = parse_event_time(moment, start);
    if (!parsed) return wrong(fmt::format("'{}' is neither {}", moment, event_time_form));
    *time = *parsed;
  }
  if (std::string mistake = reference::life_mistake(event); !mistake.empty()) {
    return wrong(mistake);
  }
  return event;
}

}  // namespace reident::satcs
