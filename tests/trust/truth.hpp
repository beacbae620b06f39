// How a model would have run on the truth: free runs without sensors' noise, and their errors.
#pragma once

#include <optional>
#include <utility>
#include <vector>

#include <nlohmann/json.hpp>

#include "service/config/config.hpp"
#include "service/model/model_version.hpp"
#include "service/windows/window_data.hpp"
#include "tests/trust/known_series.hpp"

namespace reident::trust {

/// Sums of squared errors over ranges of equal length, so that errors of any span of them follow
/// by addition.
class ErrorCurve {
 public:
  ErrorCurve() = default;
  ErrorCurve(storage::Time origin, Duration block, std::size_t outputs);

  /// Errors (N x p) of the output `y` (N x p) at `first`, `first` + period, ...
  void add(storage::Time first, Duration period, const identification::Matrix& y,
           const identification::Matrix& errors);
  void add(const ErrorCurve& other);

  std::int64_t block_of(storage::Time time) const;
  storage::Time begin_of(std::int64_t block) const { return origin_ + block * block_; }
  Duration block() const { return block_; }
  /// MRSE (design: 100 ||y - yhat|| / ||y||, the mean over the outputs) over the blocks
  /// [first, last); absent where they hold no row. Infinite where a run diverged.
  std::optional<double> mrse_percent(std::int64_t first, std::int64_t last) const;

 private:
  struct Sums {
    double squared_errors = 0;
    double squares = 0;
    NLOHMANN_DEFINE_TYPE_INTRUSIVE(Sums, squared_errors, squares)
  };
  Sums& at(std::int64_t block, std::size_t output);

  storage::Time origin_ = 0;
  Duration block_ = 1;
  std::size_t outputs_ = 1;
  std::vector<Sums> sums_;  // of block b and output q at b * outputs_ + q

 public:
  NLOHMANN_DEFINE_TYPE_INTRUSIVE(ErrorCurve, origin_, block_, outputs_, sums_)
};

/// Extremes of a range of a signal.
struct Extremes {
  storage::Time time = 0;
  double low = 0;
  double high = 0;
};

/// The truth of one life as one equipment's models see it. For one thread at a time.
class Truth {
 public:
  /// `truth` holds what perfect sensors would have sent when the real ones did; `block` is the
  /// orbit. All must outlive this.
  Truth(const KnownSeries& truth, const KnownSeries& simulated, const SpacecraftConfig& spacecraft,
        const EquipmentConfig& equipment, storage::TimeRange extent, Duration block);

  /// The model started on the truth's first rows of `range`, a part of the extent, and run freely
  /// through it.
  ErrorCurve free_run(const EquipmentModel& model, storage::TimeRange range) const;
  /// The hand-written simulator over `range`; where it has no such output, the mean of the truth.
  ErrorCurve baseline(storage::TimeRange range) const;
  /// The MRSE over `range` that an error as large as the sensors' own would have: noise and the
  /// converter's quantum together.
  double resolution_percent(storage::TimeRange range) const;

  /// Extremes of the first output over `range`, in ranges of `step`.
  std::vector<Extremes> output_extremes(storage::TimeRange range, Duration step) const;

  const EquipmentConfig& equipment() const { return equipment_; }
  storage::TimeRange extent() const { return extent_; }
  ErrorCurve empty_curve() const;

 private:
  WindowRequest outputs_alone() const;
  const identification::Record& record_for(const WindowRequest& request) const;

  const KnownSeries& truth_;
  const KnownSeries& simulated_;
  const std::string& spacecraft_;
  const EquipmentConfig& equipment_;
  storage::TimeRange extent_;
  Duration block_;
  /// All of the truth as the models of one request see it, which nearly all of them have.
  mutable std::optional<std::pair<WindowRequest, identification::Record>> record_;
};

/// Identified as the service does, but from telemetry without a fault, its corrections left out;
/// absent where the window gives no model.
std::optional<EquipmentModel> oracle(const KnownSeries& clean, const SpacecraftConfig& spacecraft,
                                     const EquipmentConfig& equipment, storage::TimeRange window);

}  // namespace reident::trust
