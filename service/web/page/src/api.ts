// Questions to the server. openapi.json describes the answers.
import { useEffect, useRef, useState } from "preact/hooks";
import { useChanges, type Change } from "./live";

export interface Answer<T> {
  data: T | null;  // the last that came
  error: string;   // why the last question got none; empty where it did
  loading: boolean;
}

export class Refused extends Error {
  constructor(message: string, readonly code: string) {
    super(message);
  }
}

export async function ask<T>(path: string, parameters: Record<string, string | undefined>, signal?: AbortSignal): Promise<T> {
  const query = new URLSearchParams();
  for (const [name, value] of Object.entries(parameters)) if (value) query.set(name, value);
  const answer = await fetch(`/api/v1/${path}?${query}`, { signal }).catch((error) => {
    throw signal?.aborted ? error : new Error("The page's server does not answer: it was stopped, or the network is cut.");
  });
  const body = await answer.json();
  if (!answer.ok) throw new Refused(body.error?.message ?? answer.statusText, body.error?.code ?? "");
  return body;
}

/**
 * The answer to a question, asked again when a change comes that `isNews` says is one of it, and with
 * the first sign of life of the service that comes `refresh` seconds after the last answer.
 */
export function useAnswer<T>(path: string | null, parameters: Record<string, string | undefined>,
                             isNews: (change: Change) => boolean = () => false, refresh = Infinity): Answer<T> {
  const [answer, set] = useState<Answer<T>>({ data: null, error: "", loading: true });
  const [turn, setTurn] = useState(0);
  const timer = useRef<number>();
  const asked = useRef(0);
  const key = JSON.stringify([path, parameters]);
  useEffect(() => {
    if (path === null) return;
    const abort = new AbortController();
    asked.current = performance.now();
    set((before) => ({ ...before, loading: true }));
    ask<T>(path, parameters, abort.signal)
      .then((data) => set({ data, error: "", loading: false }))
      .catch((error) => {
        if (!abort.signal.aborted) set((before) => ({ ...before, error: String(error.message ?? error), loading: false }));
      });
    return () => abort.abort();
  }, [key, turn]);
  const isFirst = useRef(true);  // what is known already is no news
  useChanges((change) => {
    const isOld = change.event === "service" && performance.now() - asked.current > 1000 * refresh;
    // The database or the page's server went away, or is back.
    const isOther = (change.event === "database" && (change.data.error !== "" || answer.error !== "")) || (change.event === "connection" && change.data.open === true && answer.error !== "");
    if ((!isNews(change) && !isOld && !isOther) || isFirst.current) return;
    clearTimeout(timer.current);
    timer.current = window.setTimeout(() => setTurn((n) => n + 1), 100);
  });
  useEffect(() => {
    isFirst.current = false;
    return () => clearTimeout(timer.current);
  }, []);
  return answer;
}

/** The answer to a question that is asked again every few seconds. */
export function usePolled<T>(path: string, seconds: number): Answer<T> {
  const [answer, set] = useState<Answer<T>>({ data: null, error: "", loading: true });
  useEffect(() => {
    const abort = new AbortController();
    const look = () => ask<T>(path, {}, abort.signal)
      .then((data) => set({ data, error: "", loading: false }))
      .catch((error) => {
        if (!abort.signal.aborted) set((before) => ({ ...before, error: String(error.message ?? error), loading: false }));
      });
    look();
    const timer = setInterval(look, 1000 * seconds);
    return () => {
      clearInterval(timer);
      abort.abort();
    };
  }, [path, seconds]);
  return answer;
}

export const isDecision = (change: Change) => change.event === "registry";
export const isAbout = (spacecraft?: string, equipment?: string) => (change: Change) =>
  change.event === "registry" && change.data.spacecraft === spacecraft && change.data.equipment === equipment;

export interface Hold {
  actor: string;
  reason: string;
  since: string;
}

export interface EquipmentLine {
  spacecraft: string;
  equipment: string;
  champion: string | null;
  since: string | null;
  decided_by: string | null;
  error_percent: number | null;
  approved_error_percent: number | null;
  simulator_percent: number | null;
  failure: string | null;
  hold: Hold | null;
  change: string | null;
  waiting: string[];  // for an operator
  telemetry: string | null;
  simulators: number;
  current: number;
  attempts: number;
  versions: number;
}

export interface Alarm {
  spacecraft: string;
  equipment: string;
  code: string;
  text: string;
  since: string;
  acknowledged_by: string;
}

export interface Decision {
  id: string;
  time: string;
  telemetry?: string;
  spacecraft?: string;
  equipment?: string;
  kind: string;
  version: string;
  actor: string;
  reason: string;
}

export interface VersionLine {
  version: string;
  status: string;
  parent: string | null;
  window: Range;
  time: string;
  outcome: string;
  order: number | null;
  error_percent: number | null;
  fit_percent: number | null;
  interval_percent: [number, number] | null;
}

export interface Range {
  begin: string;
  end: string;
}

export interface Signal {
  name: string;
  unit: string;
  expression?: string;
}

export interface Equipment {
  spacecraft: string;
  equipment: string;
  line: EquipmentLine;
  telemetry: Range | null;
  inputs: Signal[];
  outputs: Signal[];
  parameters: string[];
  versions: VersionLine[];
  decisions: Decision[];
}

export interface Columns {
  least_s: number[];
  least: (number | null)[];
  greatest_s: number[];
  greatest: (number | null)[];
  samples: number[];
}

export interface Telemetry extends Columns {
  range: Range;
  bin_s: number;
  unit: string;
  low_limit: number | null;
  high_limit: number | null;
  flagged: [number, number, string][];
  gaps: [number, number][];
}

export interface Run {
  range: Range;
  bin_s: number;
  version: string;
  mrse_percent: number | null;
  outputs: { name: string; unit: string; run: Columns; residual: Columns }[];
}

export interface Timeline {
  range: Range;
  bin_s: number;
  champions: { version: string; begin_s: number; end_s: number; approved_error_percent: number | null }[];
  events: { at_s: number; time: string; kind: string; version: string; actor: string; reason: string }[];
  records: { version: string; from_s: number[]; to_s: number[]; error_percent: (number | null)[]; simulator_percent: (number | null)[] }[];
  excluded: { begin_s: number; end_s: number; check: string; parameters: string[] }[];
}

export interface Version {
  spacecraft: string;
  equipment: string;
  version: string;
  status: string;
  asks_operator: boolean;
  champion: string | null;
  held: string | null;
  verdict: string;
  conditions: { rule: string; asked: string; found: string; holds: boolean | null }[];
  window: Range;
  identified_from: Range;
  validated_on: Range;
  trigger: string;
  outcome: string;
  reason: string;
  method: string;
  order: number;
  sample_period_s: number;
  poles: [number, number][];
  inputs: Signal[];
  outputs: Signal[];
  digest: string;
  digest_matches: boolean;
  evidence: Record<string, unknown>;
  record: { against: string; blocks: number; change: string | null; begin: string[]; score: number[]; mean: number[]; lower: number[] } | null;
  decisions: Decision[];
}

export interface PairService {
  service: string;
  role: string;  // leads, follows, listens
  term: number;
  lag: number | null;
}

export interface OverviewAnswer {
  equipment: EquipmentLine[];
  alarms: Alarm[];
  pair: PairService[];  // that are heard; none: the service is of none
}

export interface Service {
  service: string;
  program_version: string;
  started: string;
  time: string;
  age_s: number;
  newest_telemetry: string | null;
  certificate_end: string | null; // null: the domain is not secured
  certificate_days: number | null;
  last_error: string;
  failing_champions: string;
  alarms: string[];
  pair?: { name: string; role: string; term: number; partner: string; lag: number | null };
  [count: string]: unknown;
}

export interface ServiceAnswer {
  time: string;
  program_version: string;
  configured: { service: string; domain: number; partition: string };
  services: Service[];
  database: { bytes: number; log_bytes: number; error: string };
  page: Record<string, number>;
}
