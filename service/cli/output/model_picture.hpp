// A published model as one picture: what was measured and what the model says, their difference,
// the inputs, the singular values that its order was chosen by, and its poles.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "service/model/model_version.hpp"
#include "service/review/model_run.hpp"

namespace reident::cli {

struct PicturePart {
  /// "identify", "tune", "validate", or "excluded": its class in the style sheet too.
  std::string name;
  storage::TimeRange range;
};

struct PictureData {
  std::string title;
  std::string subtitle;
  const EquipmentModel& model;
  const ModelRun& run;  // of the model over `range`
  storage::TimeRange range;
  std::vector<PicturePart> parts;
  std::vector<double> singular_values;  // descending; empty where they are not known
  /// Another version of the same outputs, run over the same range.
  struct Other {
    std::string name;
    ModelRun run;
  };
  std::optional<Other> other = {};
  std::optional<storage::Time> change = {};  // since when the equipment is another
};

/// A self-contained SVG document. However many rows there are it stays below 500 kB: a pixel column
/// shows the least and the greatest of its values.
std::string model_picture(const PictureData& data);

}  // namespace reident::cli
