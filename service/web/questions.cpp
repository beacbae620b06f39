#include "service/web/questions.hpp"

#include <algorithm>
#include <charconv>

#include <fmt/format.h>

#include "service/model/reasons.hpp"
#include "service/support/floor_divide.hpp"
#include "service/support/text.hpp"
#include "service/support/time_text.hpp"

namespace reident::web {
namespace {

// Years 1823 to 2116: differences of two such times fit in 64 bits.
constexpr storage::Time sane_time = (storage::Time{1} << 62) - 1;
constexpr std::int64_t most_bins = 4000;
constexpr std::int64_t usual_bins = 500;
constexpr storage::Time millisecond = 1'000'000;

storage::Time time_of(const HttpRequest& request, std::string_view name, storage::Time otherwise) {
  const std::string_view text = request.parameter(name);
  if (text.empty()) return otherwise;
  const auto time = parse_time(text);
  if (!time || *time > sane_time || *time < -sane_time)
    throw BadRequest(
        fmt::format("{} {:.60} is no time of the years 1823 to 2116; write it as "
                    "2025-01-31T12:00:00Z",
                    name, text));
  return *time;
}

}  // namespace

storage::EquipmentName equipment_of(const Stored& stored, const HttpRequest& request) {
  const storage::EquipmentName asked{std::string(request.parameter("spacecraft")),
                                     std::string(request.parameter("equipment"))};
  const auto known = stored.history.equipment();
  if (std::find(known.begin(), known.end(), asked) != known.end()) return asked;
  std::vector<std::string> names;
  for (const storage::EquipmentName& one : known)
    names.push_back(one.spacecraft + "/" + one.equipment);
  throw BadRequest(
      fmt::format("there is no equipment {:.80}/{:.80} with attempts; there is {}",
                  asked.spacecraft, asked.equipment, names.empty() ? "none yet" : joined(names)),
      404);
}

storage::SeriesInfo series_of(const Stored& stored, const HttpRequest& request) {
  const std::string_view spacecraft = request.parameter("spacecraft");
  const std::string_view parameter = request.parameter("parameter");
  const std::string_view origin = request.parameter("origin");
  for (storage::SeriesInfo& one : stored.telemetry.series())
    if (one.spacecraft == spacecraft && one.name == parameter &&
        storage::name(one.origin) == (origin.empty() ? "real" : origin))
      return std::move(one);
  throw BadRequest(fmt::format("there is no telemetry of {:.80} {:.80}; /api/v1/series lists what "
                               "there is",
                               spacecraft, parameter),
                   404);
}

StoredVersion version_of(const Stored& stored, const storage::EquipmentName& equipment,
                         const HttpRequest& request) {
  const std::int64_t number = number_of(request, "version", 1, INT64_MAX, 0);
  if (number == 0) throw BadRequest("name the version, as in version=3");
  auto version = stored_version(stored.history, equipment, number);
  if (!version)
    throw BadRequest(fmt::format("{}/{} has no version {}; /api/v1/equipment lists those it has",
                                 equipment.spacecraft, equipment.equipment, number),
                     404);
  return *std::move(version);
}

storage::TimeRange range_of(const HttpRequest& request, storage::TimeRange otherwise) {
  const storage::TimeRange range{time_of(request, "begin", otherwise.begin),
                                 time_of(request, "end", otherwise.end)};
  if (range.begin < range.end) return range;
  throw BadRequest(fmt::format("the range would begin at {} and end at {}; let it end later",
                               time_text(range.begin), time_text(range.end)));
}

std::int64_t number_of(const HttpRequest& request, std::string_view name, std::int64_t least,
                       std::int64_t most, std::int64_t otherwise) {
  const std::string_view text = request.parameter(name);
  if (text.empty()) return otherwise;
  std::int64_t number = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), number);
  if (error != std::errc() || end != text.data() + text.size() || number < least || number > most)
    throw BadRequest(
        fmt::format("{} {:.40} is no whole number from {} to {}", name, text, least, most));
  return number;
}

storage::TimeBins bins_of(const HttpRequest& request, storage::TimeRange range) {
  const std::int64_t count = number_of(request, "bins", 1, most_bins, usual_bins);
  const storage::Time length = (range.end - range.begin) / count;
  return {range, std::max(millisecond, length - length % millisecond)};
}

storage::Time TelemetryClock::place_of(const storage::Decision& decision) {
  if (const auto until = judged_until(decision)) {
    last_ = until;
  } else if (!extent_ || (decision.time >= extent_->begin && decision.time <= extent_->end)) {
    last_ = decision.time;
  } else if (!last_) {
    last_ = decision.time < extent_->begin ? extent_->begin : extent_->end;
  }
  return *last_;
}

}  // namespace reident::web
