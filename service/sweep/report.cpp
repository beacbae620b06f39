#include "service/sweep/report.hpp"

#include <cmath>

#include "service/sweep/tasks.hpp"

namespace reident::sweep {
namespace {

using nlohmann::ordered_json;

constexpr double same_within = 0.01;

class GeometricMean {
 public:
  void add(double value) {
    sum_ += std::log(value);
    ++count_;
  }
  ordered_json json() const {
    const double mean = std::exp(sum_ / static_cast<double>(count_));
    return std::isfinite(mean) ? ordered_json(mean) : ordered_json();
  }

 private:
  double sum_ = 0;
  std::size_t count_ = 0;
};

}  // namespace

std::optional<ordered_json> report_of(const Plan& plan) {
  ordered_json report = {{"spacecraft", ordered_json::array()}};
  std::size_t windows = 0, equipment = 0, better = 0, worse = 0;
  GeometricMean ratios, would_regret, was_regret;
  for (std::size_t i = 0; i < plan.spacecraft.size(); ++i) {
    auto judged = result_of(plan, {TaskKind::judgement, i});
    if (!judged) return std::nullopt;
    windows += judged->at("windows").get<std::size_t>();
    for (const ordered_json& one : judged->at("equipment")) {
      ++equipment;
      const ordered_json& common = one.at("common");
      if (common.at("would_regret").is_number()) {
        would_regret.add(common.at("would_regret"));
        was_regret.add(common.at("was_regret"));
      }
      const ordered_json& would = common.at("would_mrse_percent");
      const ordered_json& was = common.at("was_mrse_percent");
      if (!would.is_number() || !was.is_number()) continue;
      const double ratio = would.get<double>() / was.get<double>();
      if (!std::isfinite(ratio) || ratio == 0) continue;
      ratios.add(ratio);
      if (ratio < 1 - same_within) ++better;
      if (ratio > 1 + same_within) ++worse;
    }
    for (const char* of_the_file : {"plan", "registry_bytes"}) judged->erase(of_the_file);
    (*judged)["registry"] = plan.registry_of(i).string();
    report["spacecraft"].push_back(*std::move(judged));
  }
  report["windows"] = windows;
  report["equipment"] = equipment;
  report["better"] = better;
  report["worse"] = worse;
  report["error_ratio"] = ratios.json();
  report["would_regret"] = would_regret.json();
  report["was_regret"] = was_regret.json();
  return report;
}

}  // namespace reident::sweep
