#include "service/model/model_json.hpp"

#include <cmath>
#include <limits>
#include <stdexcept>

namespace reident {
namespace {

using identification::Index;
using identification::Matrix;
using identification::Vector;
using Json = nlohmann::ordered_json;

Json number_to_json(double value) {
  return std::isfinite(value) ? Json(value) : Json(nullptr);
}

Json to_json(const std::vector<Signal>& signals) {
  Json array = Json::array();
  for (const Signal& signal : signals) {
    Json entry = {{"name", signal.name},
                  {"unit", signal.unit},
                  {"low", number_to_json(signal.low)},
                  {"high", number_to_json(signal.high)}};
    if (!signal.expression.empty()) entry["expression"] = signal.expression;
    array.push_back(std::move(entry));
  }
  return array;
}

Json to_json(const identification::Score& score) {
  return {{"mrse_percent", reident::to_json(score.mrse_percent)},
          {"fit_percent", reident::to_json(score.fit_percent)},
          {"rows", score.rows}};
}

Json to_json(const EquipmentModel::Tracking& tracking) {
  return {{"state", reident::to_json(tracking.gain.state)},
          {"integral", reident::to_json(tracking.gain.integral)},
          {"error_limit", reident::to_json(tracking.gain.error_limit)},
          {"validation", to_json(tracking.validation)}};
}

Json to_json(const storage::TimeRange& range) {
  return {{"begin_ns", range.begin}, {"end_ns", range.end}};
}

[[noreturn]] void refuse(const std::string& field, const std::string& what) {
  throw std::invalid_argument("model JSON: field \"" + field + "\" " + what);
}

/// A value of the document with the path that leads to it, for messages.
class Field {
 public:
  Field(const Json& value, std::string path) : value_(value), path_(std::move(path)) {}

  Field operator[](const std::string& key) const {
    const std::string path = path_.empty() ? key : path_ + "." + key;
    if (!value_.is_object()) refuse(path_.empty() ? "(document)" : path_, "must be an object");
    const auto found = value_.find(key);
    if (found == value_.end()) refuse(path, "is missing");
    return {*found, path};
  }
  bool has(const std::string& key) const { return value_.is_object() && value_.contains(key); }
  Field operator[](std::size_t index) const {
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

Vector vector_from(const Field& field, Index size) {
  field.require_size(static_cast<std::size_t>(size));
  Vector vector(size);
  for (Index i = 0; i < size; ++i) vector(i) = field[static_cast<std::size_t>(i)].number();
  return vector;
}

Matrix matrix_from(const Field& field, Index rows, Index columns) {
  field.require_size(static_cast<std::size_t>(rows));
  Matrix matrix(rows, columns);
  for (Index row = 0; row < rows; ++row) {
    matrix.row(row) = vector_from(field[static_cast<std::size_t>(row)], columns).transpose();
  }
  return matrix;
}

std::string expression_from(const Field& signal) {
  if (!signal.has("expression")) return {};
  const Field field = signal["expression"];
  const auto parsed = Expression::parse(field.text());
  if (const auto* mistake = std::get_if<ExpressionMistake>(&parsed))
    field.refuse_value(mistake->message);
  return field.text();
}

std::vector<Signal> signals_from(const Field& field) {
  std::vector<Signal> signals;
  for (std::size_t i = 0; i < field.array_size(); ++i) {
    const Field entry = field[i];
    signals.push_back({entry["name"].text(), entry["unit"].text(), entry["low"].number(),
                       entry["high"].number(), expression_from(entry)});
  }
  return signals;
}

storage::TimeRange range_from(const Field& field) {
  return {field["begin_ns"].integer(), field["end_ns"].integer()};
}

identification::Score score_from(const Field& field, Index outputs) {
  return {vector_from(field["mrse_percent"], outputs), vector_from(field["fit_percent"], outputs),
          field["rows"].integer()};
}

EquipmentModel::Tracking tracking_from(const Field& field,
                                       const identification::StateSpaceModel& dynamics) {
  const Index inputs = dynamics.inputs(), outputs = dynamics.outputs();
  EquipmentModel::Tracking tracking;
  tracking.gain.state = matrix_from(field["state"], inputs, dynamics.order());
  tracking.gain.integral = matrix_from(field["integral"], inputs, 2 * outputs);
  tracking.gain.error_limit = vector_from(field["error_limit"], outputs);
  tracking.validation = score_from(field["validation"], outputs);
  return tracking;
}

identification::StateSpaceModel dynamics_from(const Field& model, Index inputs, Index outputs) {
  identification::StateSpaceModel dynamics;
  const Field a = model["A"];
  const Index order = static_cast<Index>(a.array_size());
  if (const Field stated = model["order"]; stated.integer() != order) {
    refuse("order", "is " + std::to_string(stated.integer()) + " and A has " +
                        std::to_string(order) + " rows");
  }
  dynamics.A = matrix_from(a, order, order);
  dynamics.B = matrix_from(model["B"], order, inputs);
  dynamics.C = matrix_from(model["C"], outputs, order);
  dynamics.D = matrix_from(model["D"], outputs, inputs);
  if (const Field gain = model["K"]; gain.array_size() > 0) {
    dynamics.K = matrix_from(gain, order, outputs);
  }
  dynamics.u0 = vector_from(model["input_offset"], inputs);
  dynamics.y0 = vector_from(model["output_offset"], outputs);
  dynamics.period_s = model["sample_period_s"].number();
  return dynamics;
}

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
  const identification::StateSpaceModel& dynamics = model.dynamics;
  Json json = {
      {"spacecraft", model.spacecraft},
      {"equipment", model.equipment},
      {"inputs", to_json(model.inputs)},
      {"outputs", to_json(model.outputs)},
      {"order", dynamics.order()},
      {"sample_period_s", number_to_json(dynamics.period_s)},
      {"hold_ns", model.hold_ns},
      {"A", to_json(dynamics.A)},
      {"B", to_json(dynamics.B)},
      {"C", to_json(dynamics.C)},
      {"D", to_json(dynamics.D)},
      {"K", to_json(dynamics.K)},
      {"input_offset", to_json(dynamics.u0)},
      {"output_offset", to_json(dynamics.y0)},
      {"identified_from", to_json(model.identified_from)},
      {"validated_on", to_json(model.validated_on)},
      {"validation", to_json(model.validation)},
      {"method", model.method},
  };
  if (model.tracking) json["tracking"] = to_json(*model.tracking);
  return json;
}

EquipmentModel equipment_model_from_json(const std::string& text) {
  Json document;
  try {
    document = Json::parse(text);
  } catch (const Json::parse_error& error) {
    throw std::invalid_argument(std::string("model JSON: ") + error.what());
  }
  const Field field(document, "");
  EquipmentModel model;
  model.spacecraft = field["spacecraft"].text();
  model.equipment = field["equipment"].text();
  model.inputs = signals_from(field["inputs"]);
  model.outputs = signals_from(field["outputs"]);
  const Index outputs = static_cast<Index>(model.outputs.size());
  model.dynamics = dynamics_from(field, static_cast<Index>(model.inputs.size()), outputs);
  model.hold_ns = field["hold_ns"].integer();
  model.identified_from = range_from(field["identified_from"]);
  model.validated_on = range_from(field["validated_on"]);
  model.validation = score_from(field["validation"], outputs);
  model.method = field["method"].text();
  if (field.has("tracking")) model.tracking = tracking_from(field["tracking"], model.dynamics);
  return model;
}

}  // namespace reident
