// Which telemetry of an equipment is not believed: ticks at which a declared relation of its
// sensors does not hold, or a sensor shows a fault by itself. They are holes for whoever
// identifies, validates or watches.
#pragma once

#include <string>
#include <vector>

#include <nlohmann/json_fwd.hpp>

#include "identification/samples/tick_ranges.hpp"
#include "service/config/config.hpp"
#include "service/windows/chunk_cache.hpp"
#include "service/windows/window_data.hpp"
#include "storage/types/sample_source.hpp"

namespace reident {

/// What is checked.
struct Checks {
  bool screening = false;
  std::vector<Relation> relations;
};

Checks checks_of(const EquipmentConfig& equipment);

/// One check over stretches of time; what it keeps of a window serves the next.
class PlausibilityChecks {
 public:
  /// Relations are evaluated on the grid of `request`.
  PlausibilityChecks(const WindowRequest& request, const Checks& checks);

  /// Checks `samples`: the rows at `ticks` with u the parameters that the inputs are computed from
  /// and `described` what they are. A relation of which telemetry has not described a parameter
  /// does not apply.
  Plausibility look(const storage::SampleSource& archive, const WindowData& described,
                    const identification::Record& samples, identification::TickRange ticks);

  void forget(identification::TickRange ticks);

 private:
  struct BoundRelation {
    Relation relation;
    std::vector<std::string> parameters;
    WindowRequest request;  // of its residual, as a derived input
    ChunkCache residuals;
    std::vector<std::uint32_t> ids;  // that these were read of
  };
  void look(const storage::SampleSource& archive, BoundRelation& bound,
            identification::TickRange ticks, Plausibility& result);

  bool screening_;
  std::vector<BoundRelation> relations_;
};

/// Faults that were found in `ticks`, at least one, each once, over their number, whether they have
/// telemetry or not.
double fault_share(const Plausibility& plausibility, identification::TickRange ticks);

/// For an attempt's evidence. Of more than 20 stretches the longest are listed.
nlohmann::ordered_json to_json(const Plausibility& plausibility, Duration period);

/// What an operator has to know: the longest stretch that was left out, by whom and since when.
std::string worst_of(const Plausibility& plausibility, Duration period);

}  // namespace reident
