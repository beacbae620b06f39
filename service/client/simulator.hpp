// reident-simulator: the example of a simulator that uses the models of reident. It has no inputs
// of its own: telemetry drives the models, as in a trainer that runs along with the satellite.
#pragma once

#include <chrono>
#include <filesystem>
#include <map>
#include <optional>
#include <stop_token>
#include <string>
#include <vector>

#include "service/client/live_equipment.hpp"
#include "service/client/model_subscriber.hpp"
#include "service/client/simulator_report.hpp"
#include "service/dds/dds.hpp"

namespace reident {

/// What the command line says.
struct SimulatorOptions {
  dds::Endpoint endpoint;
  Subscription subscription;
  std::optional<std::filesystem::path> cache;  // folder of the last good versions; absent: none
  LiveEquipment::Mode mode = LiveEquipment::Mode::free;
  std::chrono::nanoseconds report_period = std::chrono::seconds(5);
  bool json = false;  // of what is printed
};

/// Subscribes, drives each equipment's model with the live telemetry, exchanges versions while they
/// run, reports the running errors and acknowledges what runs. It keeps the newest frames and loses
/// older ones rather than slow the source. All on the thread that calls run().
class Simulator {
 public:
  /// Throws dds::Error.
  explicit Simulator(const SimulatorOptions& options);
  /// Returns once the stop is requested, from any thread. Throws dds::Error.
  void run(const std::stop_token& stop);

 private:
  using Clock = std::chrono::steady_clock;

  void take_telemetry();
  /// Says which of the names that are subscribed to nobody publishes.
  void report_unpublished() const;
  ModelSubscriber::Listener listener();
  /// Makes the equipment's run, or exchanges its version.
  void adopt(const ModelVersion& version, const Arrival& arrival);
  /// Prints and acknowledges each run that went on since the last report.
  void report_running();

  SimulatorOptions options_;
  SimulatorReport report_;
  dds::Participant participant_;
  ModelSubscriber models_;
  dds::Reader<storage::ParameterDescriptor> descriptors_;
  dds::Reader<storage::TelemetryFrame> frames_;
  dds::WaitSet ready_;
  /// By spacecraft and id.
  std::map<std::pair<std::string, std::uint32_t>, storage::ParameterDescriptor> parameters_;
  struct Running {
    LiveEquipment live;
    RunningModel told;                   // as it was when it was adopted
    identification::Index reported = 0;  // ticks that the last report spoke of
  };
  void acknowledge(const storage::EquipmentName& name, Running& running);
  std::map<storage::EquipmentName, Running> equipment_;
};

}  // namespace reident
