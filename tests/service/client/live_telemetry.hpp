// Descriptors and frames for the example model's signals.
#pragma once

#include "tests/service/model/example_model.hpp"

namespace reident::test {

inline std::vector<storage::ParameterDescriptor> example_descriptors() {
  const auto analog = storage::ParameterKind::analog;
  return {{"CBERS4", 1, "I_BDRIN1", "A", "", analog, {}, {}},
          {"CBERS4", 2, "I_BDRIN2", "A", "", analog, {}, {}},
          {"CBERS4", 3, "I_BDROUT", "A", "", analog, {}, {}}};
}

/// Anything with describe().
template <class T>
void describe_all(T& listener) {
  for (const storage::ParameterDescriptor& descriptor : example_descriptors()) {
    listener.describe(descriptor);
  }
}

inline storage::TelemetryFrame frame_at(storage::Time time, std::vector<storage::Sample> samples) {
  return {"CBERS4", "station", storage::Origin::real, 0, time, time, std::move(samples)};
}

/// Smooth inputs within the example model's ranges at tick k.
inline identification::Vector example_input(std::int64_t k) {
  identification::Vector u(2);
  u << 2.5 + 2 * std::sin(0.05 * static_cast<double>(k)),
      1.5 + std::cos(0.03 * static_cast<double>(k));
  return u;
}

/// The example model as the satellite would run it, from rest.
class ExamplePlant {
 public:
  double step(const identification::Vector& u) {
    const auto& dynamics = model_.dynamics;
    const double y = (dynamics.C * x_ + dynamics.D * (u - dynamics.u0) + dynamics.y0)(0);
    x_ = (dynamics.A * x_ + dynamics.B * (u - dynamics.u0)).eval();
    return y;
  }
  /// The frame of tick k at 1 s, with all three parameters.
  storage::TelemetryFrame frame(std::int64_t k) {
    const identification::Vector u = example_input(k);
    const auto good = storage::Quality::good;
    auto frame =
        frame_at(k * 1'000'000'000, {{1, good, u(0)}, {2, good, u(1)}, {3, good, step(u)}});
    frame.sequence = static_cast<std::uint64_t>(k);
    return frame;
  }

 private:
  EquipmentModel model_ = example_model();
  identification::Vector x_ = identification::Vector::Zero(2);
};

}  // namespace reident::test
