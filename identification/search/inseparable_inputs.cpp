#include "identification/search/inseparable_inputs.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "identification/fit/output_error_fit.hpp"
#include "identification/numerics/decompositions.hpp"
#include "identification/search/model_search.hpp"
#include "identification/statistics/correlation.hpp"

namespace reident::identification {
namespace {

/// Variance inflation above which others explain nearly all of an input, or of a gain's error.
constexpr double least_inflation = 10;
constexpr double deviations_told = 2;  // of an error: 95 %

/// Principal components of channels in the size of each.
SymmetricEigen principal_components(const Matrix& covariance) {
  const Vector size = covariance.diagonal().cwiseSqrt();
  const Vector per_size = (size.array() > 0).select(size.cwiseInverse(), 0.0);
  return symmetric_eigen(per_size.asDiagonal() * covariance * per_size.asDiagonal());
}

/// Each diagonal entry of a covariance over what it would be if all else were known.
Vector variance_inflation(const Matrix& covariance) {
  constexpr double rounding = 1e-14;
  const SymmetricEigen components = principal_components(covariance);
  return components.vectors.cwiseAbs2() * components.values.cwiseMax(rounding).cwiseInverse();
}

/// The gains of the inputs (m) to one output.
struct Gains {
  Vector found;          // in units
  Matrix errors_by_row;  // what each row has moved them by, in units
  std::vector<RowRange> segments;

  /// How far off a combination of gains may be.
  double uncertainty(const Vector& weights) const {
    Series moves(errors_by_row * weights, segments);
    return deviations_told * std::sqrt(moves.centred().squaredNorm() * correlated_rows(moves));
  }
};

using Group = std::vector<Index>;

/// Inputs that are linear in each other but for little. What hardly moves is a space of components;
/// two inputs belong together where a projection on it makes the one of the other.
std::vector<Group> groups_of(const Matrix& correlation) {
  constexpr double taking_part = 0.1;
  const SymmetricEigen components = principal_components(correlation);
  const Vector still = (components.values.array() < 1 / least_inflation).cast<double>();
  const Matrix projection =
      components.vectors * still.asDiagonal() * components.vectors.transpose();
  std::vector<Group> groups;
  for (Index j = 0; j < projection.rows(); ++j) {
    Group own;
    std::erase_if(groups, [&](const Group& group) {
      const bool joins = std::any_of(group.begin(), group.end(), [&](Index other) {
        return std::abs(projection(j, other)) > taking_part;
      });
      if (joins) own.insert(own.end(), group.begin(), group.end());
      return joins;
    });
    own.push_back(j);
    groups.push_back(std::move(own));
  }
  std::erase_if(groups, [](const Group& group) { return group.size() < 2; });
  return groups;
}

/// "a, b and c".
std::string list(const std::vector<std::string>& words) {
  std::string text;
  for (std::size_t i = 0; i < words.size(); ++i)
    text += (i == 0 ? "" : i + 1 == words.size() ? " and " : ", ") + words[i];
  return text;
}

/// What the rows know best of the gains of two inputs, whose moves have these deviations.
std::string best_known(const Gains& gains, const Group& pair, const Vector& deviations,
                       const std::vector<std::string>& names) {
  constexpr double equal = 0.01;
  const Matrix errors = gains.errors_by_row(Eigen::all, pair) * deviations(pair).asDiagonal();
  const Vector best = symmetric_eigen(errors.transpose() * errors).vectors.col(0);
  double ratio = best(1) * deviations(pair[1]) / (best(0) * deviations(pair[0]));
  if (!std::isfinite(ratio)) return "";
  if (std::abs(ratio - 1) < equal) ratio = 1;
  Vector weights = Vector::Zero(deviations.size());
  weights(pair[0]) = 1;
  weights(pair[1]) = ratio;
  const std::string together =
      ratio == 1 ? "their sum of "
                 : names[0] + " by 1 with " + names[1] + " by " + four_digits(ratio) + " does ";
  return ", while " + together + four_digits(gains.found.dot(weights)) + " +-" +
         two_digits(gains.uncertainty(weights)) + (ratio == 1 ? " is known" : "");
}

/// The rows that the final model's B and D are fitted to.
RowRange fitted_rows(PreparedRows& rows, const Recipe& recipe) {
  Recipe unrefined = recipe;
  unrefined.refinement_steps = 0;
  const Index end = rows.fitted().size();
  const Index count =
      affordable_rows(unrefined, rows.inputs(), rows.outputs(), rows.options().search_budget / 3);
  return {std::max<Index>(0, end - count), end};
}

}  // namespace

std::vector<std::string> inseparable_inputs(PreparedRows& rows, const Identified& identified) {
  const Normalisation& channels = rows.normalisation();
  const Matrix correlation = input_correlation(rows.sums(), channels);
  const std::vector<Group> groups = groups_of(correlation);
  const auto gain = static_gain(identified.model);
  if (groups.empty() || !gain) return {};
  const Vector u_scale = channels.u_scale(channels.inputs);
  const Vector y_scale = channels.y_scale(channels.outputs);
  const RowRange looked_at = fitted_rows(rows, identified.recipe);
  const std::vector<RowRange> segments = ranges_from(rows.normalised(), looked_at);
  const Matrix C =
      y_scale.cwiseInverse().asDiagonal() * identified.model.C(channels.outputs, Eigen::all);
  const std::vector<Matrix> errors = gain_errors_by_row(
      identified.model.A, C, identified.recipe.direct, rows.normalised(), looked_at);
  std::vector<std::string> sentences;
  for (std::size_t q = 0; q < errors.size(); ++q) {
    const Index output = channels.outputs[q];
    const Vector units = y_scale(static_cast<Index>(q)) * u_scale.cwiseInverse();
    const Gains gains{(*gain)(output, channels.inputs).transpose(), errors[q] * units.asDiagonal(),
                      segments};
    const Vector inflation =
        variance_inflation(gains.errors_by_row.transpose() * gains.errors_by_row);
    for (const Group& group : groups) {
      const Vector effects = gains.found.cwiseProduct(u_scale)(group);
      const double together =
          std::sqrt(std::max(0.0, effects.dot(correlation(group, group) * effects)));
      std::vector<std::string> names, values;
      Index undecided = 0;
      for (const Index j : group) {
        const double uncertainty = gains.uncertainty(Vector::Unit(rows.inputs(), j));
        undecided +=
            inflation(j) > least_inflation && 2 * uncertainty * u_scale(j) > together ? 1 : 0;
        names.push_back(rows.input_name(channels.inputs[static_cast<std::size_t>(j)]));
        values.push_back(four_digits(gains.found(j)) + " +-" + two_digits(uncertainty));
      }
      if (undecided < 2) continue;
      sentences.push_back(
          list(names) + " move together, and the rows hardly show what each of them does: to " +
          channel_name("output", output, rows.options().output_names) + " their gains are " +
          list(values) + (group.size() == 2 ? best_known(gains, group, u_scale, names) : "") +
          "; leave one of them out, or choose rows in which they move apart");
    }
  }
  return sentences;
}

}  // namespace reident::identification
