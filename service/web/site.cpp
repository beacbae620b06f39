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

using SteadyClock = std::chrono::steady_clock;

struct Route {
  std::string_view path;
  Json (*view)(const Stored& stored, const HttpRequest& request);
};
constexpr std::array routes{
    Route{"/api/v1/waiting", waiting_view},     Route{"/api/v1/equipment", equipment_view},
    Route{"/api/v1/version", version_view},     Route{"/api/v1/timeline", timeline_view},
    Route{"/api/v1/telemetry", telemetry_view}, Route{"/api/v1/run", run_view},
    Route{"/api/v1/events", events_view},       Route{"/api/v1/simulators", simulators_view},
    Route{"/api/v1/series", series_view},       Route{"/api/v1/completeness", completeness_view},
    Route{"/api/v1/gaps", gaps_view},           Route{"/api/v1/excluded", excluded_view},
    Route{"/api/v1/commands", commands_view}};

constexpr std::array<std::string_view, 12> others = {
    "/page.js",         "/page.css",      "/api/v1/overview", "/api/v1/service",
    "/api/v1/session",  "/api/v1/orders", "/api/v1/changes",  "/api/v1/stream",
    "/api/v1/refusals", "/api/v1/login",  "/api/v1/logout",   "/api/v1/fleet"};

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

/// The route for counts: paths that are not known are one.
std::string route_of(const std::string& path) {
  const bool is_known = path == "/" || path == "/metrics" || path == "/livez" ||
                        path == "/readyz" ||
                        std::any_of(routes.begin(), routes.end(),
                                    [&path](const Route& one) { return one.path == path; }) ||
                        std::find(others.begin(), others.end(), path) != others.end();
  return is_known ? path : "other";
}

HttpResponse text_response(int status, std::string body) {
  HttpResponse response;
  response.status = status;
  response.content_type = "text/plain; charset=utf-8";
  response.body = std::move(body);
  return response;
}

}  // namespace

void Site::handle(HttpRequest&& request, Respond respond) {
  const auto begun = SteadyClock::now();
  const std::string route = route_of(request.path);
  const Respond counted = [this, begun, route, respond = std::move(respond)](Answer answer) {
    const auto* response = std::get_if<HttpResponse>(&answer);
    answered_.add(route, response ? response->status : 200,
                  std::chrono::duration<double>(SteadyClock::now() - begun).count());
    respond(std::move(answer));
  };
  request.is_post ? post(request, counted) : get(std::move(request), counted);
}

void Site::get(HttpRequest&& request, const Respond& respond) {
  if (request.path == "/livez") return respond(text_response(200, "ok\n"));
  if (request.path == "/readyz") return respond(readiness(request));
  if (request.path == "/metrics") return metrics(request.accepts_gzip, respond);
  if (request.path == "/api/v1/service") return respond(service());
  if (request.path == "/api/v1/overview")
    return parts_.pool.ask(
        [this](const Stored& stored) {
          return json_response(overview_view(stored, parts_.config, configured_services()));
        },
        request.accepts_gzip, respond);
  if (request.path == "/api/v1/fleet")
    return parts_.pool.ask([this](const Stored&) { return json_response(parts_.fleet.view()); },
                           request.accepts_gzip, respond);
  if (request.path == "/api/v1/session") return respond(session(request));
  if (request.path == "/api/v1/refusals") return respond(json_response(parts_.audit.last()));
  if (request.path == "/api/v1/stream")
    return respond(EventStream{revision_in(request.last_event)});
  if (request.path == "/api/v1/changes")
    return respond(
        json_response(parts_.live.changes_since(revision_in(request.parameter("since")))));
  const auto route = std::find_if(routes.begin(), routes.end(),
                                  [&](const Route& one) { return one.path == request.path; });
  if (route == routes.end()) return respond(page_file(request));
  const bool compressed = request.accepts_gzip;
  const auto asked = std::make_shared<const HttpRequest>(std::move(request));
  parts_.pool.ask([view = route->view,
                   asked](const Stored& stored) { return json_response(view(stored, *asked)); },
                  compressed, respond);
}

void Site::post(const HttpRequest& request, const Respond& respond) {
  if (auto refusal = parts_.access.refusal(request)) {
    parts_.audit.add({.code = "origin", .peer = request.peer, .action = request.path}, utc_now());
    return respond(*std::move(refusal));
  }
  if (request.path == "/api/v1/login") return log_in(request, respond);
  if (request.path == "/api/v1/orders") return order(request, respond);
  if (request.path != "/api/v1/logout")
    return respond(problem(404, "not_found", "nothing is posted here"));
  parts_.access.log_out(request);
  respond(json_response({{"ok", true}}));
}

void Site::log_in(const HttpRequest& request, const Respond& respond) {
  const Json body = Json::parse(request.body, nullptr, false);
  const auto text = [&body](const char* key) {
    return body.is_object() && body.contains(key) && body[key].is_string()
               ? body[key].get<std::string>()
               : std::string();
  };
  const bool is_secure = request.is_secure || request.origin.starts_with("https:");
  parts_.orders.later(
      [this, name = text("name"), password = text("password"), peer = request.peer, is_secure] {
        const auto login = parts_.access.log_in(name, password, SteadyClock::now());
        if (const auto* failure = std::get_if<Access::NoLogin>(&login)) {
          parts_.audit.add({.code = "login", .user = name, .peer = peer}, utc_now());
          return *failure == Access::NoLogin::too_often
                     ? problem(429, "too_often", "this name was wrong too often; wait a minute")
                     : problem(403, "login", "name or password is wrong");
        }
        HttpResponse response = json_response({{"ok", true}});
        response.headers.emplace_back("Set-Cookie",
                                      "reident_session=" + std::get<std::string>(login) +
                                          "; Path=/; HttpOnly; SameSite=Strict; Max-Age=43200" +
                                          (is_secure ? "; Secure" : ""));
        return response;
      },
      respond);
}

void Site::order(const HttpRequest& request, const Respond& respond) {
  Refused refused{.code = "", .user = "", .peer = request.peer};
  const auto refuse = [this, &refused, &respond](int status, const char* code,
                                                 std::string_view why) {
    refused.code = code;
    parts_.audit.add(refused, utc_now());
    respond(problem(status, code, why));
  };
  const auto account = parts_.access.who(request);
  if (!account) return refuse(401, "nobody", "nobody is logged in: only accounts may order");
  refused.user = account->name;
  PageOrder order;
  try {
    order = read_order(request.body, account->name);
  } catch (const BadRequest& mistake) {
    return refuse(400, "order", mistake.what());
  }
  storage::Command& command = order.command;
  refused.action = command.action;
  refused.spacecraft = command.spacecraft;
  refused.equipment = command.equipment;
  refused.version = std::to_string(command.version);
  if (request.token != parts_.access.token(request))
    return refuse(403, "token",
                  "the page is from before the server began; ask for the token again");
  const auto role = role_for(command.action);
  if (!role) return refuse(400, "action", "there is no such action");
  if (!account->may(*role, command.spacecraft))
    return refuse(403, "role",
                  fmt::format("{} is {} and may not {} for {}", account->name, name(account->role),
                              command.action, command.spacecraft));
  parts_.pool.ask(
      [this, order, refused](const Stored& stored) mutable {
        const auto champion =
            stored.history.champion_decision({order.command.spacecraft, order.command.equipment});
        if (!order.champion || *order.champion == (champion ? champion->version : 0))
          return HttpResponse();
        refused.code = "stale";
        parts_.audit.add(refused, utc_now());
        return problem(
            409, "stale",
            champion ? fmt::format("version {} is champion since {}, by {}; what the "
                                   "form showed is past: open it again",
                                   champion->version, time_text(champion->time), champion->actor)
                     : "there is no champion any more; open the form again");
      },
      false,
      [this, command, respond](Answer answer) {
        if (std::get<HttpResponse>(answer).status == 200)
          parts_.orders.send(command, respond);
        else
          respond(std::move(answer));
      });
}

HttpResponse Site::session(const HttpRequest& request) const {
  const auto account = parts_.access.who(request);
  return json_response({{"user", account ? Json(account->name) : Json()},
                        {"role", account ? Json(name(account->role)) : Json()},
                        {"spacecraft", account ? Json(account->spacecraft) : Json::array()},
                        {"token", parts_.access.token(request)},
                        {"has_passwords", parts_.access.has_passwords()},
                        {"has_fleet", parts_.fleet.is_there()}});
}

void Site::metrics(bool compressed, const Respond& respond) {
  parts_.pool.ask(
      [this](const Stored& stored) {
        MetricsText text;
        const auto services = parts_.live.services();
        const auto heard = services.find(parts_.config.service_name);
        put_service(text, heard == services.end() ? std::nullopt : std::optional(heard->second));
        put_files(text, parts_.config.database);
        put_registry(text, stored, overview_view(stored, parts_.config, configured_services()),
                     parts_.live.decisions());
        put_server(text, parts_.counts());
        answered_.put(text);
        HttpResponse response = text_response(200, std::move(text).take());
        response.content_type = "text/plain; version=0.0.4; charset=utf-8";
        return response;
      },
      compressed, respond);
}

std::vector<ServiceStatus> Site::configured_services() const {
  const Config& config = parts_.config;
  std::vector<ServiceStatus> services;
  for (const auto& [name, one] : parts_.live.services()) {
    const bool is_configured =
        config.pair.empty() ? name == config.service_name : one.status.pair == config.pair;
    if (is_configured && one.is_fresh()) services.push_back(one.status);
  }
  return services;
}

HttpResponse Site::service() const {
  Json services = Json::array();
  for (const auto& [name, heard] : parts_.live.services()) services.push_back(status_value(heard));
  const std::string error = parts_.live.database_error();
  const ServerCounts counts = parts_.counts();
  return json_response({{"time", time_value(utc_now())},
                        {"program_version", program_version()},
                        {"configured",
                         {{"service", parts_.config.service_name},
                          {"domain", parts_.config.domain},
                          {"partition", parts_.config.partition}}},
                        {"services", std::move(services)},
                        {"database",
                         {{"bytes", size_of(parts_.config.database)},
                          {"log_bytes", size_of(parts_.config.database.string() + "-wal")},
                          {"error", error}}},
                        {"page",
                         {{"connections", counts.connections},
                          {"streams", counts.streams},
                          {"refused_connections", counts.refused},
                          {"coalesced", counts.coalesced}}}});
}

HttpResponse Site::readiness(const HttpRequest& request) const {
  const auto services = parts_.live.services();
  const auto heard = services.find(parts_.config.service_name);
  const Json status = heard == services.end() ? Json() : status_value(heard->second);
  const bool is_fresh = heard != services.end() && heard->second.is_fresh();
  const std::string database = parts_.live.database_error();
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
               status.is_object() ? fmt::format("{} is silent for {} s", parts_.config.service_name,
                                                status["age_s"].get<double>())
                                  : fmt::format("no service {} in domain {}, partition {}",
                                                parts_.config.service_name, parts_.config.domain,
                                                parts_.config.partition)) +
          line(failure.empty(), "service", failure));
}

}  // namespace reident::web
