// A swap in mid-run, over many pairs of versions.
#include <cmath>

#include <gtest/gtest.h>

#include "service/client/model_runner.hpp"
#include "tests/support/version_pairs.hpp"

namespace reident::testing {
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
    const Vector before = Eigen::Map<const Vector>(y_.data(), static_cast<Index>(y_.size()));
    runner_.step(u.data(), y_.data());
    return Eigen::Map<const Vector>(y_.data(), before.size()) - before;
  }
  double output(std::size_t q) const { return y_[q]; }

 private:
  Declaration declaration_;
  std::vector<double> y_;
  ModelRunner runner_;
};

/// The output's largest change in a step from the swap to the end of its transition, over the
/// larger of the two models' own in that neighbourhood; the largest of the outputs.
double jump_of(std::uint64_t seed) {
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
  for (Index q = 0; q < p; ++q)
    EXPECT_NEAR(run.output(static_cast<std::size_t>(q)), after.output(static_cast<std::size_t>(q)),
                3 * own(q))
        << "seed " << seed << " ends as the new version";
  return (felt.array() / own.array()).maxCoeff();
}

TEST(AnySwap, moves_the_output_by_at_most_three_times_the_models_own_step) {
  for (std::uint64_t seed = 1; seed <= 200; ++seed) EXPECT_LE(jump_of(seed), 3) << "seed " << seed;
}

}  // namespace
}  // namespace reident::testing
