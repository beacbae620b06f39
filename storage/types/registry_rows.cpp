#include "storage/types/registry_rows.hpp"

#include <algorithm>
#include <array>
#include <stdexcept>
#include <utility>

namespace reident::storage {
namespace {

constexpr std::array kinds{
    std::pair{DecisionKind::approve, std::string_view("approve")},
    std::pair{DecisionKind::reject, std::string_view("reject")},
    std::pair{DecisionKind::wait, std::string_view("wait")},
    std::pair{DecisionKind::roll_back, std::string_view("roll_back")},
    std::pair{DecisionKind::withdraw, std::string_view("withdraw")},
};

}  // namespace

std::string_view name(DecisionKind kind) {
  for (const auto& [known, name] : kinds)
    if (known == kind) return name;
  throw std::logic_error("a decision without a name");
}

std::optional<DecisionKind> decision_kind(std::string_view name) {
  const auto found = std::find_if(kinds.begin(), kinds.end(),
                                  [&](const auto& kind) { return kind.second == name; });
  return found == kinds.end() ? std::nullopt : std::optional(found->first);
}

}  // namespace reident::storage
