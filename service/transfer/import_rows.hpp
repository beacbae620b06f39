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
#include "service/support/csv.hpp"
#include "service/transfer/telemetry_csv.hpp"
#include "storage/archive/archive.hpp"

namespace reident::transfer {

struct ImportOptions {
  std::filesystem::path file;
  /// What is given here goes before what a long file says. A wide one needs the spacecraft.
  std::optional<std::string> spacecraft;
  std::optional<std::string> source;      // otherwise import:FILE
  std::optional<storage::Origin> origin;  // otherwise real
  /// The time column of a wide file; absent: the first that looks like a time.
  std::optional<std::string> time_column;
  TimeUnit time_unit = TimeUnit::any;  // `any`: by the column's name
  /// Columns of a wide file, as satcs-replay takes them.
  std::vector<satcs::ColumnMapping> mappings;
  std::vector<std::string> only;
  std::vector<std::string> leave_out;  // columns
  bool keep_names = false;
  bool skip_bad_lines = false;
};

/// What waits for a commit. Frames keep their memory from batch to batch.
class ImportBatch {
 public:
  /// The frame behind the last one, empty; it counts from keep() on.
  storage::TelemetryFrame& next();
  void keep();
  /// The last frame that counts; null where there is none.
  storage::TelemetryFrame* last() { return count_ == 0 ? nullptr : &frames_[count_ - 1]; }
  void add(storage::TelemetryFrame& frame, const storage::Sample& sample) {
    frame.samples.push_back(sample);
    ++samples_;
  }
  void clear();

  std::span<const storage::TelemetryFrame> frames() const { return {frames_.data(), count_}; }
  std::uint64_t samples() const { return samples_; }
  std::vector<storage::ParameterDescriptor> descriptors;  // of parameters that had none

 private:
  std::vector<storage::TelemetryFrame> frames_;
  std::size_t count_ = 0;
  std::uint64_t samples_ = 0;
};

class ImportRows {
 public:
  virtual ~ImportRows() = default;
  /// Adds the row that the reader stands at, or nothing of it and an error.
  virtual std::optional<csv::Error> add(const csv::Reader& reader, ImportBatch& batch) = 0;
};

/// For the layout of the reader's file. It may stand at the first row, to see which column holds a
/// time. The archive must outlive the result.
std::variant<std::unique_ptr<ImportRows>, csv::Error> import_rows(const ImportOptions& options,
                                                                  const csv::Reader& reader,
                                                                  const storage::Archive& archive);

}  // namespace reident::transfer
