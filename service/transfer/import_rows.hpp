// Rows of a CSV file as telemetry frames.
#pragma once

#include <filesystem>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <variant>
#include <vector>

#include "service/satcs/replay/replay.hpp"
#include "service/telemetry_file/telemetry_file.hpp"
#include "service/transfer/telemetry_csv.hpp"
#include "storage/archive/archive.hpp"

namespace reident::transfer {

/// What `reident import` was asked.
struct ImportOptions {
  std::filesystem::path file;
  /// What is given here goes before what a long file says. A wide one needs the spacecraft.
  std::optional<std::string> spacecraft;
  std::optional<std::string> source;      // otherwise import:FILE
  std::optional<storage::Origin> origin;  // otherwise real
  telemetry_file::ReadingOptions reading;
  /// Columns of a wide file, as satcs-replay takes them.
  std::vector<satcs::ColumnMapping> mappings;
  std::vector<std::string> only;
  std::vector<std::string> leave_out;  // columns
  bool keep_names = false;
  bool skip_bad_lines = false;
};

/// What waits for a commit. Frames keep their memory from batch to batch. References to them hold
/// until the next next() or clear().
class ImportBatch {
 public:
  /// The frame behind the last one, empty; it counts from keep() on.
  storage::TelemetryFrame& next();
  /// Counts the frame of next().
  void keep();
  /// The last frame that counts; null where there is none.
  storage::TelemetryFrame* last() { return count_ == 0 ? nullptr : &frames_[count_ - 1]; }
  /// Adds a sample to a frame that counts already.
  void add(storage::TelemetryFrame& frame, const storage::Sample& sample) {
    frame.samples.push_back(sample);
    ++samples_;
  }
  /// Begins the next batch.
  void clear();

  std::span<const storage::TelemetryFrame> frames() const { return {frames_.data(), count_}; }
  std::uint64_t samples() const { return samples_; }
  std::vector<storage::ParameterDescriptor> descriptors;  // of parameters that had none

 private:
  std::vector<storage::TelemetryFrame> frames_;
  std::size_t count_ = 0;
  std::uint64_t samples_ = 0;
};

/// Turns the rows of one file into frames without sequence numbers. One thread at a time.
class ImportRows {
 public:
  virtual ~ImportRows() = default;
  /// Adds the row that the reader stands at, or nothing of it and an error. An empty cell is no
  /// sample, nor is a value that is named as missing, and a row without a sample is no frame.
  virtual std::optional<csv::Error> add(const telemetry_file::TelemetryFile& reader,
                                        ImportBatch& batch) = 0;
  /// Columns that are left out since no cell of them is a number; one sentence each.
  virtual std::vector<std::string> left_out() const { return {}; }
};

/// Returns the rows of the layout that the reader's file has, and finds the reader's time. Requires
/// a reader whose head holds a row. An error where no spacecraft is known, no column holds a time,
/// a column that is named is not there, or a parameter has another unit in the archive. Options and
/// archive must outlive the result.
std::variant<std::unique_ptr<ImportRows>, csv::Error> import_rows(
    const ImportOptions& options, telemetry_file::TelemetryFile& reader,
    const storage::Archive& archive);

}  // namespace reident::transfer
