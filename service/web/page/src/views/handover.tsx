// The handover of a shift: what changed, who decided, what waits, and what the next shift should know.
import { useEffect, useState } from "preact/hooks";
import { isDecision, useAnswer, type Decision, type EquipmentLine } from "../api";
import { isoOf, secondsOf, timeText } from "../format";
import { decisionColumns, Facts, Loaded, useZone } from "../parts";
import { saveFile, Table } from "../table";
import { change, link } from "../url";

const shift = 8 * 3600;

/** Text that locks: from then on it can be read and printed, and stands in the address. */
function Note({ note, locked, begin, end }: { note: string; locked: boolean; begin: string; end: string }) {
  const [text, setText] = useState(note);
  useEffect(() => setText(note), [note]);
  if (locked)
    return (
      <>
        <p class="locked">{note || "No remark."}</p>
        <p class="note">Locked. <button type="button" class="quiet" onClick={() => saveFile(`handover-${end.slice(0, 16)}.txt`, "text/plain", `${begin} to ${end}\n\n${note}\n`)}>save as text</button></p>
      </>
    );
  return (
    <>
      <label class="wide">For the next shift <textarea rows={5} maxLength={2000} value={text} onInput={(event) => setText((event.target as HTMLTextAreaElement).value)} onBlur={() => change({ note: text }, true)} /></label>
      <div class="toolbar"><button type="button" onClick={() => change({ note: text, locked: "1", begin, end })}>Lock, with the range</button></div>
    </>
  );
}

function Waits({ lines }: { lines: EquipmentLine[] }) {
  return <Table name="state" caption="At the end" rows={lines} empty="No equipment has a model yet." href={(row) => link("equipment", { spacecraft: row.spacecraft, equipment: row.equipment })} columns={[
    { title: "equipment", text: (row) => `${row.spacecraft}/${row.equipment}` },
    { title: "champion", text: (row) => row.champion ?? "none", isNumber: true },
    { title: "waits for an operator", text: (row) => row.waiting.join(", ") || "nothing" },
    { title: "held", text: (row) => (row.hold ? `by ${row.hold.actor}${row.hold.reason && `: ${row.hold.reason}`}` : "no") },
    { title: "fails", text: (row) => row.failure ?? "no" },
  ]} />;
}

export function HandoverView({ parameters }: { parameters: Record<string, string> }) {
  const zone = useZone();
  const [opened] = useState(() => Date.now() / 1000);
  const end = parameters.end ?? isoOf(opened), begin = parameters.begin ?? isoOf(secondsOf(end) - shift);
  const locked = parameters.locked === "1";
  const decided = useAnswer<{ events: Decision[] }>("events", { begin, end, rows: "1000" }, (change) => !parameters.end && isDecision(change));
  const overview = useAnswer<{ equipment: EquipmentLine[] }>("overview", {}, isDecision);
  return (
    <>
      <div class="title"><h1>Handover</h1><span>{timeText(begin)} to {timeText(end)} {zone}</span></div>
      {!locked && (
        <div class="toolbar">
          {[4, 8, 12, 24].map((hours) => <button type="button" onClick={() => change({ begin: isoOf(secondsOf(end) - hours * 3600), end })}>last {hours} h</button>)}
          <button type="button" onClick={() => print()}>print</button>
        </div>
      )}
      <section><Note note={parameters.note ?? ""} locked={locked} begin={begin} end={end} /></section>
      <Loaded answer={decided}>
        {({ events }) => {
          const changes = events.filter((one) => one.kind === "approve" || one.kind === "roll_back" || one.kind === "withdraw");
          const people = events.filter((one) => one.actor !== "gate");
          return (
            <>
              <Facts facts={[
                ["decisions", String(events.length)], ["that changed what simulators run", String(changes.length)],
                ["by operators", people.length === 0 ? "none" : `${people.length}: ${[...new Set(people.map((one) => one.actor))].join(", ")}`],
              ]} />
              <Table name="handover-changes" caption="What changed" rows={changes} columns={decisionColumns(zone, true)} empty="No champion changed." />
              <Table name="handover-operators" caption="What operators decided" rows={people} columns={decisionColumns(zone, true)} empty="No operator decided." />
            </>
          );
        }}
      </Loaded>
      <Loaded answer={overview}>{({ equipment }) => <Waits lines={equipment} />}</Loaded>
    </>
  );
}
