#include "storage/types/telemetry.hpp"

namespace reident::storage {

std::string_view name(Quality quality) {
  switch (quality) {
    case Quality::good:
      return "good";
    case Quality::out_of_limits:
      return "out of limits";
    case Quality::suspect:
      return "suspect";
    case Quality::disputed:
      return "disputed";
    case Quality::invalid:
      break;
  }
  return "invalid";
}

std::string_view name(Origin origin) {
  return origin == Origin::real ? "real" : "simulated";
}

std::string_view name(ParameterKind kind) {
  return kind == ParameterKind::analog ? "analog" : "digital";
}

}  // namespace reident::storage
