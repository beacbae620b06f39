// What the simulators and services of a partition say, heard by a program that has just joined.
#pragma once

#include <chrono>

#include "service/cli/output/simulator_list.hpp"
#include "service/dds/dds.hpp"

namespace reident::cli {

/// Listens until what is new has ended: no writer of versions or acknowledgements, no simulator and
/// no champion appeared for a second, or for two where there is none of one of them; at most for
/// `limit`. Each of those who live sends what it
/// said last as soon as it is discovered. Throws dds::Error.
PartitionSurvey look_into(const dds::Endpoint& endpoint, std::chrono::nanoseconds limit);

}  // namespace reident::cli
