// The authorities of a site and what they gave to whom: a folder that its keeper has, and that no
// program of the domain reads. deploy/SECURITY.md has its files.
#pragma once

#include <cstdint>
#include <filesystem>
#include <stdexcept>
#include <string>
#include <vector>

namespace reident::security {

/// What cannot be done, and what would mend it.
class Error : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// How long certificates are valid, unless something else is asked for: nanoseconds.
inline constexpr std::int64_t usual_validity = std::int64_t{365} * 86'400'000'000'000;

/// One that was given a certificate.
struct Member {
  std::string role, name;
  std::vector<std::string> partitions;  // patterns; none where its folder is not there any more
  std::int64_t end = 0;                 // of its newest certificate; nanoseconds since 1970
  bool revoked = false;                 // the newest certificate is
};

/// Two programs must not change one site at a time. Calls throw Error.
class Site {
 public:
  /// Makes the two authorities, which are valid for ten years, with their keys. The folder must
  /// not be there, or be empty.
  static Site init(const std::filesystem::path& folder, const std::string& organisation,
                   std::int64_t now);
  /// Opens a folder of init().
  explicit Site(std::filesystem::path folder);

  /// Gives a name a role: makes the folder members/NAME. A name that has a certificate which is
  /// neither revoked nor ended is refused, as is one that had the role in other partitions: such
  /// permissions stay valid. Returns the folder.
  std::filesystem::path grant(const std::string& role, const std::string& name,
                              const std::vector<std::string>& partitions, std::int64_t validity,
                              std::int64_t now);
  /// Gives a member a new key and certificate, in its folder, with the role and the partitions that
  /// it has. The one before stays valid until its end. Returns the folder.
  std::filesystem::path renew(const std::string& name, std::int64_t validity, std::int64_t now);
  /// Revokes every certificate of a name that has not ended. Returns how many; the list of
  /// revocations is put into each member's folder.
  std::size_t revoke(const std::string& name, std::int64_t now);

  /// Everyone who was given a certificate, by name.
  std::vector<Member> members() const;
  /// When the first of the authorities ends.
  std::int64_t end() const;

  std::filesystem::path folder_of(const std::string& name) const;

 private:
  std::filesystem::path make(const Member& member, std::int64_t validity, std::int64_t now);

  std::filesystem::path folder_;
};

}  // namespace reident::security
