#include "service/operations/commands.hpp"

#include <algorithm>
#include <array>
#include <set>
#include <variant>

#include <fmt/format.h>

#include "service/dds/wire.hpp"
#include "service/model/reasons.hpp"
#include "service/support/text.hpp"
#include "service/support/time_text.hpp"

namespace reident {
namespace {

using storage::Command;
using storage::CommandOutcome;
using storage::Decision;
using storage::DecisionKind;
using storage::EquipmentName;
using storage::Registry;
using storage::Version;

/// A command whose equipment is known.
struct Order {
  const Command& command;
  Registry& registry;
  const CommandContext& context;
  const EquipmentName& equipment;
  const storage::Time now;

  const std::string& spacecraft() const { return equipment.spacecraft; }
  const std::string& name() const { return equipment.equipment; }
  std::string full_name() const { return reident::full_name(equipment); }
  storage::NewDecision decision(DecisionKind kind) const {
    return {kind, command.actor, command.reason};
  }
  void decide(std::int64_t version, DecisionKind kind) const {
    registry.decide(spacecraft(), name(), version, decision(kind), now);
  }
  storage::Hold hold() const { return {command.actor, command.reason, now}; }
};

CommandOutcome refused(std::string why) {
  return {false, std::move(why)};
}
CommandOutcome done(std::string what) {
  return {true, std::move(what)};
}

/// "approved by Ana at 2026-11-21T15:00:00Z".
std::string text(const Decision& decision) {
  return fmt::format("{} by {} at {}", past(decision.kind), decision.actor,
                     time_text(decision.time));
}

std::string champion_text(const std::optional<Decision>& made) {
  return made ? fmt::format("version {} is champion now ({})", made->version, text(*made))
              : "there is no champion now";
}

/// What became of a version, who decided so and when: "was rejected by gate at ...".
std::string fate(const Order& order, const Version& version) {
  const auto decisions = order.registry.decisions(order.spacecraft(), order.name(), version.number);
  const auto champion = order.registry.champion_decision(order.spacecraft(), order.name());
  // Nothing follows a withdrawal, so the last decision is the one that counts.
  const std::string last = text(decisions.back());
  if (version.status == "approved") return fmt::format("is the champion, {}", last);
  if (version.status == "superseded")
    return fmt::format("was {}; {}", last, champion_text(champion));
  return fmt::format("was {}", last);
}

std::variant<Version, CommandOutcome> named_version(const Order& order) {
  if (order.command.version == 0)
    return refused(fmt::format("{} needs the number of a version", order.command.action));
  if (auto version =
          order.registry.version(order.spacecraft(), order.name(), order.command.version))
    return *std::move(version);
  storage::HistoryFilter newest;
  newest.spacecraft = order.spacecraft();
  newest.equipment = order.name();
  newest.versions_only = true;
  newest.last = 1;
  const auto attempts = order.registry.attempts(newest);
  return refused(fmt::format(
      "{} has no version {}: {}", order.full_name(), order.command.version,
      attempts.empty() ? "it has none yet" : fmt::format("its last is {}", *attempts[0].version)));
}

std::optional<CommandOutcome> refuse_what_does_not_wait(const Order& order,
                                                        const Version& version) {
  if (version.status == "waiting") return std::nullopt;
  return refused(fmt::format("version {} of {} is not waiting: it {}", version.number,
                             order.full_name(), fate(order, version)));
}

/// Rejects the versions that the approval of this one answers. Returns their numbers.
std::vector<std::string> answer_superseded(const Order& order, std::int64_t approved) {
  Decision of_approved;
  of_approved.spacecraft = order.spacecraft();
  of_approved.equipment = order.name();
  of_approved.version = approved;
  std::vector<std::string> answered;
  for (const Decision& other : waiting_for_operator(order.registry)) {
    if (!supersedes(of_approved, other)) continue;
    order.registry.decide(order.spacecraft(), order.name(), other.version,
                          {DecisionKind::reject, order.command.actor,
                           fmt::format("superseded: version {} was approved", approved)},
                          order.now);
    answered.push_back(fmt::format("version {}", other.version));
  }
  return answered;
}

CommandOutcome approve(const Order& order) {
  const auto named = named_version(order);
  if (const auto* refusal = std::get_if<CommandOutcome>(&named)) return *refusal;
  const Version& version = std::get<Version>(named);
  if (auto refusal = refuse_what_does_not_wait(order, version)) return *refusal;
  if (const auto hold = order.registry.hold(order.spacecraft(), order.name()))
    return refused(hold_text(order.equipment, *hold) + ": release it first");
  const auto champion = order.registry.champion(order.spacecraft(), order.name());
  const std::vector<std::string> answered = answer_superseded(order, version.number);
  order.decide(version.number, DecisionKind::approve);
  std::string what = fmt::format("version {} of {} is approved and champion now, {}",
                                 version.number, order.full_name(),
                                 champion ? fmt::format("after version {}", champion->number)
                                          : "the first since there was none");
  if (!answered.empty())
    what += fmt::format("; {} that waited before it {} rejected", joined(answered),
                        answered.size() > 1 ? "are" : "is");
  return done(std::move(what));
}

CommandOutcome reject(const Order& order) {
  const auto named = named_version(order);
  if (const auto* refusal = std::get_if<CommandOutcome>(&named)) return *refusal;
  const Version& version = std::get<Version>(named);
  if (auto refusal = refuse_what_does_not_wait(order, version)) return *refusal;
  order.decide(version.number, DecisionKind::reject);
  return done(fmt::format("version {} of {} is rejected", version.number, order.full_name()));
}

CommandOutcome roll_back_to(const Order& order, const Version& version) {
  const auto from = order.registry.champion_decision(order.spacecraft(), order.name());
  order.decide(version.number, DecisionKind::roll_back);
  const std::string what =
      from ? fmt::format("{} is rolled back from version {} to version {}", order.full_name(),
                         from->version, version.number)
           : fmt::format("{} is rolled back to version {}", order.full_name(), version.number);
  if (order.registry.hold(order.spacecraft(), order.name())) return done(what + " and stays held");
  return done(fmt::format("{}; new windows go on and may replace it: 'reident hold {}' prevents it",
                          what, order.full_name()));
}

CommandOutcome roll_back(const Order& order) {
  if (order.command.version == 0) {
    const auto made = order.registry.champion_decision(order.spacecraft(), order.name());
    if (!made)
      return refused(
          fmt::format("{} has no champion to roll back from: name the version to roll "
                      "back to",
                      order.full_name()));
    const auto previous = order.registry.previous_champion(order.spacecraft(), order.name());
    if (previous) return roll_back_to(order, *previous);
    return refused(
        fmt::format("{} cannot be rolled back: version {}, {}, follows no champion that is left",
                    order.full_name(), made->version, text(*made)));
  }
  const auto named = named_version(order);
  if (const auto* refusal = std::get_if<CommandOutcome>(&named)) return *refusal;
  const Version& version = std::get<Version>(named);
  if (version.status == "superseded") return roll_back_to(order, version);
  return refused(fmt::format("{} cannot be rolled back to version {}: it {}{}", order.full_name(),
                             version.number, fate(order, version),
                             version.status == "rejected" || version.status == "waiting"
                                 ? " and was never champion"
                                 : ""));
}

CommandOutcome withdraw(const Order& order) {
  const auto named = named_version(order);
  if (const auto* refusal = std::get_if<CommandOutcome>(&named)) return *refusal;
  const Version& version = std::get<Version>(named);
  if (version.status != "approved" && version.status != "superseded")
    return refused(fmt::format("version {} of {} cannot be withdrawn: it {}{}", version.number,
                               order.full_name(), fate(order, version),
                               version.status == "withdrawn" ? "" : " and was never champion"));
  order.decide(version.number, DecisionKind::withdraw);
  const auto champion = order.registry.champion_decision(order.spacecraft(), order.name());
  const std::string what =
      fmt::format("version {} of {} is withdrawn", version.number, order.full_name());
  if (!champion)
    return done(what +
                " and no champion is left: simulators that start now get none, those that run keep "
                "what they have until the next version");
  return done(fmt::format("{}; version {} is champion {}", what, champion->version,
                          version.status == "approved" ? "again" : "as before"));
}

CommandOutcome hold(const Order& order) {
  if (const auto held = order.registry.hold(order.spacecraft(), order.name()))
    return refused(fmt::format("{} is held already by {} since {}{}", order.full_name(),
                               held->actor, time_text(held->since), reason_text(held->reason)));
  order.registry.put_on_hold(order.spacecraft(), order.name(), order.hold());
  const auto champion = order.registry.champion_decision(order.spacecraft(), order.name());
  return done(fmt::format("{} keeps {} until 'reident release {}'", order.full_name(),
                          champion ? fmt::format("version {}", champion->version) : "no champion",
                          order.full_name()));
}

CommandOutcome release(const Order& order) {
  const auto held = order.registry.hold(order.spacecraft(), order.name());
  if (!held) return refused(fmt::format("{} is not held", order.full_name()));
  order.registry.release(order.spacecraft(), order.name(), order.hold());
  return done(fmt::format("{} is released; it was held by {} since {}", order.full_name(),
                          held->actor, time_text(held->since)));
}

CommandOutcome identify_now(const Order& order) {
  if (!order.context.ask_for_window)
    return refused(
        "no service runs that could identify: 'reident backfill' tries the windows of "
        "telemetry that is archived");
  const auto end = order.context.ask_for_window(order.equipment, "asked by " + order.command.actor);
  if (!end)
    return refused(
        fmt::format("no telemetry of {} has come to the service: 'reident check-config' "
                    "shows whether it is configured",
                    order.full_name()));
  return done(
      fmt::format("the window of {} that ends at {} is due now: 'reident history' shows what "
                  "comes of it",
                  order.full_name(), time_text(*end)));
}

constexpr std::string_view acknowledge_prefix = "acknowledge ";

std::string alarm_text(const storage::Alarm& alarm) {
  const auto& [spacecraft, equipment] = alarm.about;
  if (spacecraft.empty()) return alarm.code;
  return alarm.code + " of " + (equipment.empty() ? spacecraft : full_name(alarm.about));
}

/// Whether the command names what the alarm is about, by the spacecraft, the equipment or both; one
/// that names neither means every alarm of the code.
bool is_about(const storage::Alarm& alarm, const Command& command) {
  const auto& [spacecraft, equipment] = alarm.about;
  if (command.equipment.empty())
    return command.spacecraft.empty() || command.spacecraft == spacecraft;
  if (command.spacecraft.empty() && command.equipment == spacecraft) return true;
  return command.equipment == equipment &&
         (command.spacecraft.empty() || command.spacecraft == spacecraft);
}

CommandOutcome acknowledge(const Command& command, Registry& registry, storage::Time now) {
  const std::string code = command.action.substr(acknowledge_prefix.size());
  std::vector<std::string> raised, acknowledged;
  for (const storage::Alarm& alarm : registry.alarms()) {
    raised.push_back(alarm_text(alarm));
    if (alarm.code == code && is_about(alarm, command) &&
        registry.acknowledge(code, alarm.about, command.actor, command.reason, now))
      acknowledged.push_back(alarm_text(alarm));
  }
  if (!acknowledged.empty())
    return done(fmt::format("{} {} acknowledged by {}{}", joined(acknowledged),
                            acknowledged.size() > 1 ? "are" : "is", command.actor,
                            reason_text(command.reason)));
  return refused(
      fmt::format("no alarm {}{} is raised; raised: {}", code,
                  command.equipment.empty()
                      ? ""
                      : " of " + (command.spacecraft.empty() ? "" : command.spacecraft + "/") +
                            command.equipment,
                  raised.empty() ? "none" : joined(raised)));
}

struct Action {
  std::string_view name;
  CommandOutcome (*carry_out)(const Order&);
  bool needs_reason;
};
constexpr std::array actions{Action{"approve", approve, true},
                             Action{"reject", reject, true},
                             Action{"roll_back", roll_back, false},
                             Action{"withdraw", withdraw, true},
                             Action{"hold", hold, false},
                             Action{"release", release, false},
                             Action{"identify_now", identify_now, false}};

std::string list(const std::set<EquipmentName>& equipment) {
  std::vector<std::string> names;
  for (const EquipmentName& one : equipment) names.push_back(full_name(one));
  return names.empty() ? "none" : joined(names);
}

std::variant<EquipmentName, CommandOutcome> named_equipment(const Command& command,
                                                            const std::set<EquipmentName>& known) {
  std::set<EquipmentName> meant;
  for (const EquipmentName& one : known)
    if (one.equipment == command.equipment &&
        (command.spacecraft.empty() || command.spacecraft == one.spacecraft))
      meant.insert(one);
  if (meant.size() == 1) return *meant.begin();
  if (meant.empty())
    return refused(fmt::format("there is no equipment {}; known: {}",
                               command.spacecraft.empty()
                                   ? command.equipment
                                   : full_name({command.spacecraft, command.equipment}),
                               list(known)));
  return refused(fmt::format("{} is the name of several equipment; name the spacecraft: {}",
                             command.equipment, list(meant)));
}

/// The actor goes out with the version, so it keeps the rules of names on DDS.
dds::Fault fault_of_texts(const Command& command) {
  dds::TextReader texts;
  texts.name(command.actor.c_str(), "the operator's name");
  texts.text(command.reason.c_str(), "the reason");
  return texts.fault();
}

/// About no equipment.
constexpr std::string_view switch_over = "switch_over";

CommandOutcome carry_out(const Command& command, Registry& registry, const CommandContext& context,
                         storage::Time now) {
  if (command.action.starts_with(acknowledge_prefix)) {
    if (const auto fault = fault_of_texts(command)) return refused(*fault);
    return acknowledge(command, registry, now);
  }
  if (command.action == switch_over) {
    if (const auto fault = fault_of_texts(command))
      return refused(*fault + ": every command names who gave it and why");
    return context.hand_over ? context.hand_over(command)
                             : refused("no service runs that could give leadership away");
  }
  const auto action = std::find_if(actions.begin(), actions.end(),
                                   [&](const Action& one) { return one.name == command.action; });
  if (action == actions.end()) {
    std::vector<std::string> names;
    for (const Action& one : actions) names.emplace_back(one.name);
    names.emplace_back("acknowledge ALARM");
    names.emplace_back(switch_over);
    return refused(fmt::format("there is no action {}; known: {}", command.action, joined(names)));
  }
  if (const auto fault = fault_of_texts(command))
    return refused(*fault + ": every decision names who made it and why");
  if (action->needs_reason && command.reason.empty())
    return refused(fmt::format("{} needs a reason", command.action));
  std::set<EquipmentName> known(context.configured.begin(), context.configured.end());
  for (EquipmentName& one : registry.equipment()) known.insert(std::move(one));
  const auto equipment = named_equipment(command, known);
  if (const auto* refusal = std::get_if<CommandOutcome>(&equipment)) return *refusal;
  return action->carry_out({command, registry, context, std::get<EquipmentName>(equipment), now});
}

}  // namespace

CommandOutcome execute(const Command& command, Registry& registry, const CommandContext& context,
                       storage::Time now) {
  return registry.execute(command, now, [&] { return carry_out(command, registry, context, now); });
}

std::vector<Decision> waiting_for_operator(const Registry& registry) {
  std::vector<Decision> waits = registry.waits();
  // Without evidence it is of a program before version 0.2, which let it wait for an operator.
  std::erase_if(waits, [](const Decision& last) {
    return !last.evidence_json.empty() && !waits_for_operator(last);
  });
  return waits;
}

bool supersedes(const Decision& approved, const Decision& other) {
  return approved.spacecraft == other.spacecraft && approved.equipment == other.equipment &&
         other.version < approved.version;
}

std::vector<EquipmentName> equipment_of(const Config& config) {
  std::vector<EquipmentName> names;
  for (const SpacecraftConfig& spacecraft : config.spacecraft)
    for (const EquipmentConfig& equipment : spacecraft.equipment)
      names.push_back({spacecraft.name, equipment.name});
  return names;
}

std::string full_name(const EquipmentName& equipment) {
  return equipment.spacecraft + "/" + equipment.equipment;
}

std::string reason_text(const std::string& reason) {
  return reason.empty() ? "" : fmt::format(" ({})", reason);
}

std::string hold_text(const EquipmentName& equipment, const storage::Hold& hold) {
  return fmt::format("{} is held by {} since {}{}", full_name(equipment), hold.actor,
                     time_text(hold.since), reason_text(hold.reason));
}

}  // namespace reident
