// Which telemetry of an equipment is excluded: ticks at which a declared relation of its sensors
// does not hold, or a sensor shows a fault by itself (identification/METHOD.md, section 17). They
// are holes for whoever identifies, validates or monitors.
#pragma once

#include <string>
#include <vector>

#include <nlohmann/json_fwd.hpp>

#include "identification/samples/tick_ranges.hpp"
#include "service/config/config.hpp"
#include "service/windows/chunk_cache.hpp"
#include "service/windows/window_data.hpp"
#include "storage/types/sample_reader.hpp"

namespace reident {

/// What is checked of an equipment.
struct Checks {
  bool screening = false;
  std::vector<Relation> relations;
};

/// Returns the checks that the configuration asks for.
Checks checks_of(const EquipmentConfig& equipment);

/// The checks of one equipment over ranges of time; what it keeps of a window serves the next.
/// One thread at a time.
class PlausibilityChecks {
 public:
  /// Relations are evaluated on the grid of `request`.
  PlausibilityChecks(const WindowRequest& request, const Checks& checks);

  /// Checks `samples`: the rows at `ticks` with u the parameters that the inputs are computed from
  /// and `described` what they are. A relation of which telemetry has not described a parameter
  /// does not apply. Residuals of relations are read where they are not kept. Throws
  /// storage::Error.
  Plausibility look(const storage::SampleReader& archive, const WindowData& described,
                    const identification::Record& samples, identification::TickRange ticks);

  /// Forgets what was read of these ticks, since samples were stored there.
  void forget(identification::TickRange ticks);

 private:
  struct BoundRelation {
    Relation relation;
    std::vector<std::string> parameters;
    WindowRequest request;  // of its residual, as a derived input
    ChunkCache residuals;
    std::vector<std::uint32_t> ids;  // that these were read of
  };
  void look(const storage::SampleReader& archive, BoundRelation& bound,
            identification::TickRange ticks, Plausibility& result);

  bool screening_;
  std::vector<BoundRelation> relations_;
};

/// Returns how many ranges in `ticks` were found faulty, however long, over the number of `ticks`.
/// Requires at least one tick.
double fault_share(const Plausibility& plausibility, identification::TickRange ticks);

/// Returns what an attempt's evidence says (`implausible`). Of more than 20 ranges the longest
/// are listed. `period`: of a tick [ns].
nlohmann::ordered_json to_json(const Plausibility& plausibility, Duration period);

/// Returns what an operator has to know, as a sentence: the longest range that was excluded, by
/// which check and since when. Requires that any was found.
std::string worst_of(const Plausibility& plausibility, Duration period);

}  // namespace reident
