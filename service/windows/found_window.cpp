#include "service/windows/found_window.hpp"

#include "service/model/model_json.hpp"
#include "service/windows/provenance.hpp"

namespace reident {
namespace {

std::string digest_of(const PreparedWindow& prepared) {
  const identification::Record& record = prepared.data.record;
  return record.rows() == 0 ? "" : digest_of_samples(record, prepared.loaded);
}

}  // namespace

FoundWindow found_window(const PreparedWindow& prepared) {
  FoundWindow found{.samples_digest = digest_of(prepared),
                    .outcome = prepared.attempt.outcome,
                    .reason = prepared.attempt.reason,
                    .evidence = prepared.evidence,
                    .search = prepared.search,
                    .model = {}};
  if (prepared.candidate) found.model = prepared.candidate->model;
  return found;
}

nlohmann::ordered_json to_json(const FoundWindow& found) {
  return {{"samples_digest", found.samples_digest},
          {"outcome", found.outcome},
          {"reason", found.reason},
          {"evidence", found.evidence},
          {"search", found.search},
          {"model", found.model ? to_json(*found.model) : nlohmann::ordered_json()}};
}

FoundWindow found_window_from_json(const nlohmann::ordered_json& json) {
  FoundWindow found{.samples_digest = json.at("samples_digest").get<std::string>(),
                    .outcome = json.at("outcome").get<std::string>(),
                    .reason = json.at("reason").get<std::string>(),
                    .evidence = json.at("evidence"),
                    .search = json.at("search"),
                    .model = {}};
  if (const auto& model = json.at("model"); !model.is_null())
    found.model = equipment_model_from_json(model.dump());
  return found;
}

std::optional<PreparedWindow> restored_window(const storage::Archive& archive,
                                              const RefreshRequest& request, WindowCache& kept,
                                              const FoundWindow& found) {
  PreparedWindow prepared = loaded_window(archive, request, kept);
  if (digest_of(prepared) != found.samples_digest) return std::nullopt;
  prepared.evidence = found.evidence;
  prepared.search = found.search;
  prepared.attempt.outcome = found.outcome;
  prepared.attempt.reason = found.reason;
  if (found.model)
    prepared.candidate =
        candidate_of(request, prepared.data, found.model->dynamics, found.model->method);
  prepared.timer.end();
  return prepared;
}

}  // namespace reident
