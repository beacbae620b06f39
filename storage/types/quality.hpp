// How a sample is flagged. The table of this file is the one place that lists the qualities:
// codecs, SQL, import, export, messages and identification index it or loop over it.
//
// A new quality is an enumerator and a row here, a row of SCHEMA.md ("Qualities"), a constant of
// idl/satcs.idl if a frame may bring it, and the next version in database/schema.hpp: to an older
// program a chunk with a number that it does not know is damaged. Tests fail where the row of the
// page or the constant is missing.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

namespace reident::storage {

/// `disputed` is the archive's own: good telemetry gave two values for one identity, and which of
/// them is true cannot be decided.
enum class Quality : std::uint8_t { good, out_of_limits, suspect, invalid, disputed };

struct QualityFacts {
  Quality quality;
  std::string_view name;
  /// Stands for it in frames, in rows of the history and in chunks. It never changes.
  std::uint8_t wire;
  /// The lower rank wins where one identity has two values. No file holds ranks.
  int rank;
  /// Identification and simulators may use the sample; others are holes.
  bool is_usable;
  /// A frame may bring it; others are the archive's own.
  bool is_sent;
};

/// Ascending by wire value; the enumerators have the same values.
inline constexpr std::array quality_table = {
    // clang-format off
    //           quality                 name             wire  rank  usable  sent
    QualityFacts{Quality::good,          "good",          0,    0,    true,   true},
    QualityFacts{Quality::out_of_limits, "out of limits", 1,    1,    true,   true},
    QualityFacts{Quality::suspect,       "suspect",       2,    2,    false,  true},
    QualityFacts{Quality::invalid,       "invalid",       3,    3,    false,  true},
    QualityFacts{Quality::disputed,      "disputed",      4,    4,    false,  false},
    // clang-format on
};

/// Those of the table, in its order.
inline constexpr auto qualities = [] {
  std::array<Quality, quality_table.size()> all{};
  for (std::size_t i = 0; i < all.size(); ++i) all[i] = quality_table[i].quality;
  return all;
}();

static_assert(
    [] {
      for (std::size_t i = 0; i < quality_table.size(); ++i) {
        const QualityFacts& row = quality_table[i];
        if (row.wire != i || static_cast<std::size_t>(row.quality) != i) return false;
        for (std::size_t k = 0; k < i; ++k)
          if (quality_table[k].rank == row.rank || quality_table[k].name == row.name) return false;
      }
      return true;
    }(),
    "wire values and enumerators count from 0; ranks and names are distinct");

constexpr bool is_wire_value(std::int64_t number) {
  return number >= 0 && number < static_cast<std::int64_t>(quality_table.size());
}

constexpr std::uint8_t wire_value(Quality quality) {
  return static_cast<std::uint8_t>(quality);
}

constexpr std::optional<Quality> quality_of_wire(std::int64_t number) {
  return is_wire_value(number) ? std::optional(static_cast<Quality>(number)) : std::nullopt;
}

/// Those of `invalid` where the table does not know the quality.
constexpr const QualityFacts& facts(Quality quality) {
  return quality_table[wire_value(is_wire_value(wire_value(quality)) ? quality : Quality::invalid)];
}

constexpr std::string_view name(Quality quality) {
  return facts(quality).name;
}

constexpr bool is_usable(Quality quality) {
  return facts(quality).is_usable;
}

constexpr bool is_better(Quality one, Quality other) {
  return facts(one).rank < facts(other).rank;
}

std::optional<Quality> quality_named(std::string_view name);

/// All names for a message, as "'good', 'suspect' or 'invalid'", each between two of `quote`.
std::string quality_names(std::string_view quote = "");

}  // namespace reident::storage
