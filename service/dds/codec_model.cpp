#include <algorithm>
#include <cmath>
#include <span>

#include "service/dds/codec.hpp"

namespace reident::dds {
namespace {

using identification::Index;
using identification::Matrix;
using identification::Vector;
using RowMajor = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

template <class Sequence>
Sequence borrow_signals(const std::vector<Signal>& signals, std::vector<reident_Signal>& buffer) {
  buffer.clear();
  for (const Signal& signal : signals) {
    buffer.push_back({borrow(signal.name), borrow(signal.unit), signal.low, signal.high,
                      borrow(signal.expression)});
  }
  return borrow<Sequence>(buffer);
}

/// Copies the numbers of a version and remembers the first that is not usable.
class NumberReader {
 public:
  Matrix matrix(const dds_sequence_double& wire, std::uint64_t rows, std::uint64_t columns,
                const char* field) {
    if (!fault_ && wire._length != rows * columns) {
      fault_ = std::string(field) + " has " + std::to_string(wire._length) + " numbers; " +
               std::to_string(rows) + " x " + std::to_string(columns) + " are due";
    }
    if (fault_) return {};
    const std::span<const double> numbers(wire._buffer, wire._length);
    if (!std::all_of(numbers.begin(), numbers.end(), [](double x) { return std::isfinite(x); })) {
      fault_ = std::string(field) + " has a number that is not finite";
      return {};
    }
    return Eigen::Map<const RowMajor>(wire._buffer, static_cast<Index>(rows),
                                      static_cast<Index>(columns));
  }
  Vector vector(const dds_sequence_double& wire, std::uint64_t size, const char* field) {
    const Matrix column = matrix(wire, size, 1, field);
    return fault_ ? Vector() : Vector(column.col(0));
  }
  /// Infinite and undefined figures are allowed.
  Vector score(const dds_sequence_double& wire, std::uint64_t size, const char* field) {
    if (!fault_ && wire._length != size) {
      fault_ = std::string(field) + " has " + std::to_string(wire._length) +
               " numbers; one is due for an output";
    }
    if (fault_) return {};
    return Eigen::Map<const Vector>(wire._buffer, static_cast<Index>(size));
  }
  const Fault& fault() const { return fault_; }

 private:
  Fault fault_;
};

template <class Sequence>
std::vector<Signal> read_signals(const Sequence& wire, TextReader& texts) {
  std::vector<Signal> signals;
  signals.reserve(wire._length);
  for (const reident_Signal& signal : std::span(wire._buffer, wire._length)) {
    signals.push_back({texts.name(signal.name, "a signal's name"),
                       texts.text(signal.unit, "a signal's unit"), signal.low, signal.high,
                       texts.text(signal.expression, "a signal's expression")});
  }
  return signals;
}

Fault fault_in_signals(const std::vector<Signal>& signals) {
  for (const Signal& signal : signals) {
    if (!std::isfinite(signal.low) || !std::isfinite(signal.high) || signal.low > signal.high) {
      return "the range of " + signal.name + " is not two finite numbers in order";
    }
  }
  return std::nullopt;
}

Fault read_dynamics(const reident_ModelVersion& wire, EquipmentModel& model) {
  const std::uint64_t n = wire.order;
  const std::uint64_t m = model.inputs.size();
  const std::uint64_t p = model.outputs.size();
  identification::StateSpaceModel& dynamics = model.dynamics;
  NumberReader numbers;
  dynamics.A = numbers.matrix(wire.A, n, n, "A");
  dynamics.B = numbers.matrix(wire.B, n, m, "B");
  dynamics.C = numbers.matrix(wire.C, p, n, "C");
  dynamics.D = numbers.matrix(wire.D, p, m, "D");
  if (wire.K._length > 0) dynamics.K = numbers.matrix(wire.K, n, p, "K");
  dynamics.u0 = numbers.vector(wire.input_offset, m, "input_offset");
  dynamics.y0 = numbers.vector(wire.output_offset, p, "output_offset");
  model.validation.mrse_percent = numbers.score(wire.mrse_percent, p, "mrse_percent");
  model.validation.fit_percent = numbers.score(wire.fit_percent, p, "fit_percent");
  return numbers.fault();
}

bool has_tracking(const reident_ModelVersion& wire) {
  return std::max({wire.tracking_state._length, wire.tracking_integral._length,
                   wire.tracking_error_limit._length}) > 0;
}

Fault read_tracking(const reident_ModelVersion& wire, EquipmentModel& model) {
  const std::uint64_t m = model.inputs.size();
  const std::uint64_t p = model.outputs.size();
  EquipmentModel::Tracking tracking;
  NumberReader numbers;
  tracking.gain.state = numbers.matrix(wire.tracking_state, m, wire.order, "tracking_state");
  tracking.gain.integral = numbers.matrix(wire.tracking_integral, m, 2 * p, "tracking_integral");
  tracking.gain.error_limit = numbers.vector(wire.tracking_error_limit, p, "tracking_error_limit");
  tracking.validation = {numbers.score(wire.tracking_mrse_percent, p, "tracking_mrse_percent"),
                         numbers.score(wire.tracking_fit_percent, p, "tracking_fit_percent"),
                         wire.tracking_validation_rows};
  if (!numbers.fault() && tracking.validation.rows < 0) {
    return "the number of validation rows of tracking is negative";
  }
  model.tracking = std::move(tracking);
  return numbers.fault();
}

Fault fault_in_scalars(const ModelVersion& version) {
  const EquipmentModel& model = version.model;
  if (version.number < 1) return "the version's number is below 1";
  if (model.outputs.empty()) return "the model has no output";
  if (!std::isfinite(model.dynamics.period_s) || model.dynamics.period_s <= 0) {
    return "the sample period is not a number of seconds above 0";
  }
  if (model.sample_hold_ns < 1) return "the hold is below 1 ns";
  if (const auto phase = static_cast<double>(model.phase_ns.value_or(0));
      phase < 0 || phase >= model.dynamics.period_s * 1e9) {
    return "the phase is below 0 or not below the sample period";
  }
  if (model.identified_from.end < model.identified_from.begin ||
      model.validated_on.end < model.validated_on.begin) {
    return "a range of time ends before it begins";
  }
  if (model.validation.rows < 0) return "the number of validation rows is negative";
  return std::nullopt;
}

}  // namespace

dds_sequence_double Codec<ModelVersion>::Encoder::lend(const Matrix& matrix) {
  std::vector<double>& buffer = numbers_.emplace_back(static_cast<std::size_t>(matrix.size()));
  Eigen::Map<RowMajor>(buffer.data(), matrix.rows(), matrix.cols()) = matrix;
  return borrow<dds_sequence_double>(buffer);
}

const reident_ModelVersion& Codec<ModelVersion>::Encoder::operator()(const ModelVersion& version) {
  numbers_.clear();
  const EquipmentModel& model = version.model;
  const identification::StateSpaceModel& dynamics = model.dynamics;
  wire_.spacecraft = borrow(model.spacecraft);
  wire_.equipment = borrow(model.equipment);
  // Older programs know neither phase nor expressions nor the gain, nor does their digest.
  wire_.format = model.phase_ns ? 3 : has_expressions(model.inputs) || model.tracking ? 2 : 1;
  wire_.number = version.number;
  wire_.digest = borrow(version.digest);
  wire_.decided_ns = version.decided;
  wire_.decided_by = borrow(version.decided_by);
  wire_.rollback = version.rollback;
  wire_.program_version = borrow(version.program_version);
  wire_.sample_period_s = dynamics.period_s;
  wire_.hold_ns = model.sample_hold_ns;
  wire_.order = static_cast<std::uint32_t>(dynamics.order());
  wire_.inputs = borrow_signals<decltype(wire_.inputs)>(model.inputs, inputs_);
  wire_.outputs = borrow_signals<decltype(wire_.outputs)>(model.outputs, outputs_);
  wire_.A = lend(dynamics.A);
  wire_.B = lend(dynamics.B);
  wire_.C = lend(dynamics.C);
  wire_.D = lend(dynamics.D);
  wire_.K = lend(dynamics.K);
  wire_.input_offset = lend(dynamics.u0);
  wire_.output_offset = lend(dynamics.y0);
  wire_.identified_begin_ns = model.identified_from.begin;
  wire_.identified_end_ns = model.identified_from.end;
  wire_.validated_begin_ns = model.validated_on.begin;
  wire_.validated_end_ns = model.validated_on.end;
  wire_.mrse_percent = lend(model.validation.mrse_percent);
  wire_.fit_percent = lend(model.validation.fit_percent);
  wire_.validation_rows = model.validation.rows;
  wire_.method = borrow(model.method);
  put_tracking(model.tracking.value_or(EquipmentModel::Tracking{}));
  wire_.phase_ns = model.phase_ns.value_or(0);
  return wire_;
}

void Codec<ModelVersion>::Encoder::put_tracking(const EquipmentModel::Tracking& tracking) {
  wire_.tracking_state = lend(tracking.gain.state);
  wire_.tracking_integral = lend(tracking.gain.integral);
  wire_.tracking_error_limit = lend(tracking.gain.error_limit);
  wire_.tracking_mrse_percent = lend(tracking.validation.mrse_percent);
  wire_.tracking_fit_percent = lend(tracking.validation.fit_percent);
  wire_.tracking_validation_rows = tracking.validation.rows;
}

Fault Codec<ModelVersion>::decode(const reident_ModelVersion& wire,
                                  const ReaderOptions& /*options*/, ModelVersion& version) {
  EquipmentModel& model = version.model;
  TextReader texts;
  model.spacecraft = texts.name(wire.spacecraft, "spacecraft");
  model.equipment = texts.name(wire.equipment, "equipment");
  version.number = wire.number;
  version.digest = texts.name(wire.digest, "digest");
  if (wire.format > reident_MODEL_FORMAT) {
    return "the version has format " + std::to_string(wire.format) + " and this program knows " +
           std::to_string(reident_MODEL_FORMAT) + "; update it";
  }
  version.decided = wire.decided_ns;
  version.decided_by = texts.text(wire.decided_by, "decided_by");
  version.rollback = wire.rollback;
  version.program_version = texts.text(wire.program_version, "program_version");
  model.inputs = read_signals(wire.inputs, texts);
  model.outputs = read_signals(wire.outputs, texts);
  model.method = texts.text(wire.method, "method");
  model.dynamics.period_s = wire.sample_period_s;
  model.sample_hold_ns = wire.hold_ns;
  if (wire.phase_ns != 0) model.phase_ns = wire.phase_ns;
  model.identified_from = {wire.identified_begin_ns, wire.identified_end_ns};
  model.validated_on = {wire.validated_begin_ns, wire.validated_end_ns};
  model.validation.rows = wire.validation_rows;
  if (texts.fault()) return texts.fault();
  if (Fault fault = fault_in_scalars(version)) return fault;
  if (Fault fault = fault_in_signals(model.inputs)) return fault;
  if (Fault fault = fault_in_signals(model.outputs)) return fault;
  if (has_expressions(model.outputs)) return "an output has an expression; it must be measured";
  if (Fault fault = read_dynamics(wire, model)) return fault;
  return has_tracking(wire) ? read_tracking(wire, model) : std::nullopt;
}

}  // namespace reident::dds
