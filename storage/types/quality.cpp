#include "storage/types/quality.hpp"

namespace reident::storage {

std::optional<Quality> quality_named(std::string_view name) {
  for (const QualityFacts& row : quality_table)
    if (row.name == name) return row.quality;
  return std::nullopt;
}

std::string quality_names(std::string_view quote) {
  std::string names;
  for (const QualityFacts& row : quality_table) {
    if (&row != &quality_table.front()) names += &row == &quality_table.back() ? " or " : ", ";
    names.append(quote).append(row.name).append(quote);
  }
  return names;
}

}  // namespace reident::storage
