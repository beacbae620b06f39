// The figures of a plot as a table.
import { isoOf, timeText } from "./format";
import type { Panel } from "./plot";
import { Table } from "./table";

/** A key that is meant for the page, and not for a field of a form. */
export function isKey(event: KeyboardEvent): boolean {
  const target = event.target as HTMLElement;
  return !event.ctrlKey && !event.altKey && !event.metaKey && !/^(INPUT|TEXTAREA|SELECT)$/.test(target.tagName);
}

export function Figures({ panel, zone }: { panel: Panel; zone: string }) {
  const rows = panel.lines.flatMap((line) => line.points[0].map((time, index) => ({ line: line.label, time, value: line.points[1][index] }))).filter((row) => row.value !== null && row.value !== undefined);
  return <Table name={panel.title} caption={`${panel.title} [${panel.unit}]`} rows={rows}
    columns={[
      { title: `time (${zone})`, text: (row) => timeText(isoOf(row.time)), isTime: true },
      { title: "line", text: (row) => row.line },
      { title: `value [${panel.unit}]`, text: (row) => String(row.value), isNumber: true },
    ]} />;
}
