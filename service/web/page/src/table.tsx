// A table that can be read by a screen reader, moved in by keys, and taken away as CSV.
import type { ComponentChildren } from "preact";

export interface Column<Row> {
  title: string;
  text: (row: Row) => string;                   // as in CSV
  cell?: (row: Row) => ComponentChildren;       // as shown, where that is more
  isNumber?: boolean;
  isTime?: boolean;
  isWide?: boolean;                             // words, which need room
}

function classOf<Row>({ isNumber, isTime, isWide }: Column<Row>): string {
  return isNumber ? "number" : isTime ? "time" : isWide ? "wide" : "";
}

export function csvOf<Row>(columns: Column<Row>[], rows: Row[]): string {
  const quoted = (text: string) => (/[",\r\n]/.test(text) ? `"${text.replace(/"/g, '""')}"` : text);
  return [columns.map((column) => quoted(column.title)).join(","),
          ...rows.map((row) => columns.map((column) => quoted(column.text(row))).join(","))].join("\r\n") + "\r\n";
}

export function saveFile(name: string, type: string, text: string): void {
  const address = URL.createObjectURL(new Blob([text], { type }));
  const anchor = document.createElement("a");
  anchor.href = address;
  anchor.download = name;
  anchor.click();
  URL.revokeObjectURL(address);
}

interface TableProperties<Row> {
  name: string;  // of the CSV file
  caption: string;
  columns: Column<Row>[];
  rows: Row[];
  href?: (row: Row) => string | undefined;  // where a row leads
  rowClass?: (row: Row) => string;
  empty?: string;
}

export function Table<Row>({ name, caption, columns, rows, href, rowClass, empty }: TableProperties<Row>) {
  return (
    <section class="table">
      <div class="table-head">
        <h2>{caption}</h2>
        {rows.length > 0 && (
          <button type="button" class="quiet" onClick={() => saveFile(`${name}.csv`, "text/csv", csvOf(columns, rows))}>
            CSV
          </button>
        )}
      </div>
      {rows.length === 0 ? <p class="empty">{empty ?? "None."}</p> : (
        <div class="scroll" tabIndex={0} role="region" aria-label={caption}>
          <table aria-label={caption}>
            <thead>
              <tr>{columns.map((column) => <th scope="col" class={classOf(column)}>{column.title}</th>)}</tr>
            </thead>
            <tbody>
              {rows.map((row) => (
                <tr class={rowClass?.(row)}>
                  {columns.map((column, index) => {
                    const content = column.cell ? column.cell(row) : column.text(row);
                    const address = index === 0 ? href?.(row) : undefined;
                    return (
                      <td class={classOf(column)} data-title={column.title}>
                        <div>{address ? <a href={address} data-row>{content}</a> : content}</div>
                      </td>
                    );
                  })}
                </tr>
              ))}
            </tbody>
          </table>
        </div>
      )}
    </section>
  );
}
