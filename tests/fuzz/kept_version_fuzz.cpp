// Any file in a simulator's folder is a version that is sound, or is refused with a reason. The
// first byte says whether the rest are the file, or places and new bytes in a good one's content,
// whose SHA-256 is made right again.
#include <cstdint>
#include <cstdlib>
#include <span>
#include <string>

#include "service/client/cached_version_file.hpp"
#include "service/client/version_check.hpp"
#include "service/support/sha256.hpp"
#include "tests/fuzz/memory_file.hpp"
#include "tests/service/model/example_model.hpp"

namespace {

using namespace reident;

void require(bool condition) {
  if (!condition) std::abort();
}

std::string good_content() {
  CachedVersion kept{test::example_version(4), 10, 20};
  kept.version.model = test::full_example_model();
  kept.version.digest = model_digest(kept.version.model);
  const std::string text = kept_version_text(kept, "operations");
  const std::size_t begin = text.find(R"("kept":)") + 7;
  return text.substr(begin, text.rfind('}') - begin);
}

std::string sealed(const std::string& content) {
  return R"({"format":1,"sha256":")" + sha256_hex(content) + R"(","kept":)" + content + "}\n";
}

std::string text_from(std::span<const std::uint8_t> data) {
  static const std::string good = good_content();
  const bool is_whole = data[0] % 2 == 0;
  data = data.subspan(1);
  if (is_whole) return {data.begin(), data.end()};
  std::string changed = good;
  for (; data.size() >= 3; data = data.subspan(3))
    changed[(data[0] + 256U * data[1]) % changed.size()] = static_cast<char>(data[2]);
  return sealed(changed);
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* bytes, std::size_t size) {
  static const test::MemoryFile file;
  if (size == 0) return 0;
  file.write(text_from({bytes, size}));
  const auto read = read_kept_version(file.path(), "operations");
  if (const auto* unusable = std::get_if<Unusable>(&read))
    require(!unusable->reason.empty());
  else
    require(!damage(std::get<CachedVersion>(read).version));
  return 0;
}
