#include "service/windows/caching_reader.hpp"

#include <gtest/gtest.h>

namespace reident::caching_reader_test {
namespace {

/// Counts what it is asked for; its samples show by whom.
class Counted final : public storage::SampleReader {
 public:
  std::optional<storage::ParameterDescriptor> parameter(const std::string&,
                                                        const std::string& name) const override {
    ++asked;
    if (name == "unknown") return std::nullopt;
    storage::ParameterDescriptor descriptor;
    descriptor.name = name;
    return descriptor;
  }
  storage::Series read(const std::string&, storage::Origin, std::uint32_t parameter,
                       storage::TimeRange range) const override {
    ++asked;
    return {{range.begin}, {double(parameter)}, {storage::Quality::good}, {}};
  }
  mutable int asked = 0;
};

TEST(CachingReader, AsksForEachParameterAndRangeOnceAndGivesTheSame) {
  const Counted reader;
  const CachingReader once(reader);
  for (int i = 0; i < 3; ++i) {
    EXPECT_EQ(once.parameter("SAT", "u")->name, "u");
    EXPECT_FALSE(once.parameter("SAT", "unknown"));
    for (const std::uint32_t parameter : {1u, 2u})
      for (const storage::TimeRange range :
           {storage::TimeRange{0, 10}, storage::TimeRange{0, 20}, storage::TimeRange{5, 20}}) {
        const storage::Series series = once.read("SAT", storage::Origin::real, parameter, range);
        EXPECT_EQ(series.time.front(), range.begin);
        EXPECT_EQ(series.value.front(), parameter);
      }
  }
  EXPECT_EQ(reader.asked, 2 + 6);
}

TEST(CachingReader, KeepsSpacecraftAndOriginsApart) {
  const Counted reader;
  const CachingReader once(reader);
  once.read("SAT", storage::Origin::real, 1, {0, 10});
  once.read("SAT", storage::Origin::simulated, 1, {0, 10});
  once.read("SAT-2", storage::Origin::real, 1, {0, 10});
  EXPECT_EQ(reader.asked, 3);
}

}  // namespace
}  // namespace reident::caching_reader_test
