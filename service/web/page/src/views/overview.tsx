// How all models are now, worst first.
import { isDecision, useAnswer, type EquipmentLine } from "../api";
import { figure, timeText } from "../format";
import { Figure, Loaded, useZone } from "../parts";
import { Table, type Column } from "../table";
import { link } from "../url";

/** What needs a person first: a failing champion, then what waits, then no champion, then growth of the error. */
function urgency(line: EquipmentLine): number {
  const growth = line.error_percent !== null && line.approved_error_percent ? line.error_percent / line.approved_error_percent : 0;
  return (line.failure ? 1e9 : 0) + (line.waiting.length > 0 ? 1e6 : 0) + (line.champion ? 0 : 1e3) + growth;
}

function state(line: EquipmentLine): string {
  const texts = [];
  if (line.failure) texts.push("the champion fails");
  if (line.waiting.length > 0) texts.push(`${line.waiting.length} wait${line.waiting.length === 1 ? "s" : ""}`);
  if (line.hold) texts.push(`held by ${line.hold.actor}`);
  if (!line.champion) texts.push("no champion");
  return texts.join("; ") || "well";
}

export function Overview() {
  const zone = useZone();
  const answer = useAnswer<{ equipment: EquipmentLine[] }>("overview", {}, isDecision);
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
    { title: "challengers", text: (line) => String(line.challengers), isNumber: true },
    { title: "versions", text: (line) => String(line.versions), isNumber: true },
  ];
  return (
    <Loaded answer={answer}>
      {({ equipment }) => (
        <Table name="overview" caption="Equipment" columns={columns}
          rows={[...equipment].sort((a, b) => urgency(b) - urgency(a))}
          href={(line) => link("equipment", { spacecraft: line.spacecraft, equipment: line.equipment })}
          rowClass={(line) => (line.failure ? "failing" : "")}
          empty="No window was tried yet: the service tries the first when telemetry has filled it." />
      )}
    </Loaded>
  );
}
