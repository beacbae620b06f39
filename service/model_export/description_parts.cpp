#include "service/model_export/description_parts.hpp"

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

std::string base_unit_element(const std::string& unit) {
  const auto base = base_unit(unit);
  if (!base) return "";
  std::string text = "<BaseUnit";
  for (const BaseUnit::Power& power : base->powers)
    text += fmt::format(" {}=\"{}\"", power.unit, power.exponent);
  if (base->factor != 1) text += fmt::format(" factor=\"{}\"", xml_number(base->factor));
  if (base->offset != 0) text += fmt::format(" offset=\"{}\"", xml_number(base->offset));
  return text + "/>";
}

}  // namespace

std::string xml_number(double value) {
  return fmt::format("{}", value);
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

std::string unit_attribute(const FmuVariable& variable) {
  return variable.unit.empty() ? "" : fmt::format(" unit=\"{}\"", xml_text(variable.unit));
}

std::string categories_and_experiment(const EquipmentModel& model) {
  return "  <LogCategories>\n"
         "    <Category name=\"logStatusWarning\" description=\"an input without a finite "
         "value\"/>\n"
         "    <Category name=\"logStatusDiscard\" description=\"a call that cannot be "
         "answered\"/>\n"
         "    <Category name=\"logStatusError\" description=\"a call that is refused\"/>\n"
         "  </LogCategories>\n" +
         fmt::format("  <DefaultExperiment startTime=\"0\" stepSize=\"{}\"/>\n",
                     xml_number(model.dynamics.period_s));
}

std::string root_attributes(const ExportedVersion& exported) {
  const ModelVersion& version = exported.version;
  const std::string name =
      xml_text(fmt::format("{}/{}", version.model.spacecraft, version.model.equipment));
  return fmt::format(
      "modelName=\"{0}\"\n"
      "    description=\"Model of {0} identified from telemetry, version {1} ({2}), digest {3}\"\n"
      "    version=\"{1}\" generationTool=\"reident {4}\" variableNamingConvention=\"flat\"",
      name, version.number, xml_text(exported.status), version.digest, xml_text(program_version()));
}

std::string version_element(const ModelVersion& version) {
  const EquipmentModel& model = version.model;
  return fmt::format(
      "<Version spacecraft=\"{}\" equipment=\"{}\" number=\"{}\" digest=\"{}\" decided=\"{}\" "
      "decidedBy=\"{}\" method=\"{}\"/>\n",
      xml_text(model.spacecraft), xml_text(model.equipment), version.number, version.digest,
      time_text(version.decided), xml_text(version.decided_by), xml_text(model.method));
}

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

}  // namespace reident::model_export
