#include "service/model/model_json.hpp"
#include "service/model_export/model_export.hpp"
#include "service/model_export/version_head.hpp"

namespace reident::model_export {

std::string json_file(const ExportedVersion& exported) {
  using Json = nlohmann::ordered_json;
  Json object = Json::object();
  object["format"] = "reident model version 1";
  visit_head(exported, [&object](const char* name, const auto& value) { object[name] = value; });
  object["program_version"] = exported.version.program_version;
  if (exported.start) {
    object["start"] = {
        {"time", time_text(exported.start->time)},
        {"state", std::vector<double>(exported.start->x.begin(), exported.start->x.end())}};
  }
  object["model"] = to_json(exported.version.model);
  return object.dump(2, ' ', false, Json::error_handler_t::replace) + "\n";
}

}  // namespace reident::model_export
