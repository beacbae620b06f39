// The daemon's configuration: what it listens to, which equipment it keeps true, and the limits.
// deploy/reident.toml has every key with its default. What is not in the file has its default here;
// one that depends on another key is filled in when the file is read.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "service/model/derived_inputs.hpp"
#include "storage/database/database.hpp"

namespace reident {

/// Nanoseconds; in the file a string with a unit: "500ms", "10s", "90min", "2h", "3d".
using Duration = std::int64_t;

enum class ApprovalPolicy { automatic, by_hand };

/// What becomes of a version that is better than the champion but for a constant, which a biased
/// sensor that no relation binds would show too.
enum class BiasPolicy { wait, approve };

/// What becomes of a champion that errs more than the mean of the outputs, or than the simulator's
/// own model.
enum class FailurePolicy { keep, withdraw };

/// What binds parameters of a spacecraft as long as their sensors read right: a sum of currents
/// at a node, two measurements of one voltage.
struct Relation {
  std::string name;
  std::string expression;  // over SATCS parameters; about 0
  double tolerance = 0;    // in its unit
  bool operator==(const Relation&) const = default;
};

/// One equipment. Shares are of the window's rows; times are nanoseconds.
struct EquipmentConfig {
  std::string name;
  std::vector<std::string> inputs;  // SATCS parameters, or names of derived inputs
  std::vector<DerivedInput> derived;
  int regime_inputs = 0;  // the last so many inputs are those of operating regimes
  std::vector<std::string> outputs;
  Duration sample_period = 0;
  Duration sample_hold = 0;  // default: three sample periods
  /// A tick takes samples of up to so long after it; below sample_period. Absent: as with_phase()
  /// (service/windows/ticks.hpp) finds it.
  std::optional<Duration> phase{};
  Duration window = 0;
  Duration slide = 0;
  double validation_share = 0.3;  // last part of the window, for scores alone
  double tune_share = 0.2;        // the part before it, for choices alone
  double min_coverage = 0.5;      // least share of the window's ticks with every channel valid
  int min_order = 1;
  int max_order = 10;
  std::optional<int> horizon;      // absent: chosen
  Duration cycle = 0;              // of its operation, such as an orbit: errors repeat with it;
                                   // default: the validation part
  int members = 12;                // versions that are scored beside the champion, at most
  double max_mrse_percent = 20;    // of a version
  double margin_percent = 15;      // least reduction of the champion's error
  double confidence_percent = 95;  // 100 less the percentage of champions that may ever give way to
                                   // a version that is not better
  Duration min_interval = 0;       // between two versions; a quarter of slide
  std::optional<double> baseline_mrse_percent;  // error of the simulator's own model, where it
                                                // sends no telemetry
  ApprovalPolicy approval = ApprovalPolicy::automatic;
  BiasPolicy bias = BiasPolicy::wait;
  FailurePolicy on_failure = FailurePolicy::keep;
  bool screening = true;            // whether sensor faults are looked for
  std::vector<Relation> relations;  // the spacecraft's that name a parameter of this equipment
};

/// One spacecraft; names of its equipment are distinct.
struct SpacecraftConfig {
  std::string name;
  std::vector<EquipmentConfig> equipment;
  std::vector<Relation> relations{};
};

/// A whole file that has no mistake.
struct Config {
  std::string service_name = "reident";  // its instance name: in a pair with the strength
  std::string pair;  // name of the pair, the one in the file; empty: it is of none
  int strength = 2;  // 2 or 1: who leads when both start, 2 does
  std::filesystem::path database;
  storage::Durability durability = storage::Durability::power_cut;
  std::uint32_t domain = 0;
  std::string partition = "operations";
  Duration cut = 0;  // the longest cut of the network that loses no telemetry; 0: as DDS has it
  double rate = 0;   // frames a second of a source; known where a cut is
  std::filesystem::path security{};        // folder of the service's files; empty: not secured
  std::size_t queue_frames = 8192;         // bound of the queue between DDS and the archive
  std::size_t queue_mib = 64;              // its bound in memory
  std::size_t batch_frames = 4096;         // frames of one transaction, at most; no more than 5 MiB
  std::size_t recent_samples = 1'000'000;  // that wait for chunks, in memory too
  Duration batch_delay = 0;                // a started batch is committed after this; default 100ms
  std::optional<Duration> keep{};  // older telemetry is removed; absent: none is for its age
  std::optional<std::uint64_t> max_size{};  // bytes; the oldest makes room; absent: none
  std::size_t max_frame_samples = 65536;
  Duration max_clock_lead = 0;  // generation times further ahead of this clock are jumps; 1h
  Duration settle = 0;          // a window waits this long for stragglers; default 1s
  unsigned workers = 1;         // identification threads
  std::string log_level = "info";
  std::vector<SpacecraftConfig> spacecraft;
  std::string digest;  // SHA-256 of the file's bytes, hexadecimal
};

/// One mistake of a file.
struct ConfigMistake {
  std::uint32_t line = 0;  // 1-based; 0 for the file as a whole
  std::string message;     // what is wrong and what would mend it
};

/// Returns the configuration, or every mistake in it, ordered by line; a file that cannot be read
/// is one mistake. A relative database path begins in the file's folder. Throws nothing for what a
/// file holds.
std::variant<Config, std::vector<ConfigMistake>> load_config(const std::filesystem::path& path);

/// As load_config(), for a text; `folder` is where a relative database path begins.
std::variant<Config, std::vector<ConfigMistake>> parse_config(std::string_view text,
                                                              const std::filesystem::path& folder);

/// Returns the ticks that a window of the equipment needs at least: the rows left to the subspace
/// step, after the shares for validation and tuning, must be at least the columns that its 2 s
/// block rows of inputs and outputs ask for.
std::int64_t least_window_ticks(const EquipmentConfig& equipment);

/// Whom commands are for: the service of the configuration, or of its pair whoever leads it then.
inline const std::string& addressee(const Config& config) {
  return config.pair.empty() ? config.service_name : config.pair;
}

}  // namespace reident
