// A sweep's report as text for a terminal.
#pragma once

#include <string>

#include <nlohmann/json.hpp>

namespace reident::cli {

/// `report` is that of service/sweep/report.hpp. An equipment a line, those with the largest change
/// of the error first, at most `rows`; 0: all. `width` is that of the terminal, 0 without one.
std::string sweep_table(const nlohmann::ordered_json& report, std::size_t rows, std::size_t width);

/// The publications of both, a line each, by equipment and generation time.
std::string sweep_publications(const nlohmann::ordered_json& report, std::size_t width);

}  // namespace reident::cli
