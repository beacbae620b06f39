// The free run of a version over telemetry, block by block, as a simulator runs it: without
// interruption. Its state at the end of a block is kept with the score, so that the run goes on
// behind a restart to the same bits.
#pragma once

#include <cstddef>
#include <cstdint>

#include "service/model/model_version.hpp"
#include "service/windows/block_reader.hpp"
#include "storage/types/registry_rows.hpp"

namespace reident {

/// Runs version `number` from `before` on through the block and scores it. Where `before` has no
/// state, or does not reach the block, the state is estimated from the telemetry: behind a gap that
/// is bridged (identification/simulation/hole_bridging.hpp) from the run as well. A block without
/// rows gives a score without rows and keeps the state. Requires a well-formed model with the
/// inputs and outputs of the samples.
storage::BlockScore score_block(const EquipmentModel& model, std::int64_t number,
                                const BlockSamples& samples, const storage::RunState& before);

/// Returns what BlockScore::bias_effects says of the bias at `place` of so many: the mean of the
/// sensor's values, and for each output the means of the effect's square and of its product with
/// the error. Null where the score has none, or those of another number of biases.
const double* bias_effect_in(const storage::BlockScore& score, std::size_t place,
                             std::size_t biases);

}  // namespace reident
