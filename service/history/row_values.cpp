#include "service/history/row_values.hpp"

#include <cmath>
#include <limits>
#include <stdexcept>

#include "service/dds/wire.hpp"

namespace reident::history {
namespace {

/// Each byte as the character of its number, in UTF-8.
std::string bytes_as_characters(const std::string& bytes) {
  std::string text;
  for (const char c : bytes) {
    const auto byte = static_cast<unsigned char>(c);
    if (byte < 0x80) {
      text += c;
      continue;
    }
    text += static_cast<char>(0xc0 | (byte >> 6));
    text += static_cast<char>(0x80 | (byte & 0x3f));
  }
  return text;
}

std::string characters_as_bytes(const std::string& text) {
  std::string bytes;
  for (std::size_t i = 0; i < text.size(); ++i) {
    const auto lead = static_cast<unsigned char>(text[i]);
    if (lead < 0x80) {
      bytes += text[i];
      continue;
    }
    if ((lead != 0xc2 && lead != 0xc3) || i + 1 == text.size())
      throw std::invalid_argument("a text of bytes has a character above U+00FF");
    const auto next = static_cast<unsigned char>(text[++i]);
    bytes += static_cast<char>(((lead & 0x03) << 6) | (next & 0x3f));
  }
  return bytes;
}

}  // namespace

Json text_value(const std::string& text) {
  return dds::is_utf8(text) ? Json(text) : Json::array({bytes_as_characters(text)});
}

std::string read_text(const Json& value) {
  return value.is_array() ? characters_as_bytes(value.at(0).get_ref<const std::string&>())
                          : value.get<std::string>();
}

Json document_value(const std::string& text) {
  Json object = Json::parse(text, nullptr, false);
  if (object.is_object() && dds::is_utf8(text) && object.dump() == text) return object;
  return text_value(text);
}

std::string read_document(const Json& value) {
  return value.is_object() ? value.dump() : read_text(value);
}

Json number_value(double number) {
  if (std::isnan(number)) return "NaN";
  if (std::isinf(number)) return number > 0 ? "Infinity" : "-Infinity";
  return number;
}

double read_number(const Json& value) {
  if (!value.is_string()) return value.get<double>();
  const auto& text = value.get_ref<const std::string&>();
  if (text == "NaN") return std::numeric_limits<double>::quiet_NaN();
  if (text == "Infinity") return std::numeric_limits<double>::infinity();
  if (text == "-Infinity") return -std::numeric_limits<double>::infinity();
  throw std::invalid_argument("'" + text + "' is no number");
}

Json numbers_value(const std::vector<double>& numbers) {
  Json array = Json::array();
  for (const double number : numbers) array.push_back(number_value(number));
  return array;
}

std::vector<double> read_numbers(const Json& value) {
  if (!value.is_array()) throw std::invalid_argument("an array of numbers is wanted");
  std::vector<double> numbers;
  for (const Json& number : value) numbers.push_back(read_number(number));
  return numbers;
}

}  // namespace reident::history
