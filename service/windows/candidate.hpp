// From a window to a candidate: load, identify, correct, fit, score. The registry is not looked at,
// so that windows can be worked on in any order and side by side.
//
// Archive, configuration and window determine the candidate to the last bit, timings aside,
// whatever was kept of earlier windows. A known model that is adapted to the window gives another
// one, which the known model determines too.
#pragma once

#include <exception>
#include <functional>
#include <optional>
#include <string>

#include <nlohmann/json.hpp>

#include "identification/search/identify.hpp"
#include "service/config/config.hpp"
#include "service/model/model_version.hpp"
#include "service/support/phase_timer.hpp"
#include "service/windows/window_cache.hpp"
#include "storage/archive/archive.hpp"
#include "storage/registry/registry.hpp"

namespace reident {

/// One window of an equipment, and why it is tried.
struct RefreshRequest {
  std::string spacecraft;
  EquipmentConfig equipment;
  storage::TimeRange window;
  std::string trigger;               // why now, as the attempt records it
  std::string configuration_digest;  // of the file, for the attempt
};

/// The rows of a window, in the order of time: identified from, chosen by, judged by.
struct WindowParts {
  identification::RowRange identify, tune, validate;
  identification::RowRange fitted() const { return {identify.begin, tune.end}; }
};

/// Returns the parts of a window with so many rows, by the equipment's shares. Each may be empty.
WindowParts parts_of(identification::Index rows, const EquipmentConfig& equipment);

/// A model of the window, and its run.
struct Candidate {
  EquipmentModel model;
  WindowParts parts;
  identification::Vector x0;                 // n; at the window's first row
  identification::Matrix y_hat;              // N x p; free run over all rows of the window
  storage::TimeRange tuned_on;               // the times of the rows for choices
  std::optional<std::int64_t> adapted_from;  // the version whose poles it has
};

/// A window as it was loaded, and the candidate that it gave. Its evidence goes into the attempt.
struct PreparedWindow {
  storage::NewAttempt attempt;  // outcome and reason are there where there is no candidate
  WindowRequest loaded;         // what `data` was read as
  Checks checks;                // that were made on it
  WindowData data;
  std::optional<ParameterCoverage> least_covered;  // where too few ticks have a row
  std::optional<Candidate> candidate;
  nlohmann::ordered_json evidence = nlohmann::ordered_json::object();
  nlohmann::ordered_json search;  // how the model that was identified was found
  PhaseTimer timer;
};

/// Gives the attempt the verdict that telemetry which it needs is damaged, and no candidate.
void refuse_damaged(PreparedWindow& prepared, const storage::Error& error);

/// Thrown when `stop` answered true; nothing was decided.
class Stopped : public std::exception {};

/// Loads the window and looks for no model yet. Where it cannot be loaded the attempt has the
/// outcome and the reason, `data` no rows. Throws storage::Error but for damage.
PreparedWindow loaded_window(const storage::Archive& archive, const RefreshRequest& request,
                             WindowCache& kept);

/// What the dynamics are as the candidate of a window that was loaded. `method` says how they were
/// found.
Candidate candidate_of(const RefreshRequest& request, const WindowData& data,
                       const identification::StateSpaceModel& dynamics, const std::string& method);

/// `known`, version `number` of the equipment, made to fit the window
/// (identification/fit/adaptation.hpp): A and C stay. Absent where the window gave no candidate,
/// and where `known` looks at other telemetry, is not stable, or has an order that the
/// configuration does not allow.
std::optional<Candidate> adapted_candidate(const RefreshRequest& request,
                                           const EquipmentModel& known, std::int64_t number,
                                           const PreparedWindow& prepared);

/// The regression of the outputs on the inputs without dynamics (order 0), fitted as the window's
/// candidate was. Requires a candidate.
Candidate static_candidate(const RefreshRequest& request, const PreparedWindow& prepared);

/// Adds what is to be said of the window's candidate to its evidence: how it was found, its errors
/// and its diagnostics. Requires a candidate.
void describe_candidate(PreparedWindow& prepared);

/// Searches the gain with which the candidate follows telemetry, by integral feedback, and scores
/// it on the validation part. Where no gain is found the evidence says why. Requires a candidate.
/// Apart from prepare_window: most candidates are turned away, and this would take a quarter of
/// their time.
void let_follow(PreparedWindow& prepared);

/// Returns the options that an equipment's configuration stands for, without those of one window.
identification::IdentifyOptions options_of(const EquipmentConfig& equipment);

/// Returns a cache of the equipment's windows, with nothing in it.
WindowCache window_cache_of(const std::string& spacecraft, const EquipmentConfig& equipment);

/// Loads the window and identifies a candidate from its first two parts. Without one the attempt
/// has the outcome and the reason; telemetry that is damaged is such a reason. Requires `kept` of
/// the same spacecraft and equipment (window_cache_of). The search runs on `for_each`, or on the
/// calling thread where it is empty. Calls `stop` between phases; throws Stopped where it answered
/// true. Throws storage::Error where the archive cannot be read for another reason than damage.
PreparedWindow prepare_window(const storage::Archive& archive, const RefreshRequest& request,
                              WindowCache& kept, const identification::ForEach& for_each,
                              const std::function<bool()>& stop);

}  // namespace reident
