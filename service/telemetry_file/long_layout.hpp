// Files that hold one sample a row: its time, the name of its parameter, its value.
#pragma once

#include <map>
#include <optional>

#include "service/telemetry_file/telemetry_file.hpp"

namespace reident::telemetry_file {

/// Positions of the columns.
struct LongLayout {
  std::size_t parameter = 0, value = 0;
  std::optional<std::size_t> unit;
};

/// By the names of the columns: value, Wert, _value beside parameter, name, Mnemonic, _field and
/// their like. Absent where a file with these columns has one for each parameter.
std::optional<LongLayout> find_long_layout(const std::vector<std::string>& columns);
/// Looks at the cells of a file too: a column that is not called parameter has to hold words.
std::optional<LongLayout> find_long_layout(const TelemetryFile& file);

/// Notes the unit of each parameter: numbers in V and in mV make no series.
class UnitsOfParameters {
 public:
  /// What is wrong with a sample whose parameter was in another unit before; a blank unit says
  /// nothing.
  std::optional<std::string> check(std::string_view parameter, std::string_view unit,
                                   std::uint64_t line);

 private:
  struct First {
    std::string unit;
    std::uint64_t line = 0;
  };
  std::map<std::string, First, std::less<>> first_;
  std::string last_parameter_, last_unit_;
};

/// Opens a file; one of one sample a row as the table of a row for each time and a column for each
/// parameter that it stands for. Further samples of a parameter at a time are rows of their own.
/// Bad lines of samples are left out with a remark where `skip_bad_lines`, else an error.
std::variant<TelemetryFile, Error> open_as_table(const std::filesystem::path& path,
                                                 const ReadingOptions& options,
                                                 bool skip_bad_lines);

}  // namespace reident::telemetry_file
