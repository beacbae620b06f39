// What several views show.
import type { ComponentChildren } from "preact";
import { useEffect, useState } from "preact/hooks";
import type { Answer, Decision } from "./api";
import { figure, onZoneChange, timeText, unknown, zoneLabel } from "./format";
import type { Column } from "./table";
import { link } from "./url";

/** Draws again when the viewer changes the zone. */
export function useZone(): string {
  const [label, set] = useState(zoneLabel);
  useEffect(() => onZoneChange(() => set(zoneLabel())), []);
  return label;
}

export function Loaded<T>({ answer, children }: { answer: Answer<T>; children: (data: T) => ComponentChildren }) {
  if (answer.error && !answer.data) return <p class="error" role="alert">{answer.error}</p>;
  if (!answer.data) return <p class="empty" aria-busy="true">Asking …</p>;
  return (
    <>
      {answer.error && <p class="error" role="alert">Not current: {answer.error}</p>}
      {children(answer.data)}
    </>
  );
}

/** A figure in one of three states: fresh, old, or not known. */
export function Figure({ value, digits = 3, unit = "", old = false }: { value: number | null | undefined; digits?: number; unit?: string; old?: boolean }) {
  const text = figure(value, digits);
  if (text === unknown) return <span class="unknown" title="not known">{unknown}</span>;
  return <span class={old ? "old" : ""} title={old ? "old: the service is silent" : undefined}>{text}{unit && ` ${unit}`}</span>;
}

const words: Record<string, string> = {
  approve: "approved", reject: "rejected", wait: "waits", roll_back: "rolled back to", withdraw: "withdrawn",
};

export function kindText(kind: string): string {
  return words[kind] ?? kind;
}

/** A version that waits either asks an operator, or telemetry is yet to show whether it is better. */
export function statusText(status: string, asksOperator: boolean): string {
  if (status === "waiting") return asksOperator ? "waits for an operator" : "challenger";
  return status === "approved" ? "champion" : status;
}

export function Status({ status, asksOperator }: { status: string; asksOperator: boolean }) {
  const kind = status === "waiting" && !asksOperator ? "challenger" : status;
  return <span class={`status ${kind}`}>{statusText(status, asksOperator)}</span>;
}

/** `about`: the equipment that all rows are of; without, each row names its own. */
export function decisionColumns(zone: string, about?: { spacecraft?: string; equipment?: string }): Column<Decision>[] {
  const versionOf = (row: Decision) => link("version", { spacecraft: about?.spacecraft ?? row.spacecraft, equipment: about?.equipment ?? row.equipment, version: row.version });
  return [
    { title: `time (${zone})`, text: (row) => timeText(row.time), isTime: true },
    ...(!about ? [{
      title: "equipment", text: (row: Decision) => `${row.spacecraft}/${row.equipment}`,
      cell: (row: Decision) => <a href={link("equipment", { spacecraft: row.spacecraft, equipment: row.equipment })}>{row.spacecraft}/{row.equipment}</a>,
    }] : []),
    { title: "decision", text: (row) => kindText(row.kind), cell: (row) => <span class={`event ${row.kind}`}>{kindText(row.kind)}</span> },
    { title: "version", text: (row) => row.version, cell: (row) => <a href={versionOf(row)}>{row.version}</a>, isNumber: true },
    { title: "by", text: (row) => row.actor },
    { title: "reason", text: (row) => row.reason, isWide: true },
  ];
}

export function Facts({ facts }: { facts: [string, ComponentChildren][] }) {
  return <dl class="facts">{facts.map(([name, value]) => <div><dt>{name}</dt><dd>{value}</dd></div>)}</dl>;
}
