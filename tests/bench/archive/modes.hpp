// What reident_archive_bench measures: one thing in one process, as one JSON object on one line.
#pragma once

#include <CLI/CLI.hpp>
#include <nlohmann/json.hpp>

#include "tests/bench/archive/telemetry_store.hpp"

namespace reident::bench {

void add_append(CLI::App& app);
void add_ask(CLI::App& app);
void add_read(CLI::App& app);
void add_size(CLI::App& app);
void add_content(CLI::App& app);

/// The kind and the file that a mode begins with.
struct StoreChoice {
  StoreKind kind = StoreKind::archive;
  std::string file;

  void add_to(CLI::App& mode) {
    mode.add_option("kind", kind, "archive or plain")
        ->required()
        ->transform(CLI::CheckedTransformer(std::map<std::string, StoreKind>{
            {"archive", StoreKind::archive}, {"plain", StoreKind::plain}}));
    mode.add_option("file", file, "Its file")->required();
  }
};

/// Seconds of a clock that only goes forward.
double seconds_now();
/// Processor time of this process so far, in seconds.
double processor_seconds();
/// Greatest resident memory of this process so far, in MiB.
double peak_mib();
void print(const nlohmann::json& result);

}  // namespace reident::bench
