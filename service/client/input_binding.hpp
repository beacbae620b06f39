// From what a simulator supplies to what a model takes.
#pragma once

#include <cstdint>
#include <string>
#include <variant>
#include <vector>

#include "service/model/derived_inputs.hpp"
#include "service/model/model_version.hpp"

namespace reident {

/// An input that a simulator supplies, or an output that it wants.
struct DeclaredSignal {
  std::string name;
  std::string unit;  // empty: any
};

/// The place of each of `signals` in `declared`; or a sentence that says which is missing there, or
/// has another unit.
std::variant<std::vector<std::size_t>, std::string> places_of(
    const std::vector<Signal>& signals, const std::vector<DeclaredSignal>& declared);

/// Computes a model's inputs from the declared ones. A declared input that has the name of a
/// derived one stands for it; otherwise the expression is evaluated, whose parameters must be
/// declared.
class InputBinding {
 public:
  static std::variant<InputBinding, std::string> make(const EquipmentModel& model,
                                                      const std::vector<DeclaredSignal>& declared);

  /// u (m values) from the declared ones. Where one is not finite, what u holds from the call
  /// before stays. Returns the sum of REIDENT_INPUT_MISSING and REIDENT_INPUT_OUTSIDE. Allocates
  /// nothing.
  int bind(const double* declared, double* u) {
    if (is_derived_) return bind_any(declared, u);
    const std::size_t* place = places_.data();
    const double *low = low_.data(), *high = high_.data();
    for (std::size_t i = 0; i < sources_.size(); ++i) {
      const double value = declared[place[i]];
      if (!(value >= low[i] && value <= high[i])) return bind_any(declared, u);
      u[i] = value;
    }
    flagged_ = false;
    return 0;
  }

  /// The same flags of one declared input, at the last call of bind().
  int flags(std::size_t declared) const;

 private:
  InputBinding(const EquipmentModel& model, InputExpressions expressions,
               std::vector<std::size_t> places, bool is_derived);
  /// The same for inputs that are derived, missing or outside.
  int bind_any(const double* declared, double* u);

  InputExpressions expressions_;
  std::vector<std::size_t> places_;                // in the declared inputs, of each parameter
  std::vector<std::vector<std::size_t>> sources_;  // of each model input, in the declared ones
  bool is_derived_;                                // any of them
  std::vector<double> low_, high_;
  identification::Vector parameters_, fresh_;
  std::vector<std::uint8_t> flags_;  // of each model input, where any is flagged
  bool flagged_ = false;
};

}  // namespace reident
