#include "service/security/documents.hpp"

#include <algorithm>
#include <utility>

#include <fmt/format.h>

#include "service/support/time_text.hpp"

namespace reident::security {
namespace {

constexpr const char* every_domain =
    "<domains><id_range><min>0</min><max>230</max></id_range></domains>";

std::string escaped(std::string_view text) {
  std::string result;
  for (const char c : text) {
    if (c == '&')
      result += "&amp;";
    else if (c == '<')
      result += "&lt;";
    else if (c == '>')
      result += "&gt;";
    else
      result += c;
  }
  return result;
}

std::string unescaped(std::string text) {
  for (const auto& [from, to] :
       {std::pair("&lt;", "<"), std::pair("&gt;", ">"), std::pair("&amp;", "&")})
    for (std::size_t at = 0; (at = text.find(from, at)) != std::string::npos; ++at)
      text.replace(at, std::string_view(from).size(), to);
  return text;
}

template <class Texts>
std::string list(std::string_view outer, std::string_view inner, const Texts& texts) {
  std::string result = fmt::format("<{}>", outer);
  for (const auto& text : texts) result += fmt::format("<{}>{}</{}>", inner, escaped(text), inner);
  return result + fmt::format("</{}>", outer);
}

std::string rule(std::string_view kind, const std::vector<std::string_view>& topics,
                 const std::vector<std::string>& partitions) {
  if (topics.empty()) return {};
  return fmt::format("        <{}>{}{}</{}>\n", kind, list("topics", "topic", topics),
                     list("partitions", "partition", partitions), kind);
}

}  // namespace

// Encryption of whole packets is the cheapest protection, since a packet holds many messages.
// Without origin authentication a member that shares a key with a service could forge the service's
// messages to others.
std::string governance_text() {
  return fmt::format(R"(<?xml version="1.0" encoding="UTF-8"?>
<dds xmlns:xsi="http://www.w3.org/2001/XMLSchema-instance"
     xsi:noNamespaceSchemaLocation="https://www.omg.org/spec/DDS-SECURITY/20170901/omg_shared_ca_governance.xsd">
  <domain_access_rules>
    <domain_rule>
      {}
      <allow_unauthenticated_participants>false</allow_unauthenticated_participants>
      <enable_join_access_control>true</enable_join_access_control>
      <discovery_protection_kind>ENCRYPT</discovery_protection_kind>
      <liveliness_protection_kind>ENCRYPT</liveliness_protection_kind>
      <rtps_protection_kind>ENCRYPT_WITH_ORIGIN_AUTHENTICATION</rtps_protection_kind>
      <topic_access_rules>
        <topic_rule>
          <topic_expression>*</topic_expression>
          <enable_discovery_protection>true</enable_discovery_protection>
          <enable_liveliness_protection>true</enable_liveliness_protection>
          <enable_read_access_control>true</enable_read_access_control>
          <enable_write_access_control>true</enable_write_access_control>
          <metadata_protection_kind>NONE</metadata_protection_kind>
          <data_protection_kind>NONE</data_protection_kind>
        </topic_rule>
      </topic_access_rules>
    </domain_rule>
  </domain_access_rules>
</dds>
)",
                     every_domain);
}

std::string permissions_text(const Role& role, const std::string& subject,
                             const std::vector<std::string>& partitions, const Validity& validity) {
  return fmt::format(
      R"(<?xml version="1.0" encoding="UTF-8"?>
<dds xmlns:xsi="http://www.w3.org/2001/XMLSchema-instance"
     xsi:noNamespaceSchemaLocation="https://www.omg.org/spec/DDS-SECURITY/20170901/omg_shared_ca_permissions.xsd">
  <permissions>
    <grant name="{}">
      <subject_name>{}</subject_name>
      <validity><not_before>{}</not_before><not_after>{}</not_after></validity>
      <allow_rule>
        {}
{}{}      </allow_rule>
      <default>DENY</default>
    </grant>
  </permissions>
</dds>
)",
      role.name, escaped(subject), time_text(validity.begin), time_text(validity.end), every_domain,
      rule("publish", role.publishes, partitions), rule("subscribe", role.subscribes, partitions));
}

std::vector<std::string> partitions_in(std::string_view text) {
  std::vector<std::string> partitions;
  for (std::string& one : elements(text, "partition"))
    if (std::find(partitions.begin(), partitions.end(), one) == partitions.end())
      partitions.push_back(std::move(one));
  return partitions;
}

std::vector<std::string> elements(std::string_view text, std::string_view name) {
  const std::string begin = fmt::format("<{}>", name), end = fmt::format("</{}>", name);
  std::vector<std::string> found;
  for (std::size_t at = 0; (at = text.find(begin, at)) != std::string_view::npos;) {
    at += begin.size();
    const std::size_t stop = text.find(end, at);
    if (stop == std::string_view::npos) break;
    constexpr std::string_view blanks = " \t\r\n";
    std::string_view content = text.substr(at, stop - at);
    const std::size_t first = content.find_first_not_of(blanks);
    if (first != std::string_view::npos)
      found.push_back(unescaped(
          std::string(content.substr(first, content.find_last_not_of(blanks) - first + 1))));
    at = stop;
  }
  return found;
}

}  // namespace reident::security
