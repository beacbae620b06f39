#include "service/dds/codec.hpp"

namespace reident::dds {
namespace {

RunningModel read_running(const reident_ModelAcknowledgement& wire, TextReader& texts) {
  RunningModel running;
  running.version = wire.running_version;
  running.offered_version = wire.offered_version;
  running.mode = texts.text(wire.mode, "mode");
  running.from_cache = wire.from_cache;
  running.decided = wire.decided_ns;
  running.since = wire.since_ns;
  running.mrse_percent = wire.running_mrse_percent;
  running.remaining_step = wire.remaining_step;
  running.transition_steps = wire.transition_steps;
  running.steps = wire.steps;
  running.steps_outside = wire.steps_outside;
  running.steps_missing = wire.steps_missing;
  // An older program says what runs with `version` alone.
  const bool is_older = wire.program_version == nullptr || *wire.program_version == '\0';
  if (is_older && wire.accepted) running.version = wire.version;
  return running;
}

}  // namespace

const reident_IdentificationReport& Codec<IdentificationReport>::Encoder::operator()(
    const IdentificationReport& report) {
  wire_.spacecraft = borrow(report.spacecraft);
  wire_.equipment = borrow(report.equipment);
  wire_.attempt = report.attempt;
  wire_.window_begin_ns = report.window.begin;
  wire_.window_end_ns = report.window.end;
  wire_.trigger = borrow(report.trigger);
  wire_.outcome = borrow(report.outcome);
  wire_.reason = borrow(report.reason);
  wire_.version = report.version;
  wire_.order = report.order;
  wire_.mrse_percent = report.mrse_percent;
  wire_.fit_percent = report.fit_percent;
  wire_.champion_mrse_percent = report.champion_mrse_percent;
  wire_.time_ns = report.time;
  return wire_;
}

Fault Codec<IdentificationReport>::decode(const reident_IdentificationReport& wire,
                                          const ReaderOptions& /*options*/,
                                          IdentificationReport& report) {
  TextReader texts;
  report.spacecraft = texts.name(wire.spacecraft, "spacecraft");
  report.equipment = texts.name(wire.equipment, "equipment");
  report.attempt = wire.attempt;
  report.window = {wire.window_begin_ns, wire.window_end_ns};
  report.trigger = texts.text(wire.trigger, "trigger");
  report.outcome = texts.name(wire.outcome, "outcome");
  report.reason = texts.text(wire.reason, "reason");
  report.version = wire.version;
  report.order = wire.order;
  report.mrse_percent = wire.mrse_percent;
  report.fit_percent = wire.fit_percent;
  report.champion_mrse_percent = wire.champion_mrse_percent;
  report.time = wire.time_ns;
  if (texts.fault()) return texts.fault();
  if (report.window.end < report.window.begin) return "the window ends before it begins";
  if (report.order < 0) return "the order is negative";
  if (report.version < 0) return "the version's number is negative";
  return std::nullopt;
}

const reident_ModelAcknowledgement& Codec<ModelAcknowledgement>::Encoder::operator()(
    const ModelAcknowledgement& acknowledgement) {
  wire_.simulator = borrow(acknowledgement.simulator);
  wire_.spacecraft = borrow(acknowledgement.spacecraft);
  wire_.equipment = borrow(acknowledgement.equipment);
  wire_.version = acknowledgement.version;
  wire_.digest = borrow(acknowledgement.digest);
  wire_.accepted = acknowledgement.accepted;
  wire_.reason = borrow(acknowledgement.reason);
  wire_.host = borrow(acknowledgement.host);
  wire_.process = acknowledgement.process;
  wire_.program_version = borrow(acknowledgement.program_version);
  const RunningModel& running = acknowledgement.running;
  wire_.running_version = running.version;
  wire_.offered_version = running.offered_version;
  wire_.mode = borrow(running.mode);
  wire_.from_cache = running.from_cache;
  wire_.decided_ns = running.decided;
  wire_.since_ns = running.since;
  wire_.running_mrse_percent = running.mrse_percent;
  wire_.remaining_step = running.remaining_step;
  wire_.transition_steps = running.transition_steps;
  wire_.steps = running.steps;
  wire_.steps_outside = running.steps_outside;
  wire_.steps_missing = running.steps_missing;
  return wire_;
}

Fault Codec<ModelAcknowledgement>::decode(const reident_ModelAcknowledgement& wire,
                                          const ReaderOptions& /*options*/,
                                          ModelAcknowledgement& acknowledgement) {
  TextReader texts;
  acknowledgement.simulator = texts.name(wire.simulator, "simulator");
  acknowledgement.spacecraft = texts.name(wire.spacecraft, "spacecraft");
  acknowledgement.equipment = texts.name(wire.equipment, "equipment");
  acknowledgement.version = wire.version;
  acknowledgement.digest = texts.text(wire.digest, "digest");
  acknowledgement.accepted = wire.accepted;
  acknowledgement.reason = texts.text(wire.reason, "reason");
  acknowledgement.host = texts.text(wire.host, "host");
  acknowledgement.process = wire.process;
  acknowledgement.program_version = texts.text(wire.program_version, "program_version");
  acknowledgement.running = read_running(wire, texts);
  if (texts.fault()) return texts.fault();
  const RunningModel& running = acknowledgement.running;
  if (acknowledgement.version < 0 || running.version < 0 || running.offered_version < 0)
    return "the version's number is negative";
  if (running.transition_steps < 0) return "the steps of the transition are negative";
  return std::nullopt;
}

const reident_ServiceStatus& Codec<ServiceStatus>::Encoder::operator()(
    const ServiceStatus& status) {
  wire_.service = borrow(status.service);
  wire_.program_version = borrow(status.program_version);
  wire_.started_ns = status.started;
  wire_.time_ns = status.time;
  wire_.frames_received = status.frames_received;
  wire_.frames_rejected = status.frames_rejected;
  wire_.samples_stored = status.samples_stored;
  wire_.duplicates = status.duplicates;
  wire_.conflicts = status.conflicts;
  wire_.late = status.late;
  wire_.sequence_missing = status.sequence_missing;
  wire_.clock_jumps = status.clock_jumps;
  wire_.queue_length = status.queue_length;
  wire_.queue_waits = status.queue_waits;
  wire_.windows_pending = status.windows_pending;
  wire_.attempts = status.attempts;
  wire_.approvals = status.approvals;
  wire_.newest_telemetry_ns = status.newest_telemetry;
  wire_.last_error = borrow(status.last_error);
  wire_.failing_champions = borrow(status.failing_champions);
  wire_.alarms = borrow(status.alarms);
  wire_.equipment = borrow(status.equipment);
  wire_.pair = borrow(status.pair);
  wire_.role = borrow(status.role);
  wire_.term = status.term;
  wire_.partner = borrow(status.partner);
  wire_.lag = status.lag;
  wire_.descriptors_rejected = status.descriptors_rejected;
  wire_.certificate_end_ns = status.certificate_end;
  return wire_;
}

Fault Codec<ServiceStatus>::decode(const reident_ServiceStatus& wire,
                                   const ReaderOptions& /*options*/, ServiceStatus& status) {
  TextReader texts;
  status.service = texts.name(wire.service, "service");
  status.program_version = texts.text(wire.program_version, "program_version");
  status.started = wire.started_ns;
  status.time = wire.time_ns;
  status.frames_received = wire.frames_received;
  status.frames_rejected = wire.frames_rejected;
  status.samples_stored = wire.samples_stored;
  status.duplicates = wire.duplicates;
  status.conflicts = wire.conflicts;
  status.late = wire.late;
  status.sequence_missing = wire.sequence_missing;
  status.clock_jumps = wire.clock_jumps;
  status.queue_length = wire.queue_length;
  status.queue_waits = wire.queue_waits;
  status.windows_pending = wire.windows_pending;
  status.attempts = wire.attempts;
  status.approvals = wire.approvals;
  status.newest_telemetry = wire.newest_telemetry_ns;
  status.last_error = texts.text(wire.last_error, "last_error");
  status.failing_champions = texts.text(wire.failing_champions, "failing_champions");
  status.alarms = texts.text(wire.alarms, "alarms");
  status.equipment = texts.text(wire.equipment, "equipment");
  status.pair = texts.text(wire.pair, "pair");
  status.role = texts.text(wire.role, "role");
  status.term = wire.term;
  status.partner = texts.text(wire.partner, "partner");
  status.lag = wire.lag;
  status.descriptors_rejected = wire.descriptors_rejected;
  status.certificate_end = wire.certificate_end_ns;
  return texts.fault();
}

}  // namespace reident::dds
