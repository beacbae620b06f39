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
  char percent[8];
  std::snprintf(percent, sizeof percent, "%3.0f", 100 * held);
  draw("[" + bar + "] " + percent + " %  " + std::string(detail), now);
}

void Progress::update(std::string_view detail, Clock::time_point now) {
  if (due(now)) draw(std::string(detail), now);
}

void Progress::draw(const std::string& line, Clock::time_point now) {
  std::fprintf(out_, "\r\033[K%s", line.c_str());
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
