#include "identification/search/closed_loop.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <complex>
#include <functional>
#include <limits>

#include "identification/numerics/decompositions.hpp"
#include "identification/simulation/free_run.hpp"
#include "identification/statistics/feedback.hpp"
#include "identification/subspace/ssarx.hpp"

namespace reident::identification {
namespace {

constexpr Index past = 12;
constexpr Index most_rows = 4096;  // looked at, the last ones
constexpr Index max_order = 6;
/// A figure is certainly above zero where it is so by more than twice its spread over all rows and
/// the halves.
constexpr double certain_spreads = 2;
/// Where the output explains more than this of an input, the sign of its gain needs a proof, and
/// where it explains all, there is none.
constexpr double dominant_share = 0.5, whole_share = 0.98;
constexpr double equal_responses = 0.1;  // relative difference
constexpr double far_more = 3;           // of the responses to a step
constexpr double least_growth = 10;      // logarithm, over the rows: an integrator drifts by less

/// The gain from an input to an output at rest; 0 where it has no meaning.
double gain_of(const StateSpaceModel& model, Index output, Index input) {
  const auto gain = static_gain(model);
  return gain ? (*gain)(output, input) : 0;
}

/// What an output has moved by so many rows after a step of an input by one.
double step_response(const StateSpaceModel& model, Index output, Index input, Index rows) {
  Vector x = Vector::Zero(model.order());
  for (Index t = 0; t < rows; ++t) x = (model.A * x + model.B.col(input)).eval();
  return model.C.row(output).dot(x) + model.D(output, input);
}

std::string poles_of(const StateSpaceModel& model) {
  const ComplexVector poles = eigenvalues(model.A);
  std::vector<std::complex<double>> sorted(poles.begin(), poles.end());
  std::sort(sorted.begin(), sorted.end(), [](const auto& a, const auto& b) {
    return std::abs(a) != std::abs(b) ? std::abs(a) > std::abs(b) : a.imag() > b.imag();
  });
  std::string text;
  for (const std::complex<double>& pole : sorted) {
    if (pole.imag() < 0) continue;
    text += (text.empty() ? "" : ", ") + four_digits(pole.real());
    if (pole.imag() > 0) text += " +- " + four_digits(pole.imag()) + "i";
  }
  return text;
}

/// The outputs that the model makes of the inputs over the normalised rows, in their deviations and
/// from any zero.
Matrix of_inputs(PreparedRows& rows, const Identified& identified) {
  Matrix result = Matrix::Zero(rows.normalised().rows(), rows.outputs());
  result.topRows(rows.fitted().size()) =
      free_run(identified.model, rows.record(), rows.fitted(), identified.x0)(
          Eigen::all, rows.normalisation().outputs);
  for (Index q = 0; q < rows.outputs(); ++q)
    result.col(q) /=
        rows.normalisation().y_scale(rows.normalisation().outputs[static_cast<std::size_t>(q)]);
  return result;
}

/// Each input and output, with such words between them.
std::string pairs_of(const std::vector<Feedback>& feedback, const std::string& between,
                     const PreparedRows& rows) {
  const Normalisation& channels = rows.normalisation();
  std::string who;
  for (const Feedback& one : feedback)
    who += (who.empty() ? "" : ", ") +
           rows.input_name(channels.inputs[static_cast<std::size_t>(one.input)]) + between +
           channel_name("output", channels.outputs[static_cast<std::size_t>(one.output)],
                        rows.options().output_names);
  return who;
}

/// Those of all rows and of each half; fewer where there are too few rows.
std::vector<LoopModel> loop_models(const Record& record, RowRange rows) {
  const Index middle = (rows.begin + rows.end) / 2;
  std::vector<LoopModel> loops;
  for (const RowRange part : {rows, RowRange{rows.begin, middle}, RowRange{middle, rows.end}})
    if (auto loop = loop_model(record, part, past, max_order)) loops.push_back(std::move(*loop));
  return loops;
}

/// Whether a figure of the models is certainly above zero.
bool is_above_zero(const std::vector<LoopModel>& loops,
                   const std::function<double(const StateSpaceModel&)>& figure) {
  std::vector<double> values;
  for (const LoopModel& loop : loops) values.push_back(figure(loop.model));
  const auto [least, greatest] = std::minmax_element(values.begin(), values.end());
  return *least > certain_spreads * (*greatest - *least);
}

/// Whether most values are those of the row before: such an input is a command, and no sensor's.
bool mostly_repeats(const Vector& values, RowRange rows) {
  Index repeats = 0;
  for (Index row = rows.begin + 1; row < rows.end; ++row)
    repeats += values(row) == values(row - 1) ? 1 : 0;
  return 2 * repeats > rows.size();
}

/// The inputs that follow outputs. It warns of commands whose steps an output shows a row before,
/// and leaves them out: its newest row alone shows them, as a model that explains most of it lets
/// expect. It was read later. A controller works against what the output does, or sees more of it.
std::vector<Feedback> followers(PreparedRows& rows, const StateSpaceModel& model,
                                RowRange looked_at, const Matrix& explained,
                                std::vector<std::string>& warnings) {
  const Normalisation& channels = rows.normalisation();
  const Record& record = rows.normalised();
  std::vector<Feedback> feedback = feedback_of(record, looked_at, past, explained);
  if (feedback.empty()) return feedback;
  const std::vector<Feedback> older = feedback_of(record, looked_at, past, explained, 1);
  const auto is_early = [&](const Feedback& one) {
    const double response =
        step_response(model, channels.outputs[static_cast<std::size_t>(one.output)],
                      channels.inputs[static_cast<std::size_t>(one.input)], past);
    const auto of_output = [&](const Matrix& values) -> Vector {
      const auto part = values.col(one.output).segment(looked_at.begin, looked_at.size());
      return part.array() - part.mean();
    };
    const double left = of_output(record.y - explained).squaredNorm();
    return one.rises == (response > 0) &&
           left < (1 - dominant_share) * of_output(record.y).squaredNorm() &&
           mostly_repeats(record.u.col(one.input), looked_at) &&
           std::none_of(older.begin(), older.end(), [&](const Feedback& other) {
             return other.input == one.input && other.output == one.output;
           });
  };
  const auto early = std::stable_partition(feedback.begin(), feedback.end(), std::not_fn(is_early));
  if (early != feedback.end())
    warnings.push_back(
        pairs_of({early, feedback.end()}, " changes up to a row behind ", rows) +
        ": they are not sampled at one time, as where one is read later than the other, "
        "and the model takes them for simultaneous");
  feedback.erase(early, feedback.end());
  return feedback;
}

/// LoopModel::log_variance of what is left of the outputs.
double log_variance_of_rest(const Matrix& y, const Matrix& explained, RowRange rows) {
  const Matrix rest = (y - explained).middleRows(rows.begin, rows.size());
  const Matrix centred = rest.rowwise() - rest.colwise().mean();
  return log_variance(centred.transpose()).value_or(-std::numeric_limits<double>::infinity());
}

}  // namespace

std::optional<Verdict> closed_loop_verdict(PreparedRows& rows, const Identified& identified,
                                           std::vector<std::string>& warnings) {
  const Normalisation& channels = rows.normalisation();
  const Index fitted = rows.fitted().size();
  const RowRange looked_at{std::max<Index>(0, fitted - most_rows), fitted};
  const Record& record = rows.normalised();
  const Matrix explained = of_inputs(rows, identified);
  const std::vector<Feedback> feedback =
      followers(rows, identified.model, looked_at, explained, warnings);
  if (feedback.empty()) return std::nullopt;
  const std::string who = pairs_of(feedback, " follows ", rows);

  if (std::any_of(feedback.begin(), feedback.end(),
                  [](const Feedback& one) { return one.share > whole_share; }))
    return Verdict{VerdictCode::closed_loop,
                   "closed loop: " + who +
                       " and does nothing else: the rows show the controller and not the "
                       "equipment; choose a window in which something else drives the loop, such "
                       "as its reference, and take that as the input"};
  const std::vector<LoopModel> loops = loop_models(record, looked_at);
  if (loops.size() < 3) {
    warnings.push_back("closed loop: " + who +
                       "; the rows are too few to say what the inputs do by themselves");
    return std::nullopt;
  }
  const auto certain = [&loops](const auto& figure) { return is_above_zero(loops, figure); };
  const auto runs_away = [](const LoopModel& loop, Index within) {
    return double(within) * std::log(spectral_radius(loop.model)) > least_growth;
  };
  if (runs_away(loops.front(), looked_at.size()) &&
      log_variance_of_rest(record.y, explained, looked_at) > loops.front().log_variance &&
      certain([](const StateSpaceModel& loop) { return spectral_radius(loop) - 1; }))
    return Verdict{VerdictCode::closed_loop,
                   "closed loop: " + who + "; without that the equipment is unstable (poles " +
                       poles_of(loops.front().model) +
                       "), so that a simulation on its inputs alone runs away; take what drives "
                       "the loop, such as its reference, as the input"};
  std::string compared, sensors;
  bool agree = true;
  for (const Feedback& one : feedback) {
    const Index input = channels.inputs[static_cast<std::size_t>(one.input)];
    const Index output = channels.outputs[static_cast<std::size_t>(one.output)];
    const std::string of_input = rows.input_name(input);
    const std::string of_output = channel_name("output", output, rows.options().output_names);
    const double found = gain_of(identified.model, output, input);
    const auto has_sign = [&](double sign) {
      return certain([&](const StateSpaceModel& loop) {
        return sign * gain_of(loop, one.output, one.input) * found;
      });
    };
    const std::string would_be =
        "the gain from " + of_input + " to " + of_output + " would be " + four_digits(found);
    // What acts at once is no part of the method's model: so the model has to begin so too.
    const bool begins_otherwise =
        !has_sign(1) && found * step_response(identified.model, output, input, past) < 0 &&
        certain([&](const StateSpaceModel& loop) {
          return -found * step_response(loop, one.output, one.input, past);
        });
    if (has_sign(-1) || begins_otherwise)
      return Verdict{VerdictCode::closed_loop,
                     "closed loop: " + who + "; " + would_be +
                         ", which is the controller's: by a method for closed loops " +
                         (has_sign(-1) ? "it has the other sign"
                                       : "a step begins with the other sign, and the rows do not "
                                         "show where it ends") +
                         "; take what drives the loop as the input"};
    if (one.share > dominant_share && !has_sign(1))
      return Verdict{VerdictCode::closed_loop,
                     "closed loop: " + who + " and hardly moves otherwise; " + would_be +
                         ", and nothing shows that this is not the controller's; choose a window "
                         "in which something else drives the loop, and take that as the input"};
    const double unit = channels.y_scale(output) / channels.u_scale(input);
    const Index after = looked_at.size() / 10;
    const double own = step_response(identified.model, output, input, after);
    const double of_loop = unit * step_response(loops.front().model, one.output, one.input, after);
    const auto has_far_more = [&](const LoopModel& loop) {
      const double response = unit * step_response(loop.model, one.output, one.input, after);
      return !runs_away(loop, after) && response * of_loop > 0 &&
             std::abs(response) > far_more * std::abs(own);
    };
    const std::string responses = "; in this model " + of_output + " moves by " + four_digits(own) +
                                  " in the " + std::to_string(after) + " rows after a step of " +
                                  of_input + ", and by " + four_digits(of_loop) +
                                  " by a method for closed loops";
    if (mostly_repeats(record.u.col(one.input), looked_at) &&
        std::all_of(loops.begin(), loops.end(), has_far_more))
      return Verdict{VerdictCode::closed_loop,
                     "closed loop: " + who + responses +
                         ", so that it shows the controller; take what drives the loop, such as "
                         "its reference, as the input"};
    agree = agree && std::abs(own - of_loop) <= equal_responses * std::abs(own);
    sensors += (sensors.empty() ? "the sensor of " : " or that of ") + of_input;
    compared += responses;
  }
  // A worse sensor of an input and a controller look alike. Where it matters, it is a controller.
  warnings.push_back(agree ? who + ", in a closed loop or since " + sensors +
                                 " is worse than it seems; the model is about the same either way" +
                                 compared
                           : "closed loop: " + who + compared);
  return std::nullopt;
}

}  // namespace reident::identification
