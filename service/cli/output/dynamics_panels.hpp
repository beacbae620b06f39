// What a model's order and dynamics are, as panels of its picture.
#pragma once

#include <vector>

#include "identification/simulation/state_space.hpp"
#include "service/cli/output/svg.hpp"

namespace reident::cli {

/// Draws singular values, descending, on a logarithmic scale, and where the chosen order ends. Says
/// so where there is none that has a logarithm.
void draw_singular_values(Svg& svg, const std::vector<double>& singular_values,
                          identification::Index chosen_order, const Box& box);

/// Draws the poles in the unit circle, and lists their time constants to the right of the box.
void draw_poles(Svg& svg, const identification::StateSpaceModel& dynamics, const Box& box);

}  // namespace reident::cli
