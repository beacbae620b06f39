#include "service/cli/identify_outliers.hpp"

#include <algorithm>
#include <utility>
#include <variant>
#include <vector>

#include "identification/simulation/free_run.hpp"
#include "identification/statistics/outlying_rows.hpp"

namespace reident::cli {
namespace {

using identification::Identified;
using identification::Index;
using identification::Matrix;
using identification::Record;
using identification::RowRange;
using identification::TickRange;
using identification::TickSet;

constexpr int most_passes = 4;
constexpr double rounding = 1e-9;  // of an output

/// From the first row of the identification on, from which a model's state is known.
RowRange run_of(const IdentifyData& data) {
  return {data.identify.begin, std::max(data.identify.end, data.validate.end)};
}

Matrix errors_of(const IdentifyData& data, const Identified& model) {
  const RowRange run = run_of(data);
  return data.record.y.middleRows(run.begin, run.size()) -
         free_run(model.model, data.record, run, model.x0);
}

/// By output.
std::vector<TickSet> outliers(const IdentifyData& data, const Identified& model) {
  const RowRange run = run_of(data);
  const std::vector<RowRange> segments = ranges_from(data.record, run);
  const Matrix errors = errors_of(data, model);
  std::vector<TickSet> found;
  for (Index q = 0; q < errors.cols(); ++q) {
    std::vector<TickRange> ticks;
    if (errors.col(q).norm() >
        rounding * data.record.y.col(q).segment(run.begin, run.size()).norm())
      for (const Index row : identification::outlying_rows(errors.col(q), segments)) {
        const std::int64_t tick = tick_of_row(data.record, run.begin + row);
        ticks.push_back({tick, tick + 1});
      }
    found.push_back(identification::united(std::move(ticks)));
  }
  return found;
}

IdentifyData without_rows(const IdentifyData& whole, const std::vector<TickSet>& found) {
  IdentifyData rest = whole;
  std::vector<TickRange> all;
  for (std::size_t q = 0; q < found.size(); ++q) {
    if (found[q].empty()) continue;
    rest.left_out.push_back({whole.outputs[q], "outlier",
                             "stands out of what the inputs and the rows around explain",
                             found[q]});
    all.insert(all.end(), found[q].begin(), found[q].end());
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
  return errors_of(data, model).colwise().norm().cwiseQuotient(y.colwise().norm()).norm();
}

}  // namespace

void leave_out_outliers(IdentifyData& data, Identified& found,
                        const identification::IdentifyOptions& options) {
  std::vector<TickSet> now = outliers(data, found), before;
  const auto are_none = [&now] { return std::ranges::all_of(now, &TickSet::empty); };
  if (are_none()) return;
  const IdentifyData whole = data;
  for (int pass = 0; pass < most_passes && !are_none() && now != before; ++pass) {
    IdentifyData rest = without_rows(whole, now);
    if (rest.validate.size() == 0) return;
    auto again = identification::identify(rest.record, rest.identify, options);
    auto* better = std::get_if<Identified>(&again);
    if (!better || !(error_of(rest, *better) < error_of(rest, found))) return;
    data = std::move(rest);
    found = std::move(*better);
    before = std::exchange(now, outliers(whole, found));
  }
}

}  // namespace reident::cli
