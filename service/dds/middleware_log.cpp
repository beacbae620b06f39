#include "service/dds/middleware_log.hpp"

#include <chrono>
#include <cstdint>
#include <map>
#include <string>
#include <string_view>
#include <utility>

#include <dds/dds.h>

#include "service/support/log.hpp"
#include "service/support/mutex.hpp"

namespace reident::dds {
namespace {

using SteadyClock = std::chrono::steady_clock;

constexpr auto quiet_time = std::chrono::hours(1);
constexpr std::size_t most_texts = 256;  // names of participants make new ones

/// Texts that were logged, and how often they came since.
class Repeated {
 public:
  /// How often the text came since its last line, where it is to be logged; -1 else.
  std::int64_t heard(std::string_view text) {
    const MutexLock lock(mutex_);
    const auto now = SteadyClock::now();
    if (texts_.size() >= most_texts) texts_.clear();
    const auto [found, is_new] = texts_.try_emplace(std::string(text));
    Text& one = found->second;
    if (!is_new && now < one.quiet_until) {
      ++one.left_out;
      return -1;
    }
    one.quiet_until = now + quiet_time;
    return std::exchange(one.left_out, 0);
  }

 private:
  struct Text {
    SteadyClock::time_point quiet_until;
    std::int64_t left_out = 0;
  };
  Mutex mutex_;
  std::map<std::string, Text> texts_ REIDENT_GUARDED_BY(mutex_);
};

void write(void*, const dds_log_data_t* data) {
  static Repeated repeated;
  std::string_view text(data->message, data->size);
  while (text.ends_with('\n')) text.remove_suffix(1);
  const std::int64_t left_out = repeated.heard(text);
  if (left_out < 0) return;
  const auto level = (data->priority & (DDS_LC_FATAL | DDS_LC_ERROR)) != 0 ? log::Level::error
                     : (data->priority & DDS_LC_WARNING) != 0              ? log::Level::warning
                                                                           : log::Level::info;
  log::write(level, "dds", "the middleware says", {{"text", text}, {"times_left_out", left_out}});
}

}  // namespace

void log_what_the_middleware_says() {
  dds_set_log_sink(write, nullptr);
}

}  // namespace reident::dds
