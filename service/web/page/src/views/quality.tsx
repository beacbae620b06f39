// What of the telemetry is missing, and which sensors screening did not believe.
import { useAnswer, type Range } from "../api";
import { durationText, figure, secondsOf, timeText } from "../format";
import { Loaded, useZone } from "../parts";
import { Table } from "../table";
import { link } from "../url";

interface Excluded {
  spacecraft: string;
  check: string;
  relation: string;
  parameters: string[];
  begin: string;
  end: string;
  lasts: boolean;
  stretches: number;
  residual: number | null;
  tolerance: number | null;
  equipment: string[];
}

interface Gap {
  spacecraft: string;
  begin: string;
  end: string;
  seconds: number;
  parameters: string[];
  of: number;
}

/** The last days of telemetry, where no range is given. */
export interface TelemetryRange {
  begin?: string;
  end?: string;
}

const around = (begin: string, end: string, spacecraft: string, equipment: string) => link("equipment", { spacecraft, equipment, begin, end });

/** It lasts at the end of the range. */
const isOpen = (gap: Gap, range: Range) => secondsOf(gap.end) >= secondsOf(range.end) - 1;

function LeftOut({ count, what }: { count: number; what: string }) {
  return count > 0 ? <p class="note">{count} shorter {what} not listed.</p> : null;
}

export function Disbelieved({ begin, end }: TelemetryRange) {
  const zone = useZone();
  const answer = useAnswer<{ excluded: Excluded[]; left_out: number }>("excluded", { begin, end });
  return (
    <Loaded answer={answer}>
      {({ excluded, left_out }) => (
        <>
          <Table name="disbelieved" caption="Sensors that are not believed, the newest first" rows={excluded} empty="Screening excluded nothing."
            rowClass={(row) => (row.lasts ? "failing" : "")}
            columns={[
              { title: "parameters", text: (row) => `${row.spacecraft} ${row.parameters.join(", ")}` },
              { title: `since (${zone})`, text: (row) => timeText(row.begin), isTime: true },
              { title: `until (${zone})`, text: (row) => (row.lasts ? "still" : timeText(row.end)), cell: (row) => (row.lasts ? <span class="bad">still, at {timeText(row.end)}</span> : timeText(row.end)), isTime: true },
              { title: "why", text: (row) => (row.relation ? `relation ${row.relation} is ${figure(row.residual)}, tolerance ${figure(row.tolerance)}` : row.check) + (row.stretches > 1 ? `, ${row.stretches} times` : ""), isWide: true },
              { title: "excluded from", text: (row) => row.equipment.join(", "),
                cell: (row) => row.equipment.map((name) => <><a href={around(row.begin, row.end, row.spacecraft, name)}>{name}</a> </>) },
            ]} />
          <LeftOut count={left_out} what="stretches of windows are" />
        </>
      )}
    </Loaded>
  );
}

export function Gaps({ begin, end }: TelemetryRange) {
  const zone = useZone();
  const answer = useAnswer<{ range: Range; gaps: Gap[]; left_out: number }>("gaps", { begin, end, rows: "25" });
  return (
    <Loaded answer={answer}>
      {({ range, gaps, left_out }) => (
        <>
          <Table name="gaps" caption="Gaps, the longest first" rows={gaps} empty="Nothing is missing." columns={[
            { title: "spacecraft", text: (row) => row.spacecraft },
            { title: `from (${zone})`, text: (row) => timeText(row.begin), isTime: true },
            { title: `to (${zone})`, text: (row) => `${isOpen(row, range) ? "still at " : ""}${timeText(row.end)}`, isTime: true },
            { title: "length", text: (row) => durationText(row.seconds), isNumber: true },
            { title: "of", text: (row) => (row.parameters.length === row.of ? `all ${row.of} parameters` : `${row.parameters.length} of ${row.of}: ${row.parameters.join(", ")}`),
              cell: (row) => (row.parameters.length === row.of ? <>all {row.of} parameters</> : <>{row.parameters.length} of {row.of}: {row.parameters.slice(0, 6).join(", ")}{row.parameters.length > 6 && " …"}</>), isWide: true },
          ]} />
          <LeftOut count={left_out} what="gaps are" />
        </>
      )}
    </Loaded>
  );
}
