#include "identification/subspace/weighting.hpp"

namespace reident::identification {

std::string_view name(Weighting weighting) {
  switch (weighting) {
    case Weighting::n4sid:
      return "n4sid";
    case Weighting::moesp:
      return "moesp";
    case Weighting::cva:
      return "cva";
  }
  return "unknown";
}

}  // namespace reident::identification
