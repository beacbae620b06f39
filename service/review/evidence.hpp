// What an attempt looked at, as it is stored (service/judgement/EVIDENCE.md has the members).
#pragma once

#include <nlohmann/json.hpp>

#include "storage/types/registry_rows.hpp"

namespace reident {

/// The evidence of an attempt, or of a decision, as a JSON object; empty where it holds none.
nlohmann::ordered_json evidence_of(const storage::Attempt& attempt);
nlohmann::ordered_json evidence_of(const storage::Decision& decision);

}  // namespace reident
