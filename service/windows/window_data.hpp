// The samples of a window, straight from the archive onto the grid of identification.
#pragma once

#include <string>
#include <variant>
#include <vector>

#include "identification/samples/record.hpp"
#include "identification/samples/tick_ranges.hpp"
#include "service/config/config.hpp"
#include "service/model/model_version.hpp"
#include "storage/types/sample_reader.hpp"

namespace reident {

/// What counts as most, for the rule that decides on versions (service/DESIGN.md, "Constants that
/// are not configured").
inline constexpr double most = 0.5;

/// What is read and how it is put on the grid; an equipment's configuration and a published model
/// both say it.
struct WindowRequest {
  std::string spacecraft;
  std::vector<std::string> inputs;    // names of parameters or of derived inputs
  std::vector<DerivedInput> derived;  // of the inputs
  std::vector<std::string> outputs;   // names of parameters
  Duration period = 0;                // of the grid, whose ticks are multiples of it since 1970
  Duration sample_hold = 0;           // how long a sample serves
  Duration phase = 0;                 // a tick has the values that are known so long after it
  storage::Origin origin = storage::Origin::real;
  bool operator==(const WindowRequest&) const = default;
};

/// Returns the request of real telemetry. Two that are equal give comparable samples.
WindowRequest request_of(const std::string& spacecraft, const EquipmentConfig& equipment);
WindowRequest request_of(const EquipmentModel& model);

/// Returns the parameters that the equipment's signals are, or are computed from, and those that
/// are bound to them by relations; each once.
std::vector<std::string> parameters_of(const EquipmentConfig& equipment);
/// Returns those that a relation binds.
std::vector<std::string> parameters_of(const Relation& relation);
/// Returns those of the equipment's relations that apply: telemetry has described all that they
/// bind. Throws storage::Error.
std::vector<Relation> applying_relations(const storage::SampleReader& archive,
                                         const std::string& spacecraft,
                                         const EquipmentConfig& equipment);
/// Parameters of the equipment that none of these binds: a bias of their sensors goes unnoticed.
std::vector<std::string> unbound_parameters(const EquipmentConfig& equipment,
                                            const std::vector<Relation>& relations);

/// A parameter as telemetry describes it.
struct Channel {
  std::string name;
  std::uint32_t id = 0;
  bool is_analog = true;
  bool operator==(const Channel&) const = default;
};

/// A range of time that is excluded.
struct Implausible {
  std::string check;                    // "relation", "shift", "fill", "stuck", "spike" or "noise"
  Relation relation;                    // of the first two
  std::vector<std::string> parameters;  // one of which is wrong
  identification::TickRange ticks;
  double residual = 0;  // the relation's median there
};

/// What the checks found in a window.
struct Plausibility {
  std::vector<Implausible> found;
  std::vector<std::string> not_applied;  // relations, each with the reason
  std::vector<Relation> applied;
  identification::TickSet holes;  // all that was found
};

/// The samples of a window, and what they are.
struct WindowData {
  identification::Record record;
  std::vector<Signal> inputs, outputs;  // as they are described; their ranges are not set
  std::vector<Channel> input_channels;  // that the inputs are computed from
  std::vector<Channel> output_channels;
  Plausibility plausibility;  // of a WindowCache with checks: its holes are not in the record
  double coverage = 0;        // share of the window's ticks that have a row
  double read_coverage = 0;   // before holes were made of what is excluded
  bool outputs_move = false;  // of a WindowCache: any, in the whole window, before that
  /// One for each bias that was asked for, at the rows of the ticks that were: u is by how much the
  /// inputs are above those without it, over the bias, and y (N x 1) are the sensor's values.
  std::vector<identification::Record> bias_effects;
};

/// A parameter that telemetry has not described yet, so that nobody knows its samples.
struct UnknownParameter {
  std::string name;
};

/// Returns what the request's signals and parameters are, and no rows; the first parameter that has
/// no descriptor. Requires expressions that can be read. Throws storage::Error, as all that read
/// here.
std::variant<WindowData, UnknownParameter> describe_window(const storage::SampleReader& archive,
                                                           const WindowRequest& request);

/// Returns the rows at which every channel of the request is valid; u holds the input channels.
/// `described` is of the same request. The sample hold before the window is read too.
identification::Record load_samples(const storage::SampleReader& archive,
                                    const WindowRequest& request, const WindowData& described,
                                    storage::TimeRange window);

/// Returns the share of the window's ticks that are rows of the record, 0 to 1.
double coverage_of(const identification::Record& record, storage::TimeRange window,
                   Duration period);

/// A parameter and the share of a window's ticks at which it has a value, 0 to 1.
struct ParameterCoverage {
  std::string parameter;
  double coverage = 0;
};

/// Returns the parameter of the request that has a value at the fewest ticks of the window.
/// `described` is of the same request.
ParameterCoverage least_covered(const storage::SampleReader& archive, const WindowRequest& request,
                                const WindowData& described, storage::TimeRange window);

/// Returns the window's rows, nothing excluded. Samples of a usable quality count; all others are
/// holes, and so are ticks at which a derived input has no finite value.
std::variant<WindowData, UnknownParameter> load_window(const storage::SampleReader& archive,
                                                       const WindowRequest& request,
                                                       storage::TimeRange window);

/// Returns the ticks of this period in `range`: tick k is at k * period.
identification::TickRange ticks_of(storage::TimeRange range, Duration period);

/// Returns the time of a row of a record with this period. Requires a row of the record.
storage::Time time_of_row(const identification::Record& record, identification::Index row,
                          Duration period);

}  // namespace reident
