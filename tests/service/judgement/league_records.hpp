// Records of a champion and challengers, as their errors are said to be.
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <vector>

#include "service/judgement/league.hpp"
#include "service/windows/block_reader.hpp"

namespace reident::test::league {

using storage::Block;
using storage::BlockScore;
using storage::Time;
using Code = ReasonCode;

inline constexpr Time length = 15 * 60 * 1'000'000'000LL;
inline constexpr Time cycle = length * blocks_of_cycle;

/// What an output errs on a block, by the block's number: mean and mean square.
struct Error {
  double mean = 0, square = 0;
};
using Errors = std::function<Error(int block)>;

inline Errors white(double square) {
  return [square](int) { return Error{0, square}; };
}
/// Larger and smaller by a fifth in turn, as errors vary.
inline Errors varying(double square) {
  return [square](int block) { return Error{0, square * (block % 3 == 0 ? 1.2 : 0.8)}; };
}

/// Records of blocks from 0 on. The output's mean is 10 and its variance 1; the input's range is
/// -1 to 1.
class Records {
 public:
  explicit Records(int blocks) {
    limits_.cycle = cycle;
    for (int i = 0; i < blocks; ++i)
      league_.blocks.push_back(
          {{i * length, (i + 1) * length}, 100, 1, {10}, {101}, {-1}, {1}, {}});
  }
  Records& champion(const Errors& errors, int from = 0) {
    league_.champion = member(1, {from * length - 5 * cycle, from * length}, errors, from);
    return *this;
  }
  /// A version whose window ends at block `from`, and its record from there on.
  Records& challenger(const Errors& errors, int from, Time window = 2 * cycle) {
    const auto number = static_cast<std::int64_t>(league_.admitted.size()) + 2;
    league_.challengers.push_back(
        member(number, {from * length - window, from * length}, errors, from));
    league_.admitted.push_back(league_.challengers.back().window);
    return *this;
  }
  /// The run of the champion or a challenger on these blocks, which lie before its window.
  void ran_before(Member& of, const Errors& errors, int from, int to) {
    const auto scores = member(of.version, of.window, errors, from).scores;
    of.scores.insert(of.scores.begin(), scores.begin(), scores.begin() + (to - from));
  }
  /// The input goes five times as far in these blocks.
  void swings(std::size_t from, std::size_t to) {
    for (std::size_t i = from; i < to; ++i)
      league_.blocks[i].input_low = {-5}, league_.blocks[i].input_high = {5};
  }
  Records& unbound() {
    league_.unbound = {"y"};
    league_.outputs = {"y"};
    return *this;
  }
  League& league() { return league_; }
  EquipmentConfig& limits() { return limits_; }
  std::vector<Finding> findings() const { return Judge(limits_).findings(league_); }
  /// Those of the first challenger.
  std::vector<Time> earlier_blocks() const {
    return Judge(limits_).earlier_blocks(league_, league_.challengers[0]);
  }
  /// The code of what is against the first challenger; nothing where it may become champion.
  std::optional<Code> obstacle() const {
    const auto found = findings().at(0).obstacle;
    return found ? std::optional(found->code) : std::nullopt;
  }

 private:
  Member member(std::int64_t number, storage::TimeRange window, const Errors& errors,
                int from) const {
    Member member{number, window, from * length, {}};
    for (std::size_t i = static_cast<std::size_t>(from); i < league_.blocks.size(); ++i) {
      const Error error = errors(static_cast<int>(i));
      member.scores.push_back({number,
                               league_.blocks[i].range.begin,
                               100,
                               {error.mean},
                               {error.square + error.mean * error.mean},
                               {1e-6},
                               {},
                               {}});
    }
    return member;
  }

  League league_;
  EquipmentConfig limits_;
};

}  // namespace reident::test::league
