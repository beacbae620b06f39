// What one member of a secured domain holds: certificate, key, permissions, and the site's public
// documents, in one folder that `reident security grant` makes.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <variant>
#include <vector>

namespace reident::security {

/// Names of the files of a member's folder.
namespace file {
inline constexpr const char* certificate = "certificate.pem";
inline constexpr const char* key = "key.pem";
inline constexpr const char* permissions = "permissions.p7s";
inline constexpr const char* governance = "governance.p7s";
inline constexpr const char* identity_authority = "identity_authority.pem";
inline constexpr const char* permissions_authority = "permissions_authority.pem";
inline constexpr const char* revoked = "revoked.pem";
}  // namespace file

/// The contents of the files, all of which passed every check.
struct Material {
  std::filesystem::path folder;
  std::string role;                     // service, gateway, simulator, operator or page
  std::string name;                     // of the member: an operator's own
  std::string subject;                  // of the certificate, RFC 2253
  std::vector<std::string> partitions;  // patterns that the permissions name
  std::int64_t end = 0;                 // nanoseconds since 1970: the first of the files to end
  std::string first_to_end;             // its path

  std::string certificate, key, permissions, governance;
  std::string identity_authority, permissions_authority, revoked;
};

/// Reads and checks a folder. Returns what is wrong where something is: sentences that name the
/// file, the time and the remedy. Checked are that each file is there and readable, that the key is
/// its owner's alone and fits the certificate, who signed what, what has ended, has not begun or is
/// revoked, that the permissions are those of the certificate, and that the two authorities
/// differ (with one for both, CVE-2023-24011 lets a member grant itself everything).
std::variant<Material, std::vector<std::string>> read_material(const std::filesystem::path& folder,
                                                               std::int64_t now);

/// Whether the folder still holds what was read.
bool is_unchanged(const Material& material);

/// What the environment variable REIDENT_SECURITY names; empty where it is not set.
std::filesystem::path folder_of_environment();

/// "service reident-1, until 2027-11-26T12:00:00Z".
std::string description(const Material& material);

/// What somebody has to see to about the end of a material: from 30 days before it, from 7, from 1,
/// and after it; empty before. The text changes at these times alone.
std::string end_warning(const Material& material, std::int64_t now);

}  // namespace reident::security
