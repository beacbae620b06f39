// Configurations as texts, and what is wrong with them.
#pragma once

#include <ostream>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "service/config/config.hpp"

namespace reident {

constexpr Duration ms = 1'000'000;
constexpr Duration s = 1'000 * ms;
constexpr Duration min = 60 * s;

// Lines 1 to 8; what a test adds comes after.
inline const std::string minimal = R"([[spacecraft]]
name = "CBERS-4"
[[spacecraft.equipment]]
name = "BDR"
inputs = ["I_BDRIN1", "I_BDRIN2"]
outputs = ["I_BDROUT"]
sample_period = "1s"
window = "100min"
)";

inline Config config_of(const std::string& text) {
  const auto parsed = parse_config(text, "/folder");
  if (const auto* mistakes = std::get_if<std::vector<ConfigMistake>>(&parsed))
    for (const ConfigMistake& mistake : *mistakes)
      ADD_FAILURE() << mistake.line << ": " << mistake.message;
  return std::holds_alternative<Config>(parsed) ? std::get<Config>(parsed) : Config();
}

/// "line: message" of every mistake.
inline std::vector<std::string> mistakes_of(const std::string& text) {
  std::vector<std::string> found;
  const auto parsed = parse_config(text, "/folder");
  if (const auto* mistakes = std::get_if<std::vector<ConfigMistake>>(&parsed))
    for (const ConfigMistake& mistake : *mistakes)
      found.push_back(fmt::format("{}: {}", mistake.line, mistake.message));
  return found;
}

struct Mistake {
  const char* name;
  std::string text;
  std::string expected;  // "line: beginning of the message"
};
inline std::ostream& operator<<(std::ostream& out, const Mistake& mistake) {
  return out << mistake.name;
}

inline std::string name_of(const ::testing::TestParamInfo<Mistake>& tested) {
  return tested.param.name;
}

/// The minimal file with one line changed.
inline std::string with(int line, const std::string& replacement) {
  std::string text;
  std::string rest = minimal;
  for (int at = 1; !rest.empty(); ++at) {
    const std::size_t end = rest.find('\n') + 1;
    text += at == line ? replacement + "\n" : rest.substr(0, end);
    rest.erase(0, end);
  }
  return text;
}

/// With P = U * I_BDRIN1 as a second input on lines 5 and 9 to 12, line `line` replaced.
inline std::string with_derived(std::size_t line, const std::string& text) {
  const std::vector<std::string> table = {"[[spacecraft.equipment.derived]]", "name = \"P\"",
                                          "expression = \"U * I_BDRIN1\"", "unit = \"W\""};
  std::string result = with(5, "inputs = [\"I_BDRIN1\", \"P\"]");
  for (std::size_t i = 0; i < table.size(); ++i) result += (9 + i == line ? text : table[i]) + "\n";
  return result;
}

}  // namespace reident
