// Whether service/judgement/EVIDENCE.md names what evidence holds.
#pragma once

#include <fstream>
#include <iterator>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

namespace reident::test {

/// Members that the page does not name anywhere. Those of diagnostics, of limits and of reasons,
/// and the phases of the timing are not looked at.
inline std::vector<std::string> not_on_the_page(const nlohmann::json& evidence) {
  std::ifstream file(REIDENT_EVIDENCE_PAGE);
  const std::string page{std::istreambuf_iterator<char>(file), {}};
  std::vector<std::string> missing;
  const auto look = [&](const auto& again, const nlohmann::json& json) -> void {
    for (const auto& item : json.items()) {
      if (page.find('`' + item.key() + '`') == std::string::npos) missing.push_back(item.key());
      if (item.key() == "diagnostics" || item.key() == "timing_ms" || item.key() == "limits" ||
          item.key() == "reasons")
        continue;
      if (item.value().is_object()) again(again, item.value());
      if (item.value().is_array())
        for (const auto& element : item.value())
          if (element.is_object()) again(again, element);
    }
  };
  look(look, evidence);
  return missing;
}

}  // namespace reident::test
