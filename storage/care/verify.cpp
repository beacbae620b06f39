#include "storage/care/verify.hpp"

#include <algorithm>
#include <limits>
#include <set>

#include "storage/care/verify_series.hpp"
#include "storage/care/verify_tables.hpp"
#include "storage/database/connection.hpp"

namespace reident::storage {
namespace {

using sqlite::Connection;

constexpr double share_of_pages = 0.3;  // of the time, where chunks are decoded

/// What a damaged file makes impossible is a finding, and the rest is looked at all the same.
void look(const char* check, VerifyReport& report, const std::function<void()>& work) {
  try {
    work();
  } catch (const Error& error) {
    report.add({.check = check,
                .what = error.what(),
                .remedy = "restore a backup; 'sqlite3 FILE .recover' saves what can be read"});
  }
}

void verify_versions(Database& database, const VerifyOptions& options, VerifyReport& report) {
  const Registry registry(database);
  for (const EquipmentName& equipment : registry.equipment())
    for (const VersionSummary& summary :
         registry.summaries(equipment.spacecraft, equipment.equipment)) {
      const auto version =
          registry.version(equipment.spacecraft, equipment.equipment, summary.number);
      if (!version) continue;
      ++report.versions;
      const auto mistake = options.mistake_in ? options.mistake_in(*version) : std::nullopt;
      if (mistake)
        report.add({"versions", equipment.spacecraft, equipment.equipment, std::nullopt,
                    version->window.begin, version->window.end,
                    "version " + std::to_string(summary.number) + ": " + *mistake,
                    "restore its row from a backup; simulators are not sent a version whose model "
                    "is not the one of its digest"});
    }
}

/// Rows of chunk_data that not exactly one chunk refers to. The writer moves samples meanwhile:
/// what looks wrong is looked at again in one snapshot.
void verify_data_rows(Connection& connection, const DataReferences& references,
                      VerifyReport& report) {
  std::set<std::int64_t> doubtful = references.repeated();
  {
    constexpr std::int64_t rows_of_snapshot = 100'000;
    std::int64_t last = std::numeric_limits<std::int64_t>::min(), rows = rows_of_snapshot;
    while (rows == rows_of_snapshot) {
      rows = 0;
      sqlite::Query row = connection.query(
          "SELECT id FROM chunk_data WHERE id > ? ORDER BY id LIMIT ?", last, rows_of_snapshot);
      for (; row.step(); ++rows) {
        if (row.integer(0) <= last) connection.fail_out_of_order("chunk_data");
        if (last = row.integer(0); !references.has(last)) doubtful.insert(last);
      }
    }
  }
  if (doubtful.empty()) return;
  const sqlite::ReadTransaction snapshot(connection);
  std::multiset<std::int64_t> referred;
  {
    sqlite::Query row = connection.query("SELECT data FROM chunk WHERE shard = 0");
    while (row.step())
      if (doubtful.contains(row.integer(0))) referred.insert(row.integer(0));
  }
  sqlite::Query exists = connection.query("SELECT 1 FROM chunk_data WHERE id = ?");
  for (const std::int64_t id : doubtful) {
    const std::size_t chunks = referred.count(id);
    if (chunks == 1 || (chunks == 0 && !exists.bind(id).step())) continue;
    report.add({.check = "chunk",
                .what = "row " + std::to_string(id) + " of chunk_data belongs to " +
                        std::to_string(chunks) + " chunks",
                .remedy = chunks == 0 ? "no sample is missing by it; it may be what is left of one "
                                        "that another finding names"
                                      : "restore the samples of these chunks from a backup"});
  }
}

/// What cannot be opened is one finding, however many chunks are in it.
void verify_shards(Connection& connection, VerifyReport& report) {
  struct Shard {
    std::int64_t id;
    std::string file;
    std::int64_t said, found;
  };
  std::vector<Shard> shards;
  const sqlite::ReadTransaction snapshot(connection);
  {
    sqlite::Query row = connection.query(
        "SELECT shard, file, chunks, count(*) FROM chunk LEFT JOIN shard ON shard.id = chunk.shard "
        "WHERE chunk.shard <> 0 GROUP BY chunk.shard");
    while (row.step())
      shards.push_back({row.integer(0), row.text(1), row.integer(2), row.integer(3)});
  }
  ChunkBytes bytes(connection);
  for (const Shard& shard : shards) {
    try {
      bytes.shard(shard.id);
      if (shard.said != shard.found)
        report.add({.check = "shard",
                    .what = "the row of the shard " + shard.file + " says " +
                            std::to_string(shard.said) + " chunks, there are " +
                            std::to_string(shard.found),
                    .remedy = "the samples are sound; report it with the file"});
    } catch (const Error& error) {
      report.unreadable_shards.insert(shard.id);
      report.add({.check = "shard",
                  .what = error.what(),
                  .remedy = "restore the shard; its chunks were not looked at"});
    }
  }
}

/// False when it was stopped.
bool verify_all_series(Connection& connection, const VerifyOptions& options, VerifyReport& report,
                       const std::function<bool(const VerifyProgress&)>& go_on) {
  std::vector<std::int64_t> ids;
  double all = 1;
  DataReferences references;
  {
    sqlite::Query row = connection.query("SELECT id, samples FROM series ORDER BY id");
    while (row.step()) {
      ids.push_back(row.integer(0));
      all += row.real(1);
    }
  }
  double done = 0;
  const auto advanced = [&](std::uint64_t samples) {
    done += static_cast<double>(samples);
    return go_on({share_of_pages + (1 - share_of_pages) * std::min(1.0, done / all),
                  "series " + std::to_string(report.series) + " of " + std::to_string(ids.size())});
  };
  SeriesVerifier verifier(connection, options, report, references, advanced);
  for (const std::int64_t id : ids)
    if (!verifier.verify(id) || !advanced(0)) return false;
  verify_data_rows(connection, references, report);
  return true;
}

}  // namespace

void VerifyReport::add(Finding finding) {
  ++found;
  if (findings.size() < most_findings) findings.push_back(std::move(finding));
}

VerifyReport verify(Database& database, const VerifyOptions& options,
                    const std::function<bool(const VerifyProgress&)>& go_on) {
  VerifyReport report;
  Connection& connection = *database.impl().connection;
  const auto still = [&] { return go_on({0, "pages"}); };
  if (!verify_pages(connection, options.quick, report, still)) {
    report.complete = false;
    return report;
  }
  look("schema", report, [&] { verify_schema(connection, report); });
  look("source", report, [&] { verify_sources(connection, report); });
  look("rows", report, [&] { verify_rows(connection, report); });
  look("versions", report, [&] { verify_versions(database, options, report); });
  look("shard", report, [&] { verify_shards(connection, report); });
  look("series", report,
       [&] { report.complete = verify_all_series(connection, options, report, go_on); });
  return report;
}

}  // namespace reident::storage
