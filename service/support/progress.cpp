#include "service/support/progress.hpp"

#include <algorithm>
#include <unistd.h>

namespace reident {

Progress::Progress(std::FILE* out) : Progress(out, isatty(fileno(out)) == 1) {}

Progress::Progress(std::FILE* out, bool enabled) : out_(out), enabled_(enabled) {}

Progress::~Progress() {
  clear();
}

bool Progress::due(Clock::time_point now) const {
  constexpr auto interval = std::chrono::milliseconds(100);
  return enabled_ && (!drawn_ || now - last_draw_ >= interval);
}

void Progress::update(double fraction, std::string_view detail, Clock::time_point now) {
  if (!due(now)) return;
  constexpr int width = 30;
  // Written so that a fraction that is no number shows as 0.
  const double held = fraction > 0 ? std::min(fraction, 1.0) : 0.0;
  const int filled = static_cast<int>(held * width);
  const std::string bar = std::string(static_cast<std::size_t>(filled), '#') +
                          std::string(static_cast<std::size_t>(width - filled), '.');
  std::fprintf(out_, "\r\033[K[%s] %3.0f %%  %.*s", bar.c_str(), 100 * held,
               static_cast<int>(detail.size()), detail.data());
  std::fflush(out_);
  drawn_ = true;
  last_draw_ = now;
}

void Progress::clear() {
  if (!drawn_) return;
  std::fputs("\r\033[K", out_);
  std::fflush(out_);
  drawn_ = false;
}

}  // namespace reident
