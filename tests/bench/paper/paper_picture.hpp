// A line of the paper's table as a picture: what was measured together with the runs, and below
// the error of each.
#pragma once

#include <string>
#include <vector>

#include "identification/simulation/state_space.hpp"
#include "storage/types/telemetry.hpp"

namespace reident::bench {

struct PictureRun {
  std::string style;  // "simulator", "identified" or "following"
  std::string name;
  identification::Vector y;  // NaN where there is none
  double mrse_percent = 0;   // over all rows that validate, not those of the picture alone
};

struct PaperPicture {
  std::string title;
  std::string output;
  std::string unit;
  storage::TimeRange range;
  identification::Vector x;  // of the rows: seconds since the range began
  identification::Vector y;  // measured
  std::vector<PictureRun> runs;
};

/// A self-contained SVG document.
std::string svg_of(const PaperPicture& picture);

}  // namespace reident::bench
