// Panels one above the other on one axis of time.
import uPlot from "uplot";
import "uplot/dist/uPlot.min.css";
import { useEffect, useLayoutEffect, useRef } from "preact/hooks";
import { currentZone, figure, timeOfSeconds, zoneLabel } from "./format";
import { joined, robustScale, type Points } from "./series";

export interface Line {
  label: string;
  points: Points;
  colour: string;  // name of a custom property, such as "--measured"
  dash?: number[];
  width?: number;
}

export interface Level {
  value: number;
  label: string;
  colour: string;
}

export interface Panel {
  title: string;
  unit: string;
  lines: Line[];
  levels?: Level[];
  hatched?: [number, number][];  // nothing came
  height?: number;
}

export interface Mark {
  at: number;  // [s]
  label: string;
  kind: string;
}

export interface Stretch {
  begin: number;
  end: number;
  label: string;
  colour: string;
}

export interface PlotProperties {
  begin: number;  // [s]
  end: number;
  panels: Panel[];
  marks: Mark[];
  stretches: Stretch[];  // drawn as a strip over the first panel
  excluded: [number, number][];
  onRange: (begin: number, end: number) => void;
  describedBy?: string;
}

const leftAxis = 68;

function colourOf(name: string): string {
  return getComputedStyle(document.documentElement).getPropertyValue(name).trim() || "gray";
}

function hatch(plot: uPlot, begin: number, end: number, colour: string): void {
  const { ctx, bbox } = plot;
  const left = Math.max(bbox.left, plot.valToPos(begin, "x", true));
  const right = Math.min(bbox.left + bbox.width, plot.valToPos(end, "x", true));
  if (right <= left) return;
  ctx.save();
  ctx.beginPath();
  ctx.rect(left, bbox.top, Math.max(right - left, 1), bbox.height);
  ctx.clip();
  ctx.strokeStyle = colour;
  ctx.lineWidth = devicePixelRatio;
  const step = 7 * devicePixelRatio;
  ctx.beginPath();
  for (let x = left - bbox.height; x < right; x += step) {
    ctx.moveTo(x, bbox.top + bbox.height);
    ctx.lineTo(x + bbox.height, bbox.top);
  }
  ctx.stroke();
  ctx.restore();
}

function drawLevels(plot: uPlot, panel: Panel): void {
  const { ctx, bbox } = plot;
  ctx.font = `${11 * devicePixelRatio}px system-ui, sans-serif`;
  for (const level of panel.levels ?? []) {
    const y = plot.valToPos(level.value, "y", true);
    if (y < bbox.top || y > bbox.top + bbox.height) continue;
    ctx.strokeStyle = ctx.fillStyle = colourOf(level.colour);
    ctx.setLineDash([6 * devicePixelRatio, 4 * devicePixelRatio]);
    ctx.lineWidth = devicePixelRatio;
    ctx.beginPath();
    ctx.moveTo(bbox.left, y);
    ctx.lineTo(bbox.left + bbox.width, y);
    ctx.stroke();
    ctx.setLineDash([]);
    ctx.textAlign = "right";
    ctx.fillText(level.label, bbox.left + bbox.width - 4 * devicePixelRatio, y - 3 * devicePixelRatio);
  }
}

/** Triangles at the edge where values lie outside the scale. */
function drawOutside(plot: uPlot, panel: Panel): void {
  const { ctx, bbox } = plot;
  const { min, max } = plot.scales.y!;
  if (min === undefined || max === undefined || min === null || max === null) return;
  const size = 5 * devicePixelRatio;
  for (const line of panel.lines) {
    ctx.fillStyle = colourOf(line.colour);
    const [times, values] = line.points;
    let last = -Infinity;
    for (let i = 0; i < times.length; i++) {
      const value = values[i];
      if (value === null || value === undefined || (value >= min && value <= max)) continue;
      const x = plot.valToPos(times[i]!, "x", true);
      if (x < bbox.left || x > bbox.left + bbox.width || x - last < size) continue;
      last = x;
      const edge = value > max ? bbox.top : bbox.top + bbox.height;
      const into = value > max ? size * 1.6 : -size * 1.6;
      ctx.beginPath();
      ctx.moveTo(x, edge);
      ctx.lineTo(x - size, edge + into);
      ctx.lineTo(x + size, edge + into);
      ctx.fill();
    }
  }
}

function drawMarks(plot: uPlot, marks: Mark[], named: boolean): void {
  const { ctx, bbox } = plot;
  ctx.font = `${11 * devicePixelRatio}px system-ui, sans-serif`;
  ctx.textAlign = "left";
  let free = -Infinity;
  for (const mark of marks) {
    const x = plot.valToPos(mark.at, "x", true);
    if (x < bbox.left || x > bbox.left + bbox.width) continue;
    ctx.strokeStyle = ctx.fillStyle = colourOf(`--event-${mark.kind}`);
    ctx.lineWidth = 1.4 * devicePixelRatio;
    ctx.setLineDash(mark.kind === "approve" || mark.kind === "roll_back" ? [] : [3 * devicePixelRatio, 3 * devicePixelRatio]);
    ctx.beginPath();
    ctx.moveTo(x, bbox.top);
    ctx.lineTo(x, bbox.top + bbox.height);
    ctx.stroke();
    ctx.setLineDash([]);
    if (!named || x < free) continue;
    ctx.fillText(mark.label, x + 3 * devicePixelRatio, bbox.top + bbox.height - 5 * devicePixelRatio);
    free = x + ctx.measureText(mark.label).width + 8 * devicePixelRatio;
  }
}

/** Who was champion when, above the panel. */
function drawStretches(plot: uPlot, stretches: Stretch[]): void {
  const { ctx, bbox } = plot;
  const height = 15 * devicePixelRatio;
  ctx.font = `${11 * devicePixelRatio}px system-ui, sans-serif`;
  ctx.textAlign = "left";
  for (const stretch of stretches) {
    const left = Math.max(bbox.left, plot.valToPos(stretch.begin, "x", true));
    const right = Math.min(bbox.left + bbox.width, plot.valToPos(stretch.end, "x", true));
    if (right <= left) continue;
    ctx.fillStyle = colourOf(stretch.colour);
    ctx.fillRect(left, bbox.top - height, Math.max(right - left - devicePixelRatio, devicePixelRatio), height - 2 * devicePixelRatio);
    if (right - left < ctx.measureText(stretch.label).width + 6 * devicePixelRatio) continue;
    ctx.fillStyle = colourOf("--strip-text");
    ctx.fillText(stretch.label, left + 4 * devicePixelRatio, bbox.top - 5 * devicePixelRatio);
  }
}

function axis(text: string, side: number, options: Partial<uPlot.Axis>): uPlot.Axis {
  return {
    side,
    label: text,
    labelSize: 16,
    labelFont: "12px system-ui, sans-serif",
    font: "11px system-ui, sans-serif",
    stroke: () => colourOf("--quiet"),
    grid: { stroke: () => colourOf("--grid"), width: 1 },
    ticks: { stroke: () => colourOf("--grid"), width: 1, size: 4 },
    ...options,
  };
}

/** Times of day; the date stands where it changes. */
function timeLabels(splits: number[], step: number): string[] {
  let day = "";
  return splits.map((split) => {
    const [date = "", time = ""] = timeOfSeconds(split).split(" ");
    if (step >= 86400) return step >= 28 * 86400 ? date.slice(0, 7) : date;
    const shown = step >= 60 ? time.slice(0, 5) : time;
    const label = date === day ? shown : `${shown}\n${date}`;
    day = date;
    return label;
  });
}

function options(panel: Panel, place: { isFirst: boolean; isLast: boolean; width: number },
                 properties: () => PlotProperties): uPlot.Options {
  const scale = robustScale(panel.lines.map((line) => line.points), (panel.levels ?? []).map((level) => level.value));
  return {
    width: place.width,
    height: (panel.height ?? 150) + (place.isLast ? 56 : 0),
    padding: [place.isFirst ? 18 : 6, 8, place.isLast ? 0 : 4, 0],
    legend: { show: false },
    cursor: { sync: { key: "reident", scales: ["x", null] }, drag: { x: true, y: false, setScale: false }, points: { size: 5 } },
    tzDate: (seconds) => currentZone() === "UTC" ? uPlot.tzDate(new Date(seconds * 1000), "Etc/UTC") : new Date(seconds * 1000),
    scales: {
      x: { time: true, range: () => [properties().begin, properties().end] },
      y: { range: () => scale },
    },
    axes: [
      axis(place.isLast ? `time (${zoneLabel()})` : "", 2, place.isLast ? { size: 40, values: (_, splits, __, ___, step) => timeLabels(splits, step) } : { size: 0, label: undefined, values: (_, splits) => splits.map(() => "") }),
      axis(panel.unit, 3, { space: 24, size: leftAxis - 16, values: (_, splits) => splits.map((value) => figure(value, 5)) }),
    ],
    series: [
      {},
      ...panel.lines.map((line): uPlot.Series => ({
        label: line.label,
        stroke: () => colourOf(line.colour),
        width: line.width ?? 1.2,
        dash: line.dash,
        points: { show: (plot, index) => plot.data[0].length < 120 && index > 0, size: 4 },
      })),
    ],
    hooks: {
      drawClear: [(plot) => {
        for (const [begin, end] of panel.hatched ?? []) hatch(plot, begin, end, colourOf("--gap"));
        for (const [begin, end] of properties().excluded) hatch(plot, begin, end, colourOf("--excluded"));
      }],
      draw: [(plot) => {
        drawLevels(plot, panel);
        drawOutside(plot, panel);
        drawMarks(plot, properties().marks, place.isFirst);
        if (place.isFirst) drawStretches(plot, properties().stretches);
      }],
      setSelect: [(plot) => {
        if (plot.select.width < 4) return;
        const begin = plot.posToVal(plot.select.left, "x");
        const end = plot.posToVal(plot.select.left + plot.select.width, "x");
        plot.setSelect({ left: 0, top: 0, width: 0, height: 0 }, false);
        properties().onRange(begin, end);
      }],
    },
  };
}

export function Plot(properties: PlotProperties) {
  const host = useRef<HTMLDivElement>(null);
  const plots = useRef<uPlot[]>([]);
  const last = useRef(properties);
  last.current = properties;

  useLayoutEffect(() => {
    const element = host.current!;
    const make = () => {
      for (const plot of plots.current) plot.destroy();
      element.replaceChildren();
      plots.current = last.current.panels.map((panel, index, all) => {
        const figureElement = document.createElement("div");
        figureElement.className = "panel";
        const title = document.createElement("div");
        title.className = "panel-title";
        title.textContent = panel.title;
        for (const line of panel.lines) {
          const key = document.createElement("span");
          key.className = "key";
          const sample = document.createElement("i");
          sample.style.borderTop = `2px ${line.dash ? "dashed" : "solid"} var(${line.colour})`;
          key.append(sample, line.label);
          title.append(key);
        }
        figureElement.append(title);
        element.append(figureElement);
        const place = { isFirst: index === 0, isLast: index === all.length - 1, width: element.clientWidth };
        return new uPlot(options(panel, place, () => last.current), joined(panel.lines.map((line) => line.points)), figureElement);
      });
    };
    make();
    let width = element.clientWidth;
    const observer = new ResizeObserver(() => {
      if (element.clientWidth === width) return;
      width = element.clientWidth;
      make();
    });
    observer.observe(element);
    const scheme = matchMedia("(prefers-color-scheme: dark)");
    scheme.addEventListener("change", make);
    addEventListener("themechange", make);
    return () => {
      observer.disconnect();
      scheme.removeEventListener("change", make);
      removeEventListener("themechange", make);
      for (const plot of plots.current) plot.destroy();
      plots.current = [];
    };
  }, [properties.panels, properties.marks, properties.stretches, properties.excluded]);

  // A range alone: the lines that are there move within the frame, before the new ones come.
  useEffect(() => {
    for (const plot of plots.current) plot.setScale("x", { min: properties.begin, max: properties.end });
  }, [properties.begin, properties.end]);

  return <div class="plot" ref={host} role="img" aria-label="plot over time" aria-describedby={properties.describedBy} />;
}
