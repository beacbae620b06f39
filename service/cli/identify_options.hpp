// What `reident identify` is asked for besides the data, checked and as the identification takes
// it.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "identification/search/identify.hpp"
#include "service/cli/command.hpp"

namespace reident::cli {

struct ModelRequest {
  std::string order = "auto";
  std::string horizon = "auto";
  bool direct = false;              // D as the data say
  bool no_direct = false;           // D = 0
  bool as_found = false;            // A is never made stable
  std::vector<std::string> delays;  // "INPUT=SAMPLES"
  std::optional<std::string> max_delay;
};

void add_model_options(CLI::App& command, ModelRequest& request);

/// The request in the options, for a model of these inputs and outputs.
std::optional<Refusal> parse_model_request(const ModelRequest& request,
                                           const std::vector<std::string>& inputs,
                                           const std::vector<std::string>& outputs,
                                           identification::IdentifyOptions& options);

}  // namespace reident::cli
