#include "service/web/accounts.hpp"

#include <fstream>

#include <gtest/gtest.h>

#include "service/web/access.hpp"
#include "tests/support/temporary_folder.hpp"

namespace reident::web {
namespace {

using namespace std::chrono_literals;

std::variant<Accounts, std::vector<ConfigMistake>> loaded(const std::string& text) {
  const reident::test::TemporaryFolder folder;
  std::ofstream(folder / "accounts.toml") << text;
  return load_accounts(folder / "accounts.toml");
}

TEST(Accounts, SayWhoMayDoWhatForWhichSpacecraft) {
  const auto accounts = loaded(
      "[[account]]\nname = \"Ana\"\nrole = \"approver\"\nspacecraft = [\"SAT\"]\n"
      "[[account]]\nname = \"Olaf\"\nrole = \"operator\"\n"
      "[[account]]\nname = \"Vic\"\nrole = \"viewer\"\n");
  ASSERT_TRUE(std::holds_alternative<Accounts>(accounts));
  const auto may = [&](const char* name, Role role, const char* spacecraft) {
    return std::get<Accounts>(accounts).at(name).may(role, spacecraft);
  };
  EXPECT_TRUE(may("Ana", Role::approver, "SAT"));
  EXPECT_TRUE(may("Ana", Role::controller, "SAT"));
  EXPECT_FALSE(may("Ana", Role::viewer, "OTHER"));
  EXPECT_TRUE(may("Olaf", Role::controller, "OTHER"));
  EXPECT_FALSE(may("Olaf", Role::approver, "SAT"));
  EXPECT_FALSE(may("Vic", Role::controller, "SAT"));
}

TEST(Accounts, NameEveryMistakeWithItsLine) {
  const auto found = loaded(
      "[[account]]\nname = \"Ana\"\nrole = \"boss\"\n"
      "[[account]]\nname = \"Ana\"\nrole = \"viewer\"\npassword = \"secret\"\n"
      "[[account]]\nname = \"gate\"\nrole = \"viewer\"\n"
      "[[account]]\nrole = \"viewer\"\nrank = 1\n");
  ASSERT_TRUE(std::holds_alternative<std::vector<ConfigMistake>>(found));
  std::vector<std::uint32_t> lines;
  for (const ConfigMistake& mistake : std::get<std::vector<ConfigMistake>>(found))
    lines.push_back(mistake.line);
  EXPECT_EQ(lines, (std::vector<std::uint32_t>{3, 5, 7, 9, 11, 13}));
  EXPECT_TRUE(std::holds_alternative<std::vector<ConfigMistake>>(
      load_accounts("/nonexistent/accounts.toml")));
}

TEST(Accounts, KnowAPasswordByItsHashAlone) {
  const std::string hashed = hash_password("correct horse");
  EXPECT_EQ(hashed.find("horse"), std::string::npos);
  EXPECT_NE(hashed, hash_password("correct horse")) << "each with a salt of its own";
  EXPECT_TRUE(matches("correct horse", hashed));
  EXPECT_FALSE(matches("correct horsf", hashed));
  for (const char* damaged : {"", "scrypt", "scrypt:32768:8:1:00:00", "plain:1:1:1:a:b"})
    EXPECT_FALSE(matches("", damaged)) << damaged;
}

class AccessTest : public testing::Test {
 protected:
  static Accounts accounts() {
    return {{"Ana", {"Ana", Role::approver, {}, hash_password("secret")}},
            {"Cert", {"Cert", Role::viewer, {}, ""}}};
  }
  HttpRequest with_session(const std::string& name, const std::string& password) {
    HttpRequest request;
    const auto login = access.log_in(name, password, Access::Clock::now());
    if (const auto* session = std::get_if<std::string>(&login))
      request.cookie = "other=1; reident_session=" + *session;
    return request;
  }
  Access access{accounts()};
};

TEST_F(AccessTest, KnowsWhoLoggedInUntilTheyLogOut) {
  HttpRequest request = with_session("Ana", "secret");
  ASSERT_TRUE(access.who(request));
  EXPECT_EQ(access.who(request)->name, "Ana");
  EXPECT_EQ(access.token(request).size(), 64U);
  EXPECT_NE(access.token(request), access.token(with_session("Ana", "secret")));
  access.log_out(request);
  EXPECT_FALSE(access.who(request));
  EXPECT_EQ(access.token(request), "");
  request.cookie = "xreident_session=" + request.cookie;
  EXPECT_FALSE(access.who(request));
}

TEST_F(AccessTest, KnowsWhomAProxyOrACertificateNames) {
  HttpRequest request;
  request.user = "Cert";
  EXPECT_EQ(access.who(request)->role, Role::viewer);
  request.user = "Stranger";
  EXPECT_FALSE(access.who(request));
}

TEST_F(AccessTest, NobodyLogsInWithAWrongPasswordOrWithoutOne) {
  EXPECT_FALSE(access.who(with_session("Ana", "Secret")));
  EXPECT_FALSE(access.who(with_session("Cert", "")));
  EXPECT_FALSE(access.who(with_session("Nobody", "")));
}

TEST_F(AccessTest, TriesAreFewInAMinute) {
  const auto now = Access::Clock::now();
  for (int i = 0; i < 5; ++i) access.log_in("Ana", "wrong", now);
  EXPECT_EQ(std::get<Access::NoLogin>(access.log_in("Ana", "secret", now)),
            Access::NoLogin::too_often);
  EXPECT_TRUE(std::holds_alternative<std::string>(access.log_in("Ana", "secret", now + 61s)));
}

TEST_F(AccessTest, AnotherPageOrdersNothing) {
  HttpRequest request;
  request.host = "ops.example";
  request.content_type = "application/json";
  const auto status = [&](const char* origin, bool is_secure) {
    request.origin = origin;
    request.is_secure = is_secure;
    const auto refusal = access.refusal(request);
    return refusal ? refusal->status : 0;
  };
  EXPECT_EQ(status("http://ops.example", false), 0);
  EXPECT_EQ(status("https://ops.example", true), 0);
  EXPECT_EQ(status("http://ops.example", true), 403);
  EXPECT_EQ(status("http://evil.example", false), 403);
  EXPECT_EQ(status("null", false), 403);
  EXPECT_EQ(status("", false), 403);
  request.content_type = "text/plain";
  EXPECT_EQ(status("http://ops.example", false), 415);
}

}  // namespace
}  // namespace reident::web
