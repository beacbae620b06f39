// A process on a secured domain: what is refused, new files while it runs, the end. What passes
// between processes is in tests/e2e/test_security.py: within one the middleware encrypts nothing.
#include <gmock/gmock.h>

#include "service/dds/dds.hpp"
#include "tests/service/dds/dds_fixture.hpp"
#include "tests/service/security/site_fixture.hpp"

namespace reident::test::secured_domain_test {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::ThrowsMessage;

class SecuredDomain : public SiteFixture {
 protected:
  static dds::Endpoint endpoint(const std::filesystem::path& folder) {
    dds::Endpoint own = own_endpoint();
    own.security = folder;
    return own;
  }
  static ServiceStatus status(storage::Time time) {
    ServiceStatus status;
    status.service = "reident-1";
    status.time = time;
    return status;
  }
  /// Whether what is written is taken within ten seconds.
  template <class M>
  static bool passes(dds::Writer<M>& writer, dds::Reader<M>& reader, const M& message) {
    return eventually([&] {
      writer.write(message);
      bool came = false;
      reader.take(64, [&came](M&&) { came = true; });
      return came;
    });
  }
};

TEST_F(SecuredDomain, CarriesWhatTheRolesMay) {
  dds::Participant service(endpoint(grant("service", "reident-1")));
  dds::Writer<ServiceStatus> writer(service);
  dds::Reader<ServiceStatus> reader(service);
  EXPECT_TRUE(passes(writer, reader, status(1)));
  EXPECT_EQ(service.security_warning(), "");
}

TEST_F(SecuredDomain, NamesRoleTopicAndWhoMayWhereATopicIsDenied) {
  dds::Participant simulator(endpoint(grant("simulator", "trainer")));
  EXPECT_THAT(
      [&] { dds::Writer<CommandRequest> writer(simulator); },
      ThrowsMessage<dds::Error>(AllOf(HasSubstr("simulator trainer"), HasSubstr("reident/Command"),
                                      HasSubstr("operator, page"))));
  EXPECT_THAT([&] { dds::Writer<ModelVersion> writer(simulator); },
              ThrowsMessage<dds::Error>(HasSubstr("service")));
  EXPECT_THAT([&] { dds::Reader<ServiceStatus> reader(simulator); },
              ThrowsMessage<dds::Error>(HasSubstr("reident/ServiceStatus")));
}

TEST_F(SecuredDomain, NamesThePartitionThatIsNotGranted) {
  dds::Participant service(endpoint(grant("service", "reident-1", {"operations/SAT-1"})));
  EXPECT_THAT([&] { dds::Writer<ServiceStatus> writer(service); },
              ThrowsMessage<dds::Error>(
                  AllOf(HasSubstr("operations/SAT-1"), HasSubstr(own_endpoint().partition))));
}

TEST_F(SecuredDomain, IsNotJoinedWithFilesThatAreWrong) {
  const auto folder = grant("service", "reident-1", {"*"}, second);
  EXPECT_TRUE(eventually([&] { return security::read_material(folder, utc_now()).index() == 1; }));
  EXPECT_THAT([&] { dds::Participant late(endpoint(folder)); },
              ThrowsMessage<dds::Error>(HasSubstr((folder / "certificate.pem").string())));
}

TEST_F(SecuredDomain, HasOneFolderInAProcess) {
  const auto folder = grant("service", "reident-1");
  dds::Participant service(endpoint(folder));
  dds::Participant again(endpoint(folder));
  EXPECT_FALSE(service.misses_security());
  EXPECT_THROW(dds::Participant(endpoint(grant("operator", "ana"))), dds::Error);
  EXPECT_THROW(dds::Participant{own_endpoint()}, dds::Error);
}

TEST_F(SecuredDomain, StatesThatWereWrittenStayWithTheNewFiles) {
  dds::Participant service(endpoint(grant("service", "reident-1")));
  dds::Writer<ServiceStatus> writer(service);
  writer.write(status(7));
  const auto before = service.material();
  site_.renew("reident-1", 365 * day, utc_now());
  ASSERT_TRUE(eventually([&] { return service.material() != before; }));
  // Every session but the newest has ended.
  ASSERT_TRUE(eventually([&] { return before.use_count() == 1; }, 30s));
  dds::Reader<ServiceStatus> reader(service);
  const auto late = take_all(reader, 1);
  ASSERT_EQ(late.size(), 1U);
  EXPECT_EQ(late[0].time, 7);
}

TEST_F(SecuredDomain, SaysWhenTheCertificateHasEnded) {
  dds::Participant service(endpoint(grant("service", "reident-1", {"*"}, 4 * second)));
  const std::string before = service.security_warning();
  EXPECT_NE(before, "");
  EXPECT_TRUE(eventually([&] { return service.security_warning() != before; }));
}

}  // namespace
}  // namespace reident::test::secured_domain_test
