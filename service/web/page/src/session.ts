// Who looks at the page, and orders.
import { useEffect, useState } from "preact/hooks";
import { Refused } from "./api";

export interface Session {
  user: string | null;
  role: "viewer" | "operator" | "approver" | null;
  spacecraft: string[];  // none: every one
  token: string;
  has_passwords: boolean;
  has_fleet: boolean;
}

export type Role = "operator" | "approver";

const nobody: Session = { user: null, role: null, spacecraft: [], token: "", has_passwords: false, has_fleet: false };
let current = nobody;
const listeners = new Set<() => void>();

export async function learn(): Promise<void> {
  try {
    current = await (await fetch("/api/v1/session")).json();
  } catch {
    return;  // the page's server is away; what was known stays
  }
  listeners.forEach((listener) => listener());
}

export function useSession(): Session {
  const [session, set] = useState(current);
  useEffect(() => {
    const listener = () => set(current);
    listeners.add(listener);
    listener();
    return () => {
      listeners.delete(listener);
    };
  }, []);
  return session;
}

export function may(session: Session, role: Role, spacecraft: string): boolean {
  const ranks = [null, "viewer", "operator", "approver"];
  return ranks.indexOf(session.role) >= ranks.indexOf(role) &&
    (session.spacecraft.length === 0 || session.spacecraft.includes(spacecraft));
}

async function post<T>(path: string, body: unknown): Promise<T> {
  const answer = await fetch(`/api/v1/${path}`, {
    method: "POST",
    headers: { "Content-Type": "application/json", "X-Reident-Token": current.token },
    body: JSON.stringify(body),
  });
  const data = await answer.json();
  if (!answer.ok) throw new Refused(data.error?.message ?? answer.statusText, data.error?.code ?? "");
  return data;
}

export async function logIn(name: string, password: string): Promise<void> {
  await post("login", { name, password });
  await learn();
}

export async function logOut(): Promise<void> {
  await post("logout", {});
  await learn();
}

export interface Order {
  action: string;
  spacecraft: string;
  equipment: string;
  version?: string;
  champion: string | null;  // that the form showed
  reason: string;
}

/** Drawn once for each form: the same order sent twice is carried out once. */
export function newRequester(): string {
  return [...crypto.getRandomValues(new Uint8Array(16))].map((byte) => byte.toString(16).padStart(2, "0")).join("");
}

/** The service's reply. A token of a server that was started again since is learnt again, once. */
export async function order(requester: string, what: Order): Promise<{ ok: boolean; reply: string }> {
  const send = () => post<{ ok: boolean; reply: string }>("orders", { requester, ...what });
  try {
    return await send();
  } catch (error) {
    if (!(error instanceof Refused) || error.code !== "token") throw error;
    await learn();
    return send();
  }
}
