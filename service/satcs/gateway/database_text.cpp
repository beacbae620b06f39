#include "service/satcs/gateway/database_text.hpp"

#include <algorithm>

#include <fmt/format.h>

#include "service/support/text.hpp"

namespace reident::satcs {
namespace {

using namespace xtce;

std::string coding_text(const Encoding& encoding) {
  const auto name = [&]() -> const char* {
    switch (encoding.coding) {
      case Coding::unsigned_integer:
        return "unsigned";
      case Coding::twos_complement:
        return "twosComplement";
      case Coding::ones_complement:
        return "onesComplement";
      case Coding::sign_magnitude:
        return "signMagnitude";
      case Coding::ieee754:
        return "IEEE754";
      case Coding::mil_std_1750a:
        return "MILSTD_1750A";
      case Coding::text:
        return "text";
      case Coding::binary:
        return "binary";
    }
    return "";
  };
  std::string text = fmt::format("{} {}", name(), encoding.size.bits);
  if (encoding.low_byte_first) text += " low byte first";
  if (encoding.low_bit_first) text += " low bit first";
  if (!encoding.calibrator.coefficients.empty()) text += ", polynomial";
  if (!encoding.calibrator.points.empty()) text += ", spline";
  if (!encoding.context_calibrators.empty()) text += ", by context";
  return text;
}

std::string limits_text(const storage::ParameterDescriptor& descriptor) {
  if (!descriptor.low_limit && !descriptor.high_limit) return "-";
  const auto end = [](const std::optional<double>& limit) {
    return limit ? fmt::format("{:g}", *limit) : std::string();
  };
  return end(descriptor.low_limit) + ".." + end(descriptor.high_limit);
}

std::string why_not(const ParameterType& type) {
  if (!type.encoding) return "no known encoding";
  if (type.kind == Kind::text || type.kind == Kind::binary) return "no number";
  return type.is_usable
             ? "not asked for, of the primary header, identifies packets, or in no packet"
             : "its values cannot be computed";
}

}  // namespace

std::vector<std::string> note_lines(const Database& database, const std::string& file) {
  std::vector<std::string> lines;
  for (const Note& note : database.notes)
    lines.push_back(fmt::format("{}: line {}: {}: {}", file, note.line, note.path, note.what));
  return lines;
}

std::string summary_line(const Database& database,
                         const std::vector<GatewayParameter>& parameters) {
  std::vector<std::string> roots;
  for (const Index root : database.roots) roots.push_back(database.containers[root].name);
  return fmt::format(
      "{}: {} containers, {} parameters, of which {} are published; packets begin "
      "with {}",
      database.name, database.containers.size(), database.parameters.size(), parameters.size(),
      joined(roots));
}

std::vector<std::string> parameter_lines(const Database& database,
                                         const std::vector<GatewayParameter>& parameters) {
  std::size_t width = 9;
  for (const GatewayParameter& one : parameters)
    width = std::max(width, one.descriptor.name.size());
  std::vector<std::string> lines{fmt::format("{:<{}}  {:<8} {:<14} {:<30} {}", "parameter", width,
                                             "unit", "limits", "encoding", "description")};
  std::vector<bool> is_published(database.parameters.size());
  for (const GatewayParameter& one : parameters) {
    is_published[one.index] = true;
    const storage::ParameterDescriptor& descriptor = one.descriptor;
    const Parameter& parameter = database.parameters[one.index];
    lines.push_back(
        fmt::format("{:<{}}  {:<8} {:<14} {:<30} {}", descriptor.name, width,
                    descriptor.unit.empty() ? "-" : descriptor.unit, limits_text(descriptor),
                    coding_text(*database.types[parameter.type].encoding), descriptor.description));
  }
  for (Index i = 0; i < database.parameters.size(); ++i)
    if (const Parameter& one = database.parameters[i]; !is_published[i] && one.members.empty())
      lines.push_back(fmt::format("{:<{}}  not published: {}", one.name, width,
                                  why_not(database.types[one.type])));
  return lines;
}

}  // namespace reident::satcs
