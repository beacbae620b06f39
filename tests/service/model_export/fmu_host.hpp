// A small host of FMUs: unpacks one, loads its binary and calls it as FMI 2.0 says.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "tests/support/temporary_folder.hpp"

extern "C" {
#include "service/model_export/fmu/fmi2.h"
}

namespace reident::test {

/// An FMU in a folder of its own.
class UnpackedFmu {
 public:
  explicit UnpackedFmu(const std::string& bytes);

  const std::filesystem::path& folder() const { return folder_.path(); }
  std::string text(const std::string& name) const;
  void write(const std::string& name, const std::string& content) const;
  std::string resources() const { return "file://" + (folder_ / "resources").string(); }
  /// The one file in binaries/linux64.
  std::filesystem::path binary() const;
  /// Compiles sources/ with the documented command and every warning an error; the new binary.
  std::filesystem::path compiled() const;

 private:
  const TemporaryFolder folder_;
};

/// The functions of a binary, and what it logged.
class FmuBinary {
 public:
  explicit FmuBinary(const std::filesystem::path& path);
  ~FmuBinary();
  FmuBinary(const FmuBinary&) = delete;
  FmuBinary& operator=(const FmuBinary&) = delete;

  decltype(&fmi2GetVersion) get_version;
  decltype(&fmi2GetTypesPlatform) get_types_platform;
  decltype(&fmi2SetDebugLogging) set_debug_logging;
  decltype(&fmi2Instantiate) instantiate;
  decltype(&fmi2FreeInstance) free_instance;
  decltype(&fmi2SetupExperiment) setup_experiment;
  decltype(&fmi2EnterInitializationMode) enter_initialization;
  decltype(&fmi2ExitInitializationMode) exit_initialization;
  decltype(&fmi2Terminate) terminate;
  decltype(&fmi2Reset) reset;
  decltype(&fmi2GetReal) get_real;
  decltype(&fmi2SetReal) set_real;
  decltype(&fmi2GetInteger) get_integer;
  decltype(&fmi2SetString) set_string;
  decltype(&fmi2GetFMUstate) get_state;
  decltype(&fmi2SetFMUstate) set_state;
  decltype(&fmi2FreeFMUstate) free_state;
  decltype(&fmi2SerializedFMUstateSize) serialized_size;
  decltype(&fmi2SerializeFMUstate) serialize;
  decltype(&fmi2DeSerializeFMUstate) deserialize;
  decltype(&fmi2GetDirectionalDerivative) directional_derivative;
  decltype(&fmi2SetRealInputDerivatives) set_input_derivatives;
  decltype(&fmi2GetRealOutputDerivatives) get_output_derivatives;
  decltype(&fmi2DoStep) do_step;
  decltype(&fmi2CancelStep) cancel_step;
  decltype(&fmi2GetStatus) get_status;
  decltype(&fmi2GetRealStatus) get_real_status;
  decltype(&fmi2GetBooleanStatus) get_boolean_status;

  void* symbol(const char* name) const;

 private:
  void* library_;
};

/// One instance of an FMU whose value references are its inputs, then its outputs.
class FmuInstance {
 public:
  /// Instantiates; `component` is null where that was refused.
  FmuInstance(const FmuBinary& binary, const std::string& guid, const std::string& resources,
              std::size_t inputs, std::size_t outputs);
  ~FmuInstance();
  FmuInstance(const FmuInstance&) = delete;
  FmuInstance& operator=(const FmuInstance&) = delete;

  /// To where steps begin.
  void start(double time = 0);
  fmi2Status set(const std::vector<double>& inputs) const;
  std::vector<double> outputs() const;
  /// From the end of the last step.
  fmi2Status step(double seconds);
  /// The last message, and none afterwards.
  std::string logged();

  fmi2Component component = nullptr;
  double time = 0;

 private:
  static void log(fmi2ComponentEnvironment environment, fmi2String instance, fmi2Status status,
                  fmi2String category, fmi2String message, ...);

  const FmuBinary& binary_;
  std::vector<fmi2ValueReference> inputs_, outputs_;
  std::string logged_;
  fmi2CallbackFunctions functions_;  // kept as long as the instance
};

}  // namespace reident::test
