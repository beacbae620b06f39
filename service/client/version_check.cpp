#include "service/client/version_check.hpp"

#include "service/model/model_json.hpp"

namespace reident {
namespace {

std::optional<std::string> fault_in_expressions(const std::vector<Signal>& inputs) {
  for (const DerivedInput& input : derived_inputs(inputs)) {
    const auto parsed = Expression::parse(input.expression);
    if (const auto* mistake = std::get_if<ExpressionMistake>(&parsed)) {
      return "its input " + input.name + " cannot be computed: " + mistake->message;
    }
  }
  return std::nullopt;
}

}  // namespace

std::optional<std::string> damage(const ModelVersion& version) {
  if (!is_well_formed(version.model)) {
    return "its matrices, signals and period do not fit together, or are not finite";
  }
  if (auto reason = fault_in_expressions(version.model.inputs)) return reason;
  if (const std::string digest = model_digest(version.model); digest != version.digest) {
    return "its content has the digest " + digest + " and it says " + version.digest +
           "; it was damaged, or another program's format is newer";
  }
  if (const double radius = identification::spectral_radius(version.model.dynamics);
      !(radius < 1)) {
    return "it is unstable: the spectral radius is " + std::to_string(radius);
  }
  if (version.model.tracking &&
      !is_stabilising(version.model.dynamics, version.model.tracking->gain)) {
    return "its tracking gain does not fit its matrices, is not finite or does not stabilise it";
  }
  return std::nullopt;
}

Succession succession(const ModelVersion& version, const ModelVersion& running) {
  if (version.number == running.number) {
    return version.digest == running.digest ? Succession::same : Succession::different;
  }
  if (version.number > running.number || version.rollback) return Succession::newer;
  return Succession::older;
}

}  // namespace reident
