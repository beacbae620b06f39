#include "service/cli/output/model_text.hpp"

#include <algorithm>
#include <complex>
#include <vector>

#include <fmt/format.h>

#include "identification/numerics/decompositions.hpp"

namespace reident::cli {
namespace {

std::string pole_text(const std::complex<double>& pole) {
  if (pole.imag() == 0) return fmt::format("{:.6g}", pole.real());
  return fmt::format("{:.6g} \u00b1 {:.6g}j", pole.real(), pole.imag());
}

/// A complex pair once, the one first whose `slowness` is largest.
template <typename Slowness>
std::string sorted_poles_text(const identification::Matrix& A, Slowness slowness) {
  const auto eigenvalues = identification::eigenvalues(A);
  std::vector<std::complex<double>> poles;
  for (const std::complex<double>& pole : eigenvalues)
    if (pole.imag() >= 0) poles.push_back(pole);
  std::sort(poles.begin(), poles.end(),
            [slowness](const auto& a, const auto& b) { return slowness(a) > slowness(b); });
  std::string text;
  for (const auto& pole : poles) text += (text.empty() ? "" : ", ") + pole_text(pole);
  return text.empty() ? "none" : text;
}

}  // namespace

std::string poles_text(const identification::StateSpaceModel& model) {
  return sorted_poles_text(model.A, [](const auto& pole) { return std::abs(pole); });
}

std::string continuous_text(
    const std::variant<identification::ContinuousModel, identification::Verdict>& continuous) {
  if (const auto* verdict = std::get_if<identification::Verdict>(&continuous))
    return fmt::format("continuous time: none; {}\n", verdict->reason);
  const auto& model = std::get<identification::ContinuousModel>(continuous);
  if (model.A.rows() == 0) return "continuous time: a gain alone, without poles\n";
  return fmt::format("continuous time: poles {} 1/s\n",
                     sorted_poles_text(model.A, [](const auto& pole) { return pole.real(); }));
}

std::string matrix_text(std::string_view symbol, const identification::Matrix& matrix) {
  if (matrix.size() == 0) return fmt::format("{} = (none)\n", symbol);
  const std::string lead = fmt::format("{} = [", symbol);
  std::string text;
  for (Eigen::Index row = 0; row < matrix.rows(); ++row) {
    text += row == 0 ? lead : std::string(lead.size(), ' ');
    for (const double value : matrix.row(row)) text += fmt::format(" {:>12.6g}", value);
    text += row + 1 == matrix.rows() ? " ]\n" : "\n";
  }
  return text;
}

}  // namespace reident::cli
