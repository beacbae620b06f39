// What came and what is missing: a calendar for each parameter, one after the other.
import { useEffect, useMemo, useState } from "preact/hooks";
import { ask, useAnswer } from "../api";
import { count, durationText, isoOf, secondsOf, timeText } from "../format";
import { Loaded, useZone } from "../parts";
import { Table } from "../table";
import { change, rangeIn } from "../url";
import { Disbelieved, Gaps } from "./quality";

interface Series {
  spacecraft: string;
  parameter: string;
  origin: string;
  samples: number;
  first: string;
  last: string;
}

interface Days {
  begin: string[];
  came: number[];
  missing: number[];
  gaps: number[];
  longest_gap_s: number[];
}

const cell = 12;
const usualDays = 30;  // as of the server
const usualRows = 20;

function level(came: number, missing: number): string {
  if (came + missing === 0) return "none";
  const share = came / (came + missing);
  return share >= 0.999 ? "full" : share >= 0.95 ? "most" : share >= 0.5 ? "half" : "little";
}

/** Columns are weeks, rows days of the week, Monday first, in UTC. Days outside of its telemetry fill the weeks. */
function Calendar({ name, days }: { name: string; days: Days }) {
  const numbers = days.begin.map((iso) => Math.floor(secondsOf(iso) / 86400));
  const monday = numbers[0]! - ((numbers[0]! + 3) % 7);
  const weeks = Math.floor((numbers[numbers.length - 1]! - monday) / 7) + 1;
  const outside = Array.from({ length: 7 * weeks }, (_, index) => monday + index).filter((day) => day < numbers[0]! || day > numbers[numbers.length - 1]!);
  const place = (day: number) => ({ x: Math.floor((day - monday) / 7) * cell, y: ((day - monday) % 7) * cell, width: cell - 2, height: cell - 2 });
  return (
    <svg class="calendar" width={weeks * cell} height={7 * cell} role="img" aria-label={`${name}: completeness day by day; the table has the figures`}>
      {outside.map((day) => <rect class="none" {...place(day)} />)}
      {numbers.map((day, index) => (
        <rect class={level(days.came[index]!, days.missing[index]!)} {...place(day)}>
          <title>{days.begin[index]!.slice(0, 10)}: {count(days.came[index])} came, {count(days.missing[index])} missing</title>
        </rect>
      ))}
    </svg>
  );
}

const keyOf = (one: Series) => `${one.spacecraft}/${one.parameter}/${one.origin}`;
const sum = (numbers: number[] | undefined) => numbers?.reduce((a, b) => a + b, 0);

/** The days of each series: one question at a time, so that other viewers are not kept waiting. */
function useDays(series: Series[]): Record<string, Days> {
  const [days, set] = useState<Record<string, Days>>({});
  useEffect(() => {
    const abort = new AbortController();
    (async () => {
      for (const { spacecraft, parameter, origin, ...one } of series) {
        if (abort.signal.aborted) return;
        try {
          const answer = await ask<Days>("completeness", { spacecraft, parameter, origin }, abort.signal);
          set((before) => ({ ...before, [keyOf({ spacecraft, parameter, origin, ...one })]: answer }));
        } catch {
          continue;  // its row keeps its dashes
        }
      }
    })();
    return () => abort.abort();
  }, [series]);
  return days;
}

function All({ series }: { series: Series[] }) {
  const zone = useZone();
  const days = useDays(series);
  return (
    <Table name="completeness" caption="Completeness of each parameter" rows={series} empty="No telemetry is archived." columns={[
      { title: "parameter", text: (row) => `${row.spacecraft} ${row.parameter}${row.origin === "real" ? "" : ` (${row.origin})`}` },
      { title: "days (UTC)", text: (row) => String(days[keyOf(row)]?.begin.length ?? ""),
        cell: (row) => (days[keyOf(row)] ? <Calendar name={row.parameter} days={days[keyOf(row)]!} /> : <span class="unknown">…</span>) },
      { title: "came", text: (row) => count(sum(days[keyOf(row)]?.came)), isNumber: true },
      { title: "missing", text: (row) => count(sum(days[keyOf(row)]?.missing)), isNumber: true },
      { title: "gaps", text: (row) => count(sum(days[keyOf(row)]?.gaps)), isNumber: true },
      { title: "longest gap", text: (row) => durationText(days[keyOf(row)] ? Math.max(0, ...days[keyOf(row)]!.longest_gap_s) : NaN), isNumber: true },
      { title: `first (${zone})`, text: (row) => timeText(row.first), isTime: true },
      { title: `last (${zone})`, text: (row) => timeText(row.last), isTime: true },
    ]} />
  );
}

/** Of gaps and disbelieved sensors; the calendars are of all telemetry. */
function Range({ series, begin, end }: { series: Series[]; begin?: string; end?: string }) {
  const zone = useZone();
  const times = series.filter((one) => one.origin === "real");
  if (times.length === 0) return null;
  const last = Math.max(...times.map((one) => secondsOf(one.last))), first = Math.min(...times.map((one) => secondsOf(one.first)));
  const until = end ? secondsOf(end) : last + 1;
  const from = begin ? secondsOf(begin) : until - usualDays * 86400;
  const span = (name: string, days: number) => <button type="button" onClick={() => change({ begin: isoOf(until - days * 86400), end: isoOf(until) })}>{name}</button>;
  return (
    <div class="toolbar" role="toolbar" aria-label="range of time">
      <span>{timeText(isoOf(from))} to {timeText(isoOf(until))} {zone}</span>
      {span("1 d", 1)}{span("7 d", 7)}{span("30 d", 30)}
      <button type="button" onClick={() => change({ begin: isoOf(first), end: isoOf(last + 1) })}>all</button>
      <button type="button" onClick={() => change({ begin: isoOf(2 * from - until), end: isoOf(from) })} aria-label="earlier">←</button>
      <button type="button" onClick={() => change({ begin: isoOf(until), end: isoOf(2 * until - from) })} aria-label="later">→</button>
    </div>
  );
}

export function CompletenessView({ parameters }: { parameters: Record<string, string> }) {
  const answer = useAnswer<{ series: Series[] }>("series", {});
  const [shown, setShown] = useState<Series[]>([]);
  const { find = "", rows } = parameters;
  const asked = rangeIn(parameters);
  useEffect(() => setShown((answer.data?.series ?? []).filter((one) => keyOf(one).toLowerCase().includes(find.toLowerCase()))), [answer.data, find]);
  const part = useMemo(() => (rows === "all" ? shown : shown.slice(0, usualRows)), [shown, rows]);
  return (
    <Loaded answer={answer}>
      {() => (
        <>
          {asked.wrong && <p class="error" role="alert">{asked.wrong} Shown are the last 30 days.</p>}
          <Range series={answer.data!.series} begin={asked.begin} end={asked.end} />
          <Disbelieved begin={asked.begin} end={asked.end} />
          <Gaps begin={asked.begin} end={asked.end} />
          <form class="toolbar" onSubmit={(event) => event.preventDefault()}>
            <label>parameter <input type="search" value={find} onInput={(event) => change({ find: (event.target as HTMLInputElement).value }, true)} /></label>
          </form>
          <p class="legend">Columns are weeks from Monday; of a day came <span class="swatch full" /> all <span class="swatch most" /> 95 % or more <span class="swatch half" /> half or more <span class="swatch little" /> less <span class="swatch none" /> nothing was expected</p>
          <All series={part} />
          {part.length < shown.length && <p>{part.length} of {shown.length} parameters. <button type="button" onClick={() => change({ rows: "all" }, true)}>show all</button></p>}
        </>
      )}
    </Loaded>
  );
}
