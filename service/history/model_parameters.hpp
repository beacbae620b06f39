// What a stored model has telemetry of.
#pragma once

#include <string>
#include <vector>

namespace reident::history {

/// The parameters that the inputs of a model are computed from, and its outputs. Reads no more of
/// the model's JSON than its signals, which stand before the matrices. Throws std::exception where
/// that is none.
std::vector<std::string> parameters_of(const std::string& model_json);

}  // namespace reident::history
