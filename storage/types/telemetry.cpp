#include "storage/types/telemetry.hpp"

namespace reident::storage {

std::string_view name(Origin origin) {
  return origin == Origin::real ? "real" : "simulated";
}

std::string_view name(ParameterKind kind) {
  return kind == ParameterKind::analog ? "analog" : "digital";
}

}  // namespace reident::storage
