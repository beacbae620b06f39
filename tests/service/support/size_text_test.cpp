#include "service/support/size_text.hpp"

#include <gtest/gtest.h>

namespace reident::size_text_test {
namespace {

TEST(ParseSize, ReadsDecimalAndBinaryUnits) {
  const struct {
    const char* text;
    std::optional<std::uint64_t> bytes;
  } cases[] = {
      {"200 GB", 200'000'000'000},
      {"1.5TB", 1'500'000'000'000},
      {" 512MiB ", 512ULL << 20},
      {"4 kB", 4000},
      {"4KiB", 4096},
      {"0B", 0},
      {"8000000 TB", 8'000'000'000'000'000'000},
      {"10000000 TB", std::nullopt},  // more than a file can have
      {"200", std::nullopt},
      {"GB", std::nullopt},
      {"-1 GB", std::nullopt},
      {"1e3 GB", std::nullopt},
      {"1 gb", std::nullopt},
      {"1 GB more", std::nullopt},
      {"nan GB", std::nullopt},
      {"", std::nullopt},
  };
  for (const auto& [text, bytes] : cases) EXPECT_EQ(parse_size(text), bytes) << "'" << text << "'";
}

TEST(SizeText, HasThreeDigitsInTheLargestUnit) {
  EXPECT_EQ(size_text(0), "0 B");
  EXPECT_EQ(size_text(999), "999 B");
  EXPECT_EQ(size_text(1536), "1.54 kB");
  EXPECT_EQ(size_text(200'000'000'000), "200 GB");
  EXPECT_EQ(size_text(1'500'000'000'000), "1.5 TB");
}

}  // namespace
}  // namespace reident::size_text_test
