// Who ordered is who signed.
#include "service/security/command_signature.hpp"

#include <functional>

#include <gmock/gmock.h>

#include "tests/service/security/site_fixture.hpp"

namespace reident::test::command_signature_test {
namespace {

using namespace security;

class SignedCommand : public SiteFixture {
 protected:
  CommandRequest order() const {
    return {{"console", 1, "hold", "SAT", "PLANT", 3, "somebody", "why"}, "reident"};
  }
  CommandRequest signed_by(const Material& material) const {
    CommandRequest request = order();
    sign(request, material);
    return request;
  }
  /// The actor; empty where the command does not count.
  std::string actor(const CommandRequest& request, std::int64_t now = utc_now()) const {
    const auto found = actor_of(request, own_, now);
    const auto* who = std::get_if<Actor>(&found);
    return who ? who->name : "";
  }

  Material own_ = material(grant("service", "reident-1"));
  Material ana_ = material(grant("operator", "ana"));
};

TEST_F(SignedCommand, IsOfTheNameInTheCertificate) {
  EXPECT_EQ(actor(signed_by(ana_)), "ana");
}

TEST_F(SignedCommand, OfAPageNamesItsUserAndThePage) {
  EXPECT_EQ(actor(signed_by(material(grant("page", "web-1")))), "somebody (page web-1)");
}

TEST_F(SignedCommand, DoesNotCountWithoutASignature) {
  EXPECT_EQ(actor(order()), "");
  CommandRequest request = signed_by(ana_);
  request.signature.clear();
  EXPECT_EQ(actor(request), "");
  request.signature = "00";
  EXPECT_EQ(actor(request), "");
  request = signed_by(ana_);
  request.certificate = "none";
  EXPECT_EQ(actor(request), "");
}

TEST_F(SignedCommand, DoesNotCountOnceAnyFieldWasChanged) {
  const std::function<void(CommandRequest&)> changes[] = {
      [](CommandRequest& one) { one.command.requester = "other"; },
      [](CommandRequest& one) { ++one.command.request; },
      [](CommandRequest& one) { one.command.action = "release"; },
      [](CommandRequest& one) { one.command.spacecraft = "TAS"; },
      [](CommandRequest& one) { one.command.equipment = "PLAN"; },
      [](CommandRequest& one) { ++one.command.version; },
      [](CommandRequest& one) { one.command.actor = "eva"; },
      [](CommandRequest& one) { one.command.reason = "whyPLANT"; },
      [](CommandRequest& one) { one.service = "other"; },
      [](CommandRequest& one) {
        one.certificate += ' ';
        one.signature[10] ^= 1;
      },
      [this](CommandRequest& one) {
        one.certificate = material(grant("operator", "eva")).certificate;
      }};
  for (const auto& change : changes) {
    CommandRequest request = signed_by(ana_);
    change(request);
    EXPECT_EQ(actor(request), "");
  }
}

TEST_F(SignedCommand, DoesNotCountOfARoleThatMayNotOrder) {
  for (const char* role : {"service", "simulator", "gateway"})
    EXPECT_EQ(actor(signed_by(material(grant(role, std::string("a-") + role)))), "") << role;
}

TEST_F(SignedCommand, DoesNotCountOfAnotherSite) {
  Site other = Site::init(folder_ / "other", "Ground", utc_now());
  EXPECT_EQ(actor(signed_by(material(other.grant("operator", "ana", {"*"}, day, utc_now())))), "");
}

TEST_F(SignedCommand, DoesNotCountWithARevokedOrEndedCertificate) {
  const CommandRequest request = signed_by(ana_);
  EXPECT_EQ(actor(request, ana_.end), "");
  site_.revoke("ana", utc_now());
  own_ = material(site_.folder_of("reident-1"));
  EXPECT_EQ(actor(request), "");
}

}  // namespace
}  // namespace reident::test::command_signature_test
