// Samples and their information, taken from a reader and borrowed from the middleware.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <string>

#include "service/dds/entity.hpp"

namespace reident::dds {

struct Loan {
  static constexpr std::size_t capacity = 128;

  /// Takes at most `max` samples.
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
  std::array<void*, capacity> samples{};  // null: the middleware lends its own
  std::array<dds_sample_info_t, capacity> infos;
  std::size_t count = 0;
};

}  // namespace reident::dds
