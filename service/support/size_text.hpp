// Numbers of bytes as text.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

namespace reident {

/// Bytes from "200 GB", "1.5TB", "512MiB", "800000B": decimal units (kB, MB, GB, TB) or binary ones
/// (KiB, MiB, GiB, TiB), with or without a blank before them. A number without a unit is none.
std::optional<std::uint64_t> parse_size(std::string_view text);

/// "1.50 GB": three digits in the largest decimal unit.
std::string size_text(std::uint64_t bytes);

}  // namespace reident
