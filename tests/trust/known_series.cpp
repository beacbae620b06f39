#include "tests/trust/known_series.hpp"

#include <algorithm>

namespace reident::trust {

KnownSeries::KnownSeries(std::span<const storage::ParameterDescriptor> descriptors,
                         const std::vector<std::string>& names) {
  for (const storage::ParameterDescriptor& descriptor : descriptors) {
    if (std::find(names.begin(), names.end(), descriptor.name) == names.end()) continue;
    descriptors_.emplace(descriptor.name, descriptor);
    channels_.try_emplace(descriptor.id);
  }
}

void KnownSeries::append(storage::Time time, std::span<const storage::Sample> samples) {
  for (const storage::Sample& sample : samples) {
    const auto channel = channels_.find(sample.parameter);
    if (channel == channels_.end()) continue;
    channel->second.time.push_back(time);
    channel->second.value.push_back(sample.value);
  }
}

std::optional<storage::ParameterDescriptor> KnownSeries::parameter(const std::string&,
                                                                   const std::string& name) const {
  const auto found = descriptors_.find(name);
  if (found == descriptors_.end()) return std::nullopt;
  return found->second;
}

storage::Series KnownSeries::read(const std::string&, storage::Origin, std::uint32_t parameter,
                                  storage::TimeRange range) const {
  const Channel& channel = channels_.at(parameter);
  const auto first = std::lower_bound(channel.time.begin(), channel.time.end(), range.begin);
  const auto last = std::lower_bound(first, channel.time.end(), range.end);
  const auto from = first - channel.time.begin(), to = last - channel.time.begin();
  storage::Series series;
  series.time.assign(first, last);
  series.value.assign(channel.value.begin() + from, channel.value.begin() + to);
  series.quality.assign(series.time.size(), storage::Quality::good);
  return series;
}

}  // namespace reident::trust
