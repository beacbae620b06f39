// One attempt at a window: load, identify, score beside the champion, decide.
//
// Reads the archive and the registry; writes nothing. The same archive, configuration and window
// give the same result to the last bit, timings aside, whatever was kept of earlier windows.
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <string_view>

#include "identification/identify.hpp"
#include "service/daemon/config.hpp"
#include "service/daemon/gate.hpp"
#include "service/daemon/kept_window.hpp"
#include "service/model/model_version.hpp"
#include "storage/archive.hpp"
#include "storage/registry.hpp"

namespace reident {

struct RefreshRequest {
  std::string spacecraft;
  EquipmentConfig equipment;
  storage::TimeRange window;
  std::string trigger;  // why now, as the attempt records it
  std::string configuration_digest;
};

struct RefreshResult {
  storage::NewAttempt attempt;                   // its time is left to whoever records it
  std::optional<EquipmentModel> candidate;       // absent where the window gave no model
  std::optional<storage::NewDecision> decision;  // present with a candidate
  Evidence evidence;                             // meaningful with a candidate
};

/// Thrown by refresh when `stop` answered true; nothing was decided.
class Stopped : public std::exception {};

/// The options that an equipment's configuration stands for.
identification::IdentifyOptions options_of(const EquipmentConfig& equipment);

/// What is kept of the equipment's windows.
KeptWindow kept_window_of(const std::string& spacecraft, const EquipmentConfig& equipment);

/// `kept` is of the same spacecraft and equipment. The search runs on `for_each`, or on the calling
/// thread where it is empty.
RefreshResult refresh(const storage::Archive& archive, const storage::Registry& registry,
                      const RefreshRequest& request, KeptWindow& kept,
                      const identification::ForEach& for_each, const std::function<bool()>& stop);

}  // namespace reident
