// Frames that a source has written and whose readers may not have, and those of them that nobody
// can send again.
#pragma once

#include <cstdint>
#include <deque>
#include <vector>

#include "storage/types/telemetry.hpp"

namespace reident::satcs {

/// Frames that were lost one after the other.
struct LostFrames {
  std::uint64_t frames = 0;
  storage::Time first_time = 0;  // generation times of the first and the last
  storage::Time last_time = 0;
  bool operator==(const LostFrames&) const = default;
};

/// Follows one writer. While its readers are there it keeps all that they have not acknowledged;
/// while they are not it keeps its history, and what leaves that is lost.
class UnheardFrames {
 public:
  /// `history`: frames that the writer keeps for readers that come late. `on_the_way`: frames that
  /// it has at most before it waits for its readers.
  UnheardFrames(std::size_t history, std::size_t on_the_way);

  void written(storage::Time generation_time, bool readers_are_there);
  /// Every reader is there and has so many frames, counted from the first.
  void acknowledged(std::uint64_t frames);
  /// The writer ends, and with it all that it kept.
  void ended();

  /// One element for each stretch without readers in which frames were lost.
  const std::vector<LostFrames>& lost() const { return lost_; }

 private:
  void lose_first();

  std::size_t history_, on_the_way_;
  std::uint64_t written_ = 0;
  std::deque<storage::Time> kept_;  // the newest of these
  bool is_losing_ = false;          // the last element of lost_ goes on
  std::vector<LostFrames> lost_;
};

}  // namespace reident::satcs
