// What a writer of an archive does in the life of a mission, in few steps: everything about a step
// follows from its number.
#pragma once

#include <cstdint>
#include <functional>
#include <string_view>
#include <vector>

#include "storage/archive/archive.hpp"

namespace reident::storage::test {

enum class StepKind { append, compact, checkpoint, reopen };

struct Step {
  StepKind kind = StepKind::append;
  std::vector<TelemetryFrame> frames;  // of an append
};

/// A cycle of these has frames in order, late, played backwards, sent twice, contradicting each
/// other, of two sources and of the simulator, a gap in the sequence numbers that is filled later
/// and one that stays; compaction, folding the log into the file, and a restart.
inline constexpr std::uint64_t steps_of_cycle = 12;
Step step_at(std::uint64_t number);

/// So small that each cycle fills chunks, and appends move samples into chunks on their own.
inline constexpr ArchiveOptions session_options{
    .chunk_samples = 16, .recent_samples = 200, .recent_batches = 3, .step_samples = 40};

/// Carries out steps [first, end) on the archive at `path`, which is opened at the first and
/// closed after the last. `done` gets the number of each step that returned.
void carry_out_steps(const std::filesystem::path& path, Durability durability, std::uint64_t first,
                     std::uint64_t end, const std::function<void(std::uint64_t)>& begins,
                     const std::function<void(std::uint64_t)>& done);

}  // namespace reident::storage::test
