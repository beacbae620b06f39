// The samples of a window, straight from the archive onto the grid of identification.
#pragma once

#include <string>
#include <variant>
#include <vector>

#include "identification/record.hpp"
#include "service/daemon/config.hpp"
#include "service/model/model_version.hpp"
#include "storage/sample_source.hpp"

namespace reident {

/// What is read and how it is put on the grid; an equipment's configuration and a published model
/// both say it.
struct WindowRequest {
  std::string spacecraft;
  std::vector<std::string> inputs;    // names of parameters or of derived inputs
  std::vector<DerivedInput> derived;  // of the inputs
  std::vector<std::string> outputs;   // names of parameters
  Duration period = 0;
  Duration hold = 0;
  storage::Origin origin = storage::Origin::real;
  bool operator==(const WindowRequest&) const = default;
};

WindowRequest request_of(const std::string& spacecraft, const EquipmentConfig& equipment);
WindowRequest request_of(const EquipmentModel& model);

/// The parameters that the equipment's signals are, or are computed from, each once.
std::vector<std::string> parameters_of(const EquipmentConfig& equipment);

struct WindowData {
  identification::Record record;
  std::vector<Signal> inputs, outputs;    // as they are described; their ranges are not set
  std::vector<std::uint32_t> parameters;  // ids of those that the inputs are computed from
  std::vector<std::uint32_t> output_parameters;
  double coverage = 0;  // share of the window's ticks at which every channel is valid
};

/// A parameter that telemetry has not described yet, so that nobody knows its samples.
struct UnknownParameter {
  std::string name;
};

/// What the request's signals and parameters are, and no rows.
std::variant<WindowData, UnknownParameter> describe_window(const storage::SampleSource& archive,
                                                           const WindowRequest& request);

/// Share of the window's ticks that are rows of the record.
double coverage_of(const identification::Record& record, storage::TimeRange window,
                   Duration period);

/// Samples of quality good or out of limits count; suspect and invalid ones are holes, and so are
/// ticks at which a derived input has no finite value.
std::variant<WindowData, UnknownParameter> load_window(const storage::SampleSource& archive,
                                                       const WindowRequest& request,
                                                       storage::TimeRange window);

/// Time of a row of a record with this period.
storage::Time time_of_row(const identification::Record& record, identification::Index row,
                          Duration period);

}  // namespace reident
