// One version: the verdict first, then what it rests on.
import { useEffect, useMemo } from "preact/hooks";
import { isAbout, useAnswer, type Version } from "../api";
import { Decide, type Action } from "../decide";
import { Figures, isKey } from "../figures";
import { durationText, figure, percent, secondsOf, timeText } from "../format";
import { decisionColumns, Facts, Loaded, Status, useZone } from "../parts";
import { Plot, type Panel } from "../plot";
import { broken } from "../series";
import { Table } from "../table";
import { change, link } from "../url";

const unit = 110;  // radius of the circle, in the picture

function Poles({ poles }: { poles: [number, number][] }) {
  if (poles.length === 0) return <p class="empty">A static gain has no poles.</p>;
  const text = poles.map(([re, im]) => `${figure(re, 4)}${im ? ` ${im > 0 ? "+" : "−"} ${figure(Math.abs(im), 3)}j` : ""}`).join(", ");
  return (
    <figure class="poles">
      <svg viewBox="-130 -130 260 260" role="img" aria-label={`poles in the unit circle: ${text}`}>
        <circle r={unit} class="circle" />
        <line x1={-unit - 12} x2={unit + 12} class="axis" />
        <line y1={-unit - 12} y2={unit + 12} class="axis" />
        {poles.map(([re, im]) => (
          <path class="pole" d={`M${re * unit - 5},${-im * unit - 5}l10,10m0,-10l-10,10`} />
        ))}
      </svg>
      <figcaption>{text}</figcaption>
    </figure>
  );
}

function Record({ version, asTable }: { version: Version; asTable: boolean }) {
  const zone = useZone();
  const record = version.record;
  const drawn = useMemo(() => {
    if (!record || record.begin.length === 0) return null;
    const times = record.begin.map(secondsOf);
    const panels: Panel[] = [{
      title: "score of each block", unit: "1 better, −1 worse", height: 190,
      levels: [{ value: 0, label: "as good", colour: "--quiet" }],
      lines: [
        { label: "block", points: broken(times, record.score), colour: "--block", width: 0.6 },
        { label: "mean so far", points: broken(times, record.mean), colour: "--run", width: 2 },
        { label: "lower confidence bound", points: broken(times, record.lower), colour: "--good", width: 2 },
      ],
    }];
    return { panels, begin: times[0]!, end: times[times.length - 1]! + 1 };
  }, [record]);
  const none = useMemo(() => [], []);
  const marks = useMemo(() => record?.change ? [{ at: secondsOf(record.change), label: "change", kind: "change" }] : [], [record]);
  if (!record || !drawn) return <p class="empty">No record against a champion: it was the first, was refused at its window, or waits for its first block.</p>;
  const from = Number(version_parameter("from")), to = Number(version_parameter("to"));
  const [begin, end] = from < to ? [from, to] : [drawn.begin, drawn.end];
  return (
    <>
      <p>Against version {record.against}, on {record.blocks} blocks that neither was fitted to.</p>
      <div class="toolbar"><button type="button" aria-pressed={asTable} onClick={() => change({ show: asTable ? undefined : "table" })}>table</button></div>
      {asTable ? drawn.panels.map((panel) => <Figures panel={panel} zone={zone} />) : <Plot {...drawn} begin={begin} end={end} marks={marks} stretches={none} excluded={none as [number, number][]}
        onRange={(from, to) => change({ from: from.toFixed(0), to: to.toFixed(0) })} />}
    </>
  );
}

function version_parameter(name: string): string | null {
  return new URLSearchParams(location.hash.split("?")[1] ?? "").get(name);
}

function numberIn(evidence: Record<string, unknown>, path: string): number | null {
  let value: unknown = evidence;
  for (const part of path.split(".")) value = (value as Record<string, unknown> | undefined)?.[part];
  return typeof value === "number" ? value : null;
}

/** What can be decided about a version of this status. */
function actionsFor({ status, version }: Version): Action[] {
  const of = (action: string, label: string, needsReason: boolean): Action => ({ action, label, role: "approver", needsReason, version });
  switch (status) {
    case "waiting": return [of("approve", "Approve", true), of("reject", "Reject", true)];
    case "superseded": return [of("roll_back", "Roll back to it", false), of("withdraw", "Withdraw for ever", true)];
    case "approved": return [of("withdraw", "Withdraw for ever", true)];
    default: return [];
  }
}

export function VersionView({ parameters }: { parameters: Record<string, string> }) {
  const zone = useZone();
  const { spacecraft, equipment, version: number } = parameters;
  const asTable = parameters.show === "table";
  useEffect(() => {
    const pressed = (event: KeyboardEvent) => {
      if (event.key === "t" && isKey(event)) change({ show: asTable ? undefined : "table" });
    };
    addEventListener("keydown", pressed);
    return () => removeEventListener("keydown", pressed);
  }, [asTable]);
  const answer = useAnswer<Version>("version", { spacecraft, equipment, version: number }, isAbout(spacecraft, equipment));
  return (
    <Loaded answer={answer}>
      {(version) => {
        const evidence = version.evidence;
        const low = numberIn(evidence, "diagnostics.mrse_interval_percent.mean_low");
        const high = numberIn(evidence, "diagnostics.mrse_interval_percent.mean_high");
        const window = secondsOf(version.window.end) - secondsOf(version.window.begin);
        return (
          <>
            <div class="title">
              <h1><a href={link("equipment", { spacecraft, equipment })}>{spacecraft}/{equipment}</a> version {version.version}</h1>
              <Status status={version.status} asksOperator={version.asks_operator} />
            </div>
            <p class="verdict">{version.verdict}</p>
            <Decide spacecraft={spacecraft!} equipment={equipment!} champion={version.champion} actions={actionsFor(version)} />
            <div class="columns">
              <Table name={`conditions-${equipment}-${number}`} caption="Conditions" rows={version.conditions}
                empty="It was not compared with a champion."
                rowClass={(row) => (row.holds === false ? "failing" : "")}
                columns={[
                  { title: "rule", text: (row) => row.rule },
                  { title: "holds", text: (row) => (row.holds === null ? "–" : row.holds ? "yes" : "no"),
                    cell: (row) => <span class={row.holds === null ? "unknown" : row.holds ? "good" : "bad"}>{row.holds === null ? "not looked at" : row.holds ? "✓ yes" : "✗ no"}</span> },
                  { title: "asked", text: (row) => row.asked },
                  { title: "found", text: (row) => row.found },
                ]} />
              <section>
                <h2>Figures</h2>
                <Facts facts={[
                  ["error (MRSE), free run", `${percent(numberIn(evidence, "mrse_percent"))}${low !== null ? ` (95 %: ${figure(low)} to ${figure(high)} %)` : ""}`],
                  ["fit", percent(numberIn(evidence, "fit_percent"))],
                  ["champion on the same rows", percent(numberIn(evidence, "champion_mrse_percent"))],
                  ["static gain", percent(numberIn(evidence, "static_mrse_percent"))],
                  ["order, method", `${version.order}, ${version.method}`],
                  ["window", `${timeText(version.window.begin)} to ${timeText(version.window.end)} ${zone} (${durationText(window)})`],
                  ["rows identified, chose, judged", [numberIn(evidence, "rows_identified"), numberIn(evidence, "rows_tuned"), numberIn(evidence, "rows_validated")].map((n) => n ?? "–").join(", ")],
                  ["tried because of", version.trigger],
                  ["inputs", version.inputs.map((one) => one.name).join(", ")],
                  ["outputs", version.outputs.map((one) => one.name).join(", ")],
                  ["at its window", `${version.outcome}. ${version.reason}`],
                  ["digest", <><code>{version.digest.slice(0, 16)}</code> {version.digest_matches ? "matches" : <span class="bad">does not match the stored model</span>}</>],
                ]} />
              </section>
            </div>
            <section><h2>Record</h2><Record version={version} asTable={asTable} /></section>
            <p><a href={link("equipment", { spacecraft, equipment, begin: version.window.begin, end: version.window.end, version: version.version })}>Its free run over its window</a></p>
            <section><h2>Poles</h2><Poles poles={version.poles} /></section>
            <Table name={`decisions-${equipment}-${number}`} caption="Decisions" rows={version.decisions} columns={decisionColumns(zone, { spacecraft, equipment })} />
          </>
        );
      }}
    </Loaded>
  );
}
