// Panels one above the other on one axis of time.
import uPlot from "uplot";
import "uplot/dist/uPlot.min.css";
import { useEffect, useLayoutEffect, useRef } from "preact/hooks";
import { currentZone, figure, timeOfSeconds, zoneLabel } from "./format";
import { colourOf, drawLevels, drawMarks, drawOutside, drawStretches, hatch } from "./marks";
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

function options(panel: Panel, place: Place, properties: () => PlotProperties): uPlot.Options {
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
        width: line.points[0].length > place.width / 2 ? 1 / devicePixelRatio : line.width ?? 1.2,  // what is dense is drawn ten times as fast in the width of a pixel
        dash: line.dash,
        points: { show: (plot, index) => plot.data[0].length < 120 && index > 0, size: 4 },
      })),
    ],
    hooks: {
      drawClear: [(plot) => {
        plot.ctx.save();
        hatch(plot, panel.hatched ?? [], colourOf("--gap"));
        hatch(plot, properties().excluded, colourOf("--excluded"));
        plot.ctx.restore();
      }],
      draw: [(plot) => {
        plot.ctx.save();  // uPlot remembers what it set
        drawLevels(plot, panel);
        drawOutside(plot, panel);
        drawMarks(plot, properties().marks, place.isFirst);
        if (place.isFirst) drawStretches(plot, properties().stretches);
        plot.ctx.restore();
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

interface Place {
  isFirst: boolean;
  isLast: boolean;
  width: number;
}

interface Drawn {
  panel: Panel;
  place: Place;
  element: HTMLElement;
  plot: uPlot;
}

function draw(panel: Panel, place: Place, properties: () => PlotProperties): Drawn {
  const element = document.createElement("div");
  element.className = "panel";
  const title = document.createElement("div");
  title.className = "panel-title";
  title.textContent = panel.title;
  const keys = new Map(panel.lines.map((line) => [line.label, line]));
  for (const line of keys.values()) {
    const key = document.createElement("span");
    key.className = "key";
    const sample = document.createElement("i");
    sample.style.borderTop = `2px ${line.dash ? "dashed" : "solid"} var(${line.colour})`;
    key.append(sample, line.label);
    title.append(key);
  }
  element.append(title);
  return { panel, place, element, plot: new uPlot(options(panel, place, properties), joined(panel.lines.map((line) => line.points)), element) };
}

export function Plot(properties: PlotProperties) {
  const host = useRef<HTMLDivElement>(null);
  const drawn = useRef<Drawn[]>([]);
  const last = useRef(properties);
  last.current = properties;

  /** Draws what is new; a panel that is as it was stays. */
  const update = () => {
    const width = host.current!.clientWidth;
    const before = new Set(drawn.current);
    drawn.current = last.current.panels.map((panel, index, all) => {
      const place = { isFirst: index === 0, isLast: index === all.length - 1, width };
      for (const one of before)
        if (one.panel === panel && JSON.stringify(one.place) === JSON.stringify(place)) {
          before.delete(one);
          return one;
        }
      return draw(panel, place, () => last.current);
    });
    for (const one of before) one.plot.destroy();
    host.current!.replaceChildren(...drawn.current.map((one) => one.element));
  };
  const clear = () => {
    for (const one of drawn.current) one.plot.destroy();
    drawn.current = [];
  };

  useLayoutEffect(update, [properties.panels]);
  useLayoutEffect(() => {
    const again = () => {
      clear();
      update();
    };
    let width = host.current!.clientWidth;
    const observer = new ResizeObserver(() => {
      if (host.current!.clientWidth === width) return;
      width = host.current!.clientWidth;
      again();
    });
    observer.observe(host.current!);
    const scheme = matchMedia("(prefers-color-scheme: dark)");
    scheme.addEventListener("change", again);
    addEventListener("themechange", again);
    return () => {
      observer.disconnect();
      scheme.removeEventListener("change", again);
      removeEventListener("themechange", again);
      clear();
    };
  }, []);
  useEffect(() => {
    for (const { plot } of drawn.current) plot.redraw();
  }, [properties.marks, properties.stretches, properties.excluded]);

  // A range alone: the lines that are there move within the frame, before the new ones come.
  useLayoutEffect(() => {
    for (const { plot } of drawn.current) plot.setScale("x", { min: properties.begin, max: properties.end });
  }, [properties.begin, properties.end]);

  return <div class="plot" ref={host} role="img" aria-label="plot over time" aria-describedby={properties.describedBy} />;
}
