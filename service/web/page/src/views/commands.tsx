// What operators ordered, at a console or on this page, and what the service replied.
import { isDecision, useAnswer } from "../api";
import { timeText } from "../format";
import { Loaded, useZone } from "../parts";
import { Table } from "../table";
import { link } from "../url";

interface Command {
  time: string;
  action: string;
  spacecraft: string;
  equipment: string;
  version: string | null;
  actor: string;
  reason: string;
  ok: boolean;
  reply: string;
}

const about = (row: Command) => [row.spacecraft, row.equipment].filter(Boolean).join("/");

export function Commands({ begin, end, rows = "100" }: { begin?: string; end?: string; rows?: string }) {
  const zone = useZone();
  const answer = useAnswer<{ commands: Command[]; is_cut: boolean }>("commands", { begin, end, rows }, isDecision);
  return (
    <Loaded answer={answer}>
      {({ commands, is_cut }) => (
        <>
          <Table name="commands" caption="What operators ordered" rows={commands} empty="No operator ordered anything."
            rowClass={(row) => (row.ok ? "" : "failing")}
            columns={[
              { title: `time (${zone})`, text: (row) => timeText(row.time), isTime: true },
              { title: "about", text: about, cell: (row) => (row.equipment ? <a href={link("equipment", { spacecraft: row.spacecraft, equipment: row.equipment })}>{about(row)}</a> : about(row)) },
              { title: "order", text: (row) => row.action.replace(/_/g, " ") },
              { title: "version", text: (row) => row.version ?? "",
                cell: (row) => (row.version ? <a href={link("version", { spacecraft: row.spacecraft, equipment: row.equipment, version: row.version })}>{row.version}</a> : ""), isNumber: true },
              { title: "by", text: (row) => row.actor },
              { title: "reason", text: (row) => row.reason },
              { title: "reply", text: (row) => `${row.ok ? "" : "refused: "}${row.reply}`, isWide: true },
            ]} />
          {is_cut && <p class="note">There are more, which are earlier.</p>}
        </>
      )}
    </Loaded>
  );
}
