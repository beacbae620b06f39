// The whole state of a view stands in the address, so that a link shows what its sender saw.
import { useEffect, useState } from "preact/hooks";
import { secondsOf } from "./format";

export interface Place {
  view: string;
  parameters: Record<string, string>;
}

export function placeOf(hash: string): Place {
  const [path = "", query = ""] = hash.replace(/^#\/?/, "").split("?");
  return { view: path || "overview", parameters: Object.fromEntries(new URLSearchParams(query)) };
}

/** The range that an address names, as far as it does, and what is wrong with it: then it is left out. */
export function rangeIn({ begin, end }: Record<string, string>): { begin?: string; end?: string; wrong: string } {
  for (const time of [begin, end])
    if (time && isNaN(secondsOf(time))) return { wrong: `${time.slice(0, 60)} is no time; write it as 2025-01-31T12:00:00Z.` };
  if (begin && end && !(secondsOf(begin) < secondsOf(end))) return { wrong: `The range would begin at ${begin} and end at ${end}; let it end later.` };
  return { begin, end, wrong: "" };
}

/** An address within the page. Parameters that are empty are left out. */
export function link(view: string, parameters: Record<string, string | undefined> = {}): string {
  const query = new URLSearchParams();
  for (const [name, value] of Object.entries(parameters)) if (value) query.set(name, value);
  const text = query.toString();
  return `#/${view}${text ? `?${text}` : ""}`;
}

export function go(view: string, parameters: Record<string, string | undefined> = {}, replace = false): void {
  const address = link(view, parameters);
  if (address === location.hash) return;
  history[replace ? "replaceState" : "pushState"](null, "", address);
  window.dispatchEvent(new HashChangeEvent("hashchange"));  // at once; that of `location.hash = ...` waits for the browser
}

/** Changes some parameters of the place where the page is. */
export function change(parameters: Record<string, string | undefined>, replace = false): void {
  const place = placeOf(location.hash);
  go(place.view, { ...place.parameters, ...parameters }, replace);
}

export function usePlace(): Place {
  const [place, set] = useState(() => placeOf(location.hash));
  useEffect(() => {
    const moved = () => set(placeOf(location.hash));
    addEventListener("hashchange", moved);
    return () => removeEventListener("hashchange", moved);
  }, []);
  return place;
}
