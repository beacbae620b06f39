#include "service/history/rows.hpp"

#include <stdexcept>

#include "service/history/row_values.hpp"

namespace reident::history {
namespace {

storage::EquipmentName read_name(const Json& row) {
  return {read_text(row.at("spacecraft")), read_text(row.at("equipment"))};
}

storage::DecisionKind read_kind(const Json& value) {
  const auto& text = value.get_ref<const std::string&>();
  if (const auto kind = storage::decision_kind(text)) return *kind;
  throw std::invalid_argument("'" + text + "' is no kind of decision");
}

}  // namespace

Json row_of(const EquipmentRow& row) {
  Json hold;
  if (row.hold)
    hold = {{"actor", text_value(row.hold->actor)},
            {"reason", text_value(row.hold->reason)},
            {"since_ns", row.hold->since}};
  return {{"spacecraft", text_value(row.name.spacecraft)},
          {"equipment", text_value(row.name.equipment)},
          {"hold", hold}};
}

void read_row(const Json& row, EquipmentRow& equipment) {
  equipment.name = read_name(row);
  if (const Json& hold = row.at("hold"); !hold.is_null())
    equipment.hold = {read_text(hold.at("actor")), read_text(hold.at("reason")),
                      hold.at("since_ns").get<storage::Time>()};
}

Json row_of(const storage::Attempt& attempt) {
  return {{"id", attempt.id},
          {"spacecraft", text_value(attempt.spacecraft)},
          {"equipment", text_value(attempt.equipment)},
          {"window_begin_ns", attempt.window.begin},
          {"window_end_ns", attempt.window.end},
          {"trigger", text_value(attempt.trigger)},
          {"time_ns", attempt.time},
          {"outcome", text_value(attempt.outcome)},
          {"reason", text_value(attempt.reason)},
          {"version", optional_value(attempt.version)},
          {"evidence", document_value(attempt.evidence_json)},
          {"configuration_digest", text_value(attempt.configuration_digest)},
          {"program_version", text_value(attempt.program_version)}};
}

void read_row(const Json& row, storage::Attempt& attempt) {
  attempt.id = row.at("id").get<std::int64_t>();
  attempt.spacecraft = read_text(row.at("spacecraft"));
  attempt.equipment = read_text(row.at("equipment"));
  attempt.window = {row.at("window_begin_ns").get<storage::Time>(),
                    row.at("window_end_ns").get<storage::Time>()};
  attempt.trigger = read_text(row.at("trigger"));
  attempt.time = row.at("time_ns").get<storage::Time>();
  attempt.outcome = read_text(row.at("outcome"));
  attempt.reason = read_text(row.at("reason"));
  attempt.version = read_optional<std::int64_t>(row.at("version"));
  attempt.evidence_json = read_document(row.at("evidence"));
  attempt.configuration_digest = read_text(row.at("configuration_digest"));
  attempt.program_version = read_text(row.at("program_version"));
}

Json row_of(const storage::Decision& decision) {
  return {{"id", decision.id},
          {"spacecraft", text_value(decision.spacecraft)},
          {"equipment", text_value(decision.equipment)},
          {"version", decision.version},
          {"kind", storage::name(decision.kind)},
          {"actor", text_value(decision.actor)},
          {"reason", text_value(decision.reason)},
          {"time_ns", decision.time},
          {"evidence", document_value(decision.evidence_json)}};
}

void read_row(const Json& row, storage::Decision& decision) {
  decision.id = row.at("id").get<std::int64_t>();
  decision.spacecraft = read_text(row.at("spacecraft"));
  decision.equipment = read_text(row.at("equipment"));
  decision.version = row.at("version").get<std::int64_t>();
  decision.kind = read_kind(row.at("kind"));
  decision.actor = read_text(row.at("actor"));
  decision.reason = read_text(row.at("reason"));
  decision.time = row.at("time_ns").get<storage::Time>();
  // Services of before schema 4 send none.
  if (row.contains("evidence")) decision.evidence_json = read_document(row["evidence"]);
}

Json row_of(const storage::Block& block) {
  return {{"begin_ns", block.range.begin},
          {"end_ns", block.range.end},
          {"rows", block.rows},
          {"believed", number_value(block.believed)},
          {"output_mean", numbers_value(block.output_mean)},
          {"output_square", numbers_value(block.output_square)},
          {"input_low", numbers_value(block.input_low)},
          {"input_high", numbers_value(block.input_high)},
          {"baseline_square", numbers_value(block.baseline_square)}};
}

void read_row(const Json& row, storage::Block& block) {
  block.range = {row.at("begin_ns").get<storage::Time>(), row.at("end_ns").get<storage::Time>()};
  block.rows = row.at("rows").get<std::int64_t>();
  block.believed = read_number(row.at("believed"));
  block.output_mean = read_numbers(row.at("output_mean"));
  block.output_square = read_numbers(row.at("output_square"));
  block.input_low = read_numbers(row.at("input_low"));
  block.input_high = read_numbers(row.at("input_high"));
  block.baseline_square = read_numbers(row.at("baseline_square"));
}

Json row_of(const storage::BlockScore& score) {
  return {{"version", score.version},
          {"begin_ns", score.begin},
          {"rows", score.rows},
          {"error_mean", numbers_value(score.mean)},
          {"error_square", numbers_value(score.square)},
          {"noise_square", numbers_value(score.noise)},
          {"bias_effects", numbers_value(score.bias_effects)}};
}

void read_row(const Json& row, storage::BlockScore& score) {
  score.version = row.at("version").get<std::int64_t>();
  score.begin = row.at("begin_ns").get<storage::Time>();
  score.rows = row.at("rows").get<std::int64_t>();
  score.mean = read_numbers(row.at("error_mean"));
  score.square = read_numbers(row.at("error_square"));
  score.noise = read_numbers(row.at("noise_square"));
  if (const auto effects = row.find("bias_effects"); effects != row.end())
    score.bias_effects = read_numbers(*effects);
}

Json row_of(const ChampionRow& row) {
  return {{"spacecraft", text_value(row.name.spacecraft)},
          {"equipment", text_value(row.name.equipment)},
          {"decision", row.decision ? row_of(*row.decision) : Json()}};
}

void read_row(const Json& row, ChampionRow& champion) {
  champion.name = read_name(row);
  if (const Json& decision = row.at("decision"); !decision.is_null())
    read_row(decision, champion.decision.emplace());
}

Json summary_row_of(const storage::Version& version) {
  return {{"spacecraft", text_value(version.spacecraft)},
          {"equipment", text_value(version.equipment)},
          {"version", version.number},
          {"status", text_value(version.status)},
          {"parent", optional_value(version.parent)},
          {"attempt", version.attempt},
          {"window_begin_ns", version.window.begin},
          {"window_end_ns", version.window.end},
          {"created_ns", version.created},
          {"digest", text_value(version.digest)},
          {"samples_digest", text_value(version.samples_digest)}};
}

Json row_of(const storage::Version& version) {
  Json row = summary_row_of(version);
  row["provenance"] = document_value(version.provenance_json);
  row["model"] = document_value(version.model_json);
  return row;
}

void read_row(const Json& row, storage::Version& version) {
  version.spacecraft = read_text(row.at("spacecraft"));
  version.equipment = read_text(row.at("equipment"));
  version.number = row.at("version").get<std::int64_t>();
  version.status = read_text(row.at("status"));
  version.parent = read_optional<std::int64_t>(row.at("parent"));
  version.attempt = row.at("attempt").get<std::int64_t>();
  version.window = {row.at("window_begin_ns").get<storage::Time>(),
                    row.at("window_end_ns").get<storage::Time>()};
  version.created = row.at("created_ns").get<storage::Time>();
  version.digest = read_text(row.at("digest"));
  version.samples_digest = read_text(row.at("samples_digest"));
  if (row.contains("provenance")) version.provenance_json = read_document(row["provenance"]);
  if (row.contains("model")) version.model_json = read_document(row["model"]);
}

}  // namespace reident::history
