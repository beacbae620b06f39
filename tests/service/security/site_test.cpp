// A site's authorities: who was given what, and what is kept secret.
#include "service/security/site.hpp"

#include <gmock/gmock.h>

#include "tests/service/security/site_fixture.hpp"

namespace reident::test::site_test {
namespace {

namespace fs = std::filesystem;
using security::Error;
using security::Member;
using security::Site;

class SiteOfMembers : public SiteFixture {
 protected:
  Member member(const std::string& name) const {
    for (const Member& one : site_.members())
      if (one.name == name) return one;
    return {};
  }
};

TEST_F(SiteOfMembers, KeepsKeysToItsOwner) {
  grant("operator", "ana");
  std::size_t keys = 0;
  for (const auto& one : fs::recursive_directory_iterator(folder_ / "site")) {
    if (!one.path().filename().string().ends_with("key.pem")) continue;
    ++keys;
    EXPECT_EQ(fs::status(one.path()).permissions(), fs::perms::owner_read | fs::perms::owner_write)
        << one.path();
  }
  EXPECT_EQ(keys, 3U);
}

TEST_F(SiteOfMembers, IsMadeOnceInAnEmptyFolder) {
  EXPECT_THROW(Site::init(folder_ / "site", "Ground", utc_now()), Error);
  EXPECT_THROW(Site(folder_ / "none"), Error);
  const fs::path member = grant("operator", "ana");
  EXPECT_THROW(Site{member}, Error);
  const auto read = security::read_material(folder_ / "site", utc_now());
  EXPECT_THAT(std::get<std::vector<std::string>>(read),
              testing::ElementsAre(testing::HasSubstr("members/")));
  EXPECT_THROW(Site::init(folder_ / "other", "a/b", utc_now()), Error);
}

TEST_F(SiteOfMembers, ListsRolePartitionsAndEnd) {
  grant("simulator", "trainer", {"operations/SAT-1", "training"}, 10 * day);
  const Member found = member("trainer");
  EXPECT_EQ(found.role, "simulator");
  EXPECT_EQ(found.partitions, (std::vector<std::string>{"operations/SAT-1", "training"}));
  EXPECT_NEAR(static_cast<double>(found.end - utc_now()), static_cast<double>(10 * day), 10e9);
  EXPECT_FALSE(found.revoked);
}

TEST_F(SiteOfMembers, RefusesWhatIsNoRoleOrNameAndANameThatIsTaken) {
  EXPECT_THROW(grant("admiral", "ana"), Error);
  for (const char* name : {"", "..", "a/b", "ana,O=x", "-rf", "an a"})
    EXPECT_THROW(grant("operator", name), Error) << name;
  grant("operator", "ana");
  EXPECT_THROW(grant("operator", "ana"), Error);
}

TEST_F(SiteOfMembers, KeepsThePartitionsOfANameAndRole) {
  grant("simulator", "trainer", {"operations"});
  site_.revoke("trainer", utc_now());
  EXPECT_THROW(grant("simulator", "trainer", {"training"}), Error);
  grant("operator", "trainer", {"training"});
}

TEST_F(SiteOfMembers, RenewsWithTheSameRoleAndPartitionsAndANewKey) {
  const auto before = material(grant("gateway", "station", {"operations"}, day));
  const auto after = material(site_.renew("station", 100 * day, utc_now()));
  EXPECT_EQ(after.role, "gateway");
  EXPECT_EQ(after.partitions, before.partitions);
  EXPECT_NE(after.key, before.key);
  EXPECT_GT(after.end, before.end + 98 * day);
  EXPECT_THROW(site_.renew("nobody", day, utc_now()), Error);
}

TEST_F(SiteOfMembers, RevokesEveryCertificateOfANameForAllMembers) {
  grant("operator", "ana");
  site_.renew("ana", day, utc_now());
  const fs::path other = grant("operator", "eva");
  EXPECT_EQ(site_.revoke("ana", utc_now()), 2U);
  EXPECT_TRUE(member("ana").revoked);
  EXPECT_EQ(site_.revoke("ana", utc_now()), 0U);
  EXPECT_THROW(site_.renew("ana", day, utc_now()), Error);
  EXPECT_THROW(site_.revoke("nobody", utc_now()), Error);
  EXPECT_FALSE(member("eva").revoked);
  EXPECT_EQ(material(other).revoked, material(grant("operator", "ana")).revoked);
  EXPECT_FALSE(member("ana").revoked);
}

}  // namespace
}  // namespace reident::test::site_test
