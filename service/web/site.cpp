#include "service/web/site.hpp"

#include <algorithm>
#include <array>
#include <charconv>
#include <memory>
#include <utility>

#include <fmt/format.h>

#include "service/support/utc_clock.hpp"
#include "service/support/version.hpp"
#include "service/web/page_files.hpp"
#include "service/web/views.hpp"

namespace reident::web {
namespace {

constexpr double fresh_s = 5;  // heartbeats come each second

struct Route {
  std::string_view path;
  Json (*view)(const Stored& stored, const HttpRequest& request);
};
constexpr std::array routes{Route{"/api/v1/overview", overview_view},
                            Route{"/api/v1/waiting", waiting_view},
                            Route{"/api/v1/equipment", equipment_view},
                            Route{"/api/v1/version", version_view},
                            Route{"/api/v1/timeline", timeline_view},
                            Route{"/api/v1/telemetry", telemetry_view},
                            Route{"/api/v1/run", run_view},
                            Route{"/api/v1/events", events_view},
                            Route{"/api/v1/series", series_view},
                            Route{"/api/v1/completeness", completeness_view}};

std::uint64_t revision_in(std::string_view text) {
  std::uint64_t revision = 0;
  std::from_chars(text.data(), text.data() + text.size(), revision);
  return revision;
}

std::uintmax_t size_of(const std::filesystem::path& path) {
  std::error_code error;
  const std::uintmax_t size = std::filesystem::file_size(path, error);
  return error ? 0 : size;
}

HttpResponse text_response(int status, std::string body) {
  HttpResponse response;
  response.status = status;
  response.content_type = "text/plain; charset=utf-8";
  response.body = std::move(body);
  return response;
}

}  // namespace

Site::Site(const Config& config, LiveState& live, QueryPool& pool,
           std::function<ServerCounts()> counts)
    : config_(config), live_(live), pool_(pool), counts_(std::move(counts)) {}

void Site::handle(HttpRequest&& request, const Respond& respond) {
  if (request.is_post)
    return respond(problem(405, "method", "nothing is ordered here: the page only shows"));
  if (request.path == "/livez") return respond(text_response(200, "ok\n"));
  if (request.path == "/readyz") return respond(readiness(request));
  if (request.path == "/api/v1/service") return respond(service());
  if (request.path == "/api/v1/stream")
    return respond(EventStream{revision_in(request.last_event)});
  if (request.path == "/api/v1/changes")
    return respond(json_response(live_.changes_since(revision_in(request.parameter("since")))));
  const auto route = std::find_if(routes.begin(), routes.end(),
                                  [&](const Route& one) { return one.path == request.path; });
  if (route == routes.end()) return respond(page_file(request));
  const bool compressed = request.accepts_gzip;
  const auto asked = std::make_shared<const HttpRequest>(std::move(request));
  pool_.ask([view = route->view,
             asked](const Stored& stored) { return json_response(view(stored, *asked)); },
            compressed, respond);
}

HttpResponse Site::service() const {
  Json services = Json::array();
  for (const auto& [name, heard] : live_.services()) services.push_back(status_value(heard));
  const std::string error = live_.database_error();
  const ServerCounts counts = counts_();
  return json_response({{"time", time_value(utc_now())},
                        {"program_version", program_version()},
                        {"configured",
                         {{"service", config_.service_name},
                          {"domain", config_.domain},
                          {"partition", config_.partition}}},
                        {"services", std::move(services)},
                        {"database",
                         {{"bytes", size_of(config_.database)},
                          {"log_bytes", size_of(config_.database.string() + "-wal")},
                          {"error", error}}},
                        {"page",
                         {{"connections", counts.connections},
                          {"streams", counts.streams},
                          {"refused_connections", counts.refused},
                          {"coalesced", counts.coalesced}}}});
}

HttpResponse Site::readiness(const HttpRequest& request) const {
  const auto services = live_.services();
  const auto heard = services.find(config_.service_name);
  const Json status = heard == services.end() ? Json() : status_value(heard->second);
  const bool is_fresh = status.is_object() && status["age_s"].get<double>() <= fresh_s;
  const std::string database = live_.database_error();
  const std::string failure = is_fresh ? status["last_error"].get<std::string>() : "";
  const bool is_ready = is_fresh && failure.empty() && database.empty();
  if (request.parameter("verbose").empty() && request.query.empty())
    return text_response(is_ready ? 200 : 503, is_ready ? "ok\n" : "not ready\n");
  const auto line = [](bool is_well, std::string_view what, const std::string& why) {
    return fmt::format("[{}] {}{}\n", is_well ? "+" : "-", what, is_well ? " ok" : ": " + why);
  };
  return text_response(
      is_ready ? 200 : 503,
      line(database.empty(), "database", database) +
          line(is_fresh, "heartbeat",
               status.is_object()
                   ? fmt::format("{} is silent for {} s", config_.service_name,
                                 status["age_s"].get<double>())
                   : fmt::format("no service {} in domain {}, partition {}", config_.service_name,
                                 config_.domain, config_.partition)) +
          line(failure.empty(), "service", failure));
}

}  // namespace reident::web
