// The page as a whole: which address is answered by what.
#pragma once

#include <filesystem>
#include <functional>

#include "service/config/config.hpp"
#include "service/web/http.hpp"
#include "service/web/live_state.hpp"
#include "service/web/query_pool.hpp"

namespace reident::web {

class Site {
 public:
  /// `live` and `pool` have to outlive it; `counts` are the server's.
  Site(const Config& config, LiveState& live, QueryPool& pool,
       std::function<ServerCounts()> counts);

  /// Answers a request, now or from another thread.
  void handle(HttpRequest&& request, const Respond& respond);

 private:
  HttpResponse service() const;
  HttpResponse readiness(const HttpRequest& request) const;

  const Config& config_;
  LiveState& live_;
  QueryPool& pool_;
  std::function<ServerCounts()> counts_;
};

}  // namespace reident::web
