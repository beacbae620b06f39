#include "storage/types/utc_text.hpp"

#include <chrono>
#include <string_view>

namespace reident::storage {
namespace {

void put(char* at, int digits, std::int64_t number) {
  for (int i = digits - 1; i >= 0; --i, number /= 10) at[i] = static_cast<char>('0' + number % 10);
}

}  // namespace

// By hand: a query prints millions of them.
std::string utc_text(Time time) {
  using namespace std::chrono;
  const nanoseconds since_1970(time);
  const auto second = floor<seconds>(since_1970);
  const auto day = floor<days>(second);
  const year_month_day date{sys_days(day)};
  const std::int64_t of_day = (second - day).count();

  std::string text = "yyyy-mm-ddThh:mm:ss.nnnnnnnnnZ";
  put(&text[0], 4, int{date.year()});
  put(&text[5], 2, unsigned{date.month()});
  put(&text[8], 2, unsigned{date.day()});
  put(&text[11], 2, of_day / 3600);
  put(&text[14], 2, of_day / 60 % 60);
  put(&text[17], 2, of_day % 60);
  // The begin of the second of the earliest times is not a number of nanoseconds.
  put(&text[20], 9, (time % 1'000'000'000 + 1'000'000'000) % 1'000'000'000);
  return text;
}

}  // namespace reident::storage
