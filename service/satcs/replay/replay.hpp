// Recorded telemetry in a CSV file as a stream of frames: one frame a row, one parameter a column.
//
// The file is read twice: once to see that all of it can be replayed and what it holds, before
// anything is published, and once to replay it. It must not change in between: a row that cannot be
// read the second time breaks the stream.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "service/satcs/frame_stream.hpp"
#include "service/telemetry_file/telemetry_file.hpp"

namespace reident::satcs {

/// COLUMN=PARAMETER[:UNIT].
struct ColumnMapping {
  std::string column;
  std::string parameter;
  std::string unit;
};
/// Absent where the text is not of that form, or a part but the unit is empty.
std::optional<ColumnMapping> parse_mapping(std::string_view text);

/// One end of the range to replay: a time, or an offset from the earliest row ("+90", "2h").
struct ReplayBound {
  bool relative = false;
  std::int64_t ns = 0;
};
/// Absent where the text is neither.
std::optional<ReplayBound> parse_bound(std::string_view text);

/// What satcs-replay was asked.
struct ReplayOptions {
  std::filesystem::path file;
  telemetry_file::ReadingOptions reading;
  bool skip_bad_lines = false;
  std::vector<ColumnMapping> mappings;
  /// Unmapped columns keep their names; otherwise a unit at the end of a name becomes the
  /// parameter's unit: bus_u_mv is bus_u in mV.
  bool keep_names = false;
  bool invalid_blanks = false;       // a blank cell is an invalid sample, and not none
  std::vector<std::string> only;     // columns to replay; empty: all
  std::optional<ReplayBound> start;  // rows with start <= time < end
  std::optional<ReplayBound> end;
};

/// What a file holds and how it will be replayed.
struct ReplayPlan {
  struct Column {
    std::size_t position = 0;  // in the file
    storage::ParameterDescriptor parameter;
  };
  std::filesystem::path file;
  telemetry_file::ReadingOptions reading;
  std::string time_column;  // the first of those that hold the time
  std::vector<Column> columns;
  bool invalid_blanks = false;
  bool skip_bad_lines = false;
  std::vector<std::string> left_out;  // columns without a single number
  std::string found;                  // how the file is read
  /// What a user has to know: rows and columns that are left out, cells that are no numbers, clocks
  /// that go back; one sentence each.
  std::vector<std::string> remarks;
  storage::TimeRange range;  // of the rows to replay
  std::uint64_t rows = 0;    // in that range
};

/// Reads the whole file; every mistake in the options or the file is one sentence.
std::variant<ReplayPlan, csv::Error> plan_replay(const ReplayOptions& options);

/// Rows in the order of the file, whatever their times are, each received when it was generated. A
/// cell without a finite number becomes a sample of quality invalid whose value is NaN, or none
/// where it is blank and the options do not say otherwise, or stands for no value.
/// A number with a flag of limits behind it is out of limits.
class ReplayStream : public FrameStream {
 public:
  /// Throws std::runtime_error when the file cannot be opened any more.
  ReplayStream(ReplayPlan plan, Sender sender);

  std::vector<storage::ParameterDescriptor> parameters() const override;
  bool next(storage::TelemetryFrame& frame) override;
  double progress() const override;

 private:
  ReplayPlan plan_;
  telemetry_file::TelemetryFile reader_;
  Sender sender_;
  std::uint64_t rows_done_ = 0;
};

}  // namespace reident::satcs
