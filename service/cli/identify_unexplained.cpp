#include "service/cli/identify_unexplained.hpp"

#include <algorithm>
#include <optional>
#include <utility>
#include <variant>
#include <vector>

#include "identification/simulation/free_run.hpp"
#include "identification/statistics/followed.hpp"
#include "identification/statistics/limits.hpp"
#include "identification/statistics/outlying_rows.hpp"
#include "service/cli/identify_screening.hpp"

namespace reident::cli {
namespace {

using identification::Identified;
using identification::IdentifyOptions;
using identification::IdentifyResult;
using identification::Index;
using identification::Matrix;
using identification::Record;
using identification::RowRange;
using identification::TickRange;
using identification::Vector;
using identification::Verdict;
using identification::VerdictCode;

constexpr int most_passes = 4;
constexpr double rounding = 1e-9;  // of an output
constexpr double half = 0.5;       // of what a model says is followed
constexpr double certainly = 3;    // standard errors

/// From the first row of the identification on, from which a model's state is known.
RowRange run_of(const IdentifyData& data) {
  return {data.identify.begin, std::max(data.identify.end, data.validate.end)};
}

Matrix outputs_of(const IdentifyData& data, const Record& record, const Identified& model) {
  return free_run(model.model, record, run_of(data), model.x0);
}

Matrix errors_of(const IdentifyData& data, const Identified& model) {
  const RowRange run = run_of(data);
  return data.record.y.middleRows(run.begin, run.size()) - outputs_of(data, data.record, model);
}

/// Adds the rows, counted from the first of the run, if there are any.
void leave_out(std::vector<LeftOut>& found, const IdentifyData& data, LeftOut one,
               const std::vector<Index>& rows) {
  if (rows.empty()) return;
  std::vector<TickRange> ticks;
  for (const Index row : rows) {
    const std::int64_t tick = tick_of_row(data.record, run_of(data).begin + row);
    ticks.push_back({tick, tick + 1});
  }
  one.ticks = identification::united(std::move(ticks));
  found.push_back(std::move(one));
}

/// Whether the outputs follow the input, but not these rows of it.
bool are_not_followed(const IdentifyData& data, const Identified& model, Index input,
                      const std::vector<Index>& rows, const std::vector<RowRange>& segments) {
  const RowRange run = run_of(data);
  Record changed = data.record;
  auto u = changed.u.col(input).segment(run.begin, run.size());
  u = identification::bridged(u, rows, segments);
  const Matrix bridged = outputs_of(data, changed, model);
  u.setConstant(model.model.u0(input));
  const Matrix errors = errors_of(data, model);
  const Matrix y_hat = data.record.y.middleRows(run.begin, run.size()) - errors;
  const auto [these, rest] = identification::followed(
      errors, {y_hat - bridged, bridged - outputs_of(data, changed, model)}, rows, segments);
  return these.share + certainly * these.deviation < half &&
         rest.share - certainly * rest.deviation > half;
}

/// Without a model, whatever stands out.
std::vector<LeftOut> unexplained_inputs(const IdentifyData& data, const Identified* model) {
  const RowRange run = run_of(data);
  const std::vector<RowRange> segments = ranges_from(data.record, run);
  std::vector<LeftOut> found;
  for (Index j = 0; j < data.record.u.cols(); ++j) {
    const Vector u = data.record.u.col(j).segment(run.begin, run.size());
    if (!is_analog(u)) continue;
    const std::vector<Index> rows = identification::outlying_rows(u, segments, 0);
    if (!rows.empty() && (!model || are_not_followed(data, *model, j, rows, segments)))
      leave_out(found, data,
                {data.inputs[static_cast<std::size_t>(j)],
                 "spike",
                 "spikes, which the outputs hardly follow,",
                 {}},
                rows);
  }
  return found;
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

/// Without a model, whatever stands out.
std::vector<LeftOut> unexplained_outputs(const IdentifyData& data, const Identified* model) {
  const RowRange run = run_of(data);
  const std::vector<RowRange> segments = ranges_from(data.record, run);
  const Matrix all = data.record.y.middleRows(run.begin, run.size());
  const Matrix all_errors = model ? errors_of(data, *model) : all;
  std::vector<LeftOut> found;
  for (Index q = 0; q < all.cols(); ++q) {
    const std::string& output = data.outputs[static_cast<std::size_t>(q)];
    const Vector y = all.col(q), errors = all_errors.col(q);
    if (!is_analog(y) || !(errors.norm() > rounding * y.norm())) continue;
    std::vector<bool> is_limited(static_cast<std::size_t>(y.size()), false);
    const auto limits =
        model ? identification::limits_of(y, y - errors) : std::vector<identification::Limit>();
    for (const auto& limit : limits) {
      leave_out(found, data,
                {output,
                 "limit",
                 limit.is_greatest ? "has its greatest value, which the inputs lead beyond,"
                                   : "has its least value, which the inputs lead beyond,",
                 {}},
                limit.rows);
      for (const Index row : limit.rows) is_limited[static_cast<std::size_t>(row)] = true;
    }
    leave_out(found, data,
              {output, "outlier", "stands out of what the inputs and the rows around explain", {}},
              identification::outlying_rows(errors, others(segments, is_limited)));
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

/// Without a model, whatever stands out.
std::vector<LeftOut> unexplained(const IdentifyData& data, const Identified* model) {
  std::vector<LeftOut> found = unexplained_inputs(data, model);
  const std::vector<LeftOut> outputs =
      unexplained_outputs(found.empty() ? data : without_rows(data, found), model);
  found.insert(found.end(), outputs.begin(), outputs.end());
  return found;
}

/// The sum over outputs of the squared errors at the ticks that `other` has too, over the squares
/// of the output there.
double error_of(const IdentifyData& data, const Identified& model, const IdentifyData& other) {
  const RowRange run = run_of(data);
  Matrix errors = errors_of(data, model), y = data.record.y.middleRows(run.begin, run.size());
  for (Index row = 0; row < run.size(); ++row) {
    const std::int64_t tick = tick_of_row(data.record, run.begin + row);
    const Index there = first_row_at(other.record, tick);
    if (there < other.record.rows() && tick_of_row(other.record, there) == tick) continue;
    errors.row(row).setZero();
    y.row(row).setZero();
  }
  return errors.colwise().squaredNorm().cwiseQuotient(y.colwise().squaredNorm()).sum();
}

}  // namespace

IdentifyResult identify_explained(IdentifyData& data, const IdentifyOptions& options) {
  const IdentifyResult first = identify(data.record, data.identify, options);
  const auto* with_all = std::get_if<Identified>(&first);
  if (!with_all && std::get<Verdict>(first).code != VerdictCode::no_better_than_mean) return first;
  std::vector<LeftOut> now = unexplained(data, with_all), before;
  std::optional<IdentifyData> rest;
  std::optional<Identified> best;
  for (int pass = 0; pass < most_passes && now != before; ++pass) {
    if (now.empty()) return first;
    IdentifyData fewer = without_rows(data, now);
    if (fewer.validate.size() == 0) break;
    IdentifyResult again = identify(fewer.record, fewer.identify, options);
    auto* found = std::get_if<Identified>(&again);
    if (!found) break;
    if (with_all && !(error_of(fewer, *found, data) < error_of(data, *with_all, fewer))) break;
    best = std::move(*found);
    rest = std::move(fewer);
    before = std::exchange(now, unexplained(data, &*best));
  }
  if (!best || now.empty()) return first;
  data = *std::move(rest);
  return *std::move(best);
}

}  // namespace reident::cli
