// A published model in files that other programs read. README.md says what each of them holds.
#pragma once

#include <filesystem>
#include <optional>
#include <string>

#include "service/model/model_version.hpp"

namespace reident::model_export {

/// A stored version, as it stands when it is exported.
struct ExportedVersion {
  ModelVersion version;
  std::string status;  // "approved", "superseded", "rejected", "waiting" or "withdrawn"
  /// Where a simulation begins, unless its user says otherwise.
  struct Start {
    storage::Time time = 0;
    identification::Vector x;  // n
  };
  std::optional<Start> start = {};  // absent: at rest at the operating point
};

enum class FmiVersion { two, three };  // 2.0, 3.0

/// Returns why the model cannot be exported: its content is damaged, or two of its signals have one
/// name. Empty when it can. What follows requires a model that can be.
std::optional<std::string> obstacle(const ModelVersion& version);

/// Returns one JSON object; "model" in it is what equipment_model_from_json reads.
std::string json_file(const ExportedVersion& exported);

/// Returns a MATLAB file of version 5, made in memory. Throws std::runtime_error where the library
/// fails.
std::string mat_file(const ExportedVersion& exported);

/// Returns an FMU for co-simulation, from the parts in `parts`: linux64/reident_fmu.so and
/// sources/. The same version, of the same status, gives the same bytes. Throws std::runtime_error
/// where a part is missing.
std::string fmu_file(const ExportedVersion& exported, FmiVersion fmi,
                     const std::filesystem::path& parts);

/// Returns the folder of these parts: by the place of the running program, as it was built or
/// installed. Throws std::runtime_error where there is none.
std::filesystem::path fmu_parts();

}  // namespace reident::model_export
