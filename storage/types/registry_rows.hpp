// Rows of the registry: attempts, versions, decisions, commands, and how they are selected.
//
// These types hold what a row says and check nothing. Windows are in generation time; all other
// times are those of the clock when the row was made. registry.hpp has the rules that rows follow.
#pragma once

#include <compare>
#include <cstdint>
#include <limits>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "storage/types/telemetry.hpp"

namespace reident::storage {

/// What is recorded of one try to identify a model from a window, whether it gave one or not.
struct NewAttempt {
  std::string spacecraft;
  std::string equipment;
  /// Generation times of the samples that it took.
  TimeRange window;
  /// Why now: "slide", "late telemetry", ...
  std::string trigger;
  /// When it was decided.
  Time time = 0;
  /// "challenger", or the code of the reason that speaks against it.
  std::string outcome;
  /// One sentence for an operator.
  std::string reason;
  /// Scores, coverage, timings: all that the decision looked at.
  std::string evidence_json;
  std::string configuration_digest;
  std::string program_version;
};

/// The model that an attempt gave, as text that is stored as it is and never changed.
struct NewVersion {
  /// Complete and exact: the version can be rebuilt from it alone.
  std::string model_json;
  /// SHA-256 of the model, hexadecimal.
  std::string digest;
  /// Window, parts and options, so that it can be identified again; empty in versions from before
  /// schema 2, as the next one is.
  std::string provenance_json{};
  /// SHA-256 of the samples that it was identified from, hexadecimal.
  std::string samples_digest{};
};

/// What a decision does to a version. `wait` follows nothing but `wait`.
enum class DecisionKind { approve, reject, wait, roll_back, withdraw };
/// The kind as the database holds it, such as "roll_back".
std::string_view name(DecisionKind kind);
/// The kind of that name; absent where no kind has it.
std::optional<DecisionKind> decision_kind(std::string_view name);

/// A decision about a version, before it is recorded.
struct NewDecision {
  DecisionKind kind = DecisionKind::reject;
  /// "gate" or an operator's name.
  std::string actor;
  /// One sentence, in the operator's own words where one decided.
  std::string reason;
  /// What it looked at apart from the attempt; empty: nothing.
  std::string evidence_json{};
};

/// A recorded attempt.
struct Attempt : NewAttempt {
  std::int64_t id = 0;
  /// Number of the version that it gave; absent where it gave none.
  std::optional<std::int64_t> version;
};

/// A recorded version. `status` and `parent` follow from the decisions at the time of reading.
struct Version {
  std::string spacecraft;
  std::string equipment;
  /// Counts the versions of the equipment from 1.
  std::int64_t number = 0;
  /// Id of the attempt that gave it, and that one's window and time.
  std::int64_t attempt = 0;
  TimeRange window;
  Time created = 0;
  std::string model_json;
  std::string digest;
  /// "approved" (champion now), "superseded", "rejected", "waiting", "withdrawn" (for ever).
  std::string status;
  /// Number of the champion that it was judged against; absent where there was none.
  std::optional<std::int64_t> parent;
  std::string provenance_json;
  std::string samples_digest;
};

/// A version without its model, for those who list many. Fields are as in Version.
struct VersionSummary {
  std::int64_t number = 0;
  std::string status;
  std::optional<std::int64_t> parent;
};

/// A recorded decision. Ids ascend in the order of recording, which times need not.
struct Decision : NewDecision {
  std::int64_t id = 0;
  std::string spacecraft;
  std::string equipment;
  std::int64_t version = 0;
  Time time = 0;
};

/// An operator's decision that the champion of an equipment stays, until it is released. A release
/// has the same fields.
struct Hold {
  std::string actor;
  std::string reason;
  /// When it was held, or released.
  Time since = 0;
};

/// What a decision about an equipment is based on. It changes with every decision and hold, so that
/// two equal ones mean that nothing was decided in between.
struct DecisionState {
  /// Ids of the last decision, and of the last hold or release; 0 before the first.
  std::int64_t last_decision = 0;
  std::int64_t last_hold = 0;
  bool operator==(const DecisionState&) const = default;
};

/// Telemetry of one block of an equipment's time, on which versions are scored. Vectors have an
/// entry an output, or an input; all are empty without rows.
struct Block {
  TimeRange range;
  /// Samples that no check excludes, and their share of the block's ticks; a share of 0 where so
  /// many sensor faults were found that others go unnoticed.
  std::int64_t rows = 0;
  double believed = 0;
  /// Means of y and y^2.
  std::vector<double> output_mean;
  std::vector<double> output_square;
  std::vector<double> input_low;
  std::vector<double> input_high;
  /// Mean squared error of the simulator's own model; empty where it sent no telemetry.
  std::vector<double> baseline_square;
};

/// Where a free run has come to, so that it goes on behind a restart to the same bits.
struct RunState {
  /// State of the model at the tick `tick`; absent before the first row.
  std::vector<double> x;
  std::optional<std::int64_t> tick;
  /// Sums of the squared errors over the run's rows so far.
  std::vector<double> square_errors;
  std::int64_t rows = 0;
};

/// What a version's free run erred on one block.
struct BlockScore {
  std::int64_t version = 0;
  Time begin = 0;
  std::int64_t rows = 0;
  /// Means of the error and of its square; an entry an output, not finite where the run is not.
  std::vector<double> mean;
  std::vector<double> square;
  /// The part of `square` that is the sensors' noise.
  std::vector<double> noise;
  /// At the end of the block.
  RunState state;
  /// What biases of the inputs' sensors do to the run, over the bias. For one behind the other: the
  /// mean of the sensor's values, and for each output the means of the effect's square and of its
  /// product with the error. Empty where nobody looked.
  std::vector<double> bias_effects;
};

/// An operator's command. Requester and request identify it: the same pair with the same contents
/// is the same command, sent again.
struct Command {
  /// Unique name of the asking program.
  std::string requester;
  /// The program's count of its commands.
  std::uint64_t request = 0;
  /// What is to be done; the registry keeps the word and gives it no meaning.
  std::string action;
  std::string spacecraft;
  std::string equipment;
  /// 0 where the action names none.
  std::int64_t version = 0;
  /// The operator's name.
  std::string actor;
  std::string reason;
  bool operator==(const Command&) const = default;
};

/// The answer to a command, kept with it.
struct CommandOutcome {
  /// The command was carried out.
  bool ok = false;
  /// What was done, or why not.
  std::string reply;
};

/// A command that was carried out or refused.
struct KeptCommand {
  Command command;
  Time time = 0;
  CommandOutcome outcome;
};

/// The name of an equipment, which is unique within its spacecraft alone.
struct EquipmentName {
  std::string spacecraft;
  std::string equipment;
  auto operator<=>(const EquipmentName&) const = default;
};

/// Something that somebody has to see to. Code, spacecraft and equipment identify it; either name
/// is empty where it is of neither.
struct Alarm {
  std::string code;
  EquipmentName about;
  /// One sentence: what is wrong, and what would mend it.
  std::string text;
  /// When it was raised.
  Time since = 0;
  /// Who has seen it since; empty: nobody.
  std::string acknowledged_by{};
};

/// A change of the equipment, found in the record of its champion.
struct FoundChange {
  std::int64_t champion = 0;
  /// Begin of the first block that it may lie in, and end of the block with which it was found.
  Time since = 0;
  Time found = 0;
};

/// What a simulator does with the models of one equipment, from `time` on.
struct SimulatorState {
  std::string simulator;
  EquipmentName equipment;
  /// Left: nothing below holds any more.
  bool is_there = true;
  /// The version that runs, one that waits to be taken, and the newest that it refused; 0: none.
  std::int64_t version = 0;
  std::int64_t offered = 0;
  std::int64_t refused = 0;
  /// Why it refused that one.
  std::string reason;
  /// "free", "following"; empty: nothing runs.
  std::string mode;
  /// No service has confirmed the version in this run of the simulator.
  bool from_cache = false;
  /// First step on the version, by the simulator's clock.
  Time since = 0;
  /// MRSE that the state before this one had come to; not a number where there was none.
  double error_before_percent = std::numeric_limits<double>::quiet_NaN();
  std::string host;
  std::uint64_t process = 0;
  std::string program_version;
  Time time = 0;
};

/// Which attempts Registry::attempts() returns at once. Empty fields select everything. RowFilter
/// is for more than fit into memory.
struct HistoryFilter {
  std::string spacecraft;
  std::string equipment;
  /// Attempts whose window overlaps it.
  std::optional<TimeRange> window;
  /// Leaves out attempts that gave no model.
  bool versions_only = false;
  /// The newest so many.
  std::optional<std::size_t> last;
};

/// Which rows are read one after the other, by whoever may not hold all of them. Empty fields
/// select everything. To go on where a reading ended, set `beyond` to the last id that was seen.
struct RowFilter {
  std::string spacecraft;
  std::string equipment;
  /// Attempts and versions whose window overlaps it, decisions with a time in it.
  std::optional<TimeRange> range;
  /// Rows of this version alone.
  std::optional<std::int64_t> version;
  /// Descending by id, else ascending.
  bool newest_first = false;
  /// Only rows after this id, in the order that is asked for.
  std::optional<std::int64_t> beyond;
};

}  // namespace reident::storage
