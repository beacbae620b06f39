// What is drawn on a panel in addition to its lines.
import type uPlot from "uplot";
import type { Mark, Panel, Stretch } from "./plot";

export function colourOf(name: string): string {
  return getComputedStyle(document.documentElement).getPropertyValue(name).trim() || "gray";
}

/** A tile of slanted lines. */
function slanted(plot: uPlot, colour: string): CanvasPattern {
  const tile = document.createElement("canvas");
  const size = tile.width = tile.height = Math.round(7 * devicePixelRatio);
  const ctx = tile.getContext("2d")!;
  ctx.strokeStyle = colour;
  ctx.lineWidth = devicePixelRatio;
  for (const shift of [-size, 0, size]) {
    ctx.moveTo(shift, size);
    ctx.lineTo(shift + size, 0);
  }
  ctx.stroke();
  return plot.ctx.createPattern(tile, "repeat")!;
}

const narrowest = 4;  // that shows lines

/** Fills ranges with slanted lines; narrow ones are filled as a whole. */
export function hatch(plot: uPlot, ranges: [number, number][], colour: string): void {
  const { ctx, bbox } = plot;
  const narrow = new Path2D(), wide = new Path2D();
  let isAnyWide = false;
  for (const [begin, end] of ranges) {
    const left = Math.max(bbox.left, plot.valToPos(begin, "x", true));
    const width = Math.min(bbox.left + bbox.width, plot.valToPos(end, "x", true)) - left;
    if (width <= 0) continue;
    const isWide = width > narrowest * devicePixelRatio;
    isAnyWide ||= isWide;
    (isWide ? wide : narrow).rect(left, bbox.top, Math.max(width, 1), bbox.height);
  }
  ctx.fillStyle = colour;
  ctx.fill(narrow);
  if (!isAnyWide) return;
  ctx.fillStyle = slanted(plot, colour);
  ctx.fill(wide);
}

/** Text on a ground of the panel's colour, so that lines behind it do not cross it. */
function write(ctx: CanvasRenderingContext2D, text: string, x: number, y: number): void {
  const width = ctx.measureText(text).width, pad = 2 * devicePixelRatio;
  const left = ctx.textAlign === "right" ? x - width : x;
  const colour = ctx.fillStyle;
  ctx.globalAlpha = 0.85;
  ctx.fillStyle = colourOf("--panel");
  ctx.fillRect(left - pad, y - 10 * devicePixelRatio, width + 2 * pad, 13 * devicePixelRatio);
  ctx.globalAlpha = 1;
  ctx.fillStyle = colour;
  ctx.fillText(text, x, y);
}

export function drawLevels(plot: uPlot, panel: Panel): void {
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
    if (level.label) write(ctx, level.label, bbox.left + bbox.width - 4 * devicePixelRatio, y - 6 * devicePixelRatio);
  }
}

/** Triangles at the edge where values lie outside the scale. */
export function drawOutside(plot: uPlot, panel: Panel): void {
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

export function drawMarks(plot: uPlot, marks: Mark[], named: boolean): void {
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
    write(ctx, mark.label, x + 3 * devicePixelRatio, bbox.top + bbox.height - 5 * devicePixelRatio);
    free = x + ctx.measureText(mark.label).width + 8 * devicePixelRatio;
  }
}

/** Who was champion when, above the panel. */
export function drawStretches(plot: uPlot, stretches: Stretch[]): void {
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
