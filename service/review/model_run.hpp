// A stored model on archived telemetry.
#pragma once

#include <optional>
#include <string>
#include <variant>

#include "service/model/model_version.hpp"
#include "service/windows/window_data.hpp"
#include "storage/types/sample_reader.hpp"

namespace reident {

struct ModelRun {
  WindowData data;               // at least one row
  identification::Matrix y_hat;  // free run, N x p
  identification::Score score;
  /// The run that follows the measured outputs; absent without a tracking gain.
  struct Tracked {
    identification::Matrix y_hat;
    identification::Score score;
  };
  std::optional<Tracked> tracked;
};

/// The model's free run over the telemetry in `range`, the state at the beginning of each segment
/// without holes estimated from its first rows; or the reason why there is none. The scores are of
/// the rows at `scored_from` or later.
std::variant<ModelRun, std::string> run_model(const storage::SampleReader& archive,
                                              const EquipmentModel& model, storage::TimeRange range,
                                              storage::Time scored_from);

}  // namespace reident
