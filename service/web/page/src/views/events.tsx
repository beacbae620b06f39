// Who decided what, when and why.
import { isDecision, useAnswer, type Decision } from "../api";
import { timeText } from "../format";
import { decisionColumns, kindText, Loaded, useZone } from "../parts";
import { Table } from "../table";
import { change, link } from "../url";
import { Commands } from "./commands";

const kinds = ["approve", "reject", "wait", "roll_back", "withdraw"];
const changes = "approve,roll_back,withdraw";

function Choice({ name, label, options, value }: { name: string; label: string; options: [string, string][]; value: string }) {
  return (
    <label>{label}{" "}
      <select value={value} onChange={(event) => change({ [name]: (event.target as HTMLSelectElement).value, before: undefined })}>
        {options.map(([key, text]) => <option value={key}>{text}</option>)}
      </select>
    </label>
  );
}

interface Refusal {
  time: string;
  code: string;
  user: string;
  peer: string;
  action: string;
  spacecraft: string;
  equipment: string;
  version: string;
}

/** Orders that this page's server refused; those that the service refused have its reply. */
function Refusals() {
  const zone = useZone();
  const answer = useAnswer<{ refusals: Refusal[] }>("refusals", {});
  if (!answer.data || answer.data.refusals.length === 0) return null;
  return <Table name="refusals" caption="Refused by this page, since its server began" rows={answer.data.refusals} columns={[
    { title: `time (${zone})`, text: (row) => timeText(row.time), isTime: true },
    { title: "why", text: (row) => row.code },
    { title: "user", text: (row) => row.user || "nobody" },
    { title: "from", text: (row) => row.peer },
    { title: "action", text: (row) => row.action },
    { title: "equipment", text: (row) => [row.spacecraft, row.equipment].filter(Boolean).join("/") },
    { title: "version", text: (row) => (row.version === "0" ? "" : row.version), isNumber: true },
  ]} />;
}

export function EventsView({ parameters }: { parameters: Record<string, string> }) {
  const zone = useZone();
  const { spacecraft, equipment, kind, by, before, begin, end } = parameters;
  const answer = useAnswer<{ events: Decision[]; before: string | null }>("events", { spacecraft, equipment, kind, by, before, begin, end }, isDecision);
  return (
    <>
      <form class="toolbar" onSubmit={(event) => event.preventDefault()}>
        <Choice name="kind" label="decision" value={kind ?? ""} options={[["", "any"], [changes, "what changed a champion"], ...kinds.map((one): [string, string] => [one, kindText(one)])]} />
        <Choice name="by" label="by" value={by ?? ""} options={[["", "anybody"], ["gate", "the gate"], ["operator", "an operator"]]} />
        {equipment && <button type="button" onClick={() => change({ spacecraft: undefined, equipment: undefined, before: undefined })}>{spacecraft}/{equipment} ✕</button>}
      </form>
      <Loaded answer={answer}>
        {(data) => (
          <>
            <Table name="events" caption={`Decisions, the newest first${begin || end ? `: ${timeText(begin)} to ${timeText(end)} ${zone}` : ""}`} rows={data.events} columns={decisionColumns(zone)}
              href={undefined} empty="No decision is of this kind." />
            <nav class="pages" aria-label="pages">
              {before && <a href={link("events", { ...parameters, before: undefined })}>newest</a>}
              {data.before && <a href={link("events", { ...parameters, before: data.before })}>earlier</a>}
            </nav>
          </>
        )}
      </Loaded>
      {!equipment && !before && <Commands />}
      <Refusals />
    </>
  );
}
