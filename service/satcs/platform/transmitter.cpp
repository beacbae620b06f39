#include "service/satcs/platform/transmitter.hpp"

#include <cmath>

namespace reident::satcs::platform {
namespace {

constexpr double amplifier_rated_C = 25;

}  // namespace

DrivePlan::DrivePlan(const reference::Orbit& orbit, const Constants& constants,
                     const std::vector<reference::LifeEvent>& life, std::uint64_t seed)
    : orbit_(orbit),
      plan_(orbit, constants.plan, life, seed),
      life_(life),
      constants_(constants.transmitter),
      seed_(mix(seed) ^ 0x7478) {}

double DrivePlan::drive_mW(storage::Time time) const {
  if (!plan_.at(time).transmitter && !in_session(time)) return 0;
  const TransmitterConstants& c = constants_;
  const auto hour = static_cast<std::uint64_t>(time / storage::second_ns / 3600);
  const auto step =
      static_cast<std::uint64_t>(static_cast<double>(time / storage::second_ns) / c.step_s);
  const double level =
      c.drive_min_mW + (c.drive_max_mW - c.drive_min_mW) * unit_interval(mix(seed_ ^ hour));
  return level * (1 + c.drive_step * (2 * unit_interval(mix(seed_ + step)) - 1));
}

bool DrivePlan::in_session(storage::Time time) const {
  using reference::LifeKind;
  if (reference::in_mode(life_, LifeKind::safe_mode, time) ||
      reference::in_mode(life_, LifeKind::quiet, time))
    return false;
  const TransmitterConstants& c = constants_;
  const auto count = orbit_.count(time);
  const bool second_half = count.phase >= 0.5;
  const std::uint64_t bits =
      mix(seed_ ^ mix(2 * static_cast<std::uint64_t>(count.number) + (second_half ? 1 : 0)));
  if (unit_interval(bits) >= c.session_probability) return false;
  const double half_s = orbit_.period_s() / 2;
  const double length_s =
      c.session_min_s + (c.session_max_s - c.session_min_s) * unit_interval(mix(bits + 1));
  const double begin_s = (half_s - length_s) * unit_interval(mix(bits + 2));
  const double since_s = (count.phase - (second_half ? 0.5 : 0)) * orbit_.period_s() - begin_s;
  return since_s >= 0 && since_s < length_s;
}

Transmitter::Transmitter(const TransmitterConstants& constants, double step_s)
    : constants_(constants), step_s_(step_s) {}

void Transmitter::step(double drive_mW, double case_C) {
  const AmplifierConstants& c = constants_.amplifier[constants_.in_use];
  drive_mW_ = drive_mW;
  if (!on()) {
    cold_ = 1;
    output_W_ = supply_W_ = 0;
    return;
  }
  const double gain_dB =
      c.gain_dB + c.gain_dB_per_K * (case_C - amplifier_rated_C) - c.warm_up_dB * cold_;
  const double linear_W = 1e-3 * drive_mW * std::pow(10, gain_dB / 10);
  output_W_ = c.saturation_W * std::tanh(linear_W / c.saturation_W);
  supply_W_ = c.quiescent_W * (1 + c.quiescent_per_K * (case_C - amplifier_rated_C)) +
              c.direct_share * output_W_ + c.root_share * std::sqrt(output_W_ * c.saturation_W);
  cold_ *= std::exp(-step_s_ / c.warm_up_s);
}

}  // namespace reident::satcs::platform
