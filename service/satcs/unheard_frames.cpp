#include "service/satcs/unheard_frames.hpp"

#include <algorithm>

namespace reident::satcs {

UnheardFrames::UnheardFrames(std::size_t history, std::size_t on_the_way)
    : history_(history), on_the_way_(std::max(history, on_the_way)) {}

void UnheardFrames::lose_first() {
  if (!is_losing_) lost_.push_back({0, kept_.front(), 0});
  is_losing_ = true;
  ++lost_.back().frames;
  lost_.back().last_time = kept_.front();
  kept_.pop_front();
}

void UnheardFrames::written(storage::Time generation_time, bool readers_are_there) {
  kept_.push_back(generation_time);
  ++written_;
  if (!readers_are_there)
    while (kept_.size() > history_) lose_first();
  // The writer would have waited: what came before these has been acknowledged.
  while (kept_.size() > on_the_way_) kept_.pop_front();
}

void UnheardFrames::acknowledged(std::uint64_t frames) {
  while (!kept_.empty() && written_ - kept_.size() < frames) {
    kept_.pop_front();
    is_losing_ = false;
  }
}

void UnheardFrames::ended() {
  while (!kept_.empty()) lose_first();
}

}  // namespace reident::satcs
