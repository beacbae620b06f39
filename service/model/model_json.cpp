#include "service/model/model_json.hpp"

#include <cmath>
#include <limits>
#include <stdexcept>
#include <type_traits>

#include "service/model/model_fields.hpp"

namespace reident {
namespace {

using identification::Index;
using identification::Matrix;
using identification::Vector;
using Json = nlohmann::ordered_json;

Json number_to_json(double value) {
  return std::isfinite(value) ? Json(value) : Json(nullptr);
}

template <class Struct>
Json object_of(const Struct& value);

template <class Value>
Json json_of(const Value& value) {
  if constexpr (std::is_same_v<Value, double>)
    return number_to_json(value);
  else if constexpr (std::is_arithmetic_v<Value> || std::is_same_v<Value, std::string>)
    return value;
  else
    return object_of(value);
}

Json json_of(const Matrix& matrix) {
  return to_json(matrix);
}

Json json_of(const Vector& vector) {
  return to_json(vector);
}

Json json_of(const std::vector<Signal>& signals) {
  Json array = Json::array();
  for (const Signal& signal : signals) array.push_back(object_of(signal));
  return array;
}

template <class Value>
Json json_of(const std::optional<Value>& value) {
  return value ? json_of(*value) : Json(nullptr);
}

template <class Struct>
Json object_of(const Struct& value) {
  Json object = Json::object();
  visit_fields(value, [&object](const Field& field, const auto& member) {
    if (field.presence == Presence::optional && is_absent(member)) return;
    object[std::string(field.name)] = json_of(member);
  });
  return object;
}

[[noreturn]] void refuse(const std::string& field, const std::string& what) {
  throw std::invalid_argument("model JSON: field \"" + field + "\" " + what);
}

/// A value of the document with the path that leads to it, for messages.
class Entry {
 public:
  Entry(const Json& value, std::string path) : value_(value), path_(std::move(path)) {}

  Entry operator[](const std::string& key) const {
    const std::string path = path_.empty() ? key : path_ + "." + key;
    if (!value_.is_object()) refuse(path_.empty() ? "(document)" : path_, "must be an object");
    const auto found = value_.find(key);
    if (found == value_.end()) refuse(path, "is missing");
    return {*found, path};
  }
  bool has(const std::string& key) const { return value_.is_object() && value_.contains(key); }
  Entry operator[](std::size_t index) const {
    return {value_[index], path_ + "[" + std::to_string(index) + "]"};
  }
  std::size_t array_size() const {
    if (!value_.is_array()) refuse(path_, "must be an array");
    return value_.size();
  }
  std::string text() const {
    if (!value_.is_string()) refuse(path_, "must be a string");
    return value_.get<std::string>();
  }
  std::int64_t integer() const {
    if (!value_.is_number_integer()) refuse(path_, "must be an integer");
    if (value_.is_number_unsigned() &&
        value_.get<std::uint64_t>() > std::numeric_limits<std::int64_t>::max()) {
      refuse(path_, "is above the largest 64-bit integer");
    }
    return value_.get<std::int64_t>();
  }
  /// NaN for null.
  double number() const {
    if (value_.is_null()) return std::numeric_limits<double>::quiet_NaN();
    if (!value_.is_number()) refuse(path_, "must be a number or null");
    return value_.get<double>();
  }
  [[noreturn]] void refuse_value(const std::string& what) const { refuse(path_, what); }
  void require_size(std::size_t size) const {
    if (array_size() != size) {
      refuse(path_, "must have " + std::to_string(size) + " entries and has " +
                        std::to_string(array_size()));
    }
  }

 private:
  const Json& value_;
  std::string path_;
};

Vector vector_from(const Entry& entry, Index size) {
  entry.require_size(static_cast<std::size_t>(size));
  Vector vector(size);
  for (Index i = 0; i < size; ++i) vector(i) = entry[static_cast<std::size_t>(i)].number();
  return vector;
}

Matrix matrix_from(const Entry& entry, Index rows, Index columns) {
  entry.require_size(static_cast<std::size_t>(rows));
  Matrix matrix(rows, columns);
  for (Index row = 0; row < rows; ++row) {
    matrix.row(row) = vector_from(entry[static_cast<std::size_t>(row)], columns).transpose();
  }
  return matrix;
}

void check_expression(const Entry& signal) {
  if (!signal.has("expression")) return;
  const Entry entry = signal["expression"];
  const auto parsed = Expression::parse(entry.text());
  if (const auto* mistake = std::get_if<ExpressionMistake>(&parsed))
    entry.refuse_value(mistake->message);
}

/// Sets each field that it visits from the entry of its struct.
class JsonReader {
 public:
  JsonReader(const Entry& document, const Entry& fields) : document_(document), fields_(fields) {}

  template <class Member>
  void operator()(const Field& field, Member& member) const {
    const std::string key(field.name);
    if (field.presence == Presence::optional && !fields_.has(key)) return;
    read(fields_[key], field, member);
  }

 private:
  Index extent(Extent extent) const {
    const auto size = [this](const char* key) {
      return static_cast<Index>(document_[key].array_size());
    };
    switch (extent) {
      case Extent::n:
        return size("A");
      case Extent::m:
        return size("inputs");
      case Extent::p:
        return size("outputs");
      case Extent::two_p:
        return 2 * size("outputs");
      case Extent::one:
        break;
    }
    return 1;
  }

  void read(const Entry& entry, const Field&, std::string& text) const { text = entry.text(); }
  void read(const Entry& entry, const Field&, double& number) const { number = entry.number(); }
  void read(const Entry& entry, const Field&, std::int64_t& number) const {
    number = entry.integer();
  }
  /// The order, which A has already.
  void read(const Entry& entry, const Field& field, const Index&) const {
    if (const Index order = extent(Extent::n); entry.integer() != order) {
      refuse(std::string(field.name), "is " + std::to_string(entry.integer()) + " and A has " +
                                          std::to_string(order) + " rows");
    }
  }
  void read(const Entry& entry, const Field& field, Matrix& matrix) const {
    if (field.presence == Presence::may_be_empty && entry.array_size() == 0) return;
    matrix = matrix_from(entry, extent(field.rows), extent(field.columns));
  }
  void read(const Entry& entry, const Field& field, Vector& vector) const {
    vector = vector_from(entry, extent(field.rows));
  }
  void read(const Entry& entry, const Field& field, std::vector<Signal>& signals) const {
    for (std::size_t i = 0; i < entry.array_size(); ++i) {
      read(entry[i], field, signals.emplace_back());
      check_expression(entry[i]);
    }
  }
  template <class Value>
  void read(const Entry& entry, const Field& field, std::optional<Value>& value) const {
    read(entry, field, value.emplace());
  }
  template <class Struct>
  void read(const Entry& entry, const Field&, Struct& value) const {
    visit_fields(value, JsonReader(document_, entry));
  }

  const Entry& document_;
  const Entry& fields_;
};

}  // namespace

Json to_json(const Matrix& matrix) {
  Json rows = Json::array();
  for (Index row = 0; row < matrix.rows(); ++row) {
    rows.push_back(to_json(Vector(matrix.row(row).transpose())));
  }
  return rows;
}

Json to_json(const Vector& vector) {
  Json array = Json::array();
  for (const double value : vector) array.push_back(number_to_json(value));
  return array;
}

Json to_json(const EquipmentModel& model) {
  return object_of(model);
}

EquipmentModel equipment_model_from_json(const std::string& text) {
  Json document;
  try {
    document = Json::parse(text);
  } catch (const Json::parse_error& error) {
    throw std::invalid_argument(std::string("model JSON: ") + error.what());
  }
  const Entry entry(document, "");
  EquipmentModel model;
  visit_fields(model, JsonReader(entry, entry));
  return model;
}

}  // namespace reident
