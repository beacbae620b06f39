#include "service/review/evidence.hpp"

namespace reident {
namespace {

nlohmann::ordered_json object_in(const std::string& text) {
  nlohmann::ordered_json evidence = nlohmann::ordered_json::parse(text, nullptr, false);
  return evidence.is_object() ? evidence : nlohmann::ordered_json::object();
}

}  // namespace

nlohmann::ordered_json evidence_of(const storage::Attempt& attempt) {
  return object_in(attempt.evidence_json);
}

nlohmann::ordered_json evidence_of(const storage::Decision& decision) {
  return object_in(decision.evidence_json);
}

}  // namespace reident
