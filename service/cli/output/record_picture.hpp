// A version's record beside the champion's as an SVG picture.
#pragma once

#include <string>
#include <vector>

#include "service/judgement/league.hpp"

namespace reident::cli {

struct RecordPictureData {
  std::string title, subtitle;
  std::vector<ComparedBlock> blocks;  // at least one
  std::optional<Change> change;
};

/// The score of each block, their running mean and its confidence sequence, and the change of the
/// equipment, if one was found among them.
std::string record_picture(const RecordPictureData& data);

}  // namespace reident::cli
