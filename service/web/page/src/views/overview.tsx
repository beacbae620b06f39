// How all models are now, worst first.
import { isDecision, useAnswer, type Alarm, type EquipmentLine } from "../api";
import { figure, timeText } from "../format";
import { Figure, Loaded, useZone } from "../parts";
import { Table, type Column } from "../table";
import { link } from "../url";

function state(line: EquipmentLine): string {
  const texts = [];
  if (line.failure) texts.push("the champion fails");
  if (line.waiting.length > 0) texts.push(`${line.waiting.length} wait${line.waiting.length === 1 ? "s" : ""}`);
  if (line.hold) texts.push(`held by ${line.hold.actor}`);
  if (!line.champion) texts.push("no champion");
  return texts.join("; ") || "well";
}

function Alarms({ alarms, zone }: { alarms: Alarm[]; zone: string }) {
  return (
    <Table name="alarms" caption="Alarms" rows={alarms} rowClass={(alarm) => (alarm.acknowledged_by ? "" : "failing")} columns={[
      { title: "alarm", text: (alarm) => alarm.text },
      { title: "about", text: (alarm) => [alarm.spacecraft, alarm.equipment].filter(Boolean).join("/") },
      { title: `since (${zone})`, text: (alarm) => timeText(alarm.since) },
      { title: "seen by", text: (alarm) => alarm.acknowledged_by || "nobody" },
    ]} />
  );
}

export function Overview() {
  const zone = useZone();
  const answer = useAnswer<{ equipment: EquipmentLine[]; alarms: Alarm[] }>("overview", {}, isDecision);
  const columns: Column<EquipmentLine>[] = [
    { title: "equipment", text: (line) => `${line.spacecraft}/${line.equipment}` },
    {
      title: "state", text: state,
      cell: (line) => {
        const act = line.failure || line.waiting.length > 0;
        return (
          <>
            <span class={line.failure ? "bad" : act ? "act" : ""}>{state(line)}</span>
            {line.waiting.length > 0 && <> <a href={link("version", { spacecraft: line.spacecraft, equipment: line.equipment, version: line.waiting[line.waiting.length - 1] })}>look</a></>}
            {line.failure && <div class="detail">{line.failure}</div>}
          </>
        );
      },
    },
    { title: "champion", text: (line) => line.champion ?? "", cell: (line) => line.champion ?? <span class="unknown">none</span>, isNumber: true },
    { title: `since (${zone})`, text: (line) => timeText(line.since) },
    { title: "error %", text: (line) => figure(line.error_percent), cell: (line) => <Figure value={line.error_percent} />, isNumber: true },
    { title: "when approved %", text: (line) => figure(line.approved_error_percent), cell: (line) => <Figure value={line.approved_error_percent} />, isNumber: true },
    { title: "simulator %", text: (line) => figure(line.simulator_percent), cell: (line) => <Figure value={line.simulator_percent} />, isNumber: true },
    { title: "simulators", text: (line) => (line.simulators === 0 ? "none" : `${line.current} of ${line.simulators}`),
      cell: (line) => <span class={line.current < line.simulators ? "act" : ""}>{line.simulators === 0 ? "none" : `${line.current} of ${line.simulators} current`}</span>, isNumber: true },
    { title: `telemetry to (${zone})`, text: (line) => timeText(line.telemetry) },
  ];
  return (
    <Loaded answer={answer}>
      {({ equipment, alarms }) => (
        <>
        {alarms.length > 0 && <Alarms alarms={alarms} zone={zone} />}
        <Table name="overview" caption="Equipment" columns={columns}
          rows={equipment}
          href={(line) => link("equipment", { spacecraft: line.spacecraft, equipment: line.equipment })}
          rowClass={(line) => (line.failure ? "failing" : "")}
          empty="No window was tried yet: the service tries the first when telemetry has filled it." />
        </>
      )}
    </Loaded>
  );
}
