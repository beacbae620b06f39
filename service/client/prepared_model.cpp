#include "service/client/prepared_model.hpp"

#include <algorithm>
#include <tuple>

namespace reident {
namespace {

using identification::Matrix;
using identification::StateSpaceModel;

std::vector<DeclaredSignal> declared(const std::vector<Signal>& signals) {
  std::vector<DeclaredSignal> result;
  for (const Signal& signal : signals) result.push_back({signal.name, signal.unit});
  return result;
}

bool same_in_any_order(std::vector<Signal> a, std::vector<Signal> b) {
  const auto key = [](const Signal& s) { return std::tie(s.name, s.unit, s.expression); };
  const auto before = [&key](const Signal& x, const Signal& y) { return key(x) < key(y); };
  std::sort(a.begin(), a.end(), before);
  std::sort(b.begin(), b.end(), before);
  return std::equal(a.begin(), a.end(), b.begin(), b.end(),
                    [&key](const Signal& x, const Signal& y) { return key(x) == key(y); });
}

bool observes_stably(const StateSpaceModel& model) {
  return model.K.size() > 0 && identification::is_stable(model.A - model.K * model.C);
}

}  // namespace

Declaration declaration_of(const EquipmentModel& model) {
  return {declared(model.inputs), declared(model.outputs)};
}

bool same_signals(const EquipmentModel& a, const EquipmentModel& b) {
  return a.dynamics.period_s == b.dynamics.period_s && same_in_any_order(a.inputs, b.inputs) &&
         same_in_any_order(a.outputs, b.outputs);
}

std::variant<std::unique_ptr<PreparedModel>, std::string> PreparedModel::make(
    ModelVersion version, const Declaration& declaration) {
  auto binding = InputBinding::make(version.model, declaration.inputs);
  if (auto* reason = std::get_if<std::string>(&binding)) return std::move(*reason);
  auto outputs = places_of(version.model.outputs, declaration.outputs);
  if (auto* reason = std::get_if<std::string>(&outputs)) return std::move(*reason);
  if (declaration.outputs.size() != version.model.outputs.size())
    return "it has not all of the outputs that the simulator declares";
  return std::unique_ptr<PreparedModel>(
      new PreparedModel(std::move(version), std::get<InputBinding>(std::move(binding)),
                        std::get<std::vector<std::size_t>>(std::move(outputs))));
}

PreparedModel::PreparedModel(ModelVersion version, InputBinding binding,
                             std::vector<std::size_t> outputs)
    : version_(std::move(version)),
      binding_(std::move(binding)),
      outputs_(std::move(outputs)),
      kernel_(dynamics()),
      match_(dynamics(), kernel_, matched_rows),
      both_(2 * kernel_.out_room()),
      now_(both_.data()),
      next_(both_.data() + kernel_.out_room()),
      du_(Vector::Zero(dynamics().inputs())),
      u_(dynamics().inputs()),
      measured_(dynamics().outputs()),
      offset_(Vector::Zero(dynamics().outputs())),
      error_limit_(dynamics().outputs()) {
  for (identification::Index q = 0; q < error_limit_.size(); ++q) {
    const Signal& output = version_.model.outputs[static_cast<std::size_t>(q)];
    error_limit_(q) = output.high - output.low;
  }
}

PreparedModel::~PreparedModel() {
  delete tracker_.load(std::memory_order_acquire);
}

void PreparedModel::prepare_following() {
  if (!version_.model.tracking) {
    has_kalman_gain_.store(observes_stably(dynamics()), std::memory_order_release);
  } else if (tracker_.load(std::memory_order_relaxed) == nullptr) {
    tracker_.store(new identification::Tracker(dynamics(), version_.model.tracking->gain,
                                               Vector::Zero(dynamics().order())),
                   std::memory_order_release);
  }
}

}  // namespace reident
