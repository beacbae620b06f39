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

/// Returns the place of each of `signals` in `declared`; or a sentence that says which is missing
/// there, or has another unit. Requires distinct names in `declared`.
std::variant<std::vector<std::size_t>, std::string> places_of(
    const std::vector<Signal>& signals, const std::vector<DeclaredSignal>& declared);

/// Computes a model's inputs, as deviations from its operating point u0, from the declared ones. A
/// declared input that has the name of a derived one stands for it; otherwise the expression is
/// evaluated, whose parameters must be declared. One thread at a time.
class InputBinding {
 public:
  /// Returns the binding; or a sentence where a signal that the model needs is not declared, or has
  /// another unit. Requires expressions that can be read (version_check.hpp).
  static std::variant<InputBinding, std::string> make(const EquipmentModel& model,
                                                      const std::vector<DeclaredSignal>& declared);

  /// Sets `du` to u - u0 (m values) from the declared ones. Where one is not finite, what du holds
  /// from the call before stays. Returns the sum of REIDENT_INPUT_MISSING and
  /// REIDENT_INPUT_OUTSIDE. Allocates nothing.
  int bind(const double* declared, double* du) {
    if (is_derived_) return bind_any(declared, du);
    double* next = du;
    for (const Input& input : inputs_) {
      const double value = declared[input.place];
      if (!(value >= input.low && value <= input.high)) return bind_any(declared, du);
      *next++ = value - input.u0;
    }
    flagged_ = false;
    return 0;
  }

  /// Flags of one declared input at the last call of bind(), as bind() returns them: those of every
  /// input of the model that it drives.
  int flags(std::size_t declared) const;

 private:
  InputBinding(const EquipmentModel& model, InputExpressions expressions,
               std::vector<std::size_t> places, bool is_derived);
  /// Does what bind() does where inputs are derived, missing or outside.
  int bind_any(const double* declared, double* du);

  struct Input {
    std::size_t place = 0;     // in the declared inputs, where none is derived
    double low = 0, high = 0;  // range that it was identified in
    double u0 = 0;
    std::vector<std::size_t> sources;  // in the declared inputs
    int flags = 0;                     // where any is flagged
  };

  InputExpressions expressions_;
  std::vector<std::size_t> places_;  // in the declared inputs, of each parameter
  std::vector<Input> inputs_;
  bool is_derived_;  // any of them
  identification::Vector parameters_, fresh_;
  bool flagged_ = false;
};

}  // namespace reident
