#include "service/history/cursor.hpp"

#include "service/history/row_values.hpp"
#include "service/support/sha256.hpp"

namespace reident::history {
namespace {

constexpr std::size_t seal_digits = 16;

/// The size of a page may change from one to the next.
std::string seal(const HistoryQuery& query, const std::string& key) {
  const Json question = {query.subject,
                         text_value(query.spacecraft),
                         text_value(query.equipment),
                         query.range.begin,
                         query.range.end,
                         query.version,
                         query.newest_first,
                         query.origin,
                         query.parameter,
                         query.step,
                         query.until,
                         key};
  return sha256_hex(question.dump(-1, ' ', false, Json::error_handler_t::replace))
      .substr(0, seal_digits);
}

}  // namespace

std::string cursor_after(const HistoryQuery& query, const Json& key) {
  const std::string text = key.dump();
  return seal(query, text) + text;
}

std::optional<Json> key_of_cursor(const HistoryQuery& query) {
  if (query.cursor.size() < seal_digits) return std::nullopt;
  const std::string text = query.cursor.substr(seal_digits);
  if (query.cursor.substr(0, seal_digits) != seal(query, text)) return std::nullopt;
  Json key = Json::parse(text, nullptr, false);
  return key.is_array() ? std::optional(std::move(key)) : std::nullopt;
}

}  // namespace reident::history
