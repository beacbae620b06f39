// The frame around the views: where one is, what the service does, keys.
import { render } from "preact";
import "./page.css";
import { useEffect, useErrorBoundary, useRef, useState } from "preact/hooks";
import type { Service } from "./api";
import { durationText, timeText, toggleZone } from "./format";
import { Who } from "./decide";
import { begin, clockError, useChanges } from "./live";
import { useZone } from "./parts";
import { learn, useSession } from "./session";
import { go, link, usePlace, type Place } from "./url";
import { CompletenessView } from "./views/completeness";
import { EquipmentView } from "./views/equipment";
import { EventsView } from "./views/events";
import { FleetView } from "./views/fleet";
import { HandoverView } from "./views/handover";
import { Overview } from "./views/overview";
import { ServiceView } from "./views/service";
import { SimulatorsView } from "./views/simulators";
import { VersionView } from "./views/version";
import { WaitingView } from "./views/waiting";

const views: [string, string][] = [
  ["overview", "Overview"], ["waiting", "Waiting"], ["events", "Events"], ["runs", "Simulators"], ["telemetry", "Telemetry"], ["handover", "Handover"], ["service", "Service"], ["fleet", "Fleet"],
];

const keys: [string, string][] = [
  ["j, k", "next, previous row"], ["Enter", "open the row"], ["g then o, w, e, r, t, h, s, f", "overview, waiting, events, simulators, telemetry, handover, service, fleet"],
  ["+, −", "closer, farther in time"], ["←, →", "earlier, later"], ["[, ]", "previous, next decision"], ["0", "the usual range"],
  ["t", "plot or table"], ["u", "UTC or the zone of this computer"], ["d", "light, dark, high contrast"], ["?", "these keys"], ["Esc", "close"],
];

const themes = ["", "light", "dark", "contrast"];

function nextTheme(): void {
  const now = document.documentElement.dataset.theme ?? "";
  const next = themes[(themes.indexOf(now) + 1) % themes.length]!;
  document.documentElement.dataset.theme = next;
  localStorage.setItem("theme", next);
  dispatchEvent(new Event("themechange"));
}

function View({ view, parameters }: Place) {
  switch (view) {
    case "overview": return <Overview />;
    case "waiting": return <WaitingView />;
    case "equipment": return <EquipmentView key={`${parameters.spacecraft}/${parameters.equipment}`} parameters={parameters} />;
    case "version": return <VersionView key={JSON.stringify([parameters.spacecraft, parameters.equipment, parameters.version])} parameters={parameters} />;
    case "events": return <EventsView parameters={parameters} />;
    case "runs": return <SimulatorsView />;
    case "telemetry": return <CompletenessView parameters={parameters} />;
    case "handover": return <HandoverView parameters={parameters} />;
    case "service": return <ServiceView />;
    case "fleet": return <FleetView />;
    default: return <p class="error" role="alert">There is no view {view}. <a href="#/overview">Overview</a></p>;
  }
}

/** A view that cannot be drawn says so, and leaves the rest of the page. */
function Guarded(place: Place) {
  const [error, forget] = useErrorBoundary();
  useEffect(() => {
    if (error) forget();
  }, [link(place.view, place.parameters)]);
  if (error) return <p class="error" role="alert">This address cannot be shown ({String(error.message ?? error)}). <a href="#/overview">Overview</a></p>;
  return <View {...place} />;
}

interface Heard {
  status: Service;
  heard: number;  // [s]
}

const freshSeconds = 5;
const ageOf = (one: Heard) => Date.now() / 1000 - one.heard;

/** One that lives comes before one that is silent, and of a pair the one that leads. */
const rank = (one: Heard) => (ageOf(one) > freshSeconds ? 2 : one.status.pair && one.status.pair.role !== "leads" ? 1 : 0);

interface Life {
  service?: Heard;
  isOpen: boolean;    // the page's server answers
  isSilent: boolean;  // no service is heard, for so long that none runs
}

function useLife(): Life {
  const [services, set] = useState<Record<string, Heard>>({});
  const [isOpen, setOpen] = useState(true);
  const [opened] = useState(() => performance.now());
  const [, tick] = useState(0);
  useChanges(({ event, data }) => {
    if (event === "connection") setOpen(data.open as boolean);
    if (event === "service") set((before) => ({ ...before, [data.service as string]: { status: data as unknown as Service, heard: data.heard as number } }));
  });
  useEffect(() => {
    const timer = setInterval(() => tick((n) => n + 1), 1000);
    return () => clearInterval(timer);
  }, []);
  const service = Object.values(services).sort((a, b) => rank(a) - rank(b))[0];
  const age = service ? ageOf(service) : (performance.now() - opened) / 1000;
  return { service, isOpen, isSilent: age > freshSeconds };
}

/** Whether the service lives, and how far telemetry has come. */
function Pulse() {
  const zone = useZone();
  const { service, isOpen, isSilent } = useLife();
  if (!isOpen) return <span class="pulse bad" role="status">no connection to the page's server</span>;
  if (!service) return isSilent ? <span class="pulse bad" role="status">no service is heard</span> : <span class="pulse unknown">no service heard yet</span>;
  const { status } = service;
  if (isSilent) return <span class="pulse bad" role="status">service {status.service} silent for {durationText(ageOf(service))}</span>;
  if (status.last_error) return <a class="pulse bad" href="#/service" role="status">{status.last_error}</a>;
  return <span class="pulse"><span class="good">●</span> {status.service}{status.pair && ` ${status.pair.role}`}; telemetry to <span class="whole">{timeText(status.newest_telemetry)} {zone}</span>{Number(status.windows_pending) > 0 && `; ${status.windows_pending} windows pending`}{Math.abs(clockError()) > 60 && <span class="act">; this computer's clock is off by {durationText(Math.abs(clockError()))}</span>}</span>;
}

function Stale() {
  const { isOpen, isSilent } = useLife();
  return isSilent || !isOpen ? <p class="stale">Not live: this is as it was stored or heard last.</p> : null;
}

function moveInRows(step: number): void {
  const rows = [...document.querySelectorAll<HTMLAnchorElement>("main a[data-row]")];
  if (rows.length === 0) return;
  const now = rows.indexOf(document.activeElement as HTMLAnchorElement);
  rows[Math.min(Math.max(now < 0 ? (step > 0 ? 0 : rows.length - 1) : now + step, 0), rows.length - 1)]!.focus();
}

function Help({ close }: { close: () => void }) {
  const dialog = useRef<HTMLDialogElement>(null);
  useEffect(() => dialog.current!.showModal(), []);
  return (
    <dialog ref={dialog} onClose={close} aria-label="keys">
      <h2>Keys</h2>
      <dl class="facts">{keys.map(([key, what]) => <div><dt><kbd>{key}</kbd></dt><dd>{what}</dd></div>)}</dl>
      <p>No key decides anything. <a href="/notices.txt">Notices</a>, <a href="/openapi.json">API</a></p>
      <button type="button" onClick={() => dialog.current!.close()}>Close</button>
    </dialog>
  );
}

function Page() {
  const place = usePlace();
  const zone = useZone();
  const { has_fleet } = useSession();
  const [help, setHelp] = useState(false);
  const awaiting = useRef(false);  // a second key after g
  useEffect(() => {
    const pressed = (event: KeyboardEvent) => {
      const target = event.target as HTMLElement;
      if (event.ctrlKey || event.altKey || event.metaKey || /^(INPUT|TEXTAREA|SELECT)$/.test(target.tagName)) return;
      if (awaiting.current) {
        awaiting.current = false;
        const view = views.find(([name]) => name[0] === event.key);
        if (view) go(view[0]);
        return;
      }
      switch (event.key) {
        case "j": moveInRows(1); break;
        case "k": moveInRows(-1); break;
        case "g": awaiting.current = true; break;
        case "u": toggleZone(); dispatchEvent(new Event("themechange")); break;
        case "d": nextTheme(); break;
        case "?": setHelp(true); break;
        default: return;
      }
      event.preventDefault();
    };
    addEventListener("keydown", pressed);
    return () => removeEventListener("keydown", pressed);
  }, []);
  useEffect(() => {
    const { equipment, version } = place.parameters;
    document.title = [equipment && `${equipment}${version && place.view === "version" ? `@${version}` : ""}`, place.view, "reident"].filter(Boolean).join(" – ");
    window.scrollTo(0, 0);
  }, [place.view, place.parameters.equipment, place.parameters.version]);
  return (
    <>
      <a class="skip" href="#main" onClick={(event) => { event.preventDefault(); document.querySelector<HTMLElement>("main")!.focus(); }}>to the content</a>
      <header>
        <a class="brand" href="#/overview">reident</a>
        <nav aria-label="views">
          {views.filter(([name]) => name !== "fleet" || has_fleet).map(([name, title]) => <a href={link(name)} aria-current={place.view === name ? "page" : undefined}>{title}</a>)}
        </nav>
        <Pulse />
        <span class="tools">
          <Who />
          <button type="button" class="quiet" onClick={() => { toggleZone(); dispatchEvent(new Event("themechange")); }} title="UTC or the zone of this computer (u)">{zone}</button>
          <button type="button" class="quiet" onClick={nextTheme} title="light, dark, high contrast (d)" aria-label="light, dark or high contrast">◐</button>
          <button type="button" class="quiet" onClick={() => setHelp(true)} aria-label="keys">?</button>
        </span>
      </header>
      <main id="main" tabIndex={-1}>
        <Stale />
        <Guarded {...place} />
      </main>
      {help && <Help close={() => setHelp(false)} />}
    </>
  );
}

document.documentElement.dataset.theme = localStorage.getItem("theme") ?? "";
begin();
learn();
render(<Page />, document.getElementById("page")!);
