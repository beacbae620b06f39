// Single values of a row (rows.hpp says how they stand there). Each read_ function gives back what
// its partner got, to the last bit. It throws nlohmann::json::exception or std::invalid_argument
// for a value of another kind.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "service/history/rows.hpp"

namespace reident::history {

/// A text of any bytes: as it is where it is UTF-8, else an array of one text.
Json text_value(const std::string& text);
std::string read_text(const Json& value);

/// A text that may be a JSON object.
Json document_value(const std::string& text);
std::string read_document(const Json& value);

/// A double, also one that is not finite.
Json number_value(double number);
double read_number(const Json& value);

/// An array of them.
Json numbers_value(const std::vector<double>& numbers);
std::vector<double> read_numbers(const Json& value);

/// A value, or null.
template <typename T>
Json optional_value(const std::optional<T>& value) {
  return value ? Json(*value) : Json();
}
template <typename T>
std::optional<T> read_optional(const Json& value) {
  return value.is_null() ? std::nullopt : std::optional(value.get<T>());
}

}  // namespace reident::history
