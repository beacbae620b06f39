// What changes, as it changes. A browser gives one origin six connections: so one tab hears the server
// and passes on to the others what it hears. Where a browser cannot do that, each tab asks now and then.
import { useEffect, useRef } from "preact/hooks";
import { secondsOf } from "./format";

export interface Change {
  event: "service" | "registry" | "database" | "connection";
  data: Record<string, unknown>;
}

type Listener = (change: Change) => void;

const events = ["service", "registry", "database"] as const;
const pollInterval = 2000;
const listeners = new Set<Listener>();
const latest = new Map<string, Change>();

let ahead = 0;  // [s] the service's clock, of this computer's

/** The time by the service's clock [s], as soon as a service was heard. */
export function serviceNow(): number {
  return Date.now() / 1000 + ahead;
}

/** How far this computer's clock is off [s]. */
export function clockError(): number {
  return -ahead;
}

function keyOf({ event, data }: Change): string {
  return [event, data.service, data.spacecraft, data.equipment].join("/");
}

/** When a heartbeat was heard [s], by this computer's clock: a tab that opens later, or a view, is told of it late. */
function withTimeHeard(change: Change): Change {
  const { age_s: age, heard } = change.data;
  return change.event === "service" && heard === undefined ? { event: "service", data: { ...change.data, heard: Date.now() / 1000 - (age as number) } } : change;
}

function announce(news: Change): void {
  const change = withTimeHeard(news);
  const key = keyOf(change);
  if (JSON.stringify(latest.get(key)) === JSON.stringify(change)) return;  // said again on a new connection
  latest.set(key, change);
  if (change.event === "service" && (change.data.age_s as number) < 5)
    ahead = secondsOf(change.data.time as string) - (change.data.heard as number);
  listeners.forEach((listener) => listener(change));
}

function connection(isOpen: boolean): Change {
  return { event: "connection", data: { open: isOpen } };
}

function lead(channel: BroadcastChannel): void {
  const pass = (change: Change) => {
    announce(change);
    channel.postMessage(change);
  };
  // A tab that opens later asks for what is known.
  channel.addEventListener("message", ({ data }) => {
    if (data === "what is known?") for (const change of latest.values()) channel.postMessage(change);
  });
  const source = new EventSource("/api/v1/stream");
  source.onopen = () => pass(connection(true));
  source.onerror = () => pass(connection(false));
  for (const event of events)
    source.addEventListener(event, ({ data }) => pass({ event, data: JSON.parse(data) }));
}

function poll(): void {
  let revision = "";
  const ask = async () => {
    try {
      const answer = await fetch(`/api/v1/changes?since=${revision}`);
      const { revision: newest, changes } = await answer.json();
      revision = newest;
      announce(connection(true));
      for (const change of changes) announce(change);
    } catch {
      announce(connection(false));
    }
    setTimeout(ask, pollInterval);
  };
  ask();
}

export function begin(): void {
  if (!navigator.locks || !("BroadcastChannel" in window)) return poll();
  const channel = new BroadcastChannel("reident");
  channel.addEventListener("message", ({ data }) => {
    if (typeof data === "object") announce(data);
  });
  channel.postMessage("what is known?");
  navigator.locks.request("reident-stream", () => {
    lead(channel);
    return new Promise(() => {});  // until the tab closes
  });
}

/** Calls `listener` for each change, and at once for what is known. */
export function useChanges(listener: Listener): void {
  const last = useRef(listener);
  last.current = listener;
  useEffect(() => {
    const call: Listener = (change) => last.current(change);
    listeners.add(call);
    for (const change of latest.values()) call(change);
    return () => {
      listeners.delete(call);
    };
  }, []);
}
