// Figures of the page in Debian's Chromium, as one JSON object.
//
//   browser.mjs URL first|plot|tabs|live [REPETITIONS]
import { createRequire } from "node:module";

const require = createRequire(new URL("../../e2e/browser/package.json", import.meta.url));
const { chromium } = require("playwright-core");
const [url, what, repetitions = "30"] = process.argv.slice(2);
const browser = await chromium.launch({ executablePath: "/usr/bin/chromium", args: ["--no-sandbox", "--enable-precise-memory-info", "--js-flags=--expose-gc"] });
const sorted = (times) => [...times].sort((a, b) => a - b);
const median = (times) => sorted(times)[Math.floor(times.length / 2)];
const p95 = (times) => sorted(times)[Math.min(times.length - 1, Math.floor(0.95 * times.length))];
const figures = {};

/** The first view with an empty cache: what it costs, and until its rows can be moved in. */
async function first() {
  const times = [];
  for (let i = 0; i < Number(repetitions); i++) {
    const context = await browser.newContext();
    const page = await context.newPage();
    const session = await context.newCDPSession(page);
    await session.send("Network.enable");
    let bytes = 0, requests = 0, foreign = 0;
    session.on("Network.loadingFinished", (event) => { bytes += event.encodedDataLength; });
    page.on("request", (request) => {
      requests++;
      if (!request.url().startsWith(url)) foreign++;
    });
    const begun = performance.now();
    await page.goto(url);
    await page.waitForSelector("main a[data-row]");
    times.push(performance.now() - begun);
    await page.waitForLoadState("load");
    Object.assign(figures, { bytes, requests, foreign });
    await context.close();
  }
  figures.overview_ms = median(times);
  figures.overview_p95_ms = p95(times);
}

/** The plot of a year: until the last line is drawn; then from a key that moves it to the frame. */
async function plot() {
  const page = await (await browser.newContext({ viewport: { width: 1280, height: 900 } })).newPage();
  const answer = await (await fetch(`${url}api/v1/equipment?spacecraft=BENCH&equipment=E1`)).json();
  const { begin, end } = answer.telemetry;
  const panels = answer.outputs.length + answer.parameters.length;
  const drawn = () => page.waitForFunction((count) => document.querySelectorAll(".panel .u-wrap").length >= count, panels);
  const times = [];
  for (let i = 0; i < Number(repetitions); i++) {
    await page.goto(`${url}#/overview`);
    await page.waitForSelector("main a[data-row]");
    const begun = performance.now();
    await page.evaluate((hash) => { location.hash = hash; }, `#/equipment?spacecraft=BENCH&equipment=E1&begin=${begin}&end=${end}`);
    await drawn();
    times.push(performance.now() - begun);
  }
  figures.plot_year_ms = p95(times);
  figures.plot_year_median_ms = median(times);
  const closer = page.waitForResponse((response) => response.url().includes("timeline"));
  await page.keyboard.press("+");  // the whole year has no place to move to
  await closer;
  const moved = await page.evaluate(async (count) => {
    const times = [];
    for (let i = 0; i < count; i++) {
      const begun = await new Promise(requestAnimationFrame);
      const isMoved = new Promise((done) => addEventListener("hashchange", done, { once: true }));
      dispatchEvent(new KeyboardEvent("keydown", { key: i % 2 ? "ArrowRight" : "ArrowLeft" }));
      await isMoved;
      await new Promise(requestAnimationFrame);
      await new Promise((done) => setTimeout(done));
      times.push(performance.now() - begun);
      await new Promise((done) => setTimeout(done, 300));  // the answer's own drawing is apart
    }
    return times;
  }, Number(repetitions));
  figures.pan_ms = p95(moved);
}

/** The tenth tab of one browser. */
async function tabs() {
  const times = [];
  for (let i = 0; i < Number(repetitions); i++) {
    const context = await browser.newContext();
    for (let tab = 1; tab <= 10; tab++) {
      const page = await context.newPage();
      const begun = performance.now();
      await page.goto(url);
      await page.waitForSelector("main a[data-row]");
      if (tab === 10) times.push(performance.now() - begun);
    }
    await context.close();
  }
  figures.tenth_tab_ms = p95(times);
}

/** The heap of a tab that hears the service, as after a day: state is replaced, not kept. */
async function live() {
  const page = await (await browser.newContext()).newPage();
  await page.goto(url);
  await page.waitForSelector("main a[data-row]");
  const heap = () => page.evaluate(() => { globalThis.gc(); return performance.memory.usedJSHeapSize; });
  const updates = 86_400;
  const send = (count) => page.evaluate((n) => {
    const channel = new BroadcastChannel("reident");
    for (let i = 0; i < n; i++)
      channel.postMessage({ event: "service", data: { service: "reident", age_s: 0, time: String(i), newest_telemetry: "2026-01-01T00:00:00Z", last_error: "", windows_pending: i % 3 } });
    channel.close();
    return new Promise((done) => setTimeout(done, 200));
  }, count);
  await send(1000);
  const before = await heap();
  for (let sent = 0; sent < updates; sent += 2400) await send(2400);
  figures.heap_mb = (await heap() - before) / 1e6;
}

await { first, plot, tabs, live }[what]();
await browser.close();
console.log(JSON.stringify(figures));
