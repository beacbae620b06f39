// The versions that wait for an operator.
import { isDecision, useAnswer, type Range } from "../api";
import { figure, timeText } from "../format";
import { Loaded, useZone } from "../parts";
import { Table } from "../table";
import { link } from "../url";

interface Waiting {
  spacecraft: string;
  equipment: string;
  version: string;
  since: string;
  window: Range;
  error_percent: number | null;
  verdict: string;
  supersedes: string[];
}

export function WaitingView() {
  const zone = useZone();
  const answer = useAnswer<{ waiting: Waiting[] }>("waiting", {}, isDecision);
  return (
    <Loaded answer={answer}>
      {({ waiting }) => (
        <Table name="waiting" caption="Waiting for an operator" rows={waiting} empty="No version waits."
          href={(row) => link("version", { spacecraft: row.spacecraft, equipment: row.equipment, version: row.version })}
          columns={[
            { title: "version", text: (row) => `${row.spacecraft}/${row.equipment}@${row.version}` },
            { title: `since (${zone})`, text: (row) => timeText(row.since), isTime: true },
            { title: "error %", text: (row) => figure(row.error_percent), isNumber: true },
            { title: "verdict", text: (row) => row.verdict, isWide: true },
            { title: "supersedes", text: (row) => row.supersedes.join(", ") || "none" },
            { title: `window ends (${zone})`, text: (row) => timeText(row.window.end), isTime: true },
          ]} />
      )}
    </Loaded>
  );
}
