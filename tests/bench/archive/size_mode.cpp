#include <algorithm>
#include <filesystem>
#include <variant>

#include "service/satcs/reference/reference_stream.hpp"
#include "service/satcs/replay/replay.hpp"
#include "tests/bench/archive/modes.hpp"

namespace reident::bench {
namespace {

struct SizeOptions {
  std::string folder;
  std::vector<std::string> csv;
  std::int64_t reference_s = 0;
  std::size_t batch = 512;
};

std::vector<std::unique_ptr<satcs::FrameStream>> streams_of(const SizeOptions& options) {
  std::vector<std::unique_ptr<satcs::FrameStream>> streams;
  const satcs::Sender sender{.source = "bench"};
  for (const std::string& file : options.csv) {
    satcs::ReplayOptions replay;
    replay.file = file;
    auto plan = satcs::plan_replay(replay);
    if (const auto* error = std::get_if<csv::Error>(&plan))
      throw std::runtime_error(error->message);
    streams.push_back(std::make_unique<satcs::ReplayStream>(
        std::get<satcs::ReplayPlan>(std::move(plan)), sender));
  }
  if (options.reference_s > 0) {
    satcs::ReferenceOptions reference;
    reference.duration_ns = options.reference_s * 1'000'000'000;
    streams.push_back(satcs::reference_stream(reference, sender));
  }
  return streams;
}

/// All of the stream in both files; returns how many samples there were.
std::uint64_t store_all(satcs::FrameStream& stream, TelemetryStore& archive, TelemetryStore& plain,
                        std::size_t batch_frames, std::uint64_t& sequence) {
  auto descriptors = stream.parameters();
  for (auto& descriptor : descriptors) descriptor.spacecraft = mission;
  archive.describe(descriptors);
  std::vector<storage::TelemetryFrame> batch;
  std::uint64_t samples = 0;
  bool more = true;
  while (more) {
    batch.resize(batch_frames);
    std::size_t count = 0;
    while (count < batch.size() && (more = stream.next(batch[count]))) {
      auto& frame = batch[count];
      frame.spacecraft = mission;
      frame.sequence = ++sequence;
      samples += frame.samples.size();
      ++count;
    }
    batch.resize(count);
    if (batch.empty()) break;
    archive.append(batch);
    plain.append(batch);
  }
  return samples;
}

void run(const SizeOptions& options) {
  const std::filesystem::path folder(options.folder);
  const auto archive_file = folder / "size-archive.db", plain_file = folder / "size-plain.db";
  std::uint64_t samples = 0, sequence = 0;
  {
    const auto archive = open_store(StoreKind::archive, archive_file, Access::write);
    const auto plain = open_store(StoreKind::plain, plain_file, Access::write);
    for (const auto& stream : streams_of(options))
      samples += store_all(*stream, *archive, *plain, options.batch, sequence);
    archive->settle();
  }
  const auto archive_bytes = bytes_in_use(archive_file), plain_bytes = bytes_in_use(plain_file);
  for (const auto& file : {archive_file, plain_file}) std::filesystem::remove(file);
  print({{"samples", samples}, {"archive_bytes", archive_bytes}, {"plain_bytes", plain_bytes}});
}

}  // namespace

void add_size(CLI::App& app) {
  auto options = std::make_shared<SizeOptions>();
  CLI::App* mode = app.add_subcommand("size", "Bytes in use of files with the same telemetry");
  mode->add_option("folder", options->folder, "For the files")->required();
  mode->add_option("--csv", options->csv, "All columns of files of recorded telemetry");
  mode->add_option("--reference", options->reference_s, "Or so many seconds of the reference");
  mode->callback([options] { run(*options); });
}

}  // namespace reident::bench
