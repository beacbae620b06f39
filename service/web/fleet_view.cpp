#include "service/web/fleet_view.hpp"

#include <stdexcept>
#include <vector>

#include "service/fleet/instances.hpp"
#include "service/support/utc_clock.hpp"
#include "service/web/query_pool.hpp"

namespace reident::web {
namespace {

constexpr std::chrono::seconds fresh_for{3};

Json text_value(const std::string& text) {
  return text.empty() ? Json() : Json(text);
}

Json instance_value(const fleet::Instance& one) {
  const auto telemetry = one.oldest_telemetry();
  return {{"instance", one.name},
          {"act", one.needs_action()},
          {"service", one.has_service ? Json(*one.has_service) : Json()},
          {"equipment", one.rows.size()},
          {"with_champion", one.with_champion()},
          {"waiting", one.waiting()},
          {"alarms", one.unseen_alarms()},
          {"telemetry", telemetry ? time_value(*telemetry) : Json()},
          {"note", text_value(one.note())},
          {"page", text_value(one.page)}};
}

}  // namespace

Json FleetView::view() {
  if (!is_there())
    throw BadRequest(
        "this page is of one service: start reident-web with --fleet FOLDER, such as "
        "/etc/reident, for all of a site",
        404);
  const MutexLock lock(mutex_);
  if (read_ && std::chrono::steady_clock::now() < time_ + fresh_for) return *read_;
  WorkerPool one_core(1);
  Json list = Json::array();
  try {
    for (const fleet::Instance& one : fleet::read_instances(folder_, one_core))
      list.push_back(instance_value(one));
  } catch (const std::invalid_argument& error) {
    throw BadRequest(error.what(), 404);
  }
  read_ = Json{{"time", time_value(utc_now())}, {"instances", std::move(list)}};
  time_ = std::chrono::steady_clock::now();
  return *read_;
}

}  // namespace reident::web
