#include "service/windows/caching_reader.hpp"

namespace reident {

std::optional<storage::ParameterDescriptor> CachingReader::parameter(
    const std::string& spacecraft, const std::string& name) const {
  const auto [found, is_new] = described_.try_emplace({spacecraft, name});
  if (is_new) found->second = reader_.parameter(spacecraft, name);
  return found->second;
}

storage::Series CachingReader::read(const std::string& spacecraft, storage::Origin origin,
                                    std::uint32_t parameter, storage::TimeRange range) const {
  const std::tuple key(spacecraft, origin, parameter, range.begin, range.end);
  const auto found = read_.find(key);
  if (found != read_.end()) return found->second;
  return read_[key] = reader_.read(spacecraft, origin, parameter, range);
}

}  // namespace reident
