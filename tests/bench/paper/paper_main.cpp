// One line of the paper's table: an equipment identified, corrected by pole placement, and
// corrected by integral feedback, each scored on rows that nothing was chosen on.
//
// The rows between those that identify and those that validate are the ones to tune on. Prints one
// JSON object, and draws the first rows that validate where it is asked to.

#include <cstdio>
#include <fstream>
#include <optional>
#include <string>

#include <CLI/CLI.hpp>
#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "identification/correction/integral_feedback_search.hpp"
#include "identification/correction/pole_placement_search.hpp"
#include "identification/search/identify.hpp"
#include "identification/simulation/free_run.hpp"
#include "identification/simulation/scores.hpp"
#include "service/cli/identify_data.hpp"
#include "tests/bench/paper/paper_picture.hpp"

namespace {

using namespace reident::identification;
using nlohmann::ordered_json;
using reident::cli::DataRequest;
using reident::cli::IdentifyData;

struct Parts {
  RowRange identify, tune, validate;
};

IdentifyData data_of(const DataRequest& request) {
  auto read = reident::cli::read_data(request);
  if (const auto* refusal = std::get_if<reident::cli::Refusal>(&read))
    throw std::runtime_error(refusal->message);
  return std::get<IdentifyData>(std::move(read));
}

Score validated(const Record& record, const Parts& parts, RowRange run, const Matrix& y_hat) {
  return score(record.y.middleRows(parts.validate.begin, parts.validate.size()),
               y_hat.middleRows(parts.validate.begin - run.begin, parts.validate.size()));
}

/// The picture of the first rows that validate.
class Drawing {
 public:
  static constexpr Index most_rows = 18'000;  // three orbits of the reference spacecraft

  Drawing(const IdentifyData& data, const Parts& parts, const std::string& unit)
      : begin_(parts.validate.begin), rows_(std::min(most_rows, parts.validate.size())) {
    const Record& record = data.record;
    const Segment first = segments_within(record, parts.validate).front();
    rows_ = std::min(rows_, first.size());
    const auto time = [&](Index row) { return double(first.first_tick + row) * record.period_s; };
    picture_.output = data.outputs.front();
    picture_.unit = unit;
    picture_.range = {static_cast<std::int64_t>(time(0) * 1e9),
                      static_cast<std::int64_t>(time(rows_) * 1e9)};
    picture_.x = Vector::LinSpaced(rows_, 0, time(rows_ - 1) - time(0));
    picture_.y = record.y.col(0).segment(begin_, rows_);
  }

  /// `y_hat` begins with the row `run_begin` of the record.
  void add(const char* style, const char* name, const Matrix& y_hat, Index run_begin,
           const Score& error) {
    picture_.runs.push_back(
        {style, name, y_hat.col(0).segment(begin_ - run_begin, rows_), error.mrse()});
  }

  void write(const std::string& file, const std::string& title) {
    picture_.title = title;
    std::ofstream out(file);
    out << svg_of(picture_);
    if (!out.flush()) throw std::runtime_error(file + " cannot be written");
  }

 private:
  Index begin_, rows_;
  reident::bench::PaperPicture picture_;
};

ordered_json corrected(const StateSpaceModel& model, const Record& record, const Parts& parts) {
  const CorrectionSearch search = search_correction(model, record, parts.identify, parts.tune);
  if (!search.best)
    return {{"mrse_percent", nullptr}, {"reason", "no scale lowers the error to tune by 1 %"}};
  const RowRange run{parts.identify.begin, parts.validate.end};
  const Score error = validated(record, parts, run, free_run(search.best->model, record, run));
  return {{"mrse_percent", error.mrse()},
          {"fit_percent", error.fit()},
          {"scale", search.best->scale},
          {"keeps_static_gain", search.best->keeps_static_gain},
          {"tune_mrse_percent", search.best->error.mrse()},
          {"plain_tune_mrse_percent", search.plain.mrse()}};
}

ordered_json tracked(const StateSpaceModel& model, const Record& record, const Parts& parts,
                     Drawing& drawing) {
  const auto found = search_tracking(model, record, parts.identify, parts.tune);
  if (const auto* verdict = std::get_if<Verdict>(&found))
    return {{"mrse_percent", nullptr}, {"reason", verdict->reason}};
  const auto& search = std::get<TrackingSearch>(found);
  const RowRange run{parts.tune.begin, parts.validate.end};
  const Matrix y_hat = tracked_run(model, search.gain, record, run);
  const Score error = validated(record, parts, run, y_hat);
  drawing.add("following", "the model with integral feedback", y_hat, run.begin, error);
  return {{"mrse_percent", error.mrse()},
          {"fit_percent", error.fit()},
          {"scale", search.scale},
          {"tau_samples", search.tau_samples}};
}

/// Each output as it was a sample before: what says nothing of an equipment and foretells it all
/// the same, wherever it moves slowly.
ordered_json last_sample(const Record& record, const Parts& parts) {
  Matrix y_hat = record.y;
  for (const Segment& segment : record.segments)
    y_hat.middleRows(segment.begin + 1, segment.size() - 1) =
        record.y.middleRows(segment.begin, segment.size() - 1);
  const Score error = validated(record, parts, record.all(), y_hat);
  return {{"mrse_percent", error.mrse()}, {"fit_percent", error.fit()}};
}

/// The outputs of the simulator's own telemetry, whose rows are those of the real one.
ordered_json baseline(DataRequest request, const std::string& file, const IdentifyData& real,
                      const Parts& parts, Drawing& drawing) {
  request.file = file;
  const IdentifyData simulated = data_of(request);
  if (simulated.record.segments != real.record.segments)
    throw std::runtime_error(file + ": its rows are not at the times of the telemetry's");
  const Score error = validated(real.record, parts, real.record.all(), simulated.record.y);
  drawing.add("simulator", "the hand-written simulator", simulated.record.y, 0, error);
  return {{"mrse_percent", error.mrse()}, {"fit_percent", error.fit()}};
}

ordered_json line(const DataRequest& request, const std::string& baseline_file,
                  const std::string& picture_file, const std::string& unit) {
  const IdentifyData data = data_of(request);
  const Parts parts{data.identify, {data.identify.end, data.validate.begin}, data.validate};
  if (parts.tune.size() <= 0) throw std::runtime_error("no rows to tune on");
  const auto result = identify(data.record, parts.identify, {});
  if (const auto* verdict = std::get_if<Verdict>(&result))
    throw std::runtime_error(verdict->reason);
  const auto& identified = std::get<Identified>(result);
  const StateSpaceModel& model = identified.model;
  Drawing drawing(data, parts, unit);
  ordered_json json = {{"order", model.order()},
                       {"rows",
                        {{"identify", parts.identify.size()},
                         {"tune", parts.tune.size()},
                         {"validate", parts.validate.size()}}}};
  json["baseline"] = baseline_file.empty() ? ordered_json()
                                           : baseline(request, baseline_file, data, parts, drawing);
  const RowRange run{parts.identify.begin, parts.validate.end};
  const Matrix y_hat = free_run(model, data.record, run, identified.x0);
  const Score error = validated(data.record, parts, run, y_hat);
  drawing.add("identified", "the identified model, running freely", y_hat, run.begin, error);
  json["identified"] = {{"mrse_percent", error.mrse()}, {"fit_percent", error.fit()}};
  json["pole_placement"] = corrected(model, data.record, parts);
  json["integral_feedback"] = tracked(model, data.record, parts, drawing);
  json["last_sample"] = last_sample(data.record, parts);
  if (!picture_file.empty())
    drawing.write(picture_file, data.outputs.front() + ", three orbits that nothing was chosen on");
  return json;
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App app("One line of the paper's table", "reident_paper_bench");
  DataRequest request;
  request.screening = false;  // rows of two files stand beside each other
  std::string baseline_file, picture_file, unit;
  app.add_option("file", request.file, "CSV file of telemetry")->required();
  app.add_option("--input", request.inputs)->required();
  app.add_option("--output", request.outputs)->required();
  app.add_option("--derive", request.derive)->allow_extra_args(false);
  app.add_option("--time", request.reading.time.column);
  app.add_option("--period", request.period_s);
  app.add_option("--identify", request.identify)->required();
  app.add_option("--validate", request.validate)->required();
  app.add_option("--baseline", baseline_file, "the simulator's own telemetry at the same times");
  app.add_option("--picture", picture_file, "SVG file to draw to");
  app.add_option("--unit", unit, "of the output, for the picture");
  CLI11_PARSE(app, argc, argv);
  try {
    fmt::print("{}\n", line(request, baseline_file, picture_file, unit).dump());
    return 0;
  } catch (const std::exception& error) {
    fmt::print(stderr, "reident_paper_bench: {}\n", error.what());
    return 1;
  }
}
