#include "service/satcs/reference/reference_bus.hpp"

#include <algorithm>
#include <numeric>

namespace reident::satcs::reference {

Bus::Bus(const BusConstants& bus, const ErrorAmplifierConstants& mea, double step_s)
    : bus_(bus), mea_(mea), step_s_(step_s), bus_V_(mea.reference_V), mea_V_(mea.middle_V) {
  corners_V_[0] = mea.bdr_full_V;
  corners_V_[1] = mea.bdr_zero_V;
  for (std::size_t c = 0; c <= shunt_channels; ++c) {
    corners_V_[c + 2] = mea.shunt_first_V + static_cast<double>(c) * mea.shunt_step_V;
  }
}

double Bus::bdr_A(double mea_V, const Demand& demand) const {
  const double share = (mea_.bdr_zero_V - mea_V) / (mea_.bdr_zero_V - mea_.bdr_full_V);
  return demand.bdr_max_A * std::clamp(share, 0.0, 1.0);
}

double Bus::shunting(double mea_V, std::size_t channel) const {
  return std::clamp((mea_V - corners_V_[channel + 2]) / mea_.shunt_step_V, 0.0, 1.0);
}

double Bus::shunt_A(double mea_V, const Demand& demand) const {
  double sum_A = 0;
  for (std::size_t c = 0; c < shunt_channels; ++c) {
    sum_A += demand.channel_A[c] * shunting(mea_V, c);
  }
  return sum_A;
}

Bus::Solution Bus::step(const Demand& demand) {
  Solution s;
  s.array_A = std::accumulate(demand.channel_A.begin(), demand.channel_A.end(), 0.0);

  // At the end of the step V_mea = offset + slope V; the unknown is taken to be V_mea.
  const double slope = mea_.gain * (1 + step_s_ / mea_.integral_s);
  const double offset = mea_.middle_V + integral_V_ - slope * mea_.reference_V;
  const double farad_s = bus_.capacitance_F / step_s_;
  const auto excess_A = [&](double mea_V) {
    const double voltage = (mea_V - offset) / slope;
    return bdr_A(mea_V, demand) + s.array_A - shunt_A(mea_V, demand) - demand.load_A -
           farad_s * (voltage - bus_V_);
  };
  const auto* right = std::partition_point(corners_V_.begin(), corners_V_.end(),
                                           [&](double corner) { return excess_A(corner) > 0; });
  // Two points of the piece that holds the root; the outer pieces go on for ever.
  double low_V = right == corners_V_.begin() ? corners_V_.front() - 1 : *(right - 1);
  double high_V = right == corners_V_.end() ? corners_V_.back() + 1 : *right;
  const double low_A = excess_A(low_V);
  const double high_A = excess_A(high_V);
  double mea_V = low_V + (high_V - low_V) * low_A / (low_A - high_A);

  const double fold_back_mea_V = offset + slope * bus_.fold_back_V;
  const bool brown_out = mea_V < fold_back_mea_V;
  mea_V = std::max(mea_V, fold_back_mea_V);
  s.bdr_A = bdr_A(mea_V, demand);
  s.shunt_A = shunt_A(mea_V, demand);
  for (std::size_t c = 0; c < shunt_channels; ++c) s.shunting[c] = shunting(mea_V, c);
  const double supply_A = s.bdr_A + s.array_A - s.shunt_A;
  if (brown_out) {
    const double available_A = supply_A + farad_s * (bus_V_ - bus_.fold_back_V);
    s.load_share = std::clamp(available_A / demand.load_A, 0.0, 1.0);
  }
  s.capacitor_A = supply_A - s.load_share * demand.load_A;
  const double before_V = bus_V_;
  bus_V_ += s.capacitor_A / farad_s;
  s.capacitor_J = bus_.capacitance_F * (bus_V_ - before_V) * (bus_V_ + before_V) / 2;

  mea_V_ = std::clamp(mea_V, 0.0, mea_.high_rail_V);
  // At a rail the integrator waits.
  integral_V_ = mea_V_ - mea_.middle_V - mea_.gain * (bus_V_ - mea_.reference_V);
  return s;
}

}  // namespace reident::satcs::reference
