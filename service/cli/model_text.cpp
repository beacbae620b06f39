#include "service/cli/model_text.hpp"

#include <algorithm>
#include <complex>
#include <vector>

#include <Eigen/Eigenvalues>
#include <fmt/format.h>

namespace reident::cli {
namespace {

std::string pole_text(const std::complex<double>& pole) {
  if (pole.imag() == 0) return fmt::format("{:.6g}", pole.real());
  return fmt::format("{:.6g} \u00b1 {:.6g}j", pole.real(), pole.imag());
}

}  // namespace

std::string poles_text(const identification::StateSpaceModel& model) {
  const Eigen::VectorXcd eigenvalues = model.A.eigenvalues();
  std::vector<std::complex<double>> poles;
  for (const std::complex<double>& pole : eigenvalues)
    if (pole.imag() >= 0) poles.push_back(pole);
  std::sort(poles.begin(), poles.end(),
            [](const auto& a, const auto& b) { return std::abs(a) > std::abs(b); });
  std::string text;
  for (const auto& pole : poles) text += (text.empty() ? "" : ", ") + pole_text(pole);
  return text;
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
