// Samples and their information, taken from a reader and borrowed from the middleware.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <string>

#include "service/dds/entity.hpp"

namespace reident::dds {

/// Gives the samples back at its end; nothing of them may be kept beyond. The reader has to outlive
/// it. A sample counts as data where its `valid_data` is true; else it says that an instance ended.
struct Loan {
  static constexpr std::size_t capacity = 128;

  /// Takes at most `max` samples, and no more than `capacity`. Throws Error, with `about`.
  Loan(dds_entity_t from, std::size_t max, const std::string& about) : reader(from) {
    const auto size = static_cast<std::uint32_t>(std::min(max, capacity));
    count = static_cast<std::size_t>(
        check(dds_take(reader, samples.data(), infos.data(), size, size), "dds_take", about));
  }
  ~Loan() {
    if (count > 0) dds_return_loan(reader, samples.data(), static_cast<std::int32_t>(count));
  }
  Loan(const Loan&) = delete;
  Loan& operator=(const Loan&) = delete;

  dds_entity_t reader;
  std::array<void*, capacity> samples{};          // null: the middleware lends its own
  std::array<dds_sample_info_t, capacity> infos;  // of the first `count`, as `samples`
  std::size_t count = 0;
};

}  // namespace reident::dds
