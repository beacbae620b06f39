// The services of the partition, the database, and this page's own server.
import { usePolled, type Service, type ServiceAnswer } from "../api";
import { bytesText, count, durationText, timeText } from "../format";
import { Facts, useZone } from "../parts";

const freshSeconds = 5;
const counts: [string, string][] = [
  ["frames received", "frames_received"], ["frames rejected", "frames_rejected"],
  ["parameter descriptors rejected", "descriptors_rejected"], ["samples stored", "samples_stored"],
  ["duplicates", "duplicates"], ["conflicts", "conflicts"], ["late", "late"], ["sequence numbers missing", "sequence_missing"],
  ["clock jumps", "clock_jumps"], ["queue", "queue_length"], ["waits for room in the queue", "queue_waits"],
  ["windows pending", "windows_pending"], ["windows tried", "attempts"], ["versions approved", "approvals"],
];

function certificateText({ certificate_end: end, certificate_days: days }: Service, zone: string): string {
  if (end === null || days === null) return "the domain is not secured";
  return `${timeText(end)} ${zone}, ${days < 0 ? "which is past" : `in ${days} days`}`;
}

function pairText({ pair }: Service): string {
  if (!pair) return "none";
  return `${pair.name}: ${pair.role} in term ${pair.term}, with ${pair.partner || "nobody"}` +
    (pair.lag === null ? "" : `; ${count(pair.lag)} rows of the registry behind`);
}

function One({ service, zone }: { service: Service; zone: string }) {
  const isOld = service.age_s > freshSeconds;
  return (
    <section>
      <h2>{service.service} {isOld ? <span class="bad">silent for {durationText(service.age_s)}</span> : <span class="good">runs</span>}</h2>
      {service.last_error && <p class="error" role="alert">{service.last_error}</p>}
      {service.alarms.length > 0 && <ul class="alarms">{service.alarms.map((alarm) => <li class="act">{alarm}</li>)}</ul>}
      <div class={isOld ? "old" : ""}>
        <Facts facts={[
          ["version of the program", service.program_version],
          ["started", `${timeText(service.started)} ${zone}`],
          ["newest telemetry", `${timeText(service.newest_telemetry)} ${zone}`],
          ["pair", pairText(service)],
          ["certificate until", certificateText(service, zone)],
          ["failing champions", service.failing_champions || "none"],
          ...counts.map(([name, key]): [string, string] => [name, count(service[key] as number)]),
        ]} />
      </div>
    </section>
  );
}

export function ServiceView() {
  const zone = useZone();
  const { data: answer, error } = usePolled<ServiceAnswer>("service", 2);
  if (error) return <p class="error" role="alert">{error}</p>;
  if (!answer) return <p class="empty" aria-busy="true">Asking …</p>;
  const { configured, database, page } = answer;
  return (
    <>
      {answer.services.length === 0 && <p class="error" role="alert">No service {configured.service} was heard in domain {configured.domain}, partition {configured.partition}, since this page's server began. What is stored is shown all the same.</p>}
      {answer.services.map((service) => <One service={service} zone={zone} />)}
      <section>
        <h2>Database</h2>
        {database.error && <p class="error" role="alert">{database.error}</p>}
        <Facts facts={[["size", bytesText(database.bytes)], ["log", bytesText(database.log_bytes)]]} />
      </section>
      <section>
        <h2>This page's server</h2>
        <Facts facts={[["version of the program", answer.program_version], ...Object.entries(page).map(([name, value]): [string, string] => [name.replace(/_/g, " "), count(value)])]} />
      </section>
    </>
  );
}
