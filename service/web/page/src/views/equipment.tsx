// One equipment: what was measured, what the champion makes of it, and what was decided, on one axis.
import { useCallback, useEffect, useMemo, useRef, useState } from "preact/hooks";
import { ask, isAbout, useAnswer, type Equipment, type Run, type Telemetry, type Timeline, type VersionLine } from "../api";
import { Decide } from "../decide";
import { Figures, isKey } from "../figures";
import { figure, isoOf, secondsOf, timeOfSeconds, timeText } from "../format";
import { decisionColumns, Figure, kindText, Loaded, Status, statusText, useZone } from "../parts";
import { Plot, type Level, type Mark, type Panel, type Stretch } from "../plot";
import { levelsOf, pointsOf } from "../series";
import { Table } from "../table";
import { change, link, rangeIn } from "../url";

const runSpan = 3 * 86400;  // free runs of longer ranges are of blocks alone
const restMs = 80;  // a key that is held moves what is drawn; the server is asked when it rests

interface Drawn {
  timeline: Timeline | null;
  run: Run | null;
  runError: string;
  failure: string;  // why the axis has no events, or a parameter no telemetry
  telemetry: Record<string, Telemetry>;
}

/** What the plot shows, signal by signal as the answers come. */
function useDrawn(equipment: Equipment, begin: number, end: number, bins: string, version: string | null, turn: number): Drawn {
  const [drawn, set] = useState<Drawn>({ timeline: null, run: null, runError: "", failure: "", telemetry: {} });
  const { spacecraft, equipment: name } = equipment;
  const isFirst = useRef(true);
  useEffect(() => {
    const abort = new AbortController();
    const put = (part: (before: Drawn) => Partial<Drawn>) => {
      if (!abort.signal.aborted) set((before) => ({ ...before, ...part(before) }));
    };
    const failed = (error: Error) => put(() => ({ failure: String(error.message ?? error) }));
    const askAll = () => {
      const range = { begin: isoOf(begin), end: isoOf(end), bins };
      put(() => ({ failure: "" }));
      ask<Timeline>("timeline", { spacecraft, equipment: name, ...range }, abort.signal)
        .then((timeline) => put(() => ({ timeline })), failed);
      for (const parameter of [...equipment.outputs.map((one) => one.name), ...equipment.parameters])
        ask<Telemetry>("telemetry", { spacecraft, parameter, ...range }, abort.signal)
          .then((answer) => put(({ telemetry }) => ({ telemetry: { ...telemetry, [parameter]: answer } })),
                failed);
      if (!version || end - begin > runSpan) put(() => ({ run: null, runError: version ? "a free run is drawn over at most three days; the record below is of all of the range" : "" }));
      else
        ask<Run>("run", { spacecraft, equipment: name, version, ...range }, abort.signal)
          .then((run) => put(() => ({ run, runError: "" })),
                (error) => put(() => ({ run: null, runError: String(error.message ?? error) })));
    };
    const timer = setTimeout(askAll, isFirst.current ? 0 : restMs);
    isFirst.current = false;
    return () => {
      clearTimeout(timer);
      abort.abort();
    };
  }, [spacecraft, name, begin, end, bins, version, turn]);
  return drawn;
}

function limits(telemetry: Telemetry): Level[] {
  const levels: Level[] = [];
  if (telemetry.low_limit !== null) levels.push({ value: telemetry.low_limit, label: "limit", colour: "--limit" });
  if (telemetry.high_limit !== null) levels.push({ value: telemetry.high_limit, label: "limit", colour: "--limit" });
  return levels;
}

/** Panels by name, each with the answers that it was made of: what came before is not drawn again. */
type Kept = Map<string, { of: unknown[]; panel: Panel }>;

function panelsOf(equipment: Equipment, drawn: Drawn, kept: Kept): Panel[] {
  const panels: Panel[] = [];
  const push = (of: unknown[], panel: Panel) => {
    const before = kept.get(panel.title);
    const isKnown = before?.of.every((one, index) => one === of[index]);
    if (!isKnown) kept.set(panel.title, { of, panel });
    panels.push(isKnown ? before!.panel : panel);
  };
  const add = (name: string, isOutput: boolean, height: number) => {
    const telemetry = drawn.telemetry[name];
    const run = drawn.run?.outputs.find((one) => one.name === name);
    if (!telemetry && !run) return;
    const panel: Panel = { title: name, unit: telemetry?.unit ?? run?.unit ?? "", height, lines: [], levels: telemetry ? limits(telemetry) : [] };
    if (telemetry) {
      const begin = secondsOf(telemetry.range.begin);
      panel.lines.push({ label: "measured", points: pointsOf(telemetry, begin, telemetry.gaps), colour: isOutput ? "--measured" : "--input" });
      panel.hatched = telemetry.gaps.map(([from, to]) => [begin + from, begin + to]);
    }
    if (run && drawn.run)
      panel.lines.push({ label: `free run of version ${drawn.run.version}`, points: pointsOf(run.run, secondsOf(drawn.run.range.begin), telemetry?.gaps), colour: "--run", width: 1.4 });
    push([telemetry, run], panel);
    if (run && drawn.run)
      push([telemetry, run], {
        title: `${name}: residual`, unit: run.unit, height: 110, levels: [{ value: 0, label: "", colour: "--quiet" }],
        lines: [{ label: "measured − free run", points: pointsOf(run.residual, secondsOf(drawn.run.range.begin), telemetry?.gaps), colour: "--residual" }],
      });
  };
  for (const output of equipment.outputs) add(output.name, true, 190);
  const timeline = drawn.timeline;
  if (timeline && timeline.records.some((record) => record.from_s.length > 0)) {
    const begin = secondsOf(timeline.range.begin);
    const levels: Level[] = [];
    const last = timeline.champions[timeline.champions.length - 1];
    if (last?.approved_error_percent) levels.push({ value: last.approved_error_percent, label: `version ${last.version} when approved`, colour: "--good" });
    push([timeline], {
      title: "error of the champion over its last cycle, on what it was not fitted to", unit: "MRSE %", height: 130, levels,
      lines: timeline.records.filter((record) => record.from_s.length > 0).flatMap((record) => [
        { label: "champion", points: levelsOf(record.from_s, record.to_s, record.error_percent, begin), colour: "--run", width: 2 },
        ...(record.simulator_percent.some((value) => value !== null)
          ? [{ label: "simulator's own model", points: levelsOf(record.from_s, record.to_s, record.simulator_percent, begin), colour: "--simulator", dash: [4, 3] }] : []),
      ]),
    });
  }
  for (const parameter of equipment.parameters) add(parameter, false, 100);
  return panels;
}

/** What the gate refused or left waiting changes nothing in orbit: the tables below have it. */
const changesWhatRuns = (kind: string) => kind === "approve" || kind === "roll_back" || kind === "withdraw";

/** Ranges without those that overlap, ascending. */
function united(ranges: [number, number][]): [number, number][] {
  const whole: [number, number][] = [];
  for (const [begin, end] of ranges.sort((a, b) => a[0] - b[0])) {
    const last = whole[whole.length - 1];
    if (last && begin <= last[1]) last[1] = Math.max(last[1], end);
    else whole.push([begin, end]);
  }
  return whole;
}

const mostExcluded = 4;

/** What the hatched stretches are. */
function Excluded({ timeline, origin, zone }: { timeline: Timeline; origin: number; zone: string }) {
  const longest = [...timeline.excluded].sort((a, b) => b.end_s - b.begin_s - (a.end_s - a.begin_s));
  if (longest.length === 0) return null;
  return (
    <p class="note">Not believed: {longest.slice(0, mostExcluded).map((one) => `${one.parameters.join(", ")} (${one.check}) from ${timeOfSeconds(origin + one.begin_s)} to ${timeOfSeconds(origin + one.end_s)} ${zone}`).join("; ")}
      {longest.length > mostExcluded && `; and ${longest.length - mostExcluded} shorter`}. <a href={link("telemetry", { begin: timeline.range.begin, end: timeline.range.end })}>Why</a></p>
  );
}

/** The plot, or its figures as a table. */
function TimeAxis({ equipment, parameters, turn }: { equipment: Equipment; parameters: Record<string, string>; turn: number }) {
  const zone = useZone();
  const extent = equipment.telemetry!;
  const last = secondsOf(extent.end);
  const asked = rangeIn(parameters);
  const end = asked.end ? secondsOf(asked.end) : asked.begin ? Math.max(last, secondsOf(asked.begin) + 86400) : last;
  const begin = asked.begin ? secondsOf(asked.begin) : Math.max(Math.min(secondsOf(extent.begin), end - 1), end - 86400);
  const version = parameters.version ?? equipment.line.champion;
  const bins = String(Math.min(1000, Math.max(200, Math.round(innerWidth / 2))));
  const drawn = useDrawn(equipment, begin, end, bins, version, turn);
  const kept = useRef<Kept>(new Map());
  const panels = useMemo(() => panelsOf(equipment, drawn, kept.current), [equipment, drawn]);
  const timeline = drawn.timeline;
  const origin = timeline ? secondsOf(timeline.range.begin) : 0;
  const marks = useMemo<Mark[]>(() => (timeline?.events ?? []).filter((event) => changesWhatRuns(event.kind) || event.actor !== "gate").map((event) => ({ at: origin + event.at_s, label: `${kindText(event.kind)} ${event.version}`, kind: event.kind })), [timeline]);
  const stretches = useMemo<Stretch[]>(() => (timeline?.champions ?? []).map((champion, index) => ({
    begin: origin + champion.begin_s, end: origin + champion.end_s, label: champion.version, colour: index % 2 ? "--strip-b" : "--strip-a",
  })), [timeline]);
  const excluded = useMemo(() => united((timeline?.excluded ?? []).map((one) => [origin + one.begin_s, origin + one.end_s])), [timeline]);
  const asTable = parameters.show === "table";

  const move = useCallback((from: number, to: number, isRepeated = false) => {
    const [least, most] = [secondsOf(extent.begin), last];
    const width = Math.min(Math.max(to - from, 2), most - least);
    const start = Math.min(Math.max(from, least), most - width);
    change({ begin: isoOf(start), end: isoOf(start + width) }, isRepeated);
  }, [extent.begin, last]);

  useEffect(() => {
    const pressed = (event: KeyboardEvent) => {
      if (!isKey(event)) return;
      const width = end - begin, middle = (begin + end) / 2;
      const places = equipment.decisions.filter((one) => (changesWhatRuns(one.kind) || one.actor !== "gate") && one.telemetry).map((one) => secondsOf(one.telemetry!)).sort((a, b) => a - b);
      const beside = (at: number | undefined) => at !== undefined && move(at - width / 2, at + width / 2);
      if (event.key === "+" || event.key === "=") move(middle - width / 4, middle + width / 4);
      else if (event.key === "-") move(middle - width, middle + width);
      else if (event.key === "ArrowLeft" && !event.shiftKey) move(begin - width / 4, end - width / 4, event.repeat);
      else if (event.key === "ArrowRight" && !event.shiftKey) move(begin + width / 4, end + width / 4, event.repeat);
      else if (event.key === "0") change({ begin: undefined, end: undefined });
      else if (event.key === "[") beside(places.filter((at) => at < middle - 1).pop());
      else if (event.key === "]") beside(places.find((at) => at > middle + 1));
      else if (event.key === "t") change({ show: asTable ? undefined : "table" });
      else return;
      event.preventDefault();
    };
    addEventListener("keydown", pressed);
    return () => removeEventListener("keydown", pressed);
  }, [begin, end, asTable, equipment, move]);

  const span = (name: string, seconds: number | null) => (
    <button type="button" onClick={() => (seconds === null ? move(secondsOf(extent.begin), last) : move(end - seconds, end))}>{name}</button>
  );
  return (
    <section>
      <div class="toolbar" role="toolbar" aria-label="range of time">
        <span>{timeText(isoOf(begin))} to {timeText(isoOf(end))} {zone}</span>
        {span("1 h", 3600)}{span("1 d", 86400)}{span("30 d", 30 * 86400)}{span("1 y", 365 * 86400)}{span("all", null)}
        <button type="button" onClick={() => move(begin - (end - begin) / 2, end - (end - begin) / 2)} aria-label="earlier">←</button>
        <button type="button" onClick={() => move(begin + (end - begin) / 2, end + (end - begin) / 2)} aria-label="later">→</button>
        <button type="button" onClick={() => move(begin + (end - begin) / 4, end - (end - begin) / 4)} aria-label="closer">+</button>
        <button type="button" onClick={() => move(begin - (end - begin) / 2, end + (end - begin) / 2)} aria-label="farther">−</button>
        <button type="button" aria-pressed={asTable} onClick={() => change({ show: asTable ? undefined : "table" })}>table</button>
      </div>
      {asked.wrong && <p class="error" role="alert">{asked.wrong} Shown is the usual range.</p>}
      {drawn.failure && <p class="error" role="alert">{drawn.failure}</p>}
      {drawn.runError && <p class="note">{drawn.runError}</p>}
      {asTable ? panels.map((panel) => <Figures panel={panel} zone={zone} />)
        : panels.length > 0 && <Plot begin={begin} end={end} panels={panels} marks={marks} stretches={stretches} excluded={excluded} onRange={move} />}
      <p class="legend"><span class="swatch gap" /> nothing came <span class="swatch excluded" /> excluded by screening <span class="swatch strip" /> champion</p>
      {timeline && <Excluded timeline={timeline} origin={origin} zone={zone} />}
    </section>
  );
}

/** Error of each version with its 95 % interval. */
function VersionErrors({ versions, asks }: { versions: VersionLine[]; asks: (row: VersionLine) => boolean }) {
  const shown = versions.filter((one) => one.error_percent !== null).slice(-60);
  if (shown.length < 2) return null;
  const greatest = Math.max(...shown.map((one) => Math.min(one.interval_percent?.[1] ?? one.error_percent!, 3 * one.error_percent!)));
  const width = 900, height = 110, step = width / shown.length;
  const kindOf = (row: VersionLine) => (row.status === "approved" || row.status === "superseded" ? row.status : asks(row) ? "waiting" : "other");
  const kinds = new Set<string>(shown.map(kindOf));
  const y = (value: number) => height - 14 - (Math.min(value, greatest) / greatest) * (height - 24);
  return (
    <section>
      <h2>Error of each version, with its 95 % interval</h2>
      <div class="scroll" tabIndex={0} role="region" aria-label="error of each version">
      <svg class="errors" viewBox={`0 0 ${width} ${height}`} role="img" aria-label="error of each version; the table below has the figures">
        {shown.map((one, index) => {
          const x = (index + 0.5) * step;
          return (
            <g class={kindOf(one)}>
              {one.interval_percent && <line x1={x} x2={x} y1={y(one.interval_percent[0])} y2={y(one.interval_percent[1])} />}
              <circle cx={x} cy={y(one.error_percent!)} r={one.status === "approved" ? 5 : 3.2} />
              {(shown.length <= 30 || one.status === "approved") && <text x={x} y={height - 2}>{one.version}</text>}
            </g>
          );
        })}
        <text class="scale" x="0" y="10">{figure(greatest)} %</text>
      </svg>
      </div>
      <p class="legend">{[["approved", "champion"], ["superseded", "was champion"], ["waiting", "waits for an operator"], ["other", "others"]].map(([kind, text]) => kinds.has(kind!) && <><span class={`swatch dot ${kind}`} /> {text}</>)}</p>
    </section>
  );
}

export function EquipmentView({ parameters }: { parameters: Record<string, string> }) {
  const zone = useZone();
  const { spacecraft, equipment: name, versions: shown } = parameters;
  const answer = useAnswer<Equipment>("equipment", { spacecraft, equipment: name }, isAbout(spacecraft, name));
  const turn = answer.data?.decisions.length ?? 0;  // a decision draws again what is shown
  return (
    <Loaded answer={answer}>
      {(equipment) => {
        const line = equipment.line;
        const asks = (row: VersionLine) => line.waiting.includes(row.version);
        // The newest, and of the others those that run, ran or ask for somebody.
        const versions = [...equipment.versions].reverse().filter((row, index) => shown === "all" || index < 10 || row.status === "approved" || row.status === "superseded" || asks(row));
        const telling = equipment.decisions.filter((one) => changesWhatRuns(one.kind) || one.actor !== "gate").reverse();
        return (
          <>
            <div class="title">
              <h1>{spacecraft}/{name}</h1>
              {line.champion ? <span>champion <a href={link("version", { spacecraft, equipment: name, version: line.champion })}>{line.champion}</a> since {timeText(line.since)} {zone}, by {line.decided_by}; error <Figure value={line.error_percent} unit="%" />, when approved <Figure value={line.approved_error_percent} unit="%" /></span> : <span class="unknown">no champion</span>}
              {line.hold && <span class="act">held by {line.hold.actor} since {timeText(line.hold.since)} {zone}{line.hold.reason && `: ${line.hold.reason}`}</span>}
            </div>
            {line.failure && <p class="error" role="alert">{line.failure}</p>}
            {equipment.telemetry ? <TimeAxis equipment={equipment} parameters={parameters} turn={turn} /> : <p class="empty">No telemetry of {spacecraft} is archived.</p>}
            <Decide spacecraft={spacecraft!} equipment={name!} champion={line.champion} actions={[
              line.hold ? { action: "release", label: "Release", role: "operator", needsReason: false } : { action: "hold", label: "Hold the champion", role: "operator", needsReason: true },
              { action: "identify_now", label: "Identify now", role: "operator", needsReason: false },
            ]} />
            <VersionErrors versions={equipment.versions} asks={asks} />
            <Table name={`versions-${name}`} caption={`Versions, the newest first${versions.length < line.versions ? `: ${versions.length} of ${line.versions}` : ""}`} rows={versions}
              href={(row) => link("version", { spacecraft, equipment: name, version: row.version })}
              columns={[
                { title: "version", text: (row) => row.version },
                { title: "status", text: (row) => statusText(row.status, asks(row)), cell: (row) => <Status status={row.status} asksOperator={asks(row)} /> },
                { title: "error %", text: (row) => figure(row.error_percent), isNumber: true },
                { title: "95 % interval", text: (row) => (row.interval_percent ? `${figure(row.interval_percent[0])} to ${figure(row.interval_percent[1])}` : "–"), isNumber: true },
                { title: "fit %", text: (row) => figure(row.fit_percent), isNumber: true },
                { title: "order", text: (row) => String(row.order ?? "–"), isNumber: true },
                { title: `window ends (${zone})`, text: (row) => timeText(row.window.end), isTime: true },
              ]} />
            {versions.length < equipment.versions.length && <p><button type="button" onClick={() => change({ versions: "all" }, true)}>show all {equipment.versions.length}</button></p>}
            <Table name={`decisions-${name}`} caption="Decisions that changed what simulators run, or were made by an operator" rows={telling} columns={decisionColumns(zone, { spacecraft, equipment: name })} empty="None yet." />
            <p><a href={link("events", { spacecraft, equipment: name })}>All {equipment.decisions.length} decisions, the gate's too</a></p>
          </>
        );
      }}
    </Loaded>
  );
}
