// The gate: from the evidence about a candidate to the decision, as one pure function.
//
// service/DESIGN.md has the table of reasons.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "service/config/config.hpp"
#include "service/model/reasons.hpp"
#include "storage/types/telemetry.hpp"

namespace reident {

/// Scores are free runs on the validation part: nothing was fitted to it, and of two candidates at
/// most one was chosen by it.
struct Evidence {
  bool well_formed = false;  // sizes agree, all numbers finite
  double spectral_radius = 0;
  double slowest_over_window = 0;  // the longest time constant over the window's length
  bool validation_moves = false;   // every output takes more than one value there
  double mrse_percent = 0;
  double fit_percent = 0;         // the worst output's
  double residual_over_span = 0;  // largest |error| of any output over its range in the window
  double outside_share = 0;       // of the validation rows: an input is outside what identified
  double fault_share = 0;         // sensor faults found in the window, each once, over its ticks
  storage::Time window_end = 0;

  /// The candidate against another run, on the rows at which both have an output.
  struct Comparison {
    std::int64_t rows = 0;
    double mrse_percent = 0;             // the candidate's there
    double rival_mrse_percent = 0;       // not finite where the rival's run went astray
    double reduction_percent = 0;        // by which the candidate's MRSE is lower
    std::optional<double> sure_percent;  // lower bound of it; absent: the rows are too few
    double noise_percent = 0;            // of the candidate's error there, what sensors alone make
  };
  /// Against the mean of each output over the same rows.
  Comparison mean;

  /// Of the simulator's own model, from its telemetry.
  std::optional<Comparison> baseline;

  struct Champion {
    std::int64_t version = 0;
    storage::Time window_end = 0;
    std::optional<Comparison> comparison;  // absent: it cannot run on these samples
    /// Samples of the champion's window with inputs that the candidate was not validated with: of
    /// its validation part, or of all of it where what the candidate gains may be a constant alone.
    struct Elsewhere {
      std::int64_t rows = 0;
      double disagreement_percent = 0;  // rms between the two, of the output's range
      /// The same with the champion's mean error on the candidate's validation part added to its
      /// outputs, where that brings them nearer.
      double without_offset_percent = 0;
      double mrse_percent = 0;  // the candidate's there
      double champion_mrse_percent = 0;
    };
    /// Absent: there is no such place, or the candidate is not better by the margin.
    std::optional<Elsewhere> elsewhere;
    /// The comparison with the champion's mean error on these samples taken from it.
    std::optional<Comparison> without_offset{};
    /// Parameters whose sensors could show that mean error, and which no relation binds.
    std::vector<std::string> unbound{};
    double validated_mrse_percent = 0;  // where it was validated; 0: not known
    double slowest_rows = 0;            // samples in the slowest time constant of the two
    double movement = 1;                // of these samples (run_comparison.hpp)
    std::string still{};                // input that stands still all over the window (the same)
    /// The comparison there, before the candidate's window. Looked at where the candidate is surely
    /// better and the champion was not left behind; absent where less than half is left.
    std::optional<Comparison> where_validated{};
  };
  std::optional<Champion> champion;

  struct Hold {
    std::string actor;
    std::string reason;
  };
  std::optional<Hold> hold;
};

struct GateDecision {
  Outcome outcome;
  std::vector<Reason> reasons;  // the figures that decided; the last one has the outcome
};

/// What the reduction surely has to be, in percent, with the champion's mean error taken from it,
/// and, of a version on probation, over the validation part and what came after it: a third of the
/// margin.
double surely_needed_elsewhere(const EquipmentConfig& limits);

/// Whether the candidate errs less than the other run by more than so many times the sensors'
/// noise, the noise taken from both errors.
bool shows_beside_noise(const Evidence::Comparison& comparison, double times);

/// What is less tells little of how the two will err, and a simulator gains nothing by it.
constexpr double least_gain_over_noise = 1.5;
/// The same where so much of it lasts: surely all over a version's window and after it.
constexpr double lasting_gain_over_noise = 1;
/// What is less goes on probation, where it can, and has to last until the last look.
constexpr double plain_gain_over_noise = 2;

/// Whether so many faults of sensors were found, each once, over the ticks looked at, that those
/// which are too small to be found are enough to spoil a comparison with the champion.
bool is_in_doubt(double fault_share);

/// Whether inputs that move over this share of the champion's ranges are those of an unusual
/// operation, as a safe mode: what fits it may be far off in the usual one.
bool is_unusual(double movement);

/// Whether the champion errs so much more than where it was validated that a change of the
/// equipment has left it behind: from one stretch of operation to another the error differs by
/// less. Also where the latter, as 0, is not known.
bool is_left_behind(double mrse_percent, double validated_mrse_percent);

GateDecision decide(const Evidence& evidence, const EquipmentConfig& limits);

}  // namespace reident
