// The codes of the reasons that evidence holds.
#pragma once

#include <string>

#include <nlohmann/json.hpp>

#include "service/model/reasons.hpp"

namespace reident::test {

inline nlohmann::json reasons_in(const std::string& evidence_json) {
  return nlohmann::json::parse(evidence_json).at("reasons");
}

/// The code of the last reason, which decided.
inline std::string code_in(const std::string& evidence_json) {
  return reasons_in(evidence_json).back().at("code");
}

}  // namespace reident::test
