// A member's folder: everything that is wrong is named with its file before anything is joined.
#include "service/security/material.hpp"

#include <fstream>
#include <functional>

#include <gmock/gmock.h>

#include "service/security/documents.hpp"
#include "service/security/openssl.hpp"
#include "tests/service/security/site_fixture.hpp"

namespace reident::test::material_test {
namespace {

namespace fs = std::filesystem;
using namespace security;
using ::testing::Contains;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::Not;

class MemberFolder : public SiteFixture {
 protected:
  /// What is wrong at a time.
  static std::vector<std::string> mistakes(const fs::path& folder, std::int64_t now = utc_now()) {
    const auto read = read_material(folder, now);
    const auto* wrong = std::get_if<std::vector<std::string>>(&read);
    return wrong ? *wrong : std::vector<std::string>();
  }
  static std::string read(const fs::path& path) {
    std::ifstream file(path);
    return {std::istreambuf_iterator<char>(file), {}};
  }
  static void write(const fs::path& path, const std::string& text) {
    std::ofstream(path, std::ios::trunc) << text;
  }
  static void copy(const fs::path& from, const fs::path& to, const char* name) {
    fs::copy_file(from / name, to / name, fs::copy_options::overwrite_existing);
  }

  fs::path member_ = grant("service", "reident-1");
};

TEST_F(MemberFolder, OfASiteIsRight) {
  const Material read = material(member_);
  EXPECT_EQ(read.role, "service");
  EXPECT_EQ(read.name, "reident-1");
  EXPECT_EQ(read.subject, "CN=reident-1,OU=service,O=Ground");
  EXPECT_EQ(read.partitions, std::vector<std::string>{"*"});
  EXPECT_NEAR(static_cast<double>(read.end - utc_now()), static_cast<double>(365 * day), 10e9);
}

TEST_F(MemberFolder, NamesEachFileThatIsMissing) {
  for (const auto& one : fs::directory_iterator(member_)) fs::remove(one.path());
  const auto wrong = mistakes(member_);
  EXPECT_EQ(wrong.size(), 7U);
  for (const char* name : {file::certificate, file::key, file::permissions, file::governance,
                           file::identity_authority, file::permissions_authority, file::revoked})
    EXPECT_THAT(wrong, Contains(HasSubstr((member_ / name).string())));
  EXPECT_THAT(mistakes(member_ / "none"), Contains(HasSubstr("none")));
}

TEST_F(MemberFolder, NamesEachFileThatIsNone) {
  for (const char* name : {file::certificate, file::key, file::permissions, file::governance,
                           file::identity_authority, file::permissions_authority, file::revoked}) {
    const std::string before = read(member_ / name);
    write(member_ / name, "no PEM\n");
    EXPECT_THAT(mistakes(member_), Contains(HasSubstr((member_ / name).string()))) << name;
    write(member_ / name, before);
  }
  EXPECT_THAT(mistakes(member_), IsEmpty());
}

TEST_F(MemberFolder, NamesWhatHasEndedWithItsTimeAndWhatHasNotBegun) {
  const std::int64_t end = material(member_).end;
  EXPECT_THAT(mistakes(member_, end - second), IsEmpty());
  const auto ended = mistakes(member_, end);
  EXPECT_THAT(ended, Contains(HasSubstr((member_ / file::certificate).string())));
  EXPECT_THAT(mistakes(member_, utc_now() - day), Contains(HasSubstr(file::certificate)));
  EXPECT_THAT(mistakes(member_, utc_now() + 4000 * day),
              Contains(HasSubstr(file::identity_authority)));
}

TEST_F(MemberFolder, RefusesAKeyOfAnotherCertificate) {
  copy(grant("simulator", "trainer"), member_, file::key);
  EXPECT_THAT(mistakes(member_), Contains(HasSubstr((member_ / file::key).string())));
}

TEST_F(MemberFolder, RefusesAKeyThatOthersCanRead) {
  fs::permissions(member_ / file::key, fs::perms::group_read, fs::perm_options::add);
  EXPECT_THAT(mistakes(member_), Contains(HasSubstr("0640")));
}

TEST_F(MemberFolder, RefusesPermissionsOfAnother) {
  copy(grant("operator", "ana"), member_, file::permissions);
  EXPECT_THAT(mistakes(member_), Contains(HasSubstr("CN=ana,OU=operator,O=Ground")));
}

TEST_F(MemberFolder, RefusesFilesOfAnotherSite) {
  Site other = Site::init(folder_ / "other", "Ground", utc_now());
  const fs::path foreign = other.grant("service", "reident-1", {"*"}, day, utc_now());
  for (const char* name : {file::permissions, file::governance, file::identity_authority,
                           file::permissions_authority, file::revoked}) {
    const std::string before = read(member_ / name);
    copy(foreign, member_, name);
    EXPECT_THAT(mistakes(member_), Not(IsEmpty())) << name;
    write(member_ / name, before);
  }
}

TEST_F(MemberFolder, RefusesOneAuthorityForIdentityAndPermissions) {
  copy(member_, folder_.path(), file::identity_authority);
  fs::copy_file(member_ / file::identity_authority, member_ / file::permissions_authority,
                fs::copy_options::overwrite_existing);
  EXPECT_THAT(mistakes(member_), Contains(HasSubstr("CVE-2023-24011")));
}

TEST_F(MemberFolder, RefusesPermissionsThatTheMemberSignedItself) {
  const Certificate certificate = read_certificate(read(member_ / file::certificate));
  const Key key = read_key(read(member_ / file::key));
  write(member_ / file::permissions,
        sign_document(permissions_text(*find_role("service"), subject_text(certificate), {"*"},
                                       validity_of(certificate)),
                      certificate, key));
  EXPECT_THAT(mistakes(member_), Contains(HasSubstr((member_ / file::permissions).string())));
}

TEST_F(MemberFolder, NamesARevokedCertificate) {
  EXPECT_EQ(site_.revoke("reident-1", utc_now()), 1U);
  EXPECT_THAT(mistakes(member_), Contains(HasSubstr((member_ / file::certificate).string())));
}

TEST_F(MemberFolder, IsUnchangedUntilAFileIs) {
  const Material before = material(member_);
  EXPECT_TRUE(is_unchanged(before));
  site_.renew("reident-1", day, utc_now());
  EXPECT_FALSE(is_unchanged(before));
}

TEST_F(MemberFolder, WarnsFromThirtySevenAndOneDaysBeforeTheEnd) {
  const Material read = material(member_);
  EXPECT_EQ(end_warning(read, read.end - 31 * day), "");
  std::vector<std::string> texts;
  for (const std::int64_t left : {30 * day, 8 * day, 7 * day, 2 * day, day, second, -second, -day})
    if (const std::string text = end_warning(read, read.end - left);
        texts.empty() || texts.back() != text)
      texts.push_back(text);
  EXPECT_EQ(texts.size(), 4U);
  for (const std::string& text : texts) EXPECT_THAT(text, HasSubstr(member_.string()));
}

}  // namespace
}  // namespace reident::test::material_test
