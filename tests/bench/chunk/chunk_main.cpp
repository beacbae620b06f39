// reident_chunk_bench: size and speed of column chunks on recorded telemetry.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <map>
#include <string>
#include <time.h>
#include <variant>
#include <vector>

#include <CLI/CLI.hpp>

#include "service/telemetry_file/telemetry_file.hpp"
#include "storage/chunks/chunk.hpp"

namespace {

using reident::storage::ChunkDecoder;
using reident::storage::ChunkEncoder;
using reident::storage::ChunkSummary;
using reident::storage::ChunkTarget;
using reident::storage::Quality;
using reident::storage::Time;

constexpr double repeat_s = 0.02;  // decoding of a column, at least: the clock is coarse

struct Options {
  std::vector<std::string> files;
  std::string time = "unix_s";
  std::vector<std::size_t> chunk{4096, 16384, 65536};
  int level = ChunkEncoder::default_level;
  bool columns = false;
};

struct Column {
  std::string name;
  std::vector<Time> time;
  std::vector<double> value;
  std::vector<Quality> quality;
  std::vector<std::int64_t> source;
};

struct Totals {
  double samples = 0, bytes = 0, time = 0, value = 0, quality = 0, source = 0;
  double encode_s = 0, decode_s = 0, decode_part_s = 0;
};

double cpu_seconds() {
  timespec now{};
  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &now);
  return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

/// Every column of a file but its time; cells without a number give no sample. All samples are good
/// and of one source.
std::vector<Column> read_columns(const std::string& file, const std::string& time_column) {
  using reident::telemetry_file::Cell;
  using reident::telemetry_file::TelemetryFile;
  reident::telemetry_file::ReadingOptions options;
  options.time.column = time_column;
  auto opened = TelemetryFile::open(file, options);
  if (const auto* error = std::get_if<reident::csv::Error>(&opened))
    throw CLI::ValidationError(error->message);
  auto& reader = std::get<TelemetryFile>(opened);
  if (const auto error = reader.find_time()) throw CLI::ValidationError(error->message);
  std::vector<Column> columns;
  std::vector<std::size_t> positions;
  for (std::size_t c = 0; c < reader.columns().size(); ++c) {
    if (reader.is_time(c)) continue;
    positions.push_back(c);
    columns.emplace_back().name = reader.columns()[c];
  }
  auto step = reader.next();
  for (; step == TelemetryFile::Step::row; step = reader.next())
    for (std::size_t c = 0; c < columns.size(); ++c) {
      const Cell cell = reader.cell(positions[c]);
      if (cell.kind != Cell::Kind::number || !std::isfinite(cell.value)) continue;
      columns[c].time.push_back(reader.time_ns());
      columns[c].value.push_back(cell.value);
    }
  if (step == TelemetryFile::Step::error) throw CLI::ValidationError(reader.error().message);
  for (Column& column : columns) {
    column.quality.assign(column.time.size(), Quality::good);
    column.source.assign(column.time.size(), 1);
  }
  return columns;
}

using Chunks = std::vector<std::vector<std::uint8_t>>;

Chunks encode(const Column& column, std::size_t most, ChunkEncoder& encoder, Totals& totals) {
  Chunks chunks;
  for (std::size_t first = 0; first < column.time.size(); first += most) {
    const std::size_t count = std::min(most, column.time.size() - first);
    const double start = cpu_seconds();
    chunks.push_back(encoder.encode({std::span(column.time).subspan(first, count),
                                     std::span(column.value).subspan(first, count),
                                     std::span(column.quality).subspan(first, count),
                                     std::span(column.source).subspan(first, count)}));
    totals.encode_s += cpu_seconds() - start;
    totals.bytes += static_cast<double>(chunks.back().size());
    const ChunkEncoder::Sizes& sizes = encoder.sizes();
    totals.time += static_cast<double>(sizes.time);
    totals.value += static_cast<double>(sizes.value);
    totals.quality += static_cast<double>(sizes.quality);
    totals.source += static_cast<double>(sizes.source);
  }
  totals.samples += static_cast<double>(column.time.size());
  return chunks;
}

/// Seconds that it takes to decode all chunks, or of each the sixteenth of its samples that lies in
/// the middle of its time.
double decode(const Chunks& chunks, bool sixteenth, Column& back) {
  ChunkDecoder decoder;
  const ChunkTarget target{&back.time, &back.value, &back.quality, &back.source};
  int repeats = 0;
  const double start = cpu_seconds();
  double spent = 0;
  do {
    back.time.clear();  // keeps the memory
    back.value.clear();
    back.quality.clear();
    back.source.clear();
    for (const auto& chunk : chunks) {
      const auto summary = std::get<ChunkSummary>(reident::storage::read_summary(chunk));
      const Time part = (summary.last_time - summary.first_time) / 32;
      const Time middle = summary.first_time + 16 * part;
      const auto error = sixteenth ? decoder.decode(chunk, {middle - part, middle + part}, target)
                                   : decoder.decode(chunk, target);
      if (error) throw CLI::ValidationError("a chunk " + error->message);
    }
    ++repeats;
    spent = cpu_seconds() - start;
  } while (spent < repeat_s);
  return spent / repeats;
}

void measure(const Column& column, std::size_t most, ChunkEncoder& encoder, Totals& totals) {
  const Chunks chunks = encode(column, most, encoder, totals);
  Column back;
  totals.decode_part_s += decode(chunks, true, back);
  totals.decode_s += decode(chunks, false, back);
  if (back.time != column.time || back.value != column.value || back.quality != column.quality ||
      back.source != column.source)
    throw CLI::ValidationError(column.name + " did not come back");
}

void print(const std::string& what, const Totals& totals) {
  const auto each = [&](double bytes) { return bytes / totals.samples; };
  std::printf("%-24s %8.4f %8.4f %8.4f %8.4f %8.4f %9.1f %9.1f %9.2f\n", what.c_str(),
              each(totals.bytes), each(totals.time), each(totals.value), each(totals.quality),
              each(totals.source), totals.samples / totals.encode_s / 1e6,
              totals.samples / totals.decode_s / 1e6, totals.decode_part_s / totals.decode_s);
}

void run(const Options& options) {
  std::vector<std::vector<Column>> files;
  for (const std::string& file : options.files) files.push_back(read_columns(file, options.time));
  std::printf("%-24s %8s %8s %8s %8s %8s %9s %9s %9s\n", "bytes a sample", "all", "time", "value",
              "quality", "source", "enc M/s", "dec M/s", "1/16");
  for (const std::size_t most : options.chunk) {
    ChunkEncoder encoder(options.level);
    std::map<std::string, Totals> columns;
    Totals all;
    for (const auto& file : files)
      for (const Column& column : file) {
        if (options.columns) measure(column, most, encoder, columns[column.name]);
        measure(column, most, encoder, all);
      }
    for (const auto& [name, totals] : columns) print(name, totals);
    print("chunks of " + std::to_string(most), all);
  }
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App app("Size and speed of column chunks, on one core", "reident_chunk_bench");
  Options options;
  app.add_option("file", options.files, "CSV files; every column but the time is a parameter")
      ->required();
  app.add_option("--time", options.time, "Name of the column with the time")->capture_default_str();
  app.add_option("--chunk", options.chunk, "Samples of a chunk")->capture_default_str();
  app.add_option("--level", options.level, "Level of zstd")->capture_default_str();
  app.add_flag("--columns", options.columns, "A line for each column, too");
  try {
    app.parse(argc, argv);
    run(options);
  } catch (const CLI::Error& error) {
    return app.exit(error);
  }
  return 0;
}
