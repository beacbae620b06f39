// The DC/DC converters of the secondary lines, and the plate that they warm.
//
//   V_out = V_0 - R_out I_out
//   P_in  = V_out I_out + idle + drop I_out + R(T) I_out^2
#pragma once

#include <array>

#include "service/satcs/reference/reference_constants.hpp"

namespace reident::satcs::reference {

/// The three converters, in steps of `step_s` [s]. A line is numbered from 0: 5 V, 15 V, 12 V.
class Converters {
 public:
  using Lines = std::array<double, converter_count>;

  Converters(const std::array<ConverterConstants, converter_count>& constants,
             const ConverterPlateConstants& plate, double step_s);
  void age(const std::array<ConverterConstants, converter_count>& constants) {
    constants_ = constants;
  }

  /// Output voltage of a line at a current.
  double output_V(std::size_t line, double output_A) const;
  /// What the converter takes [W] to give a current.
  double input_W(std::size_t line, double output_A) const;

  /// The losses of one step warm the plate.
  void step(double loss_W);

  double temperature_C() const { return temperature_C_; }

 private:
  std::array<ConverterConstants, converter_count> constants_;
  ConverterPlateConstants plate_;
  double step_s_;
  double temperature_C_ = 28;
};

}  // namespace reident::satcs::reference
