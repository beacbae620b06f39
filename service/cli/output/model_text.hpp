// A state-space model in words and figures for a terminal.
#pragma once

#include <string>
#include <string_view>
#include <variant>

#include "identification/simulation/continuous.hpp"
#include "identification/simulation/state_space.hpp"

namespace reident::cli {

/// Eigenvalues of A, the slowest first, a complex pair once: "0.97, 0.8 ± 0.1j".
std::string poles_text(const identification::StateSpaceModel& model);

/// "continuous time: poles -0.02, -0.3 ± 1.2j 1/s", the slowest first, or the reason why there is
/// none; a line.
std::string continuous_text(
    const std::variant<identification::ContinuousModel, identification::Verdict>& continuous);

/// "A = [ ... ]" with a line for each row; "A = (none)" where it has no entry.
std::string matrix_text(std::string_view symbol, const identification::Matrix& matrix);

}  // namespace reident::cli
