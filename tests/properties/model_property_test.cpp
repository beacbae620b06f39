// A model stays the same to the last bit wherever it is written and read, and its digest
// distinguishes it from every other.
#include <bit>
#include <cmath>

#include <gtest/gtest.h>
#include <rapidcheck.h>
#include <rapidcheck/gtest.h>

#include "service/dds/codec.hpp"
#include "service/model/model_json.hpp"
#include "tests/properties/any_record.hpp"
#include "tests/support/every_field.hpp"

namespace reident::model_property_test {
namespace {

using identification::Index;
using identification::Matrix;
using identification::Vector;
using test::any_of;
using test::differing_fields;
using test::visit_leaves;

/// Finite, of every magnitude, denormals and both zeros among them.
double any_number() {
  const double value = std::bit_cast<double>(*rc::gen::arbitrary<std::uint64_t>());
  return std::isfinite(value) ? value : -0.0;
}

Matrix any_matrix(Index rows, Index columns) {
  Matrix matrix(rows, columns);
  for (double& value : matrix.reshaped()) value = any_number();
  return matrix;
}

Vector any_vector(Index size) {
  return any_matrix(size, 1);
}

std::string any_text() {
  return *rc::gen::nonEmpty(rc::gen::container<std::string>(rc::gen::inRange('!', '~')));
}

std::vector<Signal> any_signals(Index count) {
  std::vector<Signal> signals;
  for (Index i = 0; i < count; ++i) {
    const double a = any_number(), b = any_number();
    signals.push_back({any_text(), any_text(), std::min(a, b), std::max(a, b)});
  }
  return signals;
}

EquipmentModel any_model() {
  const Index n = any_of(0, 5), m = any_of(0, 4), p = any_of(1, 3);
  EquipmentModel model;
  model.spacecraft = any_text();
  model.equipment = any_text();
  model.inputs = any_signals(m);
  for (Signal& input : model.inputs)
    if (any_of(0, 2) == 0) input.expression = "V_BUS*" + std::to_string(any_of(0, 1000));
  model.outputs = any_signals(p);
  model.dynamics = {any_matrix(n, n), any_matrix(n, m), any_matrix(p, n),  any_matrix(p, m), {},
                    any_vector(m),    any_vector(p),    any_of(1, 9) / 8.0};
  if (n > 0 && any_of(0, 2) == 0) model.dynamics.K = any_matrix(n, p);
  model.sample_hold_ns = any_of<std::int64_t>(1, std::int64_t{1} << 60);
  if (any_of(0, 2) == 0) model.phase_ns = any_of(1, 100'000'000);
  model.validation = {any_vector(p), any_vector(p), any_of(0, 1000)};
  if (any_of(0, 2) == 0)
    model.tracking = EquipmentModel::Tracking{
        {any_matrix(m, n), any_matrix(m, 2 * p), any_vector(p)}, {any_vector(p), any_vector(p), 3}};
  return model;
}

RC_GTEST_PROP(Model, KeepsEveryBitInJson, ()) {
  const EquipmentModel model = any_model();
  const EquipmentModel back = equipment_model_from_json(to_json(model).dump());
  RC_ASSERT(differing_fields(back, model) == std::vector<std::string>{});
}

RC_GTEST_PROP(Model, KeepsEveryBitOnTheWire, ()) {
  ModelVersion version;
  version.model = any_model();
  version.number = 1;
  version.digest = model_digest(version.model);
  dds::Codec<ModelVersion>::Encoder encode;
  ModelVersion back;
  const dds::Fault fault = dds::Codec<ModelVersion>::decode(encode(version), {}, back);
  if (fault) RC_FAIL(*fault);
  RC_ASSERT(differing_fields(back, version) == std::vector<std::string>{});
}

/// Every number that the digest covers.
std::vector<double*> numbers(EquipmentModel& model) {
  std::vector<double*> all;
  visit_leaves(model, [&all](const std::string&, const Field& field, auto& leaf) {
    if (field.digest == Digest::undigested) return;
    if constexpr (requires { leaf.reshaped(); }) {
      for (double& value : leaf.reshaped()) all.push_back(&value);
    } else if constexpr (std::is_same_v<decltype(leaf), double&>) {
      all.push_back(&leaf);
    }
  });
  return all;
}

std::vector<std::string*> texts(EquipmentModel& model) {
  std::vector<std::string*> all;
  visit_leaves(model, [&all](const std::string&, const Field& field, auto& leaf) {
    if constexpr (std::is_same_v<decltype(leaf), std::string&>)
      if (field.digest == Digest::digested) all.push_back(&leaf);
  });
  return all;
}

RC_GTEST_PROP(Model, HasAnotherDigestWhenAnyBitIsAnother, ()) {
  EquipmentModel model = any_model();
  const std::string digest = model_digest(model);
  const std::vector<double*> places = numbers(model);
  double& number = *places[any_of<std::size_t>(0, places.size())];
  const double before = number;
  number = std::bit_cast<double>(std::bit_cast<std::uint64_t>(before) ^
                                 (std::uint64_t{1} << any_of(0, 64)));
  RC_ASSERT(model_digest(model) != digest);
  number = before;
  const std::vector<std::string*> words = texts(model);
  *words[any_of<std::size_t>(0, words.size())] += any_text();
  RC_ASSERT(model_digest(model) != digest);
}

}  // namespace
}  // namespace reident::model_property_test
