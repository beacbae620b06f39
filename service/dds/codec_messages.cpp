#include "service/dds/codec.hpp"

namespace reident::dds {

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
  wire_.since_ns = acknowledgement.since;
  wire_.accepted = acknowledgement.accepted;
  wire_.reason = borrow(acknowledgement.reason);
  wire_.running_mrse_percent = acknowledgement.running_mrse_percent;
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
  acknowledgement.since = wire.since_ns;
  acknowledgement.accepted = wire.accepted;
  acknowledgement.reason = texts.text(wire.reason, "reason");
  acknowledgement.running_mrse_percent = wire.running_mrse_percent;
  if (texts.fault()) return texts.fault();
  if (acknowledgement.version < 0) return "the version's number is negative";
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
  return texts.fault();
}

}  // namespace reident::dds
