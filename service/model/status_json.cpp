#include "service/model/status_json.hpp"

#include "service/support/floor_divide.hpp"
#include "service/support/text.hpp"
#include "service/support/time_text.hpp"

namespace reident {
namespace {

using nlohmann::ordered_json;

ordered_json known_time(storage::Time time) {
  return time == 0 ? ordered_json() : ordered_json(time_text(time));
}

ordered_json lag_value(const ServiceStatus& status) {
  return status.lag < 0 ? ordered_json() : ordered_json(status.lag);
}

}  // namespace

bool is_idle(const ServiceStatus& status) {
  return status.queue_length == 0 && status.windows_pending == 0;
}

std::optional<std::int64_t> certificate_days(const ServiceStatus& status) {
  constexpr std::int64_t day = 86'400'000'000'000;
  if (status.certificate_end == 0) return std::nullopt;
  return floor_divide(status.certificate_end - status.time, day);
}

ordered_json status_json(const ServiceStatus& status) {
  ordered_json object = {{"service", status.service},
                         {"program_version", status.program_version},
                         {"started", time_text(status.started)},
                         {"time", time_text(status.time)},
                         {"idle", is_idle(status)}};
  for (const auto& [name, count] : counts(status)) object[name] = count;
  object["newest_telemetry"] = known_time(status.newest_telemetry);
  object["certificate_end"] = known_time(status.certificate_end);
  const auto days = certificate_days(status);
  object["certificate_days"] = days ? ordered_json(*days) : ordered_json();
  object["last_error"] = status.last_error;
  object["failing_champions"] = status.failing_champions;
  object["alarms"] = lines_of(status.alarms);
  object["equipment"] = split_names(status.equipment);
  if (!status.pair.empty())
    object["pair"] = {{"name", status.pair},
                      {"role", status.role},
                      {"term", status.term},
                      {"partner", status.partner},
                      {"lag", lag_value(status)}};
  return object;
}

ordered_json pair_json(const ServiceStatus& status) {
  return {{"service", status.service},
          {"role", status.role},
          {"term", status.term},
          {"lag", lag_value(status)}};
}

}  // namespace reident
