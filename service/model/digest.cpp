#include <bit>
#include <concepts>
#include <string>
#include <string_view>

#include "service/model/model_json.hpp"
#include "service/support/sha256.hpp"

namespace reident {
namespace {

/// Appends the fields in the canonical encoding of idl/README.md.
class CanonicalEncoder {
 public:
  template <std::unsigned_integral T>
  void put(T value) {
    for (std::size_t byte = 0; byte < sizeof(T); ++byte) {
      bytes_.push_back(static_cast<char>((value >> (8 * byte)) & 0xffU));
    }
  }
  void put(double value) { put(std::bit_cast<std::uint64_t>(value)); }
  void put(std::string_view text) {
    put(static_cast<std::uint32_t>(text.size()));
    bytes_ += text;
  }
  void put(const identification::Matrix& matrix) {
    for (identification::Index row = 0; row < matrix.rows(); ++row) {
      for (identification::Index column = 0; column < matrix.cols(); ++column) {
        put(matrix(row, column));
      }
    }
  }
  void put(const identification::Vector& vector) {
    for (const double value : vector) put(value);
  }
  void put(const std::vector<Signal>& signals) {
    put(static_cast<std::uint32_t>(signals.size()));
    for (const Signal& signal : signals) {
      put(std::string_view(signal.name));
      put(std::string_view(signal.unit));
      put(signal.low);
      put(signal.high);
    }
  }
  const std::string& bytes() const { return bytes_; }

 private:
  std::string bytes_;
};

// What older programs do not know comes last, under a tag, and only where there is any: the digests
// of models without it stay as they are.
void put_expressions(const std::vector<Signal>& inputs, CanonicalEncoder& encoder) {
  if (!has_expressions(inputs)) return;
  encoder.put(std::string_view("expressions"));
  for (const Signal& input : inputs) encoder.put(std::string_view(input.expression));
}

void put_tracking(const identification::TrackingGain& gain, CanonicalEncoder& encoder) {
  encoder.put(std::string_view("tracking"));
  encoder.put(gain.state);
  encoder.put(gain.integral);
  encoder.put(gain.error_limit);
}

}  // namespace

std::string model_digest(const EquipmentModel& model) {
  const identification::StateSpaceModel& dynamics = model.dynamics;
  CanonicalEncoder encoder;
  encoder.put(std::string_view("reident model 1"));
  encoder.put(std::string_view(model.spacecraft));
  encoder.put(std::string_view(model.equipment));
  encoder.put(model.inputs);
  encoder.put(model.outputs);
  encoder.put(dynamics.period_s);
  encoder.put(static_cast<std::uint64_t>(model.hold_ns));
  encoder.put(static_cast<std::uint32_t>(dynamics.order()));
  for (const identification::Matrix* matrix :
       {&dynamics.A, &dynamics.B, &dynamics.C, &dynamics.D}) {
    encoder.put(*matrix);
  }
  encoder.put(static_cast<std::uint32_t>(dynamics.K.size() > 0));
  encoder.put(dynamics.K);
  encoder.put(dynamics.u0);
  encoder.put(dynamics.y0);
  put_expressions(model.inputs, encoder);
  if (model.tracking) put_tracking(model.tracking->gain, encoder);
  return sha256_hex(encoder.bytes());
}

}  // namespace reident
