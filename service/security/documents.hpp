// The two documents that the permissions authority signs: what protects the domain, and what a
// member may do there (OMG DDS Security 1.1, "Access control").
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "service/security/openssl.hpp"
#include "service/security/roles.hpp"

namespace reident::security {

/// What every member of a site requires of the others; one text for all domains.
std::string governance_text();

/// What the member of the subject may do: the topics of its role, in partitions that match one of
/// the patterns, within the validity.
std::string permissions_text(const Role& role, const std::string& subject,
                             const std::vector<std::string>& partitions, const Validity& validity);

/// The patterns of partitions that a text of permissions names, each once.
std::vector<std::string> partitions_in(std::string_view text);

/// The contents of each <name> element of a signed text, in order, without the blanks around them.
std::vector<std::string> elements(std::string_view text, std::string_view name);

}  // namespace reident::security
