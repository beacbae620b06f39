// The plugin for Open MCT in Debian's Chromium, with the npm package of Open MCT, on one origin with
// the page's server.
//
//   node openmct.mjs URL SPACECRAFT EQUIPMENT PARAMETER PLUGIN
//
// Prints a line "listening" when it waits for a sample and a decision that are new; then one JSON object.
import { createServer, request as ask } from "node:http";
import { readFileSync } from "node:fs";
import { dirname, extname, join } from "node:path";
import { fileURLToPath } from "node:url";
import { chromium } from "playwright-core";

const [url, spacecraft, equipment, parameter, plugin] = process.argv.slice(2);
const dist = join(dirname(fileURLToPath(import.meta.url)), "node_modules/openmct/dist");
const types = { ".js": "text/javascript", ".css": "text/css", ".html": "text/html", ".svg": "image/svg+xml", ".woff": "font/woff" };
const report = { failures: [], errors: [] };
const check = (holds, what) => { if (!holds) report.failures.push(what); };

const html = `<!doctype html><meta charset="utf-8"><title>Open MCT</title><script src="/openmct/openmct.js"></script>
<script type="module">
  import reident from "/openmct-reident.js";
  const hour = 3600e3, end = Number(new URLSearchParams(location.search).get("end"));
  openmct.setAssetPath("/openmct");
  openmct.install(openmct.plugins.LocalStorage());
  openmct.install(openmct.plugins.Espresso());
  openmct.install(openmct.plugins.UTCTimeSystem());
  openmct.install(openmct.plugins.Conductor({ menuOptions: [{ name: "fixed", timeSystem: "utc", bounds: { start: end - 24 * hour, end } }] }));
  openmct.install(reident({ url: "/reident" }));
  window.started = new Promise((started) => openmct.on("start", started));
  openmct.start();
</script>`;
let seriesAsked = 0;
const server = createServer((request, response) => {
  if (request.url.startsWith("/reident/api/v1/series")) seriesAsked++;
  if (request.url.startsWith("/reident/")) {
    const asked = ask(new URL(request.url.slice("/reident".length), url), { method: request.method, headers: { ...request.headers, host: new URL(url).host } }, (answer) => {
      response.writeHead(answer.statusCode, answer.headers);
      answer.pipe(response);
    });
    response.on("close", () => asked.destroy());
    asked.on("error", () => response.destroy());
    request.pipe(asked);
    return;
  }
  const path = request.url.split("?")[0];
  const file = path === "/openmct-reident.js" ? plugin : path.startsWith("/openmct/") ? join(dist, path.slice("/openmct/".length)) : null;
  try {
    const body = file ? readFileSync(file) : html;
    response.writeHead(200, { "Content-Type": types[file ? extname(file) : ".html"] ?? "application/octet-stream" }).end(body);
  } catch {
    response.writeHead(404).end();
  }
});
await new Promise((listening) => server.listen(0, "127.0.0.1", listening));
const origin = `http://127.0.0.1:${server.address().port}`;

const query = (parameters) => new URLSearchParams(parameters);
const { series } = await (await fetch(`${url}api/v1/series`)).json();
const stored = series.find((one) => one.parameter === parameter);
const begin = Date.parse(stored.first), end = Date.parse(stored.last) + 1000;
const named = query({ spacecraft, parameter, begin: new Date(begin).toISOString(), end: new Date(end).toISOString(), bins: "100" });
const expected = await (await fetch(`${url}api/v1/telemetry?${named}`)).json();
const { versions } = await (await fetch(`${url}api/v1/equipment?${query({ spacecraft, equipment })}`)).json();

const browser = await chromium.launch({ executablePath: "/usr/bin/chromium", args: ["--no-sandbox"] });
const page = await (await browser.newContext({ viewport: { width: 1280, height: 900 } })).newPage();
page.setDefaultTimeout(60_000);
page.on("pageerror", (error) => report.errors.push(String(error)));
await page.goto(`${origin}/?end=${end}`);
await page.evaluate(() => window.started);

const found = await page.evaluate(async ({ spacecraft, equipment, parameter, begin, end }) => {
  const { openmct } = window;
  const object = (...parts) => openmct.objects.get({ namespace: "reident", key: ["root", ...parts].join("~") });
  const children = async (parent) => (await openmct.composition.get(parent).load()).map(({ identifier }) => identifier.key);
  const one = await object(spacecraft, "telemetry", parameter);
  const request = (options) => openmct.telemetry.request(one, { start: begin, end, ...options });
  window.heard = { points: [], batches: [], decisions: [] };
  openmct.telemetry.subscribe(one, (point) => window.heard.points.push(point));
  openmct.telemetry.subscribe(one, (batch) => window.heard.batches.push(batch), { strategy: "batch" });
  openmct.telemetry.subscribe(await object(spacecraft, equipment, "decisions"), (decision) => window.heard.decisions.push(decision));
  return {
    root: await children(await object()), spacecraft: await children(await object(spacecraft)),
    telemetry: await children(await object(spacecraft, "telemetry")), equipment: await children(await object(spacecraft, equipment)),
    minmax: await request({ strategy: "minmax", size: 200 }), latest: await request({ strategy: "latest", size: 1 }),
    decisions: await openmct.telemetry.request(await object(spacecraft, equipment, "decisions"), { start: begin, end }),
    error: await openmct.telemetry.request(await object(spacecraft, equipment, "error"), { start: begin, end }),
    limits: await openmct.telemetry.getLimits(one).limits(),
  };
}, { spacecraft, equipment, parameter, begin, end });

check(found.root.includes(`root~${spacecraft}`), `the root has ${found.root}`);
check(found.spacecraft.includes(`root~${spacecraft}~${equipment}`), `${spacecraft} has ${found.spacecraft}`);
check(found.telemetry.includes(`root~${spacecraft}~telemetry~${parameter}`), `telemetry has ${found.telemetry}`);
check(found.equipment.includes(`root~${spacecraft}~${equipment}~error`), `${equipment} has ${found.equipment}`);
const values = new Set(found.minmax.map(({ value }) => value));
check([...expected.least, ...expected.greatest].every((value) => values.has(value)), "extremes of each bin are among the points");
check(found.minmax.every(({ utc }, i) => i === 0 || utc > found.minmax[i - 1].utc), "points ascend");
check(found.minmax.every(({ utc }) => utc >= begin && utc < end), "points are in the range");
check(found.latest.length === 1 && Math.abs(found.latest[0].utc - Date.parse(stored.last)) < 1, `the latest is ${JSON.stringify(found.latest)}`);
check(found.decisions.length > 0 && found.decisions.every(({ kind, actor }) => kind && actor), "decisions have who and what");
check(found.limits.CRITICAL !== undefined, "limits are told");

const askedBefore = seriesAsked;
await page.evaluate((keys) => Promise.all(keys.map((key) => window.openmct.objects.get({ namespace: "reident", key }))), found.telemetry);
check(found.telemetry.length > 1 && seriesAsked - askedBefore <= 1, `${found.telemetry.length} parameters share an answer, not ${seriesAsked - askedBefore}`);

await page.waitForFunction(() => window.heard.points.length > 0);
check(await page.evaluate(async ({ spacecraft, parameter }) =>
  (await window.openmct.telemetry.isStale(await window.openmct.objects.get({ namespace: "reident", key: `root~${spacecraft}~telemetry~${parameter}` }))).isStale === false,
{ spacecraft, parameter }), "telemetry is fresh while the service is heard");

const browse = (...keys) => page.evaluate((path) => { location.hash = path; },
  `#/browse/${keys.map((key) => `reident:${["root", ...key].join("~")}`).join("/")}`);
const begun = performance.now();
await browse([], [spacecraft], [spacecraft, "telemetry"], [spacecraft, "telemetry", parameter]);
await page.waitForSelector(".gl-plot canvas");
report.plot_ms = Math.round(performance.now() - begun);
if (process.env.REIDENT_PICTURES) await page.screenshot({ path: `${process.env.REIDENT_PICTURES}/openmct-plot.png` });
await browse([], [spacecraft], [spacecraft, equipment]);
await page.waitForFunction((count) => document.querySelectorAll("tr[data-version]").length === count, versions.length);
if (process.env.REIDENT_PICTURES) await page.screenshot({ path: `${process.env.REIDENT_PICTURES}/openmct-versions.png` });

const known = await page.evaluate(() => window.heard.points[window.heard.points.length - 1].utc);
console.log("listening");
await page.waitForFunction((utc) => window.heard.points.some((point) => point.utc > utc), known);
await page.waitForFunction((utc) => window.heard.batches.some((batch) => batch.some((point) => point.utc > utc)), known);
await page.waitForFunction(() => window.heard.decisions.some(({ actor, reason }) => actor === "Ana" && reason === "seen in Open MCT"));
await browser.close();
server.close();
server.closeAllConnections();
console.log(JSON.stringify(report));
