#include <algorithm>
#include <cctype>
#include <set>

#include <fmt/format.h>

#include "service/model_export/fmu_text.hpp"
#include "service/model_export/units.hpp"
#include "service/support/time_text.hpp"
#include "service/support/version.hpp"

namespace reident::model_export {
namespace {

constexpr std::size_t longest_identifier = 100;

/// As XML Schema writes a double; the same bits come back.
std::string number(double value) {
  return fmt::format("{}", value);
}

std::string base_unit_element(const std::string& unit) {
  const auto base = base_unit(unit);
  if (!base) return "";
  std::string text = "<BaseUnit";
  for (const BaseUnit::Power& power : base->powers)
    text += fmt::format(" {}=\"{}\"", power.unit, power.exponent);
  if (base->factor != 1) text += fmt::format(" factor=\"{}\"", number(base->factor));
  if (base->offset != 0) text += fmt::format(" offset=\"{}\"", number(base->offset));
  return text + "/>";
}

std::string unit_definitions(const FmuVariables& variables) {
  std::set<std::string> units;
  for (const auto* list : {&variables.inputs, &variables.outputs})
    for (const FmuVariable& variable : *list)
      if (!variable.unit.empty()) units.insert(variable.unit);
  if (units.empty()) return "";
  std::string text = "  <UnitDefinitions>\n";
  for (const std::string& unit : units)
    text +=
        fmt::format("    <Unit name=\"{}\">{}</Unit>\n", xml_text(unit), base_unit_element(unit));
  return text + "  </UnitDefinitions>\n";
}

std::string variable_element(const FmuVariable& variable, std::size_t reference,
                             std::string_view role, const std::string& start) {
  const std::string unit =
      variable.unit.empty() ? "" : fmt::format(" unit=\"{}\"", xml_text(variable.unit));
  return fmt::format(
      "    <ScalarVariable name=\"{}\" valueReference=\"{}\" description=\"{}\" {}>\n"
      "      <Real{}{}/>\n"
      "    </ScalarVariable>\n",
      xml_text(variable.name), reference, xml_text(variable.description), role, unit, start);
}

std::string model_variables(const FmuVariables& variables) {
  std::string text = "  <ModelVariables>\n";
  std::size_t reference = 0;
  for (const FmuVariable& input : variables.inputs)
    text += variable_element(input, reference++, R"(causality="input" variability="continuous")",
                             fmt::format(" start=\"{}\"", number(input.start)));
  for (const FmuVariable& output : variables.outputs)
    text +=
        variable_element(output, reference++,
                         R"(causality="output" variability="discrete" initial="calculated")", "");
  return text + "  </ModelVariables>\n";
}

/// <Unknown> for each output; places in <ModelVariables> count from 1.
std::string unknowns(const FmuVariables& variables, std::string_view element) {
  std::string text = fmt::format("    <{}>\n", element);
  for (std::size_t q = 0; q < variables.outputs.size(); ++q) {
    std::string dependencies;
    for (const std::size_t input : variables.direct[q])
      dependencies += fmt::format("{}{}", dependencies.empty() ? "" : " ", input + 1);
    text += fmt::format("      <Unknown index=\"{}\" dependencies=\"{}\"/>\n",
                        variables.inputs.size() + q + 1, dependencies);
  }
  return text + fmt::format("    </{}>\n", element);
}

std::string head(const ExportedVersion& exported) {
  const ModelVersion& version = exported.version;
  const EquipmentModel& model = version.model;
  const std::string name = fmt::format("{}/{}", model.spacecraft, model.equipment);
  return fmt::format(
      "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n"
      "<fmiModelDescription fmiVersion=\"2.0\" modelName=\"{}\" guid=\"{}\"\n"
      "    description=\"Model of {} identified from telemetry, version {} ({}), digest {}\"\n"
      "    version=\"{}\" generationTool=\"reident {}\" variableNamingConvention=\"flat\"\n"
      "    numberOfEventIndicators=\"0\">\n",
      xml_text(name), version.digest, xml_text(name), version.number, xml_text(exported.status),
      version.digest, version.number, xml_text(program_version()));
}

std::string co_simulation(const std::string& identifier) {
  return fmt::format(
      "  <CoSimulation modelIdentifier=\"{}\" canHandleVariableCommunicationStepSize=\"true\"\n"
      "      canInterpolateInputs=\"false\" maxOutputDerivativeOrder=\"0\"\n"
      "      canRunAsynchronuously=\"false\" canBeInstantiatedOnlyOncePerProcess=\"false\"\n"
      "      canNotUseMemoryManagementFunctions=\"true\" canGetAndSetFMUstate=\"true\"\n"
      "      canSerializeFMUstate=\"true\" providesDirectionalDerivative=\"false\">\n"
      "    <SourceFiles>\n"
      "      <File name=\"{}.c\"/>\n"
      "    </SourceFiles>\n"
      "  </CoSimulation>\n",
      identifier, identifier);
}

std::string annotations(const ModelVersion& version) {
  const EquipmentModel& model = version.model;
  return fmt::format(
      "  <VendorAnnotations>\n"
      "    <Tool name=\"reident\">\n"
      "      <Version spacecraft=\"{}\" equipment=\"{}\" number=\"{}\" digest=\"{}\" "
      "decided=\"{}\" "
      "decidedBy=\"{}\" method=\"{}\"/>\n"
      "    </Tool>\n"
      "  </VendorAnnotations>\n",
      xml_text(model.spacecraft), xml_text(model.equipment), version.number, version.digest,
      time_text(version.decided), xml_text(version.decided_by), xml_text(model.method));
}

}  // namespace

std::string model_identifier(const ModelVersion& version) {
  std::string name = version.model.spacecraft + "_" + version.model.equipment;
  const auto stands = [](unsigned char c) { return c < 0x80 && std::isalnum(c) != 0; };
  std::replace_if(
      name.begin(), name.end(), [&](char c) { return !stands(static_cast<unsigned char>(c)); },
      '_');
  if (name.front() >= '0' && name.front() <= '9') name.insert(0, "model_");
  if (name.size() > longest_identifier) name.resize(longest_identifier);
  return fmt::format("{}_v{}", name, version.number);
}

std::string xml_text(std::string_view text) {
  std::string result;
  for (const char c : text) {
    switch (c) {
      case '&':
        result += "&amp;";
        break;
      case '<':
        result += "&lt;";
        break;
      case '>':
        result += "&gt;";
        break;
      case '"':
        result += "&quot;";
        break;
      default:
        result += static_cast<unsigned char>(c) < 0x20 ? ' ' : c;  // none stands in XML
    }
  }
  return result;
}

std::string model_description(const ExportedVersion& exported, const FmuVariables& variables) {
  const ModelVersion& version = exported.version;
  return head(exported) + co_simulation(model_identifier(version)) + unit_definitions(variables) +
         "  <LogCategories>\n"
         "    <Category name=\"logStatusWarning\" description=\"an input without a finite "
         "value\"/>\n"
         "    <Category name=\"logStatusDiscard\" description=\"a call that cannot be "
         "answered\"/>\n"
         "    <Category name=\"logStatusError\" description=\"a call that is refused\"/>\n"
         "  </LogCategories>\n" +
         fmt::format("  <DefaultExperiment startTime=\"0\" stepSize=\"{}\"/>\n",
                     number(version.model.dynamics.period_s)) +
         annotations(version) + model_variables(variables) + "  <ModelStructure>\n" +
         unknowns(variables, "Outputs") + unknowns(variables, "InitialUnknowns") +
         "  </ModelStructure>\n</fmiModelDescription>\n";
}

}  // namespace reident::model_export
