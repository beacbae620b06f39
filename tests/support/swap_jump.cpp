#include "tests/support/swap_jump.hpp"

#include <algorithm>

#include "service/client/model_runner.hpp"

namespace reident::test {
namespace {

using identification::Index;
using identification::Vector;

constexpr std::int64_t swap_at = 700;
constexpr std::int64_t look_around = 300;

class FreeRun {
 public:
  FreeRun(const EquipmentModel& model, const Declaration& declaration)
      : declaration_(declaration), y_(declaration.outputs.size()), runner_(declaration) {
    swap(model);
  }
  ModelRunner::Swap swap(const EquipmentModel& model) {
    ModelVersion version;
    version.model = model;
    auto made = PreparedModel::make(version, declaration_);
    return runner_.swap(std::get<std::unique_ptr<PreparedModel>>(made));
  }
  /// The change of each output in this step.
  Vector step(const Vector& u) {
    const Vector before = output();
    runner_.step(u.data(), y_.data());
    return output() - before;
  }
  Vector output() const {
    return Eigen::Map<const Vector>(y_.data(), static_cast<Index>(y_.size()));
  }

 private:
  Declaration declaration_;
  std::vector<double> y_;
  ModelRunner runner_;
};

}  // namespace

SwapInMidRun swap_in_mid_run(std::uint64_t seed) {
  const VersionPair pair = version_pair(seed);
  const Declaration declaration = declaration_of(pair.before);
  FreeRun run(pair.before, declaration), before(pair.before, declaration),
      after(pair.after, declaration);
  const Index p = pair.before.dynamics.outputs();
  Vector own = Vector::Zero(p), felt = Vector::Zero(p);
  std::int64_t end = swap_at + look_around;
  for (std::int64_t k = 0; k < end; ++k) {
    const Vector u = smooth_input(pair, seed, k);
    if (k == swap_at)
      end = swap_at + std::max<std::int64_t>(look_around, run.swap(pair.after).transition);
    const Vector change = run.step(u), of_before = before.step(u), of_after = after.step(u);
    if (k < swap_at - look_around) continue;
    own = own.cwiseMax(of_before.cwiseAbs()).cwiseMax(of_after.cwiseAbs());
    if (k >= swap_at) felt = felt.cwiseMax(change.cwiseAbs());
  }
  const Vector left = (run.output() - after.output()).cwiseAbs();
  return {(felt.array() / own.array()).maxCoeff(), (left.array() / own.array()).maxCoeff()};
}

}  // namespace reident::test
