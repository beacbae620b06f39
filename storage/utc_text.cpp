#include "storage/utc_text.hpp"

#include <chrono>
#include <cstdio>

namespace reident::storage {

std::string utc_text(Time time) {
  using namespace std::chrono;
  const nanoseconds since_1970(time);
  const auto day = floor<days>(since_1970);
  const year_month_day date{sys_days(day)};
  const hh_mm_ss clock(since_1970 - day);
  char text[48];
  std::snprintf(text, sizeof text, "%04d-%02u-%02uT%02d:%02d:%02d.%09dZ", int{date.year()},
                unsigned{date.month()}, unsigned{date.day()},
                static_cast<int>(clock.hours().count()), static_cast<int>(clock.minutes().count()),
                static_cast<int>(clock.seconds().count()),
                static_cast<int>(clock.subseconds().count()));
  return text;
}

}  // namespace reident::storage
