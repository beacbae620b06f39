// The texts of an FMU; README.md says what is in them. Each function is pure: equal arguments give
// equal bytes, in every locale. Requires a version without obstacle().
#pragma once

#include <string>
#include <string_view>

#include "service/model_export/fmu_variables.hpp"
#include "service/model_export/model_export.hpp"

namespace reident::model_export {

/// Returns a C identifier of spacecraft, equipment and version, such as CBERS_4_BDR_v3. Other
/// characters than ASCII letters and digits become _, and a long name is cut before the version.
std::string model_identifier(const ModelVersion& version);

/// Returns the text as it stands within XML and HTML, in attributes too. Control characters become
/// blanks.
std::string xml_text(std::string_view text);

/// Returns modelDescription.xml of FMI 2.0 and of FMI 3.0. The guid, or instantiation token, is the
/// model's digest.
std::string model_description_2(const ExportedVersion& exported, const FmuVariables& variables);
std::string model_description_3(const ExportedVersion& exported, const FmuVariables& variables);

/// Returns sources/buildDescription.xml of FMI 3.0.
std::string build_description(const ModelVersion& version);

/// Returns resources/model.txt (fmu/model_file.h), with its checksum.
std::string fmu_resources(const ModelVersion& version, const FmuVariables& variables);

/// Returns documentation/index.html: what the model is, its variables, what a step does.
std::string fmu_documentation(const ExportedVersion& exported, const FmuVariables& variables);

}  // namespace reident::model_export
