#include "service/operations/protected_telemetry.hpp"

#include <algorithm>
#include <limits>
#include <set>
#include <stdexcept>

#include "service/model/model_json.hpp"
#include "service/windows/block_reader.hpp"
#include "service/windows/provenance.hpp"
#include "service/windows/window_data.hpp"

namespace reident {
namespace {

using storage::ProtectedRange;
using storage::TimeRange;
using Descriptors = std::vector<storage::ParameterDescriptor>;

storage::Time before(storage::Time time, Duration by) {
  constexpr storage::Time earliest = std::numeric_limits<storage::Time>::min();
  return time < earliest + by ? earliest : time - by;
}

void add(std::vector<ProtectedRange>& ranges, const std::string& spacecraft,
         const Descriptors& descriptors, const std::vector<std::string>& names, TimeRange range) {
  for (const std::string& name : names) {
    bool is_known = false;
    for (const storage::ParameterDescriptor& descriptor : descriptors) {
      if (descriptor.name != name) continue;
      ranges.push_back({spacecraft, descriptor.id, range});
      is_known = true;
    }
    if (!is_known) ranges.push_back({spacecraft, std::nullopt, range});
  }
}

std::vector<std::string> parameters_of(const EquipmentModel& model) {
  std::vector<std::string> names =
      InputExpressions(signal_names(model.inputs), derived_inputs(model.inputs)).parameters();
  for (const Signal& output : model.outputs) names.push_back(output.name);
  return names;
}

/// What the version was made from, and all of `range`.
void add(std::vector<ProtectedRange>& ranges, const Descriptors& descriptors,
         const storage::Version& version, TimeRange range) {
  try {
    const EquipmentModel model = equipment_model_from_json(version.model_json);
    for (const TimeRange& part : {version.window, model.identified_from, model.validated_on}) {
      range.begin = std::min(range.begin, part.begin);
      range.end = std::max(range.end, part.end);
    }
    range.begin = before(range.begin, model.sample_hold_ns);
    std::vector<std::string> names = parameters_of(model);
    for (const Relation& relation : relations_of(version))
      for (std::string& name : parameters_of(relation)) names.push_back(std::move(name));
    add(ranges, version.spacecraft, descriptors, names, range);
  } catch (const std::invalid_argument&) {
    ranges.push_back({version.spacecraft, std::nullopt, range});
  }
}

}  // namespace

std::vector<ProtectedRange> telemetry_of_versions(const storage::Archive& archive,
                                                  const storage::Registry& registry) {
  std::vector<ProtectedRange> ranges;
  for (const storage::EquipmentName& equipment : registry.equipment()) {
    std::set<std::int64_t> published;
    for (const storage::Decision& decision :
         registry.decisions(equipment.spacecraft, equipment.equipment))
      if (decision.kind == storage::DecisionKind::approve ||
          decision.kind == storage::DecisionKind::roll_back)
        published.insert(decision.version);
    const Descriptors descriptors = archive.parameters(equipment.spacecraft);
    for (const std::int64_t number : published)
      if (const auto version = registry.version(equipment.spacecraft, equipment.equipment, number))
        add(ranges, descriptors, *version, version->window);
  }
  return ranges;
}

std::vector<ProtectedRange> telemetry_still_needed(const storage::Archive& archive,
                                                   const Config& config, storage::Time now) {
  std::vector<ProtectedRange> ranges;
  for (const SpacecraftConfig& spacecraft : config.spacecraft) {
    const auto extent = archive.extent(spacecraft.name, storage::Origin::real);
    if (!extent) continue;
    const storage::Time newest = std::min(extent->end, now);
    const Descriptors descriptors = archive.parameters(spacecraft.name);
    for (const EquipmentConfig& equipment : spacecraft.equipment) {
      add(ranges, spacecraft.name, descriptors, parameters_of(equipment),
          {before(newest, std::max(equipment.window, checked_before_block(equipment)) +
                              equipment.slide + equipment.sample_hold),
           std::numeric_limits<storage::Time>::max()});
    }
  }
  return ranges;
}

}  // namespace reident
