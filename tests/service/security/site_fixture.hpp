// A site with one member of each role, in a folder of the test's own.
#pragma once

#include <filesystem>
#include <string>
#include <variant>
#include <vector>

#include <gtest/gtest.h>

#include "service/security/material.hpp"
#include "service/security/site.hpp"
#include "service/support/utc_clock.hpp"
#include "tests/support/temporary_folder.hpp"

namespace reident::test {

inline constexpr std::int64_t second = 1'000'000'000;
inline constexpr std::int64_t day = 86'400 * second;

class SiteFixture : public ::testing::Test {
 protected:
  std::filesystem::path grant(const std::string& role, const std::string& name,
                              const std::vector<std::string>& partitions = {"*"},
                              std::int64_t validity = 365 * day) {
    return site_.grant(role, name, partitions, validity, utc_now());
  }
  static security::Material material(const std::filesystem::path& folder) {
    auto read = security::read_material(folder, utc_now());
    if (const auto* mistakes = std::get_if<1>(&read)) {
      ADD_FAILURE() << mistakes->front();
      return {};
    }
    return std::get<0>(std::move(read));
  }

  TemporaryFolder folder_;
  security::Site site_ = security::Site::init(folder_ / "site", "Ground", utc_now());
};

}  // namespace reident::test
