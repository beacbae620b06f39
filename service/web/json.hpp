// Values of the page's answers. Times are texts of UTC to the nanosecond, and so are numbers of
// versions and ids: a browser's numbers have 53 bits.
#pragma once

#include <cmath>
#include <cstdint>
#include <optional>
#include <string>

#include <nlohmann/json.hpp>

#include "service/support/time_text.hpp"
#include "service/web/http.hpp"
#include "storage/types/registry_rows.hpp"

namespace reident::web {

using Json = nlohmann::ordered_json;

inline Json time_value(storage::Time time) {
  return time_text(time);
}
inline Json id_value(std::int64_t id) {
  return std::to_string(id);
}
/// Null where it is not finite.
inline Json number_value(double number) {
  return std::isfinite(number) ? Json(number) : Json();
}
/// Null where there is none.
inline Json number_value(const std::optional<double>& number) {
  return number ? number_value(*number) : Json();
}

inline Json range_value(storage::TimeRange range) {
  return {{"begin", time_value(range.begin)}, {"end", time_value(range.end)}};
}

inline Json name_value(const storage::EquipmentName& name) {
  return {{"spacecraft", name.spacecraft}, {"equipment", name.equipment}};
}

/// Bytes that are no UTF-8 become U+FFFD.
inline HttpResponse json_response(const Json& body) {
  HttpResponse response;
  response.body = body.dump(-1, ' ', false, Json::error_handler_t::replace) + "\n";
  return response;
}

}  // namespace reident::web
