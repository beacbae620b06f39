// The texts of an FMU; README.md says what is in them.
#pragma once

#include <string>
#include <string_view>

#include "service/model_export/fmu_variables.hpp"
#include "service/model_export/model_export.hpp"

namespace reident::model_export {

/// A C identifier of spacecraft, equipment and version, such as CBERS_4_BDR_v3.
std::string model_identifier(const ModelVersion& version);

/// The text as it stands within XML and HTML, in attributes too.
std::string xml_text(std::string_view text);

/// modelDescription.xml. The guid is the model's digest.
std::string model_description(const ExportedVersion& exported, const FmuVariables& variables);

/// resources/model.txt (fmu/model_file.h).
std::string fmu_resources(const ModelVersion& version, const FmuVariables& variables);

/// documentation/index.html.
std::string fmu_documentation(const ExportedVersion& exported, const FmuVariables& variables);

}  // namespace reident::model_export
