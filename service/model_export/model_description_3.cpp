#include <fmt/format.h>

#include "service/model_export/description_parts.hpp"
#include "service/model_export/fmu_text.hpp"

namespace reident::model_export {
namespace {

std::string float_element(const FmuVariable& variable, std::size_t reference,
                          std::string_view causality, bool has_start) {
  return fmt::format(
      "    <Float64 name=\"{}\" valueReference=\"{}\" description=\"{}\" causality=\"{}\" "
      "variability=\"discrete\"{}{}/>\n",
      xml_text(variable.name), reference, xml_text(variable.description), causality,
      unit_attribute(variable),
      has_start ? fmt::format(" start=\"{}\"", xml_number(variable.start)) : "");
}

std::string model_variables_3(const FmuVariables& variables) {
  std::string text = "  <ModelVariables>\n";
  std::size_t reference = 0;
  for (const FmuVariable& input : variables.inputs)
    text += float_element(input, reference++, "input", true);
  for (const FmuVariable& output : variables.outputs)
    text += float_element(output, reference++, "output", false);
  for (const FmuVariable& state : variables.states)
    text += float_element(state, reference++, "local\" initial=\"exact", true);
  return text + fmt::format(
                    "    <Float64 name=\"{}\" valueReference=\"{}\" description=\"Simulation "
                    "time [s]\" causality=\"independent\" variability=\"continuous\"/>\n"
                    "  </ModelVariables>\n",
                    xml_text(variables.time), reference);
}

/// An element for each output, by value references. Initially an output follows from states too.
std::string dependencies_of_outputs(const FmuVariables& variables, std::string_view element,
                                    bool initially) {
  const std::size_t states = variables.inputs.size() + variables.outputs.size();
  std::string text;
  for (std::size_t q = 0; q < variables.outputs.size(); ++q) {
    std::vector<std::size_t> references = variables.direct[q];
    if (initially)
      for (const std::size_t state : variables.shown[q]) references.push_back(states + state);
    text += fmt::format("    <{} valueReference=\"{}\" dependencies=\"{}\"/>\n", element,
                        variables.inputs.size() + q, fmt::join(references, " "));
  }
  return text;
}

std::string co_simulation_3(const ModelVersion& version) {
  return fmt::format(
      "  <CoSimulation modelIdentifier=\"{}\" canHandleVariableCommunicationStepSize=\"true\"\n"
      "      fixedInternalStepSize=\"{}\" hasEventMode=\"true\" canGetAndSetFMUState=\"true\"\n"
      "      canSerializeFMUState=\"true\"/>\n",
      model_identifier(version), xml_number(version.model.dynamics.period_s));
}

}  // namespace

std::string model_description_3(const ExportedVersion& exported, const FmuVariables& variables) {
  const ModelVersion& version = exported.version;
  return fmt::format(
             "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n"
             "<fmiModelDescription fmiVersion=\"3.0\" instantiationToken=\"{}\" {}>\n",
             version.digest, root_attributes(exported)) +
         co_simulation_3(version) + unit_definitions(variables) +
         categories_and_experiment(version.model) + model_variables_3(variables) +
         "  <ModelStructure>\n" + dependencies_of_outputs(variables, "Output", false) +
         dependencies_of_outputs(variables, "InitialUnknown", true) +
         "  </ModelStructure>\n  <Annotations>\n    <Annotation type=\"org.reident\">\n      " +
         version_element(version) + "    </Annotation>\n  </Annotations>\n</fmiModelDescription>\n";
}

std::string build_description(const ModelVersion& version) {
  const std::string identifier = model_identifier(version);
  return fmt::format(
      "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n"
      "<fmiBuildDescription fmiVersion=\"3.0\">\n"
      "  <BuildConfiguration modelIdentifier=\"{0}\">\n"
      "    <SourceFileSet language=\"C11\" compilerOptions=\"-ffp-contract=off\">\n"
      "      <SourceFile name=\"{0}.c\"/>\n"
      "    </SourceFileSet>\n"
      "    <Library name=\"m\"/>\n"
      "  </BuildConfiguration>\n"
      "</fmiBuildDescription>\n",
      identifier);
}

}  // namespace reident::model_export
