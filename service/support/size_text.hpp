// Numbers of bytes as text.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

namespace reident {

/// Bytes from "200 GB", "1.5TB", "512MiB", "800000B": decimal units (kB, MB, GB, TB) or binary ones
/// (KiB, MiB, GiB, TiB), with or without a blank before them, rounded to whole bytes. Absent for a
/// number without a unit, a negative one, and for 2^63 bytes or more.
std::optional<std::uint64_t> parse_size(std::string_view text);

/// Returns bytes as in "1.5 GB": up to three digits in the largest decimal unit that fits.
std::string size_text(std::uint64_t bytes);

}  // namespace reident
