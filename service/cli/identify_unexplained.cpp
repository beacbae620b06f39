#include "service/cli/identify_unexplained.hpp"

#include <algorithm>
#include <utility>
#include <variant>
#include <vector>

#include "identification/simulation/free_run.hpp"
#include "identification/statistics/limits.hpp"
#include "identification/statistics/outlying_rows.hpp"
#include "service/cli/identify_screening.hpp"

namespace reident::cli {
namespace {

using identification::Identified;
using identification::Index;
using identification::Matrix;
using identification::RowRange;
using identification::TickRange;
using identification::TickSet;
using identification::Vector;

constexpr int most_passes = 4;
constexpr double rounding = 1e-9;  // of an output

/// From the first row of the identification on, from which a model's state is known.
RowRange run_of(const IdentifyData& data) {
  return {data.identify.begin, std::max(data.identify.end, data.validate.end)};
}

Matrix outputs_of(const IdentifyData& data, const Identified& model) {
  return free_run(model.model, data.record, run_of(data), model.x0);
}

TickSet ticks_of(const IdentifyData& data, const std::vector<Index>& rows) {
  std::vector<TickRange> ticks;
  for (const Index row : rows) {
    const std::int64_t tick = tick_of_row(data.record, run_of(data).begin + row);
    ticks.push_back({tick, tick + 1});
  }
  return identification::united(std::move(ticks));
}

/// The parts of the segments in which no row is `left_out`.
std::vector<RowRange> others(const std::vector<RowRange>& segments,
                             const std::vector<bool>& left_out) {
  std::vector<RowRange> parts;
  for (const RowRange& segment : segments) {
    bool follows = false;
    for (Index row = segment.begin; row < segment.end; ++row) {
      if (left_out[static_cast<std::size_t>(row)]) {
        follows = false;
      } else if (std::exchange(follows, true)) {
        ++parts.back().end;
      } else {
        parts.push_back({row, row + 1});
      }
    }
  }
  return parts;
}

std::vector<LeftOut> unexplained(const IdentifyData& data, const Identified& model) {
  const RowRange run = run_of(data);
  const std::vector<RowRange> segments = ranges_from(data.record, run);
  const Matrix y_hat = outputs_of(data, model);
  std::vector<LeftOut> found;
  for (Index q = 0; q < y_hat.cols(); ++q) {
    const std::string& output = data.outputs[static_cast<std::size_t>(q)];
    const Vector y = data.record.y.col(q).segment(run.begin, run.size());
    const Vector errors = y - y_hat.col(q);
    if (!(errors.norm() > rounding * y.norm())) continue;
    std::vector<bool> is_limited(static_cast<std::size_t>(y.size()), false);
    const auto limits = is_analog(y) ? identification::limits_of(y, y_hat.col(q))
                                     : std::vector<identification::Limit>();
    for (const auto& limit : limits) {
      found.push_back({output, "limit",
                       limit.is_greatest ? "has its greatest value, which the inputs lead beyond,"
                                         : "has its least value, which the inputs lead beyond,",
                       ticks_of(data, limit.rows)});
      for (const Index row : limit.rows) is_limited[static_cast<std::size_t>(row)] = true;
    }
    if (const auto rows = identification::outlying_rows(errors, others(segments, is_limited));
        !rows.empty())
      found.push_back({output, "outlier",
                       "stands out of what the inputs and the rows around explain",
                       ticks_of(data, rows)});
  }
  return found;
}

IdentifyData without_rows(const IdentifyData& whole, const std::vector<LeftOut>& found) {
  IdentifyData rest = whole;
  std::vector<TickRange> all;
  for (const LeftOut& one : found) {
    rest.left_out.push_back(one);
    all.insert(all.end(), one.ticks.begin(), one.ticks.end());
  }
  rest.record = without(whole.record, identification::united(std::move(all)));
  const auto rows = [&](RowRange before) {
    return RowRange{first_row_at(rest.record, tick_of_row(whole.record, before.begin)),
                    first_row_at(rest.record, tick_of_row(whole.record, before.end))};
  };
  rest.identify = rows(whole.identify);
  rest.validate = rows(whole.validate);
  return rest;
}

/// Root mean square over outputs and rows, each output over its own size.
double error_of(const IdentifyData& data, const Identified& model) {
  const RowRange run = run_of(data);
  const Matrix y = data.record.y.middleRows(run.begin, run.size());
  return (y - outputs_of(data, model)).colwise().norm().cwiseQuotient(y.colwise().norm()).norm();
}

}  // namespace

void leave_out_unexplained(IdentifyData& data, Identified& found,
                           const identification::IdentifyOptions& options) {
  std::vector<LeftOut> now = unexplained(data, found), before;
  if (now.empty()) return;
  const IdentifyData whole = data;
  IdentifyData rest = data;
  Identified best = found;
  for (int pass = 0; pass < most_passes && now != before; ++pass) {
    IdentifyData fewer = without_rows(whole, now);
    if (fewer.validate.size() == 0) break;
    auto again = identification::identify(fewer.record, fewer.identify, options);
    auto* better = std::get_if<Identified>(&again);
    if (!better || !(error_of(fewer, *better) < error_of(fewer, best))) break;
    rest = std::move(fewer);
    best = std::move(*better);
    before = std::exchange(now, unexplained(whole, best));
    if (now.empty()) return;
  }
  data = std::move(rest);
  found = std::move(best);
}

}  // namespace reident::cli
