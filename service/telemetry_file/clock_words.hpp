// What clocks and cells are called in descriptions and messages.
#pragma once

#include <string>
#include <string_view>

#include "service/telemetry_file/clock.hpp"

namespace reident::telemetry_file {

/// A cell in quotes, cut where it is long.
std::string shown(std::string_view cell);
/// "milliseconds"
std::string unit_name(std::int64_t unit_ns);
/// "milliseconds since 1970"
std::string describe_format(TimeFormat format, std::int64_t unit_ns);
/// "day of year", by the first cell, which reads as `text`.
std::string describe_text(std::string_view cell, DateOrder order, const DateText& text);

}  // namespace reident::telemetry_file
