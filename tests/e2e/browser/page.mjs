// The page in Debian's Chromium: every view, in every theme and two widths.
//
//   node page.mjs URL EQUIPMENT [FOLDER]
//
// EQUIPMENT is SPACECRAFT/NAME, with versions and telemetry; pictures go into FOLDER. Prints one JSON
// object: findings of axe, errors of the console, requests and bytes, and what did not hold.
import { findings } from "./axe.mjs";
import { chromium } from "playwright-core";

const [url, subject, folder] = process.argv.slice(2);
const account = process.env.REIDENT_ACCOUNT?.split(":");  // NAME:PASSWORD of an approver
const [spacecraft, equipment] = subject.split("/");
const named = `spacecraft=${spacecraft}&equipment=${equipment}`;
const report = { axe: [], errors: [], foreign: [], failures: [], requests: 0, views: 0 };

const browser = await chromium.launch({ executablePath: "/usr/bin/chromium", args: ["--no-sandbox"] });

function check(holds, what) {
  if (!holds) report.failures.push(what);
}

async function open(options = {}) {
  const context = await browser.newContext({ viewport: { width: 1280, height: 900 }, ...options });
  const page = await context.newPage();
  page.on("console", (message) => {
    if (message.type() === "error") report.errors.push(message.text());
  });
  page.on("pageerror", (error) => report.errors.push(String(error)));
  page.on("request", (request) => {
    if (!request.url().startsWith(url) && !/^(blob|data):/.test(request.url())) report.foreign.push(request.url());
  });
  return page;
}

async function settled(page) {
  await page.waitForFunction(() => document.querySelector("main")?.childElementCount > 0 && !document.querySelector("main [aria-busy]"));
}

async function go(page, address) {
  await page.evaluate((hash) => { location.hash = hash; }, address);
  await settled(page);
}

const { line, outputs } = await (await fetch(`${url}api/v1/equipment?${named}`)).json();
const addresses = {
  overview: "#/overview", waiting: "#/waiting", equipment: `#/equipment?${named}`,
  "equipment-table": `#/equipment?${named}&show=table`,
  version: `#/version?${named}&version=${line.champion ?? line.waiting[0]}`,
  events: "#/events", runs: "#/runs", telemetry: "#/telemetry?find=" + outputs[0].name, handover: "#/handover", service: "#/service",
  fleet: "#/fleet",
};

async function everyView(theme, width) {
  const page = await open({ viewport: { width, height: 900 }, colorScheme: theme === "dark" ? "dark" : "light", deviceScaleFactor: 1 });
  await page.goto(url);
  await page.evaluate((name) => { localStorage.setItem("theme", name === "contrast" ? name : ""); }, theme);
  for (const [name, address] of Object.entries(addresses)) {
    await page.goto(`${url}?${report.views}${address}`);  // another fragment alone loads nothing
    await settled(page);
    if (name === "equipment") await page.waitForSelector(".u-wrap canvas");
    await page.waitForLoadState("load");
    report.views++;
    for (const { id, nodes } of await findings(page))
      report.axe.push(`${name} ${theme} ${width}: ${id} ${nodes.map((node) => `${node.html.slice(0, 120)} ${node.any[0]?.message ?? ""}`).join(" | ")}`);
    const wide = await page.evaluate(() => document.documentElement.scrollWidth - document.documentElement.clientWidth);
    check(wide <= 0, `${name} at ${width} is ${wide} pixels wider than the window`);
    if (folder) await page.screenshot({ path: `${folder}/${name}-${theme}-${width}.png`, fullPage: true, timeout: 0 });
  }
  await page.context().close();
}

// All bytes of the first view.
{
  const page = await open();
  page.on("request", () => report.requests++);
  await page.goto(url);
  await settled(page);
  await page.context().close();
}
for (const theme of ["light", "dark", "contrast"])
  for (const width of theme === "contrast" ? [1280] : [1280, 390]) await everyView(theme, width);

// By keyboard alone, from the overview to the figures of the plot.
{
  const page = await open();
  await page.goto(url);
  await settled(page);
  for (const key of ["j", "Enter"]) await page.keyboard.press(key);
  await page.waitForSelector(".u-wrap canvas");
  check(page.url().includes("#/equipment?"), "j and Enter open the first equipment");
  const before = page.url();
  await page.keyboard.press("+");
  await page.waitForFunction((old) => location.href !== old, before);
  const begin = new URLSearchParams(page.url().split("?")[1]).get("begin");
  check(Boolean(begin), "the range stands in the address");
  await page.keyboard.press("t");
  await page.waitForSelector("main table");
  const asked = new URLSearchParams(page.url().split("?")[1]);
  const telemetry = await (await fetch(`${url}api/v1/telemetry?${new URLSearchParams({ spacecraft, parameter: outputs[0].name, begin: asked.get("begin"), end: asked.get("end"), bins: "640" })}`)).json();
  const known = [...telemetry.least, ...telemetry.greatest].map(String);
  // Until the figures of the closer range have come.
  await page.waitForFunction((values) => {
    const rows = [...(document.querySelector("main section.table")?.querySelectorAll("tbody tr") ?? [])];
    const shown = rows.filter((row) => row.cells[1].textContent === "measured").map((row) => row.cells[2].textContent);
    return shown.length > 3 && shown.every((value) => values.includes(value));
  }, known);
  await page.keyboard.press("u");
  await page.keyboard.press("?");
  await page.waitForSelector("dialog[open]");
  await page.keyboard.press("Escape");
  await page.waitForFunction(() => !document.querySelector("dialog[open]"));
  await page.goBack();
  await page.context().close();
}

// The version that waits: found, read, and approved with a reason, by keyboard alone.
if (account) {
  const page = await open();
  await page.goto(url);
  await settled(page);
  let keys = 0;
  const press = async (...names) => {
    for (const name of names) {
      await page.keyboard.press(name);
      keys++;
    }
  };
  await page.getByRole("button", { name: "log in" }).click();
  await page.getByLabel("Name").fill(account[0]);
  await page.getByLabel("Password").fill(account[1]);
  await page.keyboard.press("Enter");
  await page.waitForFunction((name) => document.querySelector(".who")?.textContent.includes(name), account[0]);
  await page.evaluate(() => document.activeElement?.blur());
  await press("g", "w");
  await page.waitForFunction(() => location.hash.startsWith("#/waiting"));
  await settled(page);
  await page.waitForSelector("main a[data-row]");
  await press("j", "Enter");
  await page.waitForSelector("form.decide");
  check(await page.locator(".verdict").textContent() !== "", "the verdict stands above the form");
  for (const finding of await findings(page)) report.axe.push(`decide: ${finding.id}`);
  if (folder) await page.screenshot({ path: `${folder}/decide-light-1280.png` });
  await page.locator("main").focus();
  while (keys < 25 && !(await page.evaluate(() => document.activeElement?.tagName === "TEXTAREA"))) await press("Tab");
  await page.keyboard.type("seen on two passes");
  await press("Tab", "Enter");
  await page.waitForSelector("form.decide [role=status]");
  report.keys = keys;
  report.reply = await page.locator("form.decide [role=status]").textContent();
  check(keys <= 25, `${keys} keys`);
  await page.waitForFunction(() => document.querySelector(".status")?.textContent === "champion");
  // Ordering with these words again is another order, once the first was answered.
  await page.goto(`${url}${addresses.equipment}`);
  await page.waitForSelector("form.decide");
  await page.getByLabel("Reason").fill("training");
  for (const label of ["Hold the champion", "Release", "Hold the champion", "Release"]) {
    await page.getByRole("button", { name: label }).click();
    await page.waitForFunction((old) => [...document.querySelectorAll("form.decide button")].every((button) => button.textContent !== old), label);
  }
  // A key moves what is drawn within the frame. Dense lines have the width of a pixel next to marks of
  // decisions too: others take ten times as long.
  await page.waitForSelector(".u-wrap canvas");
  const widths = await page.evaluate(async () => {
    const found = [], { stroke } = CanvasRenderingContext2D.prototype;
    const measured = getComputedStyle(document.documentElement).getPropertyValue("--measured").trim();
    CanvasRenderingContext2D.prototype.stroke = function (...path) {
      if (path.length > 0 && this.strokeStyle === measured) found.push(this.lineWidth);
      return stroke.apply(this, path);
    };
    dispatchEvent(new KeyboardEvent("keydown", { key: "+" }));
    await new Promise(requestAnimationFrame);
    return found;
  });
  check(widths.length > 0 && widths.every((width) => width === 1), `lines that a key moved have widths ${widths}`);
  await page.context().close();
}

// What is no time, no view and no range is said, and the rest of the page stays. A decision leads to
// its version; what is missing and what operators ordered is there.
{
  const page = await open();
  const shown = async (address, selector) => {
    await page.goto("about:blank");
    await page.goto(url + address);
    await page.waitForSelector(selector);
  };
  await shown(`#/equipment?${named}&begin=nonsense`, "main .error");
  await page.waitForSelector(".u-wrap canvas");
  await shown(`#/equipment?${named}&begin=2020-09-13T13:00:00Z&end=2020-09-13T12:00:00Z`, "main .error");
  await page.waitForSelector(".u-wrap canvas");
  await shown("#/handover?begin=x&end=y", "main .error");
  await shown("#/%3Cb%3E?%E0%A4%A", "main .error");
  await shown("#/events?kind=approve,roll_back", "main td a[href*='version?']");
  await page.click("main td a[href*='version?']");
  await page.waitForSelector(".verdict");
  await shown("#/telemetry", "section[aria-label], main h2");
  for (const caption of ["Sensors that are not believed", "Gaps", "Completeness"])
    await page.getByRole("heading", { name: caption }).waitFor();
  await page.context().close();
}

// What is not live says so.
{
  const context = await browser.newContext();
  await context.route("**/api/v1/stream", (route) => route.abort());
  const page = await context.newPage();
  await page.goto(url);
  await page.waitForSelector(".stale");
  await page.waitForSelector(".pulse.bad");
  await context.close();
}

// In two zones: UTC is shown first, and each label names the zone.
for (const timezoneId of ["America/Sao_Paulo", "Asia/Shanghai"]) {
  const page = await open({ timezoneId });
  await page.goto(url);
  await settled(page);
  const texts = () => page.evaluate(() => [...document.querySelectorAll("main th, main td")].map((cell) => cell.textContent));
  const utc = await texts();
  check(utc.some((text) => text.includes("(UTC)")), "the zone is named");
  await page.keyboard.press("u");
  await page.waitForFunction((zone) => [...document.querySelectorAll("main th")].some((cell) => cell.textContent.includes(zone)), timezoneId);
  const local = await texts();
  const hour = (cells) => cells.map((text) => /^\d{4}-\d\d-\d\d (\d\d):/.exec(text)).filter(Boolean).map((match) => Number(match[1]))[0];
  if (hour(utc) !== undefined) check((hour(local) - hour(utc) + 24) % 24 === (timezoneId === "Asia/Shanghai" ? 8 : 21), `${timezoneId} is shown`);
  await page.context().close();
}

// Ten tabs of one browser share one stream.
{
  const context = await browser.newContext();
  let last = 0;
  for (let i = 0; i < 10; i++) {
    const page = await context.newPage();
    const begun = performance.now();
    await page.goto(url);
    await settled(page);
    await page.waitForFunction(() => document.querySelector(".pulse"));
    last = performance.now() - begun;
  }
  report.tenth_tab_ms = Math.round(last);
  const { page } = await (await fetch(`${url}api/v1/service`)).json();
  check(page.streams === 1, `ten tabs have ${page.streams} streams`);
  await context.close();
}
await browser.close();
console.log(JSON.stringify(report));
