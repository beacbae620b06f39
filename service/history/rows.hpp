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

#include "storage/types/registry_rows.hpp"
#include "storage/types/sample_columns.hpp"
#include "storage/types/series.hpp"
#include "storage/types/time_bins.hpp"

namespace reident::history {

using Json = nlohmann::ordered_json;

/// An equipment with attempts, and who holds its champion.
struct EquipmentRow {
  storage::EquipmentName name;
  std::optional<storage::Hold> hold;  // absent where nobody does
};

/// Whose champion, and the decision that made it.
struct ChampionRow {
  storage::EquipmentName name;
  std::optional<storage::Decision> decision;  // absent where there is no champion
};

/// Neighbouring bins; the number of the first of them.
struct CountsRow {
  std::size_t first = 0;
  std::vector<storage::BinCounts> counts;
};

/// Each returns the object of one row. What identifies the row is among its members, so that rows
/// of several equipment or series can be distinguished.
Json row_of(const EquipmentRow& row);
Json row_of(const storage::Attempt& attempt);
Json row_of(const storage::Decision& decision);
Json row_of(const ChampionRow& row);
Json row_of(const storage::Block& block);
/// Without the state of the run.
Json row_of(const storage::BlockScore& score);
/// A version without its model and without its provenance.
Json summary_row_of(const storage::Version& version);
Json row_of(const storage::Version& version);
Json row_of(const storage::ParameterDescriptor& parameter);
Json row_of(const storage::SeriesInfo& series);
Json row_of(const std::pair<std::int64_t, std::string>& source);
Json row_of(const storage::SequenceGap& gap);
/// The samples [first, last). Requires all four columns, and last <= samples.size().
Json row_of(const storage::SampleColumns& samples, std::size_t first, std::size_t last);
Json row_of(const CountsRow& row);

/// Each sets its second argument, which has to be new, from what row_of() made. Throws
/// nlohmann::json::exception or std::invalid_argument for a row that is not of its kind. Members
/// that it does not know are ignored: a newer service may send more.
void read_row(const Json& row, EquipmentRow& equipment);
void read_row(const Json& row, storage::Attempt& attempt);
void read_row(const Json& row, storage::Decision& decision);
void read_row(const Json& row, ChampionRow& champion);
void read_row(const Json& row, storage::Block& block);
void read_row(const Json& row, storage::BlockScore& score);
/// Reads a summary too; the members that it does not have stay empty.
void read_row(const Json& row, storage::Version& version);
void read_row(const Json& row, storage::ParameterDescriptor& parameter);
void read_row(const Json& row, storage::SeriesInfo& series);
void read_row(const Json& row, std::pair<std::int64_t, std::string>& source);
void read_row(const Json& row, storage::SequenceGap& gap);
void read_row(const Json& row, storage::SampleColumns& samples);
void read_row(const Json& row, CountsRow& counts);

}  // namespace reident::history
