#include "service/transfer/undo.hpp"

#include <algorithm>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "service/telemetry_file/long_layout.hpp"
#include "service/transfer/telemetry_csv.hpp"

namespace reident::transfer {
namespace {

/// Whose samples an import's are: what import.cpp put into the request.
struct Origins {
  std::string spacecraft, source;
  storage::Origin origin = storage::Origin::real;
  bool says_itself = false;  // rows of the file name their source
  auto operator<=>(const Origins&) const = default;
};

Origins origins_of(const storage::ImportedFile& import) {
  const auto request = nlohmann::json::parse(import.request, nullptr, false);
  const auto text = [&](const char* key) {
    return request.is_object() && request.contains(key) && request[key].is_string()
               ? request[key].get<std::string>()
               : std::string();
  };
  Origins origins;
  origins.spacecraft = text("spacecraft");
  origins.source = text("source");
  if (origins.source.empty())
    origins.source = "import:" + std::filesystem::path(import.file).filename().string();
  origins.origin = parse_origin(text("origin")).value_or(storage::Origin::real);
  std::vector<std::string> columns;
  if (request.is_object() && request.contains("columns") && request["columns"].is_array())
    for (const auto& column : request["columns"])
      if (column.is_string()) columns.push_back(column.get<std::string>());
  const auto names = [&](const char* column, bool is_given) {
    return !is_given && std::find(columns.begin(), columns.end(), column) != columns.end();
  };
  origins.says_itself = telemetry_file::find_long_layout(columns) &&
                        (names("source", !text("source").empty()) ||
                         names("spacecraft", !text("spacecraft").empty()) ||
                         names("origin", !text("origin").empty()));
  return origins;
}

bool is_same_file(const std::string& one, const std::filesystem::path& other) {
  std::error_code ignored;
  return one == other.string() || std::filesystem::equivalent(one, other, ignored);
}

}  // namespace

std::variant<storage::SourceRemovalReport, csv::Error> undo_import(
    storage::Database& database, const std::filesystem::path& file) {
  const auto imports = storage::imported_files(database);
  std::vector<const storage::ImportedFile*> undone;
  for (const auto& import : imports)
    if (is_same_file(import.file, file)) undone.push_back(&import);
  if (undone.empty()) {
    std::string known;
    for (const auto& import : imports)
      if (known.find(import.file) == std::string::npos)
        known += (known.empty() ? "" : ", ") + import.file;
    return csv::Error{fmt::format("{}: the archive holds no import of this file; it has {}",
                                  file.string(), known.empty() ? "none" : known)};
  }
  for (const auto* import : undone) {
    const Origins origins = origins_of(*import);
    if (origins.says_itself)
      return csv::Error{
          file.string() +
          ": the rows of this file say themselves what they come from, as an export's do; "
          "what it brought is not told from what was there"};
    for (const auto& other : imports)
      if (!is_same_file(other.file, file) && origins_of(other) == origins)
        return csv::Error{
            fmt::format("{}: samples of {} have the same source '{}'; undo both by importing each "
                        "with its own --source into a new database",
                        file.string(), other.file, origins.source)};
  }
  storage::Archive archive(database);
  archive.compact();
  storage::SourceRemovalReport report;
  for (const auto* import : undone) {
    const Origins origins = origins_of(*import);
    const auto removed =
        storage::remove_source(archive, origins.spacecraft, origins.origin, origins.source);
    report.samples += removed.samples;
    report.series += removed.series;
    storage::forget_import(database, import->id);
  }
  return report;
}

}  // namespace reident::transfer
