// Who runs which version, and what was refused.
import { isDecision, useAnswer } from "../api";
import { timeText } from "../format";
import { Loaded, useZone } from "../parts";
import { Table } from "../table";
import { link } from "../url";

interface Simulator {
  spacecraft: string;
  equipment: string;
  simulator: string;
  version: string | null;
  champion: string | null;
  offered: string | null;
  refused: string | null;
  reason: string;
  mode: string;
  from_cache: boolean;
  since: string | null;
  host: string;
  program_version: string;
}

const isCurrent = (row: Simulator) => row.version !== null && row.version === row.champion;

function summary(simulators: Simulator[]): string {
  const old = simulators.filter((row) => !isCurrent(row)).length;
  return simulators.length === 0 ? "Simulators" : old === 0 ? "Simulators: all run the champion" : `Simulators: ${old} of ${simulators.length} do not run the champion`;
}

function state(row: Simulator): string {
  const texts = [row.version === null ? "not running" : isCurrent(row) ? "current" : row.champion === null ? "no champion: what runs is no longer published" : `champion is ${row.champion}`];
  if (row.from_cache) texts.push("from file");
  if (row.offered) texts.push(`offered ${row.offered}: other signals`);
  if (row.refused) texts.push(`refused ${row.refused}: ${row.reason}`);
  return texts.join("; ");
}

export function SimulatorsView() {
  const zone = useZone();
  const answer = useAnswer<{ simulators: Simulator[] }>("simulators", {}, isDecision, 5);
  return (
    <Loaded answer={answer}>
      {({ simulators }) => (
        <Table name="simulators" caption={summary(simulators)} rows={[...simulators].sort((a, b) => Number(isCurrent(a)) - Number(isCurrent(b)))} empty="No simulator was heard by the service."
          rowClass={(row) => (isCurrent(row) ? "" : "failing")}
          columns={[
            { title: "simulator", text: (row) => row.simulator },
            { title: "equipment", text: (row) => `${row.spacecraft}/${row.equipment}`,
              cell: (row) => <a href={link("equipment", { spacecraft: row.spacecraft, equipment: row.equipment })}>{row.spacecraft}/{row.equipment}</a> },
            { title: "version", text: (row) => row.version ?? "none", isNumber: true },
            { title: "state", text: state, cell: (row) => <span class={isCurrent(row) ? "good" : "act"}>{state(row)}</span> },
            { title: "mode", text: (row) => row.mode || "–" },
            { title: `since (${zone})`, text: (row) => timeText(row.since), isTime: true },
            { title: "host", text: (row) => row.host },
            { title: "library", text: (row) => row.program_version },
          ]} />
      )}
    </Loaded>
  );
}
