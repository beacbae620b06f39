// How all spacecraft of the site are, the worst first.
import { useState } from "preact/hooks";
import { usePolled } from "../api";
import { timeText, unknown } from "../format";
import { Loaded, useZone } from "../parts";
import { Table } from "../table";

interface Instance {
  instance: string;
  act: boolean;
  service: boolean | null;
  equipment: number;
  with_champion: number;
  waiting: number;
  alarms: number;
  telemetry: string | null;
  note: string | null;
  page: string | null;
}

interface FleetAnswer {
  instances: Instance[];
}

const refresh = 5;  // [s]
const rowsOfScreen = 16;  // their notes may take two lines

/** Where the database cannot be read nothing is known. */
const known = (row: Instance, text: string) => (row.equipment === 0 ? unknown : text);

const serviceText = (row: Instance) => (row.service === null ? "unknown" : row.service ? "runs" : "none");

function summary(instances: Instance[]): string {
  const act = instances.filter((row) => row.act).length;
  return `Fleet: ${act === 0 ? "all" : `${act} of`} ${instances.length} ${act === 0 ? "are well" : "need somebody"}`;
}

export function FleetView() {
  const zone = useZone();
  const answer = usePolled<FleetAnswer>("fleet", refresh);
  const [all, setAll] = useState(false);
  return (
    <Loaded answer={answer}>
      {({ instances }) => (
        <>
          <Table name="fleet" caption={summary(instances)} rows={all ? instances : instances.slice(0, rowsOfScreen)}
            rowClass={(row) => (row.act ? "failing" : "")}
            href={(row) => (row.page ? `${location.protocol}//${row.page}/` : undefined)}
            columns={[
              { title: "instance", text: (row) => row.instance },
              { title: "service", text: serviceText, cell: (row) => <span class={row.service ? "good" : "act"}>{serviceText(row)}</span> },
              { title: "champions", text: (row) => known(row, `${row.with_champion} of ${row.equipment}`), isNumber: true },
              { title: "waiting", text: (row) => known(row, String(row.waiting)), isNumber: true },
              { title: "alarms", text: (row) => known(row, String(row.alarms)), isNumber: true },
              { title: `telemetry to (${zone})`, text: (row) => timeText(row.telemetry), isTime: true },
              { title: "worst", text: (row) => row.note ?? "", isWide: true },
            ]} />
          {!all && instances.length > rowsOfScreen && <button type="button" onClick={() => setAll(true)}>All {instances.length}</button>}
        </>
      )}
    </Loaded>
  );
}
