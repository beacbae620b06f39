#include "service/windows/provenance.hpp"

#include <algorithm>
#include <bit>
#include <cstring>
#include <functional>
#include <stdexcept>
#include <utility>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "service/model/model_json.hpp"
#include "service/support/sha256.hpp"

namespace reident {
namespace {

using identification::Index;
using identification::RowRange;
using nlohmann::ordered_json;

static_assert(std::endian::native == std::endian::little, "digests are of little-endian bytes");

template <class T>
void append(std::string& bytes, T value) {
  char raw[sizeof value];
  std::memcpy(raw, &value, sizeof value);
  bytes.append(raw, sizeof value);
}

ordered_json to_json(const EquipmentConfig& equipment) {
  ordered_json json = {{"name", equipment.name},
                       {"inputs", equipment.inputs},
                       {"outputs", equipment.outputs},
                       {"sample_period_ns", equipment.sample_period},
                       {"hold_ns", equipment.sample_hold},
                       {"tune_share", equipment.tune_share},
                       {"validation_share", equipment.validation_share},
                       {"min_coverage", equipment.min_coverage},
                       {"min_order", equipment.min_order},
                       {"max_order", equipment.max_order}};
  if (equipment.phase.value_or(0) > 0) json["phase_ns"] = *equipment.phase;
  if (equipment.regime_inputs > 0) json["regime_inputs"] = equipment.regime_inputs;
  if (equipment.screening) json["screening"] = true;
  for (const Relation& relation : equipment.relations)
    json["relations"].push_back({{"name", relation.name},
                                 {"expression", relation.expression},
                                 {"tolerance", relation.tolerance}});
  json["horizon"] = equipment.horizon ? ordered_json(*equipment.horizon) : ordered_json(nullptr);
  for (const DerivedInput& derived : equipment.derived)
    json["derived"].push_back(
        {{"name", derived.name}, {"expression", derived.expression}, {"unit", derived.unit}});
  return json;
}

std::vector<Relation> relations_from(const ordered_json& equipment) {
  std::vector<Relation> relations;
  if (const auto found = equipment.find("relations"); found != equipment.end())
    for (const ordered_json& one : *found)
      relations.push_back({one.at("name").get<std::string>(),
                           one.at("expression").get<std::string>(),
                           one.at("tolerance").get<double>()});
  return relations;
}

EquipmentConfig equipment_from(const ordered_json& json) {
  EquipmentConfig equipment;
  json.at("name").get_to(equipment.name);
  json.at("inputs").get_to(equipment.inputs);
  json.at("outputs").get_to(equipment.outputs);
  json.at("sample_period_ns").get_to(equipment.sample_period);
  json.at("hold_ns").get_to(equipment.sample_hold);
  equipment.phase = json.value("phase_ns", Duration{0});
  json.at("tune_share").get_to(equipment.tune_share);
  json.at("validation_share").get_to(equipment.validation_share);
  json.at("min_coverage").get_to(equipment.min_coverage);
  json.at("min_order").get_to(equipment.min_order);
  json.at("max_order").get_to(equipment.max_order);
  if (const auto& horizon = json.at("horizon"); !horizon.is_null())
    equipment.horizon = horizon.get<int>();
  equipment.regime_inputs = json.value("regime_inputs", 0);
  equipment.screening = json.value("screening", false);  // older versions were not screened
  equipment.relations = relations_from(json);
  if (const auto derived = json.find("derived"); derived != json.end())
    for (const ordered_json& one : *derived)
      equipment.derived.push_back({one.at("name").get<std::string>(),
                                   one.at("expression").get<std::string>(),
                                   one.at("unit").get<std::string>()});
  return equipment;
}

ordered_json to_json(RowRange rows, storage::TimeRange range) {
  return {{"rows", {rows.begin, rows.end}}, {"begin_ns", range.begin}, {"end_ns", range.end}};
}

ordered_json provenance_of(const RefreshRequest& request, const PreparedWindow& prepared) {
  const Candidate& candidate = *prepared.candidate;
  ordered_json json = {
      {"spacecraft", request.spacecraft},
      {"window", {{"begin_ns", request.window.begin}, {"end_ns", request.window.end}}},
      {"parts",
       {{"identify", to_json(candidate.parts.identify, candidate.model.identified_from)},
        {"tune", to_json(candidate.parts.tune, candidate.tuned_on)},
        {"validate", to_json(candidate.parts.validate, candidate.model.validated_on)}}},
      {"equipment", to_json(request.equipment)},
      {"configuration_digest", request.configuration_digest},
      {"program_version", prepared.attempt.program_version}};
  if (candidate.adapted_from) json["adapted_from"] = *candidate.adapted_from;
  return json;
}

RefreshRequest request_from(const ordered_json& provenance) {
  RefreshRequest request;
  provenance.at("spacecraft").get_to(request.spacecraft);
  request.equipment = equipment_from(provenance.at("equipment"));
  provenance.at("window").at("begin_ns").get_to(request.window.begin);
  provenance.at("window").at("end_ns").get_to(request.window.end);
  return request;
}

std::string digest_of_window(const storage::Archive& archive, const RefreshRequest& request) {
  WindowCache kept = window_cache_of(request.spacecraft, request.equipment);
  const auto loaded = kept.load(archive, request.window);
  const auto* data = std::get_if<WindowData>(&loaded);
  return data ? digest_of_samples(data->record, kept.request()) : "";
}

/// Batches that changed telemetry of the window after it was sealed, the latest first.
std::vector<std::int64_t> revisions_of(const storage::Archive& archive,
                                       const RefreshRequest& request) {
  std::vector<std::int64_t> batches;
  const storage::TimeRange range{request.window.begin - request.equipment.sample_hold,
                                 request.window.end + request.equipment.phase.value_or(0)};
  for (const std::string& name : parameters_of(request.equipment))
    if (const auto parameter = archive.parameter(request.spacecraft, name)) {
      const auto of_one =
          archive.revisions(request.spacecraft, storage::Origin::real, parameter->id, range);
      batches.insert(batches.end(), of_one.begin(), of_one.end());
    }
  std::sort(batches.begin(), batches.end(), std::greater<>());
  batches.erase(std::unique(batches.begin(), batches.end()), batches.end());
  return batches;
}

/// The archive before as many of the revisions as give the samples their digest; all of it where
/// none does.
storage::Archive as_it_was(const storage::Archive& archive, const RefreshRequest& request,
                           const std::string& digest, std::size_t& taken_back) {
  taken_back = 0;
  if (digest_of_window(archive, request) == digest) return archive;
  for (const std::int64_t batch : revisions_of(archive, request)) {
    ++taken_back;
    if (storage::Archive earlier = archive.before(batch);
        digest_of_window(earlier, request) == digest)
      return earlier;
  }
  taken_back = 0;
  return archive;
}

/// Whether it has a gain for that; those that the gate turns away are given none.
bool follows_telemetry(const storage::Version& version) {
  try {
    return equipment_model_from_json(version.model_json).tracking.has_value();
  } catch (const std::invalid_argument&) {
    return false;  // damaged: it will not be the same
  }
}

/// The candidate that version `number` of the equipment gives when it is adapted to the window.
std::optional<Candidate> adapted_again(const storage::Registry& registry,
                                       const RefreshRequest& request, std::int64_t number,
                                       const PreparedWindow& prepared) {
  const auto base = registry.version(request.spacecraft, request.equipment.name, number);
  const auto with_reason = [number](const std::string& reason) {
    return std::invalid_argument(
        fmt::format("version {}, which it was adapted from, {}", number, reason));
  };
  if (!base) throw with_reason("is not in the registry");
  if (const auto mistake = mistake_in(*base)) throw with_reason("is damaged: " + *mistake);
  auto candidate =
      adapted_candidate(request, equipment_model_from_json(base->model_json), number, prepared);
  if (!candidate) throw with_reason("looks at other telemetry");
  return candidate;
}

}  // namespace

std::string digest_of_samples(const identification::Record& record, const WindowRequest& request) {
  std::string bytes;
  for (const auto* names : {&request.inputs, &request.outputs})
    for (const std::string& name : *names) bytes += name + '\n';
  for (const identification::Segment& segment : record.segments) {
    append(bytes, std::int64_t{segment.first_tick});
    append(bytes, static_cast<std::int64_t>(segment.size()));
    for (Index row = segment.begin; row < segment.end; ++row) {
      for (const double value : record.u.row(row)) append(bytes, value);
      for (const double value : record.y.row(row)) append(bytes, value);
    }
  }
  return sha256_hex(bytes);
}

storage::NewVersion version_of(const RefreshRequest& request, const PreparedWindow& prepared) {
  const EquipmentModel& model = prepared.candidate->model;
  return {.model_json = to_json(model).dump(),
          .digest = model_digest(model),
          .provenance_json = provenance_of(request, prepared).dump(),
          .samples_digest = digest_of_samples(prepared.data.record, prepared.loaded)};
}

std::vector<Relation> relations_of(const storage::Version& version) {
  try {
    return relations_from(ordered_json::parse(version.provenance_json).at("equipment"));
  } catch (const nlohmann::json::exception&) {
    return {};
  }
}

std::optional<std::string> mistake_in(const storage::Version& version) {
  try {
    const EquipmentModel model = equipment_model_from_json(version.model_json);
    if (model.spacecraft != version.spacecraft || model.equipment != version.equipment)
      return "its model is one of " + model.spacecraft + "/" + model.equipment;
    if (model_digest(model) != version.digest)
      return "its model is not the one that its digest was made of";
  } catch (const std::invalid_argument& error) {
    return std::string("its model cannot be read: ") + error.what();
  }
  if (version.provenance_json.empty()) return std::nullopt;  // from before schema 2
  try {
    const RefreshRequest request = request_from(ordered_json::parse(version.provenance_json));
    if (request.spacecraft == version.spacecraft && request.equipment.name == version.equipment &&
        request.window == version.window)
      return std::nullopt;
    return "its provenance is that of another equipment or window";
  } catch (const nlohmann::json::exception& error) {
    return std::string("its provenance cannot be read: ") + error.what();
  }
}

Reproduction reproduce(const storage::Archive& archive, const storage::Registry& registry,
                       const storage::Version& version, const identification::ForEach& for_each) {
  if (version.provenance_json.empty())
    throw std::invalid_argument("it is from before schema 2 and does not say where it comes from");
  Reproduction result;
  RefreshRequest request;
  std::optional<std::int64_t> adapted_from;
  try {
    const ordered_json provenance = ordered_json::parse(version.provenance_json);
    request = request_from(provenance);
    if (const auto found = provenance.find("adapted_from"); found != provenance.end())
      adapted_from = found->get<std::int64_t>();
    provenance.at("program_version").get_to(result.program_version);
  } catch (const nlohmann::json::exception& error) {
    throw std::invalid_argument(std::string("the version does not say where it comes from: ") +
                                error.what());
  }
  WindowCache kept = window_cache_of(request.spacecraft, request.equipment);
  const storage::Archive then =
      as_it_was(archive, request, version.samples_digest, result.revisions);
  PreparedWindow prepared = prepare_window(then, request, kept, for_each, [] { return false; });
  result.samples_digest = digest_of_samples(prepared.data.record, prepared.loaded);
  result.same_samples = result.samples_digest == version.samples_digest;
  if (prepared.candidate && adapted_from)
    prepared.candidate = adapted_again(registry, request, *adapted_from, prepared);
  if (!prepared.candidate) {
    result.reason = prepared.attempt.reason;
    return result;
  }
  if (follows_telemetry(version)) let_follow(prepared);
  const EquipmentModel& model = prepared.candidate->model;
  result.model_digest = model_digest(model);
  result.same_model =
      result.model_digest == version.digest && to_json(model).dump() == version.model_json;
  return result;
}

}  // namespace reident
