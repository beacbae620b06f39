// What a search found in a window, without the window's samples: small enough to be kept in a file
// by the machine that searched, and enough for another one to go on as if it had searched itself.
#pragma once

#include <optional>
#include <string>

#include <nlohmann/json.hpp>

#include "service/windows/candidate.hpp"

namespace reident {

/// The result of prepare_window() as text can hold it.
struct FoundWindow {
  std::string samples_digest;   // of the window on the grid; empty where it could not be loaded
  std::string outcome, reason;  // where there is no candidate
  nlohmann::ordered_json evidence, search;
  std::optional<EquipmentModel> model;  // of the candidate
};

FoundWindow found_window(const PreparedWindow& prepared);

/// The JSON gives every bit back.
nlohmann::ordered_json to_json(const FoundWindow& found);
/// Throws std::invalid_argument or nlohmann::json::exception where the JSON is of something else.
FoundWindow found_window_from_json(const nlohmann::ordered_json& json);

/// Returns what prepare_window() returned on the same telemetry, but for timings. Absent where the
/// window's samples are others now. `kept` and what it throws are as there.
std::optional<PreparedWindow> restored_window(const storage::Archive& archive,
                                              const RefreshRequest& request, WindowCache& kept,
                                              const FoundWindow& found);

}  // namespace reident
