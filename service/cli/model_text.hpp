// A state-space model in words and figures for a terminal.
#pragma once

#include <string>
#include <string_view>

#include "identification/state_space.hpp"

namespace reident::cli {

/// Eigenvalues of A, the slowest first, a complex pair once: "0.97, 0.8 ± 0.1j".
std::string poles_text(const identification::StateSpaceModel& model);

/// "A = [ ... ]" with a line for each row; "A = (none)" where it has no entry.
std::string matrix_text(std::string_view symbol, const identification::Matrix& matrix);

}  // namespace reident::cli
