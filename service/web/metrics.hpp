// What a monitoring system is told, in Prometheus' text format.
//
// The number of series is bounded by the equipment and the routes, whatever the number of versions:
// a version is a value, never a label.
#pragma once

#include <array>
#include <cstdint>
#include <map>
#include <string>
#include <string_view>
#include <utility>

#include "service/support/mutex.hpp"
#include "service/web/live_state.hpp"
#include "service/web/query_pool.hpp"

namespace reident::web {

/// Text under construction: each metric with its help and type once, before its samples.
class MetricsText {
 public:
  using Labels = std::vector<std::pair<std::string_view, std::string>>;

  /// Begins a metric. `type`: counter, gauge or histogram.
  void begin(std::string_view name, std::string_view type, std::string_view help);
  /// A sample of the metric that was begun; `suffix` is of histograms.
  void add(double value, const Labels& labels = {}, std::string_view suffix = "");
  std::string take() && { return std::move(text_); }

 private:
  std::string text_;
  std::string name_;
};

/// Answers that were given, by route and status. Any thread may call it.
class RequestCounts {
 public:
  void add(std::string_view route, int status, double seconds);
  void put(MetricsText& text) const;

 private:
  static constexpr std::array<double, 8> bounds_s = {0.001, 0.005, 0.02, 0.1, 0.3, 1, 3, 10};
  struct Durations {
    std::array<std::uint64_t, bounds_s.size() + 1> counts{};
    double sum = 0;
  };
  mutable Mutex mutex_;
  std::map<std::pair<std::string, int>, std::uint64_t> answers_ REIDENT_GUARDED_BY(mutex_);
  std::map<std::string, Durations> durations_ REIDENT_GUARDED_BY(mutex_);
};

/// The configured service; absent where it was not heard.
void put_service(MetricsText& text, const std::optional<HeardStatus>& heard);
void put_server(MetricsText& text, const ServerCounts& counts);
void put_files(MetricsText& text, const std::filesystem::path& database);
/// The equipment of the registry, and decisions so far. `overview`: the page's answer.
void put_registry(MetricsText& text, const Stored& stored, const Json& overview,
                  const DecisionCounts& decisions);

}  // namespace reident::web
