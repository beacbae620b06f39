// Times and figures as people read them. A figure that is not known is a dash, never a zero.

export type Zone = "UTC" | "local";

let zone: Zone = localStorage.getItem("zone") === "local" ? "local" : "UTC";
const listeners = new Set<() => void>();

export function currentZone(): Zone {
  return zone;
}

/** The label of the zone that times are shown in. */
export function zoneLabel(): string {
  return zone === "UTC" ? "UTC" : Intl.DateTimeFormat().resolvedOptions().timeZone;
}

export function toggleZone(): void {
  zone = zone === "UTC" ? "local" : "UTC";
  localStorage.setItem("zone", zone);
  listeners.forEach((listener) => listener());
}

export function onZoneChange(listener: () => void): () => void {
  listeners.add(listener);
  return () => listeners.delete(listener);
}

export const unknown = "–";

/** Seconds since 1970 of a text of UTC; a double, for what is drawn or compared. */
export function secondsOf(iso: string): number {
  const [, whole = "", fraction = ""] = /^([^.Z]+)(\.\d+)?Z$/.exec(iso) ?? [];
  return Date.parse(`${whole}Z`) / 1000 + Number(fraction || 0);
}

/** A time of UTC for the API, to the millisecond. */
export function isoOf(seconds: number): string {
  return new Date(Math.round(seconds * 1000)).toISOString();
}

function parts(date: Date): string {
  if (zone === "UTC") return date.toISOString().replace("T", " ").slice(0, 19);
  const two = (n: number) => String(n).padStart(2, "0");
  return `${date.getFullYear()}-${two(date.getMonth() + 1)}-${two(date.getDate())} ` +
    `${two(date.getHours())}:${two(date.getMinutes())}:${two(date.getSeconds())}`;
}

/** "2026-11-26 11:03:33" in the zone that is shown. */
export function timeText(iso: string | null | undefined): string {
  return iso ? parts(new Date(secondsOf(iso) * 1000)) : unknown;
}

export function timeOfSeconds(seconds: number): string {
  return parts(new Date(seconds * 1000));
}

/** "4 s", "12 min", "3.5 h", "12 d". */
export function durationText(seconds: number): string {
  if (!isFinite(seconds)) return unknown;
  if (seconds < 90) return `${Math.round(seconds)} s`;
  if (seconds < 5400) return `${Math.round(seconds / 60)} min`;
  if (seconds < 172800) return `${(seconds / 3600).toFixed(1)} h`;
  return `${Math.round(seconds / 86400)} d`;
}

export function figure(value: number | null | undefined, digits = 3): string {
  if (value === null || value === undefined || !isFinite(value)) return unknown;
  if (value === 0) return "0";
  const size = Math.abs(value);
  return size >= 1e5 || size < 1e-3 ? value.toExponential(digits - 1) : String(Number(value.toPrecision(digits)));
}

export function percent(value: number | null | undefined): string {
  const text = figure(value);
  return text === unknown ? text : `${text} %`;
}

export function count(value: number | null | undefined): string {
  return value === null || value === undefined ? unknown : value.toLocaleString("en").replace(/,/g, " ");
}

export function bytesText(bytes: number): string {
  const units = ["B", "KB", "MB", "GB", "TB"];
  let unit = 0;
  while (bytes >= 1000 && unit + 1 < units.length) {
    bytes /= 1000;
    unit++;
  }
  return `${Number(bytes.toPrecision(3))} ${units[unit]}`;
}
