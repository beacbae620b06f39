#include <fmt/format.h>

#include "service/model_export/description_parts.hpp"
#include "service/model_export/fmu_text.hpp"

namespace reident::model_export {
namespace {

constexpr const char* input_role = R"(causality="input" variability="continuous")";
constexpr const char* output_role =
    R"(causality="output" variability="discrete" initial="calculated")";
constexpr const char* state_role = R"(causality="local" variability="discrete" initial="exact")";

std::string variable_element(const FmuVariable& variable, std::size_t reference,
                             std::string_view role, bool has_start) {
  return fmt::format(
      "    <ScalarVariable name=\"{}\" valueReference=\"{}\" description=\"{}\" {}>\n"
      "      <Real{}{}/>\n"
      "    </ScalarVariable>\n",
      xml_text(variable.name), reference, xml_text(variable.description), role,
      unit_attribute(variable),
      has_start ? fmt::format(" start=\"{}\"", xml_number(variable.start)) : "");
}

std::string model_variables_2(const FmuVariables& variables) {
  std::string text = "  <ModelVariables>\n";
  std::size_t reference = 0;
  for (const FmuVariable& input : variables.inputs)
    text += variable_element(input, reference++, input_role, true);
  for (const FmuVariable& output : variables.outputs)
    text += variable_element(output, reference++, output_role, false);
  for (const FmuVariable& state : variables.states)
    text += variable_element(state, reference++, state_role, true);
  return text + "  </ModelVariables>\n";
}

/// <Unknown> for each output; places in <ModelVariables> count from 1. Initially an output follows
/// from states too.
std::string unknowns(const FmuVariables& variables, std::string_view element, bool initially) {
  const std::size_t states = variables.inputs.size() + variables.outputs.size() + 1;
  std::string text = fmt::format("    <{}>\n", element);
  for (std::size_t q = 0; q < variables.outputs.size(); ++q) {
    std::vector<std::size_t> places;
    for (const std::size_t input : variables.direct[q]) places.push_back(input + 1);
    if (initially)
      for (const std::size_t state : variables.shown[q]) places.push_back(states + state);
    text += fmt::format("      <Unknown index=\"{}\" dependencies=\"{}\"/>\n",
                        variables.inputs.size() + q + 1, fmt::join(places, " "));
  }
  return text + fmt::format("    </{}>\n", element);
}

std::string co_simulation_2(const std::string& identifier) {
  return fmt::format(
      "  <CoSimulation modelIdentifier=\"{}\" canHandleVariableCommunicationStepSize=\"true\"\n"
      "      canInterpolateInputs=\"true\" maxOutputDerivativeOrder=\"0\"\n"
      "      canRunAsynchronuously=\"false\" canBeInstantiatedOnlyOncePerProcess=\"false\"\n"
      "      canNotUseMemoryManagementFunctions=\"true\" canGetAndSetFMUstate=\"true\"\n"
      "      canSerializeFMUstate=\"true\" providesDirectionalDerivative=\"false\">\n"
      "    <SourceFiles>\n"
      "      <File name=\"{}.c\"/>\n"
      "    </SourceFiles>\n"
      "  </CoSimulation>\n",
      identifier, identifier);
}

}  // namespace

std::string model_description_2(const ExportedVersion& exported, const FmuVariables& variables) {
  const ModelVersion& version = exported.version;
  return fmt::format(
             "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n"
             "<fmiModelDescription fmiVersion=\"2.0\" guid=\"{}\" {}\n"
             "    numberOfEventIndicators=\"0\">\n",
             version.digest, root_attributes(exported)) +
         co_simulation_2(model_identifier(version)) + unit_definitions(variables) +
         categories_and_experiment(version.model) +
         "  <VendorAnnotations>\n    <Tool name=\"reident\">\n      " + version_element(version) +
         "    </Tool>\n  </VendorAnnotations>\n" + model_variables_2(variables) +
         "  <ModelStructure>\n" + unknowns(variables, "Outputs", false) +
         unknowns(variables, "InitialUnknowns", true) +
         "  </ModelStructure>\n</fmiModelDescription>\n";
}

}  // namespace reident::model_export
