// The handover of a shift: what changed, who decided, what waits, and what the next shift should know.
import { useEffect, useRef, useState } from "preact/hooks";
import { isDecision, useAnswer, type Alarm, type Decision, type EquipmentLine, type OverviewAnswer } from "../api";
import { isoOf, secondsOf, timeOfSeconds, timeText } from "../format";
import { serviceNow, useChanges } from "../live";
import { decisionColumns, Loaded, useZone } from "../parts";
import { saveFile, Table } from "../table";
import { change, link, rangeIn } from "../url";
import { Commands } from "./commands";
import { Disbelieved, Gaps } from "./quality";

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

/** What asks for somebody as this is read: the past is not kept. */
function Open({ lines, alarms, now, zone }: { lines: EquipmentLine[]; alarms: Alarm[]; now: number; zone: string }) {
  const open = lines.filter((row) => row.waiting.length > 0 || row.hold || row.failure || !row.champion);
  return (
    <>
      <Table name="open" caption={`What is open now, at ${timeOfSeconds(now)} ${zone}`} rows={open} empty="Nothing waits, is held or fails."
        href={(row) => (row.attempts > 0 ? link("equipment", { spacecraft: row.spacecraft, equipment: row.equipment }) : undefined)} columns={[
          { title: "equipment", text: (row) => `${row.spacecraft}/${row.equipment}` },
          { title: "champion", text: (row) => row.champion ?? "none", isNumber: true },
          { title: "waits for an operator", text: (row) => row.waiting.join(", ") || "nothing" },
          { title: "held", text: (row) => (row.hold ? `by ${row.hold.actor}${row.hold.reason && `: ${row.hold.reason}`}` : "no") },
          { title: "fails", text: (row) => row.failure ?? "no", isWide: true },
        ]} />
      <p class="note">{lines.length - open.length} of {lines.length} equipment have a champion, and nothing is open about them.</p>
      <Table name="open-alarms" caption="Alarms now" rows={alarms} empty="None." columns={[
        { title: "alarm", text: (row) => row.text },
        { title: "about", text: (row) => [row.spacecraft, row.equipment].filter(Boolean).join("/") },
        { title: `since (${zone})`, text: (row) => timeText(row.since), isTime: true },
        { title: "seen by", text: (row) => row.acknowledged_by || "nobody" },
      ]} />
    </>
  );
}

export function HandoverView({ parameters }: { parameters: Record<string, string> }) {
  const zone = useZone();
  const [opened, setOpened] = useState(serviceNow);
  const isHeard = useRef(false);
  useChanges(({ event }) => {
    if (event !== "service" || isHeard.current) return;
    isHeard.current = true;
    setOpened(serviceNow());
  });
  const asked = rangeIn(parameters);
  const end = asked.end ?? isoOf(asked.begin ? Math.max(opened, secondsOf(asked.begin) + shift) : opened);
  const begin = asked.begin ?? isoOf(secondsOf(end) - shift);
  const locked = parameters.locked === "1";
  const decided = useAnswer<{ events: Decision[]; before: string | null }>("events", { begin, end, kind: "approve,roll_back,withdraw", rows: "1000" }, (change) => !asked.end && isDecision(change));
  const overview = useAnswer<OverviewAnswer>("overview", {}, isDecision);
  return (
    <>
      <div class="title"><h1>Handover</h1><span>{timeText(begin)} to {timeText(end)} {zone}</span></div>
      {!locked && (
        <div class="toolbar">
          {[4, 8, 12, 24].map((hours) => <button type="button" onClick={() => change({ begin: isoOf(secondsOf(end) - hours * 3600), end })}>last {hours} h</button>)}
          <button type="button" onClick={() => print()}>print</button>
        </div>
      )}
      {asked.wrong && <p class="error" role="alert">{asked.wrong} Shown are the last hours.</p>}
      <section><Note note={parameters.note ?? ""} locked={locked} begin={begin} end={end} /></section>
      <Loaded answer={decided}>
        {({ events, before }) => (
          <>
            <Table name="handover-changes" caption="What changed in what simulators run" rows={events} columns={decisionColumns(zone)} empty="No champion changed." />
            {before && <p class="note">There are more than {events.length}: take a shorter range.</p>}
          </>
        )}
      </Loaded>
      <Commands begin={begin} end={end} rows="1000" />
      <Loaded answer={overview}>{({ equipment, alarms }) => <Open lines={equipment} alarms={alarms} now={opened} zone={zone} />}</Loaded>
      <Disbelieved begin={begin} end={end} />
      <Gaps begin={begin} end={end} />
    </>
  );
}
