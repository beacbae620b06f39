// From the bins of an answer to the points of a line.
import uPlot from "uplot";
import type { Columns } from "./api";

/** Times [s] and values; a null breaks the line. */
export type Points = [number[], (number | null)[]];

/** Extremes at the times at which they were. No line is drawn over a gap [s, s]. */
export function pointsOf(columns: Columns, begin: number, gaps: [number, number][] = []): Points {
  const times: number[] = [];
  const values: (number | null)[] = [];
  let gap = 0;
  const push = (at: number, value: number | null | undefined) => {
    while (gap < gaps.length && gaps[gap]![1] <= at) {
      const middle = begin + (gaps[gap]![0] + gaps[gap]![1]) / 2;
      if (times.length > 0 && middle > times[times.length - 1]!) {
        times.push(middle);
        values.push(null);
      }
      gap++;
    }
    if (value === undefined || value === null) return;
    const time = begin + at;
    if (times.length > 0 && time <= times[times.length - 1]!) return;
    times.push(time);
    values.push(value);
  };
  for (let i = 0; i < columns.least.length; i++) {
    const least: [number, number | null | undefined] = [columns.least_s[i]!, columns.least[i]];
    const greatest: [number, number | null | undefined] = [columns.greatest_s[i]!, columns.greatest[i]];
    const [first, second] = least[0] <= greatest[0] ? [least, greatest] : [greatest, least];
    push(...first);
    if (second[0] !== first[0]) push(...second);
  }
  return [times, values];
}

/** Levels of blocks [from, to), broken where blocks do not follow each other. */
export function levelsOf(from: number[], to: number[], values: (number | null)[], begin: number): Points {
  const times: number[] = [];
  const levels: (number | null)[] = [];
  const push = (at: number, value: number | null) => {
    const last = times[times.length - 1];
    times.push(last !== undefined && begin + at <= last ? last + 1e-3 : begin + at);
    levels.push(value);
  };
  for (let i = 0; i < from.length; i++) {
    if (i > 0 && from[i]! > to[i - 1]!) push((from[i]! + to[i - 1]!) / 2, null);
    push(from[i]!, values[i] ?? null);
    push(to[i]!, values[i] ?? null);
  }
  return [times, levels];
}

/** The times at which a line of blocks breaks: between blocks that do not follow each other. */
export function broken(times: number[], values: (number | null)[]): Points {
  const steps = times.slice(1).map((time, index) => time - times[index]!).sort((a, b) => a - b);
  const usual = steps[Math.floor(steps.length / 2)] ?? 0;
  const points: Points = [[], []];
  times.forEach((time, index) => {
    const before = times[index - 1];
    if (before !== undefined && time - before > 1.5 * usual) {
      points[0].push((before + time) / 2);
      points[1].push(null);
    }
    points[0].push(time);
    points[1].push(values[index] ?? null);
  });
  return points;
}

/** One table of several lines; what a line has no value for does not break it. */
export function joined(lines: Points[]): uPlot.AlignedData {
  if (lines.length === 0 || lines.every(([times]) => times.length === 0)) return [[]] as unknown as uPlot.AlignedData;
  return uPlot.join(lines as unknown as uPlot.AlignedData[]);
}

/**
 * A scale on which most of the values fill most of the height: one absurd value does not flatten the
 * others. What lies outside is marked at the edge.
 */
export function robustScale(lines: Points[], including: number[] = []): [number, number] {
  const values: number[] = [];
  for (const [, line] of lines) for (const value of line) if (value !== null) values.push(value);
  if (values.length === 0) return [0, 1];
  values.sort((a, b) => a - b);
  const at = (share: number) => values[Math.round(share * (values.length - 1))]!;
  const middle = at(0.98) - at(0.02);
  let low = values[0]!, high = values[values.length - 1]!;
  const room = 3 * (middle || Math.abs(at(0.5)) * 0.01 || 1);
  low = Math.max(low, at(0.02) - room);
  high = Math.min(high, at(0.98) + room);
  for (const value of including)
    if (value > low - (high - low) && value < high + (high - low)) {
      low = Math.min(low, value);
      high = Math.max(high, value);
    }
  const margin = (high - low || Math.abs(high) * 0.01 || 1) * 0.06;
  return [low - margin, high + margin];
}
