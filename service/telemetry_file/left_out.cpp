#include <fmt/format.h>

#include "service/telemetry_file/telemetry_file.hpp"

namespace reident::telemetry_file {

void LeftOut::add(Damage damage, const Error& error) {
  for (Kind& kind : kinds_)
    if (kind.damage == damage) {
      ++kind.count;
      return;
    }
  kinds_.push_back({damage, 1, error.message});
}

std::uint64_t LeftOut::count() const {
  std::uint64_t count = 0;
  for (const Kind& kind : kinds_) count += kind.count;
  return count;
}

std::vector<std::string> LeftOut::sentences() const {
  std::vector<std::string> sentences;
  for (const Kind& kind : kinds_)
    sentences.push_back(fmt::format("{} {} left out for {}, the first: {}", kind.count,
                                    kind.count == 1 ? "row" : "rows", name(kind.damage),
                                    kind.first));
  return sentences;
}

}  // namespace reident::telemetry_file
