// The whole state of a view stands in the address, so that a link shows what its sender saw.
import { useEffect, useState } from "preact/hooks";

export interface Place {
  view: string;
  parameters: Record<string, string>;
}

export function placeOf(hash: string): Place {
  const [path = "", query = ""] = hash.replace(/^#\/?/, "").split("?");
  return { view: path || "overview", parameters: Object.fromEntries(new URLSearchParams(query)) };
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
  if (replace) {
    history.replaceState(null, "", address);
    window.dispatchEvent(new HashChangeEvent("hashchange"));
  } else {
    location.hash = address;
  }
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
