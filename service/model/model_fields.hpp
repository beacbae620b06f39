// The fields of a model and of its version, each named once: JSON, the digest and MATLAB files
// follow from here. The wire (service/dds/codec_model.cpp) and the FMU's resources
// (service/model_export/fmu_resources.cpp) are written by hand; tests walk these fields and name
// the one that is missing there.
//
// A new field of a model is optional, so that the JSON and the digest of every older version stay
// what they are.
#pragma once

#include <concepts>
#include <string_view>
#include <type_traits>

#include "service/model/model_version.hpp"

namespace reident {

/// Whether the model's digest covers a field. Scores and windows are evidence, not the model.
enum class Digest { undigested, digested };

/// The length of a list or of a side of a matrix: n is the order, m and p count inputs and outputs.
enum class Extent { one, n, m, p, two_p };

enum class Presence {
  always,
  may_be_empty,  // an empty array in JSON; the digest has a flag before it
  /// No key in JSON where it is absent. The digest has it last, under a tag, where it is there. A
  /// signal's optional field is one of inputs alone.
  optional
};

/// What the formats have to know of a field.
struct Field {
  std::string_view name;  // in JSON
  Digest digest = Digest::undigested;
  /// A MATLAB file's variable; for a struct, what the variables of its fields begin with. Empty:
  /// the file does not have it.
  std::string_view mat = {};
  Extent rows = Extent::one;
  Extent columns = Extent::one;
  Presence presence = Presence::always;
};

/// Whether an optional field is not there.
template <class Value>
bool is_absent(const Value& value) {
  if constexpr (requires { value.has_value(); })
    return !value.has_value();
  else if constexpr (requires { value.size(); })
    return value.size() == 0;
  else
    return false;
}

/// A struct to read, or one to set.
template <class Struct, class Type>
concept StructOf = std::same_as<std::remove_const_t<Struct>, Type>;

// visit_fields(value, visit) calls visit(Field, member) for each field, in the order of JSON and
// of the digest. A member that follows from others, and is not to be set, is const. Each
// visit_fields names all members of its struct: it does not compile when one is added or removed.

/// visit(Field, pointer to member), for lists of signals that are handled field by field.
template <class Visit>
void visit_signal_members(Visit&& visit) {
  using enum Digest;
  using enum Extent;
  visit({"name", digested, "names"}, &Signal::name);
  visit({"unit", digested, "units"}, &Signal::unit);
  visit({"low", digested}, &Signal::low);
  visit({"high", digested}, &Signal::high);
  visit({"expression", digested, "expressions", one, one, Presence::optional}, &Signal::expression);
}

template <class Visit>
void visit_fields(StructOf<Signal> auto& signal, Visit&& visit) {
  [[maybe_unused]] const auto& [name, unit, low, high, expression] = signal;
  visit_signal_members(
      [&](const Field& field, const auto member) { visit(field, signal.*member); });
}

template <class Visit>
void visit_fields(StructOf<storage::TimeRange> auto& range, Visit&& visit) {
  auto& [begin, end] = range;
  visit({"begin_ns"}, begin);
  visit({"end_ns"}, end);
}

template <class Visit>
void visit_fields(StructOf<identification::Score> auto& score, Visit&& visit) {
  using enum Digest;
  auto& [mrse_percent, fit_percent, rows] = score;
  visit({"mrse_percent", undigested, {}, Extent::p}, mrse_percent);
  visit({"fit_percent", undigested, {}, Extent::p}, fit_percent);
  visit({"rows"}, rows);
}

template <class Visit>
void visit_fields(StructOf<EquipmentModel::Tracking> auto& tracking, Visit&& visit) {
  using enum Digest;
  using enum Extent;
  auto& [gain, validation] = tracking;
  auto& [state, integral, error_limit] = gain;
  visit({"state", digested, "state", m, n}, state);
  visit({"integral", digested, "integral", m, two_p}, integral);
  visit({"error_limit", digested, "error_limit", p}, error_limit);
  visit({"validation"}, validation);
}

template <class Visit>
void visit_fields(StructOf<EquipmentModel> auto& model, Visit&& visit) {
  using enum Digest;
  using enum Extent;
  auto& [spacecraft, equipment, inputs, outputs, dynamics, sample_hold_ns, identified_from,
         validated_on, validation, tracking, method, phase_ns] = model;
  auto& [A, B, C, D, K, u0, y0, period_s] = dynamics;
  const identification::Index order = dynamics.order();
  visit({"spacecraft", digested}, spacecraft);
  visit({"equipment", digested}, equipment);
  visit({"inputs", digested, "input_", m}, inputs);
  visit({"outputs", digested, "output_", p}, outputs);
  visit({"order"}, order);
  visit({"sample_period_s", digested, "Ts"}, period_s);
  visit({"hold_ns", digested}, sample_hold_ns);
  visit({"A", digested, "A", n, n}, A);
  visit({"B", digested, "B", n, m}, B);
  visit({"C", digested, "C", p, n}, C);
  visit({"D", digested, "D", p, m}, D);
  visit({"K", digested, "K", n, p, Presence::may_be_empty}, K);
  visit({"input_offset", digested, "u0", m}, u0);
  visit({"output_offset", digested, "y0", p}, y0);
  visit({"identified_from"}, identified_from);
  visit({"validated_on"}, validated_on);
  visit({"validation"}, validation);
  visit({"method", undigested, "method"}, method);
  visit({"tracking", digested, "tracking_", one, one, Presence::optional}, tracking);
  visit({"phase_ns", digested, {}, one, one, Presence::optional}, phase_ns);
}

/// What a version has in addition to its model. The names are those of a simulator's own file;
/// exported files have service/model_export/version_head.hpp.
template <class Visit>
void visit_fields(StructOf<ModelVersion> auto& version, Visit&& visit) {
  auto& [model, number, digest, decided, decided_by, rollback, program_version] = version;
  visit({"number"}, number);
  visit({"digest"}, digest);
  visit({"decided_ns"}, decided);
  visit({"decided_by"}, decided_by);
  visit({"rollback"}, rollback);
  visit({"program_version"}, program_version);
}

}  // namespace reident
