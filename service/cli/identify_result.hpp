// What `reident identify` prints about a model.
#pragma once

#include <string>
#include <utility>
#include <variant>
#include <vector>

#include <nlohmann/json.hpp>

#include "identification/search/identify.hpp"
#include "identification/simulation/continuous.hpp"
#include "identification/statistics/diagnostics.hpp"
#include "service/model/derived_inputs.hpp"

namespace reident::cli {

struct IdentifyOutcome {
  identification::Identified identified;
  identification::Score identify;           // on the rows that it was identified from
  identification::Diagnostics diagnostics;  // on the validation rows, with the score there
  std::variant<identification::ContinuousModel, identification::Verdict> continuous;
  std::vector<std::string> inputs, outputs;  // column names, or those of derived inputs
  std::vector<DerivedInput> derived;
  std::vector<std::string> regimes;  // conditions
  std::size_t regime_inputs = 0;     // the last so many inputs are those of the regimes
  nlohmann::ordered_json left_out;   // left_out_json()
  std::vector<std::pair<std::string, double>> timing_ms;
  std::vector<std::string> warnings;
  std::string found;          // how the file is read
  std::int64_t phase_ns = 0;  // of ticks behind the multiples of the period
};

/// One JSON object, a key a line.
std::string to_json_text(const IdentifyOutcome& outcome);

/// A short report for a terminal.
std::string to_report(const IdentifyOutcome& outcome);

}  // namespace reident::cli
