// The samples of a window, straight from the archive onto the grid of identification.
#pragma once

#include <string>
#include <variant>
#include <vector>

#include "identification/record.hpp"
#include "service/daemon/config.hpp"
#include "service/model/model_version.hpp"
#include "storage/archive.hpp"

namespace reident {

/// What is read and how it is put on the grid; an equipment's configuration and a published model
/// both say it.
struct WindowRequest {
  std::string spacecraft;
  std::vector<std::string> inputs;  // parameter names
  std::vector<std::string> outputs;
  Duration period = 0;
  Duration hold = 0;
  storage::Origin origin = storage::Origin::real;
  bool operator==(const WindowRequest&) const = default;
};

WindowRequest request_of(const std::string& spacecraft, const EquipmentConfig& equipment);
WindowRequest request_of(const EquipmentModel& model);

struct WindowData {
  identification::Record record;
  std::vector<storage::ParameterDescriptor> inputs;
  std::vector<storage::ParameterDescriptor> outputs;
  double coverage = 0;  // share of the window's ticks at which every channel is valid
};

/// A parameter that telemetry has not described yet, so that nobody knows its samples.
struct UnknownParameter {
  std::string name;
};

/// The descriptors of the request's parameters, and no rows.
std::variant<WindowData, UnknownParameter> describe_window(const storage::Archive& archive,
                                                           const WindowRequest& request);

/// Share of the window's ticks that are rows of the record.
double coverage_of(const identification::Record& record, storage::TimeRange window,
                   Duration period);

/// Samples of quality good or out of limits count; suspect and invalid ones are holes.
std::variant<WindowData, UnknownParameter> load_window(const storage::Archive& archive,
                                                       const WindowRequest& request,
                                                       storage::TimeRange window);

/// Time of a row of a record with this period.
storage::Time time_of_row(const identification::Record& record, identification::Index row,
                          Duration period);

}  // namespace reident
