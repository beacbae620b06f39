#include "service/security/site.hpp"

#include <algorithm>
#include <cerrno>
#include <fcntl.h>
#include <fstream>
#include <iterator>
#include <map>
#include <system_error>
#include <unistd.h>
#include <utility>

#include <fmt/format.h>
#include <sys/stat.h>

#include "service/security/documents.hpp"
#include "service/security/material.hpp"
#include "service/security/openssl.hpp"
#include "service/support/text.hpp"
#include "service/support/time_text.hpp"

namespace reident::security {
namespace {

namespace fs = std::filesystem;

constexpr std::int64_t authority_validity = 10 * usual_validity;
constexpr std::int64_t clock_difference = 3'600'000'000'000;  // between machines of a site
constexpr std::size_t longest_name = 64;                      // of X.509
constexpr mode_t readable = 0644, secret = 0600, secret_folder = 0700;
constexpr const char* identity_key = "identity_authority_key.pem";
constexpr const char* permissions_key = "permissions_authority_key.pem";
constexpr const char* members_folder = "members";
constexpr const char* issued_folder = "issued";

[[noreturn]] void fail(const fs::path& path, const std::string& what) {
  throw Error(fmt::format("{}: {}", path.string(), what));
}

[[noreturn]] void fail_with(const fs::path& path, int code) {
  fail(path, std::generic_category().message(code) + "; check the folder and its permissions");
}

/// The file is there whole or not at all, and never has more permissions than `mode`.
void write_file(const fs::path& path, const std::string& text, mode_t mode) {
  const fs::path part = path.string() + ".part";
  ::unlink(part.c_str());
  const int descriptor = ::open(part.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, mode);
  if (descriptor < 0) fail_with(part, errno);
  const bool written =
      ::write(descriptor, text.data(), text.size()) == static_cast<ssize_t>(text.size()) &&
      ::fsync(descriptor) == 0;
  const int code = errno;
  ::close(descriptor);
  if (!written || ::rename(part.c_str(), path.c_str()) != 0) {
    ::unlink(part.c_str());
    fail_with(path, written ? errno : code);
  }
}

std::string read_file(const fs::path& path) {
  std::ifstream file(path, std::ios::binary);
  if (!file) fail(path, "cannot be read; 'reident security init' makes a site's folder");
  return {std::istreambuf_iterator<char>(file), {}};
}

template <class T>
T parsed(const fs::path& path, T (*parse)(const std::string&)) {
  T result = parse(read_file(path));
  if (!result) fail(path, "is damaged; take it from a copy of the site's folder");
  return result;
}

void make_folder(const fs::path& path) {
  if (::mkdir(path.c_str(), secret_folder) != 0 && errno != EEXIST) fail_with(path, errno);
}

void check_name(const std::string& name) {
  const auto is_allowed = [](char c) {
    return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') ||
           std::string_view("._@-").find(c) != std::string_view::npos;
  };
  if (name.empty() || name.size() > longest_name || name.front() == '.' || name.front() == '-' ||
      !std::all_of(name.begin(), name.end(), is_allowed))
    throw Error(fmt::format(
        "'{}' cannot be the name of a member; use 1 to {} letters, digits and . _ @ -, and begin "
        "with a letter or a digit",
        name, longest_name));
}

Validity validity_from(std::int64_t now, std::int64_t length) {
  constexpr std::int64_t second = 1'000'000'000;
  return {(now - clock_difference) / second * second, (now + length) / second * second};
}

struct Authority {
  Certificate certificate;
  Key key;
};

Authority identity_of(const fs::path& site) {
  return {parsed(site / file::identity_authority, read_certificate),
          parsed(site / identity_key, read_key)};
}

Authority permissions_of(const fs::path& site) {
  return {parsed(site / file::permissions_authority, read_certificate),
          parsed(site / permissions_key, read_key)};
}

Authority make_authority(const fs::path& site, const Subject& subject, Purpose purpose,
                         std::int64_t now, const char* certificate, const char* key) {
  Authority made;
  made.key = make_key();
  made.certificate =
      issue(subject, purpose, validity_from(now, authority_validity), made.key, {}, {});
  write_file(site / key, pem(made.key), secret);
  write_file(site / certificate, pem(made.certificate), readable);
  return made;
}

std::vector<Certificate> issued_to(const fs::path& site, const std::string& name) {
  std::vector<Certificate> found;
  for (const auto& one : fs::directory_iterator(site / issued_folder)) {
    Certificate certificate = parsed(one.path(), read_certificate);
    if (name.empty() || subject_of(certificate).name == name)
      found.push_back(std::move(certificate));
  }
  return found;
}

}  // namespace

Site Site::init(const fs::path& folder, const std::string& organisation, std::int64_t now) {
  std::error_code failed;
  if (fs::exists(folder, failed) && !fs::is_empty(folder, failed))
    fail(folder, "is not empty; a site's authorities are made once, in a folder of their own");
  if (organisation.empty() || organisation.size() > longest_name ||
      organisation.find_first_of(",+\"\\<>;#=/") != std::string::npos)
    throw Error(fmt::format(
        "'{}' cannot be the site's name; use 1 to {} letters, digits, blanks, dots and hyphens",
        organisation, longest_name));
  fs::create_directories(folder.parent_path(), failed);
  make_folder(folder);
  make_folder(folder / members_folder);
  make_folder(folder / issued_folder);
  const Authority identity =
      make_authority(folder, {organisation, "", "reident identity authority"},
                     Purpose::identity_authority, now, file::identity_authority, identity_key);
  const Authority permissions = make_authority(
      folder, {organisation, "", "reident permissions authority"}, Purpose::permissions_authority,
      now, file::permissions_authority, permissions_key);
  write_file(folder / file::revoked,
             pem(security::revoke({}, {}, validity_from(now, authority_validity),
                                  identity.certificate, identity.key)),
             readable);
  write_file(folder / file::governance,
             sign_document(governance_text(), permissions.certificate, permissions.key), readable);
  return Site(folder);
}

Site::Site(fs::path folder) : folder_(std::move(folder)) {
  std::error_code none;
  if (fs::exists(folder_ / file::certificate, none) && !fs::exists(folder_ / issued_folder, none))
    throw Error(fmt::format(
        "{} is the folder of a member; name the site's, which 'reident security init' made",
        folder_.string()));
  for (const char* name : {file::identity_authority, file::permissions_authority})
    static_cast<void>(parsed(folder_ / name, read_certificate));
}

fs::path Site::folder_of(const std::string& name) const {
  return folder_ / members_folder / name;
}

fs::path Site::make(const Member& member, std::int64_t validity, std::int64_t now) {
  const Role* role = find_role(member.role);
  if (role == nullptr)
    throw Error(fmt::format("there is no role {}; roles are {}", member.role, role_names()));
  if (validity <= 0) throw Error("a certificate is valid for a time above 0, such as 365d");
  const Authority identity = identity_of(folder_), permissions = permissions_of(folder_);
  Validity valid = validity_from(now, validity);
  valid.end = std::min(valid.end, end());
  const Key key = make_key();
  const Certificate certificate =
      issue({subject_of(identity.certificate).organisation, member.role, member.name},
            Purpose::member, valid, key, identity.certificate, identity.key);
  const fs::path folder = folder_of(member.name);
  make_folder(folder);
  write_file(folder_ / issued_folder / fmt::format("{}.pem", serial_of(certificate)),
             pem(certificate), readable);
  // The middleware goes by the permissions that a process had first, whatever it reads later: they
  // last as long as the authorities, and the certificate alone ends.
  const std::string document =
      permissions_text(*role, subject_text(certificate), member.partitions, {valid.begin, end()});
  write_file(folder / file::key, pem(key), secret);
  write_file(folder / file::certificate, pem(certificate), readable);
  write_file(folder / file::permissions,
             sign_document(document, permissions.certificate, permissions.key), readable);
  for (const char* name :
       {file::governance, file::identity_authority, file::permissions_authority, file::revoked})
    write_file(folder / name, read_file(folder_ / name), readable);
  return folder;
}

fs::path Site::grant(const std::string& role, const std::string& name,
                     const std::vector<std::string>& partitions, std::int64_t validity,
                     std::int64_t now) {
  check_name(name);
  for (const Member& member : members())
    if (member.name != name) {
      continue;
    } else if (!member.revoked && member.end > now) {
      throw Error(fmt::format("{} is {} already, until {}; renew it, or revoke it first", name,
                              member.role, time_text(member.end)));
    } else if (member.role == role && member.partitions != partitions) {
      throw Error(
          fmt::format("{} was {} in the partitions {}, and those permissions stay valid for "
                      "that name and role; use another name",
                      name, role, joined(member.partitions)));
    }
  return make({role, name, partitions}, validity, now);
}

fs::path Site::renew(const std::string& name, std::int64_t validity, std::int64_t now) {
  const std::vector<Member> all = members();
  const auto found = std::find_if(all.begin(), all.end(),
                                  [&name](const Member& member) { return member.name == name; });
  if (found == all.end())
    throw Error(fmt::format("there is no member {}; 'reident security show {}' lists them", name,
                            folder_.string()));
  if (found->revoked)
    throw Error(
        fmt::format("{} is revoked; 'reident security grant {} {} {}' makes it a member "
                    "again",
                    name, folder_.string(), found->role, name));
  if (found->partitions.empty())
    fail(folder_of(name) / file::permissions,
         "does not say the partitions; take it from a copy of the site's folder");
  return make(*found, validity, now);
}

std::size_t Site::revoke(const std::string& name, std::int64_t now) {
  const Authority identity = identity_of(folder_);
  RevocationList list = parsed(folder_ / file::revoked, read_revocation_list);
  std::size_t revoked = 0;
  bool is_known = false;
  for (const Certificate& certificate : issued_to(folder_, name)) {
    is_known = true;
    if (validity_of(certificate).end <= now || is_revoked(certificate, list)) continue;
    list = security::revoke(list, certificate, validity_from(now, end() - now),
                            identity.certificate, identity.key);
    ++revoked;
  }
  if (!is_known)
    throw Error(fmt::format("there is no member {}; 'reident security show {}' lists them", name,
                            folder_.string()));
  if (revoked == 0) return 0;
  write_file(folder_ / file::revoked, pem(list), readable);
  for (const auto& one : fs::directory_iterator(folder_ / members_folder))
    write_file(one.path() / file::revoked, pem(list), readable);
  return revoked;
}

std::vector<Member> Site::members() const {
  const RevocationList list = parsed(folder_ / file::revoked, read_revocation_list);
  const Certificate authority = parsed(folder_ / file::permissions_authority, read_certificate);
  std::map<std::string, Member> found;
  for (const Certificate& certificate : issued_to(folder_, "")) {
    const Subject subject = subject_of(certificate);
    Member& member = found[subject.name];
    const bool revoked = is_revoked(certificate, list);
    const std::int64_t end = validity_of(certificate).end;
    // One that is valid counts before one that is revoked.
    if (!member.name.empty() && std::pair(!revoked, end) < std::pair(!member.revoked, member.end))
      continue;
    member = {subject.unit, subject.name, {}, end, revoked};
  }
  std::vector<Member> members;
  for (auto& [name, member] : found) {
    const fs::path document = folder_of(name) / file::permissions;
    std::error_code failed;
    if (fs::exists(document, failed))
      if (const auto text = signed_text(read_file(document), authority))
        member.partitions = partitions_in(*text);
    members.push_back(std::move(member));
  }
  return members;
}

std::int64_t Site::end() const {
  return std::min(validity_of(parsed(folder_ / file::identity_authority, read_certificate)).end,
                  validity_of(parsed(folder_ / file::permissions_authority, read_certificate)).end);
}

}  // namespace reident::security
