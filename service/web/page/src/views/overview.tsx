// How all models are now, worst first.
import { useState } from "preact/hooks";
import { isDecision, useAnswer, type Alarm, type EquipmentLine, type OverviewAnswer, type PairService, type Service } from "../api";
import { count, figure, timeText } from "../format";
import type { Change } from "../live";
import { Figure, Loaded, useZone } from "../parts";
import { Table, type Column } from "../table";
import { link } from "../url";

/** Tells heartbeats with another alarm, or another role in a pair, from those that say the same again. */
function otherStates(): (news: Change) => boolean {
  const known = new Map<unknown, string>();
  return ({ event, data }) => {
    if (event !== "service") return false;
    const pair = data.pair as Service["pair"];
    const state = JSON.stringify([data.alarms, pair?.role, pair?.term, pair?.partner]);
    const isOther = known.get(data.service) !== state;
    known.set(data.service, state);
    return isOther;
  };
}

/** Errors, simulators and telemetry move without a decision: they are asked for again so often [s]. */
const refresh = 20;

const isAbout = (alarm: Alarm, line: EquipmentLine) => alarm.spacecraft === line.spacecraft && alarm.equipment === line.equipment;

function state(line: EquipmentLine, alarms: Alarm[]): string {
  const texts = [];
  if (line.failure) texts.push("the champion fails");
  for (const alarm of alarms) if (isAbout(alarm, line) && alarm.code !== "champion_failed") texts.push(`alarm ${alarm.code}`);
  if (line.waiting.length > 0) texts.push(`${line.waiting.length} wait${line.waiting.length === 1 ? "s" : ""}`);
  if (line.hold) texts.push(`held by ${line.hold.actor}`);
  if (line.attempts === 0) texts.push("no window was tried yet");
  else if (!line.champion) texts.push("no champion");
  return texts.join("; ") || "well";
}

const aboutText = (alarm: Alarm) => [alarm.spacecraft, alarm.equipment].filter(Boolean).join("/");

function Alarms({ alarms, tried, zone }: { alarms: Alarm[]; tried: Set<string>; zone: string }) {
  return (
    <Table name="alarms" caption="Alarms" rows={alarms} rowClass={(alarm) => (alarm.acknowledged_by ? "" : "failing")} columns={[
      { title: "alarm", text: (alarm) => alarm.text },
      { title: "about", text: aboutText, cell: (alarm) => (alarm.equipment && tried.has(aboutText(alarm)) ? <a href={link("equipment", { spacecraft: alarm.spacecraft, equipment: alarm.equipment })}>{aboutText(alarm)}</a> : aboutText(alarm)) },
      { title: `since (${zone})`, text: (alarm) => timeText(alarm.since), isTime: true },
      { title: "seen by", text: (alarm) => alarm.acknowledged_by || "nobody" },
    ]} />
  );
}

function Pair({ pair }: { pair: PairService[] }) {
  return (
    <Table name="pair" caption="Pair of services" rows={pair} rowClass={(one) => (one.role === "listens" ? "failing" : "")} columns={[
      { title: "service", text: (one) => one.service },
      { title: "role", text: (one) => one.role },
      { title: "term", text: (one) => String(one.term), isNumber: true },
      { title: "rows behind", text: (one) => count(one.lag), isNumber: true },
    ]} />
  );
}

export function Overview() {
  const zone = useZone();
  const [isOther] = useState(otherStates);
  const answer = useAnswer<OverviewAnswer>("overview", {}, (news) => isOther(news) || isDecision(news), refresh);
  const columns = (alarms: Alarm[]): Column<EquipmentLine>[] => [
    { title: "equipment", text: (line) => `${line.spacecraft}/${line.equipment}` },
    {
      title: "state", text: (line) => state(line, alarms), isWide: true,
      cell: (line) => {
        const act = line.waiting.length > 0 || alarms.some((alarm) => isAbout(alarm, line));
        return (
          <>
            <span class={line.failure ? "bad" : act ? "act" : ""}>{state(line, alarms)}</span>
            {line.waiting.length > 0 && <>: {line.waiting.slice(-3).map((version) => <><a href={link("version", { spacecraft: line.spacecraft, equipment: line.equipment, version })}>{version}</a> </>)}</>}
            {line.change && <div class="detail">telemetry changed {timeText(line.change)} {zone}</div>}
          </>
        );
      },
    },
    { title: "champion", text: (line) => line.champion ?? "", cell: (line) => line.champion ?? <span class="unknown">none</span>, isNumber: true },
    { title: `since (${zone})`, text: (line) => timeText(line.since), isTime: true },
    { title: "error %", text: (line) => figure(line.error_percent), cell: (line) => <Figure value={line.error_percent} />, isNumber: true },
    { title: "when approved %", text: (line) => figure(line.approved_error_percent), cell: (line) => <Figure value={line.approved_error_percent} />, isNumber: true },
    { title: "simulator %", text: (line) => figure(line.simulator_percent), cell: (line) => <Figure value={line.simulator_percent} />, isNumber: true },
    { title: "simulators", text: (line) => (line.simulators === 0 ? "none" : `${line.current} of ${line.simulators}`),
      cell: (line) => <span class={line.current < line.simulators ? "act" : ""}>{line.simulators === 0 ? "none" : `${line.current} of ${line.simulators} current`}</span>, isNumber: true },
    { title: `telemetry to (${zone})`, text: (line) => timeText(line.telemetry), isTime: true },
  ];
  return (
    <Loaded answer={answer}>
      {({ equipment, alarms, pair }) => (
        <>
        {alarms.length > 0 && <Alarms alarms={alarms} tried={new Set(equipment.filter((line) => line.attempts > 0).map((line) => `${line.spacecraft}/${line.equipment}`))} zone={zone} />}
        <Table name="overview" caption="Equipment" columns={columns(alarms)}
          rows={equipment}
          href={(line) => (line.attempts > 0 ? link("equipment", { spacecraft: line.spacecraft, equipment: line.equipment }) : undefined)}
          rowClass={(line) => (line.failure ? "failing" : "")}
          empty="No window was tried yet: the service tries the first when telemetry has filled it." />
        {pair.length > 0 && <Pair pair={pair} />}
        </>
      )}
    </Loaded>
  );
}
