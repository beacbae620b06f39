#include "service/satcs/event_time.hpp"

#include "service/support/time_text.hpp"

namespace reident::satcs {

std::optional<storage::Time> parse_event_time(std::string_view text, storage::Time start) {
  if (text.empty() || text.front() != '+') return parse_time(text);
  const auto later = parse_duration(text.substr(1));
  if (!later || *later < 0) return std::nullopt;
  return start + *later;
}

std::optional<std::string_view> cut_after_last(std::string_view& text, char mark) {
  const auto at = text.rfind(mark);
  if (at == std::string_view::npos) return std::nullopt;
  const auto after = text.substr(at + 1);
  text = text.substr(0, at);
  return after;
}

}  // namespace reident::satcs
