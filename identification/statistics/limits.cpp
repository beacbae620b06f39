#include "identification/statistics/limits.hpp"

#include <cmath>
#include <utility>

namespace reident::identification {
namespace {

constexpr Index least_beyond = 10;
constexpr double beyond_deviations = 2;
constexpr double nearly_all = 0.9;
constexpr double least_share_beyond = 0.1, most_share = 1.0 / 3;

}  // namespace

std::vector<Limit> limits_of(const Vector& values, const Vector& y_hat) {
  if (values.size() == 0) return {};
  Limit greatest{true, values.maxCoeff(), {}}, least{false, values.minCoeff(), {}};
  double squares = 0;
  for (Index row = 0; row < values.size(); ++row) {
    if (values(row) == greatest.value)
      greatest.rows.push_back(row);
    else if (values(row) == least.value)
      least.rows.push_back(row);
    else
      squares += (values(row) - y_hat(row)) * (values(row) - y_hat(row));
  }
  const Index others = values.size() - std::ssize(greatest.rows) - std::ssize(least.rows);
  const double margin = beyond_deviations * std::sqrt(squares / double(others));
  std::vector<Limit> limits;
  for (Limit* limit : {&greatest, &least}) {
    Index beyond = 0, there = 0;
    for (Index row = 0; row < values.size(); ++row) {
      const double by = y_hat(row) - limit->value;
      if (!((limit->is_greatest ? by : -by) > margin)) continue;
      ++beyond;
      there += values(row) == limit->value;
    }
    const double at_limit = double(limit->rows.size());
    if (beyond >= least_beyond && double(there) >= nearly_all * double(beyond) &&
        double(there) >= least_share_beyond * at_limit &&
        at_limit <= most_share * double(values.size()))
      limits.push_back(std::move(*limit));
  }
  return limits;
}

}  // namespace reident::identification
