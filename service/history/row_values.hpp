// Single values of a row (rows.hpp says how they stand there).
#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "service/history/rows.hpp"

namespace reident::history {

Json text_value(const std::string& text);
std::string read_text(const Json& value);

/// A text that may be a JSON object.
Json document_value(const std::string& text);
std::string read_document(const Json& value);

Json number_value(double number);
double read_number(const Json& value);

template <typename T>
Json optional_value(const std::optional<T>& value) {
  return value ? Json(*value) : Json();
}
template <typename T>
std::optional<T> read_optional(const Json& value) {
  return value.is_null() ? std::nullopt : std::optional(value.get<T>());
}

}  // namespace reident::history
