// What modelDescription.xml of FMI 2.0 and 3.0 have in common.
#pragma once

#include <string>

#include "service/model_export/fmu_variables.hpp"
#include "service/model_export/model_export.hpp"

namespace reident::model_export {

/// Returns a number as XML Schema writes a double; the same bits come back.
std::string xml_number(double value);

/// Returns what all of modelDescription.xml's units are; empty where there is none.
std::string unit_definitions(const FmuVariables& variables);

/// Returns ` unit="..."`; empty where the variable has none.
std::string unit_attribute(const FmuVariable& variable);

/// Returns <LogCategories> and <DefaultExperiment>.
std::string categories_and_experiment(const EquipmentModel& model);

/// Returns the attributes of the root that name the model, without that of its digest.
std::string root_attributes(const ExportedVersion& exported);

/// Returns an element that says which version of which equipment it is.
std::string version_element(const ModelVersion& version);

}  // namespace reident::model_export
