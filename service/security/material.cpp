#include "service/security/material.hpp"

#include <cerrno>
#include <cstdlib>
#include <fstream>
#include <iterator>
#include <system_error>

#include <fmt/format.h>
#include <sys/stat.h>

#include "service/security/documents.hpp"
#include "service/security/openssl.hpp"
#include "service/support/time_text.hpp"

namespace reident::security {
namespace {

constexpr std::int64_t day = 86'400'000'000'000;
constexpr std::uintmax_t max_bytes = 1u << 20;  // of a file
constexpr mode_t others = 077;

/// One call of read_material().
class MaterialReader {
 public:
  MaterialReader(const std::filesystem::path& folder, std::int64_t now) : now_(now) {
    material_.folder = folder;
  }
  std::variant<Material, std::vector<std::string>> operator()();

 private:
  std::string path(const char* name) const { return (material_.folder / name).string(); }
  void wrong(const char* name, const std::string& what) {
    mistakes_.push_back(fmt::format("{}: {}", path(name), what));
  }
  std::string remedy() const;
  std::string read(const char* name);
  void read_all();
  /// Checks the bounds of a file's validity, and remembers the first to end.
  void check_time(const char* name, const Validity& validity);
  void check_authorities();
  void check_certificate();
  void check_revocations();
  void check_permissions();

  const std::int64_t now_;
  Material material_;
  std::vector<std::string> mistakes_;
  Certificate certificate_, identity_authority_, permissions_authority_;
  Key key_;
  RevocationList revoked_;
};

/// The end of most sentences.
std::string MaterialReader::remedy() const {
  const std::string name = certificate_ ? subject_of(certificate_).name : "NAME";
  return fmt::format("'reident security renew SITE {}' makes the folder's files again",
                     name.empty() ? "NAME" : name);
}

std::string MaterialReader::read(const char* name) {
  errno = 0;
  std::ifstream file(material_.folder / name, std::ios::binary);
  std::error_code failed;
  if (!file || std::filesystem::file_size(material_.folder / name, failed) > max_bytes || failed) {
    const int code = errno != 0 ? errno : failed ? failed.value() : EFBIG;
    wrong(name, fmt::format("cannot be read ({}); 'reident security grant' makes a folder with "
                            "all files, which have to belong to the user of the program",
                            std::generic_category().message(code)));
    return {};
  }
  return {std::istreambuf_iterator<char>(file), {}};
}

void MaterialReader::read_all() {
  material_.certificate = read(file::certificate);
  material_.key = read(file::key);
  material_.permissions = read(file::permissions);
  material_.governance = read(file::governance);
  material_.identity_authority = read(file::identity_authority);
  material_.permissions_authority = read(file::permissions_authority);
  material_.revoked = read(file::revoked);
  if (!mistakes_.empty()) return;
  const auto parse = [this](auto& target, auto parsed, const char* name, const char* what) {
    target = std::move(parsed);
    if (!target) wrong(name, fmt::format("is no {} in PEM; {}", what, remedy()));
  };
  parse(certificate_, read_certificate(material_.certificate), file::certificate, "certificate");
  parse(key_, read_key(material_.key), file::key, "private key");
  parse(identity_authority_, read_certificate(material_.identity_authority),
        file::identity_authority, "certificate");
  parse(permissions_authority_, read_certificate(material_.permissions_authority),
        file::permissions_authority, "certificate");
  parse(revoked_, read_revocation_list(material_.revoked), file::revoked, "list of revocations");
}

void MaterialReader::check_time(const char* name, const Validity& validity) {
  if (validity.begin > now_)
    wrong(name, fmt::format("is not valid before {}, and it is {} now; correct the clock",
                            time_text(validity.begin), time_text(now_)));
  if (validity.end <= now_)
    wrong(name, fmt::format("ended at {}; {}", time_text(validity.end), remedy()));
  if (!material_.first_to_end.empty() && validity.end >= material_.end) return;
  material_.end = validity.end;
  material_.first_to_end = path(name);
}

void MaterialReader::check_authorities() {
  check_time(file::identity_authority, validity_of(identity_authority_));
  check_time(file::permissions_authority, validity_of(permissions_authority_));
  if (has_same_key(identity_authority_, permissions_authority_))
    wrong(file::permissions_authority,
          "is the identity authority too, so that each member could grant itself everything "
          "(CVE-2023-24011); make a site with two by 'reident security init'");
  if (!signed_text(material_.governance, permissions_authority_))
    wrong(file::governance, "is not signed by permissions_authority.pem; " + remedy());
}

void MaterialReader::check_certificate() {
  const Subject subject = subject_of(certificate_);
  material_.role = subject.unit;
  material_.name = subject.name;
  material_.subject = subject_text(certificate_);
  if (find_role(subject.unit) == nullptr)
    wrong(file::certificate, fmt::format("has the role '{}' in its subject's OU; roles are {}",
                                         subject.unit, role_names()));
  if (!is_signed_by(certificate_, identity_authority_))
    wrong(file::certificate,
          fmt::format("is not signed by {}, whose subject is {}; {}", file::identity_authority,
                      subject_text(identity_authority_), remedy()));
  check_time(file::certificate, validity_of(certificate_));
  struct stat status {};
  if (::stat(path(file::key).c_str(), &status) == 0 && (status.st_mode & others) != 0)
    wrong(file::key,
          fmt::format("can be used by others than its owner (mode {:04o}); chmod 600, and if "
                      "somebody may have read it, 'reident security revoke SITE {}'",
                      status.st_mode & 07777, subject.name));
  if (!is_pair(certificate_, key_))
    wrong(file::key, fmt::format("is not the key of {}; {}", file::certificate, remedy()));
}

void MaterialReader::check_revocations() {
  if (!is_signed_by(revoked_, identity_authority_)) {
    wrong(file::revoked,
          fmt::format("is not signed by {}; {}", file::identity_authority, remedy()));
    return;
  }
  check_time(file::revoked, validity_of(revoked_));
  if (is_revoked(certificate_, revoked_))
    wrong(file::certificate, fmt::format("is revoked; '{}' gives {} a new one",
                                         fmt::format("reident security grant SITE {} {}",
                                                     material_.role, material_.name),
                                         material_.name));
}

void MaterialReader::check_permissions() {
  const auto text = signed_text(material_.permissions, permissions_authority_);
  if (!text) {
    wrong(file::permissions, "is not signed by permissions_authority.pem; " + remedy());
    return;
  }
  const auto first = [&text](std::string_view name) {
    const std::vector<std::string> all = elements(*text, name);
    return all.empty() ? std::string() : all.front();
  };
  const auto begin = parse_time(first("not_before")), end = parse_time(first("not_after"));
  if (!begin || !end)
    wrong(file::permissions, "does not say until when it is valid; " + remedy());
  else
    check_time(file::permissions, {*begin, *end});
  if (const std::string subject = first("subject_name"); subject != material_.subject)
    wrong(file::permissions, fmt::format("is of {}, and the certificate is of {}; {}", subject,
                                         material_.subject, remedy()));
  material_.partitions = partitions_in(*text);
}

std::variant<Material, std::vector<std::string>> MaterialReader::operator()() {
  std::error_code failed;
  if (!std::filesystem::is_directory(material_.folder, failed)) {
    mistakes_.push_back(
        fmt::format("{}: there is no such folder; 'reident security grant SITE ROLE NAME' makes it",
                    material_.folder.string()));
    return mistakes_;
  }
  if (std::filesystem::is_directory(material_.folder / "members", failed)) {
    mistakes_.push_back(
        fmt::format("{0}: is the folder of a site's authorities; name a member's, "
                    "such as {0}/members/NAME",
                    material_.folder.string()));
    return mistakes_;
  }
  read_all();
  if (!mistakes_.empty()) return mistakes_;
  check_authorities();
  check_certificate();
  check_revocations();
  check_permissions();
  if (!mistakes_.empty()) return mistakes_;
  return std::move(material_);
}

}  // namespace

std::variant<Material, std::vector<std::string>> read_material(const std::filesystem::path& folder,
                                                               std::int64_t now) {
  return MaterialReader(folder, now)();
}

bool is_unchanged(const Material& material) {
  const auto holds = [&material](const char* name, const std::string& content) {
    std::ifstream file(material.folder / name, std::ios::binary);
    return file && std::string(std::istreambuf_iterator<char>(file), {}) == content;
  };
  return holds(file::certificate, material.certificate) && holds(file::key, material.key) &&
         holds(file::permissions, material.permissions) &&
         holds(file::governance, material.governance) &&
         holds(file::identity_authority, material.identity_authority) &&
         holds(file::permissions_authority, material.permissions_authority) &&
         holds(file::revoked, material.revoked);
}

std::filesystem::path folder_of_environment() {
  const char* folder = std::getenv("REIDENT_SECURITY");
  return folder == nullptr ? "" : folder;
}

std::string description(const Material& material) {
  return fmt::format("{} {}, until {}", material.role, material.name, time_text(material.end));
}

std::string end_warning(const Material& material, std::int64_t now) {
  const std::int64_t left = material.end - now;
  if (left > 30 * day) return {};
  const std::string when = left <= 0 ? "ended"
                                     : fmt::format("ends within {}", left > 7 * day ? "30 days"
                                                                     : left > day   ? "7 days"
                                                                                    : "a day");
  return fmt::format(
      "{} of {} {} {}, at {}.{} 'reident security renew SITE {}' makes a new one, "
      "which is taken up without a restart.",
      material.first_to_end, material.role, material.name, when, time_text(material.end),
      left <= 0 ? " Nothing is sent or heard since." : "", material.name);
}

}  // namespace reident::security
