#include "service/satcs/reference/reference_converter.hpp"

namespace reident::satcs::reference {

namespace {
constexpr double converter_rated_C = 25;
}

Converters::Converters(const std::array<ConverterConstants, converter_count>& constants,
                       const ConverterPlateConstants& plate, double step_s)
    : constants_(constants), plate_(plate), step_s_(step_s) {}

double Converters::output_V(std::size_t line, double output_A) const {
  return constants_[line].output_V - constants_[line].output_ohm * output_A;
}

double Converters::input_W(std::size_t line, double output_A) const {
  const ConverterConstants& c = constants_[line];
  const double ohm =
      c.series_ohm * (1 + plate_.series_per_K * (temperature_C_ - converter_rated_C));
  return c.idle_W + (output_V(line, output_A) + c.drop_V + ohm * output_A) * output_A;
}

void Converters::step(double loss_W) {
  const double lost_W = plate_.conductance_W_K * (temperature_C_ - plate_.base_C);
  temperature_C_ += step_s_ * (loss_W - lost_W) / plate_.heat_capacity_J_K;
}

}  // namespace reident::satcs::reference
