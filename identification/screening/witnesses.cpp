#include "identification/screening/witnesses.hpp"

#include <algorithm>
#include <cmath>

#include "identification/screening/order_statistics.hpp"

namespace reident::identification {
namespace {

constexpr double confirmed_deviations = 6;
constexpr Index compared_rows = 5000;
// A share of the rows: channels that agree in more of them measure one thing.
constexpr double most_agreeing = 0.01;

/// How far rows [begin, end) stand out from the rows on both sides; 0 of a step.
double prominence(const Vector& values, Index begin, Index end) {
  const double there = values.segment(begin, end - begin).mean();
  const double up = there - values(begin - 1), down = there - values(end);
  if (up * down <= 0) return 0;
  return std::abs(up) < std::abs(down) ? up : down;
}

/// Without the largest hundredth.
double trimmed_root_mean_square(std::vector<double> values) {
  const double most = quantile(values, 0.99);
  double sum = 0;
  std::size_t count = 0;
  for (const double value : values)
    if (value <= most) sum += value * value, ++count;
  return std::sqrt(sum / double(count));
}

/// Whether two channels hardly ever agree in other rows than these.
bool are_apart(const Vector& one, const Vector& other, const std::vector<Plateau>& excursions) {
  Index agreeing = 0;
  for (Index row = 0; row < one.size(); ++row) agreeing += one(row) == other(row) ? 1 : 0;
  for (const Plateau& at : excursions)
    if (other(at.begin) == at.value) agreeing -= at.size();
  return double(agreeing) <= most_agreeing * double(one.size());
}

}  // namespace

void bridge(Vector& values, const Plateau& plateau) {
  const double before = values(std::max<Index>(plateau.begin - 1, 0));
  const double after = values(std::min(plateau.end, values.size() - 1));
  values.segment(plateau.begin, plateau.size()).setConstant((before + after) / 2);
}

bool Witnesses::saw(std::size_t channel, const Plateau& excursion) const {
  return !std::binary_search(lost[channel].begin(), lost[channel].end(), excursion.begin);
}

Witnesses witnesses_of(const std::vector<Channel>& channels, std::size_t self,
                       const std::vector<Plateau>& excursions) {
  Witnesses result{channels, self, std::vector<std::vector<Index>>(channels.size())};
  std::vector<std::size_t> apart;
  for (std::size_t c = 0; c < channels.size(); ++c)
    if (c != self && are_apart(channels[self].values, channels[c].values, excursions))
      apart.push_back(c);
  for (const Plateau& one : excursions) {
    const auto shares = [&](std::size_t c) { return channels[c].values(one.begin) == one.value; };
    // A command is off with what it commands.
    if (std::none_of(apart.begin(), apart.end(),
                     [&](std::size_t c) { return channels[c].is_analog && shares(c); }))
      continue;
    for (const std::size_t c : apart) {
      if (!shares(c)) continue;
      result.lost[c].push_back(one.begin);
      bridge(result.channels[c].values, one);
    }
  }
  return result;
}

bool Witnesses::is_lost(const Plateau& excursion) const {
  for (std::size_t c = 0; c < channels.size(); ++c)
    if (!saw(c, excursion)) return true;
  return false;
}

bool another_stands_out(const Witnesses& witnesses, const std::vector<Excursion>& excursions) {
  for (std::size_t c = 0; c < witnesses.channels.size(); ++c) {
    if (c == witnesses.self || !(witnesses.channels[c].range() > 0)) continue;
    const Vector& values = witnesses.channels[c].values;
    const Index rows = values.size(), size = excursions.front().plateau.size();
    std::vector<double> elsewhere;
    const Index stride = std::max<Index>(1, rows / compared_rows);
    for (Index begin = 1; begin + size < rows; begin += stride)
      elsewhere.push_back(std::abs(prominence(values, begin, begin + size)));
    if (elsewhere.empty()) continue;
    const double usual = trimmed_root_mean_square(std::move(elsewhere));
    for (const Index lag : {0, 1}) {
      double sum = 0;
      Index count = 0;
      for (const Excursion& one : excursions) {
        const Index begin = one.plateau.begin + lag, end = one.plateau.end + lag;
        if (end >= rows || !witnesses.saw(c, one.plateau)) continue;
        sum += (one.height > 0 ? 1 : -1) * prominence(values, begin, end);
        ++count;
      }
      if (count > 0 && std::abs(sum) > confirmed_deviations * usual * std::sqrt(double(count)))
        return true;
    }
  }
  return false;
}

}  // namespace reident::identification
