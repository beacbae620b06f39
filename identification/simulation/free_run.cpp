#include "identification/simulation/free_run.hpp"

#include <cassert>
#include <cstddef>
#include <vector>

#include "identification/simulation/hole_bridging.hpp"
#include "identification/simulation/initial_state.hpp"
#include "identification/simulation/segment_run.hpp"

namespace reident::identification {

Matrix free_run(const StateSpaceModel& model, const Record& record, RowRange rows,
                const std::optional<Vector>& x0) {
  Matrix y_hat(rows.size(), model.outputs());
  Index out = 0;
  Vector x;
  Vector square_errors = Vector::Zero(model.outputs());
  const std::vector<Segment> segments = segments_within(record, rows);
  const SquareChanges changes = segments.size() > 1 ? square_changes(record) : SquareChanges{};
  for (std::size_t i = 0; i < segments.size(); ++i) {
    const Segment& segment = segments[i];
    const auto given = i == 0 ? x0
                              : state_after_hole(model, record, segments[i - 1], segment, x,
                                                 {changes, square_errors / double(out)});
    const auto from_here = segments.begin() + static_cast<std::ptrdiff_t>(i);
    x = run_segment(
        model, record, segment,
        given ? *given
              : estimate_initial_state(model, record, {from_here, segments.end()}, state_rows),
        y_hat, out);
    square_errors +=
        (record.y.middleRows(segment.begin, segment.size()) - y_hat.middleRows(out, segment.size()))
            .cwiseAbs2()
            .colwise()
            .sum()
            .transpose();
    out += segment.size();
  }
  assert(out == rows.size());
  return y_hat;
}

}  // namespace reident::identification
