// The rows of history as JSON objects; idl/README.md, "History", has their members.
//
// Decoding gives back what was encoded to the last bit: integers of 64 bits, doubles that are not
// finite (as the texts "NaN", "Infinity", "-Infinity"), and texts of any bytes (where they are not
// UTF-8, as an array of one text whose characters U+0000 to U+00FF are the bytes). A text that is a
// JSON object, such as a model, stands as that object wherever writing it again gives the same
// text.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <utility>

#include <nlohmann/json.hpp>

#include "storage/types/records.hpp"
#include "storage/types/sample_columns.hpp"
#include "storage/types/series.hpp"
#include "storage/types/time_bins.hpp"

namespace reident::history {

using Json = nlohmann::ordered_json;

struct EquipmentRow {
  storage::EquipmentName name;
  std::optional<storage::Hold> hold;
};

/// Whose champion, and the decision that made it.
struct ChampionRow {
  storage::EquipmentName name;
  std::optional<storage::Decision> decision;
};

/// Neighbouring bins; the number of the first of them.
struct CountsRow {
  std::size_t first = 0;
  std::vector<storage::BinCounts> counts;
};

Json row_of(const EquipmentRow& row);
Json row_of(const storage::Attempt& attempt);
Json row_of(const storage::Decision& decision);
Json row_of(const ChampionRow& row);
/// Without its model and where that comes from.
Json summary_row_of(const storage::Version& version);
Json row_of(const storage::Version& version);
Json row_of(const storage::ParameterDescriptor& parameter);
Json row_of(const storage::SeriesInfo& series);
Json row_of(const std::pair<std::int64_t, std::string>& source);
Json row_of(const storage::SequenceGap& gap);
/// The samples [first, last) of the columns, all of which are there.
Json row_of(const storage::SampleColumns& samples, std::size_t first, std::size_t last);
Json row_of(const CountsRow& row);

/// Each throws nlohmann::json::exception or std::invalid_argument for a row that is not of its
/// kind.
void read_row(const Json& row, EquipmentRow& equipment);
void read_row(const Json& row, storage::Attempt& attempt);
void read_row(const Json& row, storage::Decision& decision);
void read_row(const Json& row, ChampionRow& champion);
/// The members that a summary does not have stay empty.
void read_row(const Json& row, storage::Version& version);
void read_row(const Json& row, storage::ParameterDescriptor& parameter);
void read_row(const Json& row, storage::SeriesInfo& series);
void read_row(const Json& row, std::pair<std::int64_t, std::string>& source);
void read_row(const Json& row, storage::SequenceGap& gap);
void read_row(const Json& row, storage::SampleColumns& samples);
void read_row(const Json& row, CountsRow& counts);

}  // namespace reident::history
