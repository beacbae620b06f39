#include "service/cli/model_comparison.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include <fmt/format.h>

#include "identification/numerics/decompositions.hpp"

namespace reident::cli {
namespace {

using identification::Index;
using identification::Matrix;
using identification::StateSpaceModel;
using identification::Vector;

constexpr Index max_step_samples = 1000;

/// Samples until the slowest mode has fallen to 1 %.
Index settling_samples(const StateSpaceModel& model) {
  const double radius = spectral_radius(model);
  if (radius >= 1) return max_step_samples;
  if (radius <= 0) return 1;
  const double samples = std::ceil(std::log(0.01) / std::log(radius));
  return static_cast<Index>(std::clamp(samples, 1.0, static_cast<double>(max_step_samples)));
}

const Signal* find(const std::vector<Signal>& signals, const std::string& name) {
  const auto found = std::find_if(signals.begin(), signals.end(),
                                  [&name](const Signal& one) { return one.name == name; });
  return found == signals.end() ? nullptr : &*found;
}

std::string described(const Signal& input) {
  return input.expression.empty() ? input.name : input.name + " = " + input.expression;
}

std::vector<std::string> input_differences(const EquipmentModel& a, std::int64_t number_a,
                                           const EquipmentModel& b, std::int64_t number_b) {
  std::vector<std::string> sentences;
  for (const Signal& input : a.inputs) {
    const Signal* other = find(b.inputs, input.name);
    if (other == nullptr)
      sentences.push_back(fmt::format("only version {} has {}", number_a, described(input)));
    else if (other->expression != input.expression || other->unit != input.unit)
      sentences.push_back(fmt::format("version {} has {} [{}] and version {} has {} [{}]", number_a,
                                      described(input), input.unit, number_b, described(*other),
                                      other->unit));
  }
  for (const Signal& input : b.inputs)
    if (find(a.inputs, input.name) == nullptr)
      sentences.push_back(fmt::format("only version {} has {}", number_b, described(input)));
  return sentences;
}

/// Fills one model's side of the channels of its inputs, adding those that are not there yet.
void add_channels(const EquipmentModel& model, const std::vector<double>& times_s,
                  std::optional<double> Channel::*gain, std::vector<double> Channel::*steps,
                  std::vector<Channel>& channels) {
  const Matrix gains =
      static_gain(model.dynamics)
          .value_or(Matrix::Constant(model.dynamics.outputs(), model.dynamics.inputs(), NAN));
  for (std::size_t i = 0; i < model.inputs.size(); ++i) {
    const auto column = static_cast<Index>(i);
    const Matrix response = step_response(model.dynamics, column, times_s);
    for (std::size_t q = 0; q < model.outputs.size(); ++q) {
      const auto row = static_cast<Index>(q);
      const std::string &input = model.inputs[i].name, &output = model.outputs[q].name;
      auto channel = std::find_if(channels.begin(), channels.end(), [&](const Channel& one) {
        return one.input == input && one.output == output;
      });
      if (channel == channels.end())
        channel = channels.insert(channels.end(), {input, output, {}, {}, {}, {}});
      (*channel).*gain = gains(row, column);
      const Vector values = response.row(row).transpose();
      ((*channel).*steps).assign(values.begin(), values.end());
    }
  }
}

}  // namespace

std::vector<Pole> poles_of(const StateSpaceModel& model) {
  std::vector<Pole> poles;
  if (model.order() == 0) return poles;
  for (const std::complex<double>& value : identification::eigenvalues(model.A)) {
    if (value.imag() < 0) continue;
    const double decay = -std::log(std::abs(value));
    const double angle = std::abs(std::arg(value));
    poles.push_back({value,
                     decay > 0 ? model.period_s / decay : std::numeric_limits<double>::infinity(),
                     angle / (2 * std::numbers::pi * model.period_s)});
  }
  std::sort(poles.begin(), poles.end(),
            [](const Pole& a, const Pole& b) { return std::abs(a.value) > std::abs(b.value); });
  return poles;
}

Matrix step_response(const StateSpaceModel& model, Index input,
                     const std::vector<double>& times_s) {
  Matrix response(model.outputs(), static_cast<Index>(times_s.size()));
  Vector x = Vector::Zero(model.order());
  Index sample = 0;  // that x belongs to
  for (std::size_t i = 0; i < times_s.size(); ++i) {
    const auto wanted = static_cast<Index>(std::floor(times_s[i] / model.period_s + 1e-9));
    for (; sample < wanted; ++sample) x = model.A * x + model.B.col(input);
    response.col(static_cast<Index>(i)) = model.C * x + model.D.col(input);
  }
  return response;
}

std::vector<double> step_times(const StateSpaceModel& a, const StateSpaceModel& b) {
  const double period_s = std::min(a.period_s, b.period_s);
  const double settled_s = std::max(static_cast<double>(settling_samples(a)) * a.period_s,
                                    static_cast<double>(settling_samples(b)) * b.period_s);
  std::vector<double> times = {0};
  for (double decade = 1; times.back() < settled_s; decade *= 10)
    for (const double factor : {1.0, 2.0, 5.0})
      if (times.back() < settled_s) times.push_back(factor * decade * period_s);
  return times;
}

ModelComparison compare_models(const EquipmentModel& a, std::int64_t number_a,
                               const EquipmentModel& b, std::int64_t number_b) {
  ModelComparison comparison;
  comparison.poles_a = poles_of(a.dynamics);
  comparison.poles_b = poles_of(b.dynamics);
  comparison.times_s = step_times(a.dynamics, b.dynamics);
  add_channels(a, comparison.times_s, &Channel::gain_a, &Channel::steps_a, comparison.channels);
  add_channels(b, comparison.times_s, &Channel::gain_b, &Channel::steps_b, comparison.channels);
  comparison.input_differences = input_differences(a, number_a, b, number_b);
  return comparison;
}

}  // namespace reident::cli
