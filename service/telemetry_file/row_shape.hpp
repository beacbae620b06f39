// Rows with more cells than the header has names.
#pragma once

#include "service/telemetry_file/head_lines.hpp"

namespace reident::telemetry_file {

/// Gives the lines and the layout the cells of the header where rows have more: dates and times of
/// day that stand a blank apart under one name, blank cells at the end of every row, and numbers of
/// the rows, which get an empty name.
void join_cells(HeadLines& lines, Layout& layout);

}  // namespace reident::telemetry_file
