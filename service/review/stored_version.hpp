// All that is stored about one version of a model.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "service/history/readers.hpp"
#include "service/model/model_version.hpp"

namespace reident {

struct StoredVersion {
  storage::Version version;
  storage::Attempt attempt;
  std::vector<storage::Decision> decisions;
  std::optional<storage::Hold> hold;  // of its equipment, now
  EquipmentModel model;
  bool digest_matches = false;
};

/// Absent where the equipment has no version of that number.
std::optional<StoredVersion> stored_version(const history::HistoryReader& history,
                                            const storage::EquipmentName& equipment,
                                            std::int64_t number);

/// The range whose samples chose, as the version's provenance says it; absent in versions from
/// before schema 2.
std::optional<storage::TimeRange> tuned_on(const storage::Version& version);

}  // namespace reident
