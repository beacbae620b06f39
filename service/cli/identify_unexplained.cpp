#include "service/cli/identify_unexplained.hpp"

#include <algorithm>
#include <cstdint>
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

/// What a model does not explain of the data.
struct Unexplained {
  std::vector<LeftOut> rows;
  /// The record with a straight line in place of rows of an input; absent where there are none.
  std::optional<Record> believed;
};

/// A model and the first tick that it was identified from, at which its state is known.
struct Fitted {
  Identified identified;
  std::int64_t first_tick;
};

/// The data without rows, and the model that they give.
struct Explained {
  IdentifyData data;
  Identified identified;
};

/// The rows that a model is identified from or validated on, and what is between.
RowRange run_of(const IdentifyData& data) {
  return {std::min(data.identify.begin, data.validate.begin),
          std::max(data.identify.end, data.validate.end)};
}

Matrix measured(const IdentifyData& data) {
  return data.record.y.middleRows(run_of(data).begin, run_of(data).size());
}

/// `record` has the rows of the data.
Matrix outputs_of(const IdentifyData& data, const Record& record, const Fitted& model) {
  const RowRange run = run_of(data);
  const bool is_known = tick_of_row(record, run.begin) == model.first_tick;
  return free_run(model.identified.model, record, run,
                  is_known ? std::optional(model.identified.x0) : std::nullopt);
}

/// Whether a model leaves anything of an output.
bool has_errors(const Vector& errors, const Vector& y) {
  return errors.norm() > rounding * y.norm();
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

/// Whether the outputs follow the input, but not the rows of it that have a straight line in
/// `without`.
bool are_not_followed(const IdentifyData& data, const Record& without, const Fitted& model,
                      Index input, const std::vector<Index>& rows,
                      const std::vector<RowRange>& segments) {
  const RowRange run = run_of(data);
  Record at_rest = without;
  at_rest.u.col(input).segment(run.begin, run.size()).setConstant(model.identified.model.u0(input));
  const Matrix y = measured(data), y_hat = outputs_of(data, data.record, model);
  const Matrix bridged = outputs_of(data, without, model);
  const Matrix resting = outputs_of(data, at_rest, model);
  std::vector<Index> outputs;
  for (Index q = 0; q < y.cols(); ++q)
    if (has_errors(y.col(q) - y_hat.col(q), y.col(q))) outputs.push_back(q);
  const auto of = [&](const Matrix& a, const Matrix& b) -> Matrix {
    return (a - b)(Eigen::all, outputs);
  };
  const auto [these, rest] = identification::followed(
      of(y, y_hat), {of(y_hat, bridged), of(bridged, resting)}, rows, segments);
  return these.share + certainly * these.deviation < half &&
         rest.share - certainly * rest.deviation > half;
}

/// Without a model, whatever stands out.
Unexplained unexplained_inputs(const IdentifyData& data, const Fitted* model) {
  const RowRange run = run_of(data);
  const std::vector<RowRange> segments = ranges_from(data.record, run);
  Unexplained found;
  for (Index j = 0; j < data.record.u.cols(); ++j) {
    const Vector u = data.record.u.col(j).segment(run.begin, run.size());
    if (!is_analog(u)) continue;
    const std::vector<Index> rows = identification::outlying_rows(u, segments, 0);
    if (rows.empty()) continue;
    const Vector bridged = identification::bridged(u, rows, segments);
    Record without = data.record;
    without.u.col(j).segment(run.begin, run.size()) = bridged;
    if (model && !are_not_followed(data, without, *model, j, rows, segments)) continue;
    leave_out(found.rows, data,
              {data.inputs[static_cast<std::size_t>(j)],
               "unfollowed",
               "stands out where the outputs hardly follow,",
               {}},
              rows);
    if (!found.believed) found.believed = data.record;
    found.believed->u.col(j).segment(run.begin, run.size()) = bridged;
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
std::vector<LeftOut> unexplained_outputs(const IdentifyData& data, const Fitted* model) {
  const std::vector<RowRange> segments = ranges_from(data.record, run_of(data));
  const Matrix all = measured(data);
  const Matrix all_errors = model ? Matrix(all - outputs_of(data, data.record, *model)) : all;
  std::vector<LeftOut> found;
  for (Index q = 0; q < all.cols(); ++q) {
    const std::string& output = data.outputs[static_cast<std::size_t>(q)];
    const Vector y = all.col(q), errors = all_errors.col(q);
    if (!is_analog(y) || !has_errors(errors, y)) continue;
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
Unexplained unexplained(const IdentifyData& data, const Fitted* model) {
  Unexplained found = unexplained_inputs(data, model);
  const std::vector<LeftOut> outputs =
      unexplained_outputs(found.rows.empty() ? data : without_rows(data, found.rows), model);
  found.rows.insert(found.rows.end(), outputs.begin(), outputs.end());
  return found;
}

/// The sum over outputs of the squared errors of a model driven by what is believed of the data,
/// over the squares of the output, both at the ticks that `rest` has too.
double error_of(const IdentifyData& data, const std::optional<Record>& believed,
                const Fitted& model, const IdentifyData& rest) {
  Matrix y = measured(data);
  Matrix errors = y - outputs_of(data, believed ? *believed : data.record, model);
  for (Index row = 0; row < y.rows(); ++row) {
    const std::int64_t tick = tick_of_row(data.record, run_of(data).begin + row);
    const Index there = first_row_at(rest.record, tick);
    if (there < rest.record.rows() && tick_of_row(rest.record, there) == tick) continue;
    errors.row(row).setZero();
    y.row(row).setZero();
  }
  double sum = 0;
  for (Index q = 0; q < y.cols(); ++q)
    if (has_errors(errors.col(q), y.col(q)))
      sum += errors.col(q).squaredNorm() / y.col(q).squaredNorm();
  return sum;
}

/// Whether a model of the rows that are left errs less on them than one of all: driven by these
/// alone, and by the whole record where rows of an input were left out, which the one of all has.
bool errs_less(const Fitted& model, const Fitted& with_all, const IdentifyData& data,
               const Unexplained& left_out, const IdentifyData& rest) {
  const auto is_less = [&](const IdentifyData& rows, const std::optional<Record>& believed) {
    return error_of(rows, believed, model, rest) < error_of(rows, std::nullopt, with_all, rest);
  };
  return is_less(rest, std::nullopt) && (!left_out.believed || is_less(data, left_out.believed));
}

/// Leaves rows out and identifies, until the rows that the model does not explain are the ones that
/// were left out. Absent where that gives no model, or one that errs more than `with_all`, or that
/// explains them.
std::optional<Explained> explained(const IdentifyData& data, Unexplained now,
                                   const Fitted* with_all, const IdentifyOptions& options) {
  for (int pass = 1; !now.rows.empty(); ++pass) {
    IdentifyData fewer = without_rows(data, now.rows);
    if (fewer.validate.size() == 0) break;
    IdentifyResult result = identify(fewer.record, fewer.identify, options);
    auto* found = std::get_if<Identified>(&result);
    if (!found) break;
    Fitted model{std::move(*found), tick_of_row(fewer.record, fewer.identify.begin)};
    if (with_all && !errs_less(model, *with_all, data, now, fewer)) break;
    const std::vector<LeftOut> before = std::move(now.rows);
    now = unexplained(data, &model);
    if (now.rows == before || (pass == most_passes && !now.rows.empty()))
      return Explained{std::move(fewer), std::move(model.identified)};
  }
  return std::nullopt;
}

}  // namespace

IdentifyResult identify_explained(IdentifyData& data, const IdentifyOptions& options) {
  IdentifyResult first = identify(data.record, data.identify, options);
  std::optional<Fitted> with_all;
  std::vector<Unexplained> starts;
  if (const auto* found = std::get_if<Identified>(&first)) {
    with_all = Fitted{*found, tick_of_row(data.record, data.identify.begin)};
    starts = {unexplained(data, &*with_all)};
  } else if (std::get<Verdict>(first).code == VerdictCode::no_better_than_mean) {
    starts = {{unexplained_outputs(data, nullptr), {}}, unexplained(data, nullptr)};
  }
  for (Unexplained& start : starts)
    if (auto better = explained(data, std::move(start), with_all ? &*with_all : nullptr, options)) {
      data = std::move(better->data);
      return std::move(better->identified);
    }
  return first;
}

}  // namespace reident::cli
