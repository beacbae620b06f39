// The page as a whole: which address is answered by what, and to whom.
#pragma once

#include <filesystem>
#include <functional>

#include "service/config/config.hpp"
#include "service/web/access.hpp"
#include "service/web/audit.hpp"
#include "service/web/fleet_view.hpp"
#include "service/web/http.hpp"
#include "service/web/live_state.hpp"
#include "service/web/metrics.hpp"
#include "service/web/orders.hpp"
#include "service/web/query_pool.hpp"

namespace reident::web {

class Site {
 public:
  /// What it is made of; all of it has to outlive it. `counts` are the server's.
  struct Parts {
    const Config& config;
    LiveState& live;
    QueryPool& pool;
    Access& access;
    OrderDesk& orders;
    Audit& audit;
    FleetView& fleet;
    std::function<ServerCounts()> counts;
  };
  explicit Site(Parts parts) : parts_(std::move(parts)) {}

  /// Answers a request, now or from another thread.
  void handle(HttpRequest&& request, Respond respond);

 private:
  void get(HttpRequest&& request, const Respond& respond);
  void post(const HttpRequest& request, const Respond& respond);
  void order(const HttpRequest& request, const Respond& respond);
  void log_in(const HttpRequest& request, const Respond& respond);
  HttpResponse session(const HttpRequest& request) const;
  /// The configured service, or those of its pair, as far as they are heard now.
  std::vector<ServiceStatus> configured_services() const;
  HttpResponse service() const;
  HttpResponse readiness(const HttpRequest& request) const;
  void metrics(bool compressed, const Respond& respond);

  Parts parts_;
  RequestCounts answered_;
};

}  // namespace reident::web
