#include "service/model/model_json.hpp"
#include "service/model_export/model_export.hpp"
#include "service/support/time_text.hpp"

namespace reident::model_export {

std::string json_file(const ExportedVersion& exported) {
  using Json = nlohmann::ordered_json;
  const ModelVersion& version = exported.version;
  const Json object = {{"format", "reident model version 1"},
                       {"spacecraft", version.model.spacecraft},
                       {"equipment", version.model.equipment},
                       {"version", version.number},
                       {"digest", version.digest},
                       {"status", exported.status},
                       {"decided", time_text(version.decided)},
                       {"decided_by", version.decided_by},
                       {"program_version", version.program_version},
                       {"model", to_json(version.model)}};
  return object.dump(2, ' ', false, Json::error_handler_t::replace) + "\n";
}

}  // namespace reident::model_export
