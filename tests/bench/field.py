"""Free-run errors on benchmark data of the identification literature, beside published figures.

    field.py BUILD FOLDER

FOLDER holds the files as they are published; one that is missing is said and left out. reident gets
the identification rows alone and chooses everything. The model then runs over the validation
record. Its initial state comes from that record's first rows, which are not scored. The error is
the root mean square of what is left. Prints a table and, as the last line, one JSON object.
"""

import argparse
import csv
import json
import sys
import tempfile
import time
from dataclasses import dataclass, field
from pathlib import Path

sys.path.insert(0, str(Path(__file__).parent / "identification"))

from accuracy import rows_of, write_csv  # noqa: E402: found in the folder above
from tools import ToolFailed, Tools, run, table, write_samples  # noqa: E402


@dataclass
class Record:
    """Columns, and the rows of them that count."""
    inputs: list
    outputs: list
    rows: tuple


@dataclass
class Benchmark:
    name: str
    file: str
    columns: list  # of a file without a header
    identify: Record
    validate: list  # of Record
    state_rows: int
    unit: str
    scale: float  # units in one of the file's
    best_linear: list  # a figure for each error, in the unit
    published: dict = field(default_factory=dict)


BENCHMARKS = [
    Benchmark("cascaded tanks", "dataBenchmark.csv", ["uEst", "uVal", "yEst", "yVal", "Ts"],
              Record(["uEst"], ["yEst"], (0, 1024)), [Record(["uVal"], ["yVal"], (0, 1024))], 5,
              "V", 1, [0.595], {"best linear approximation": [0.757], "Volterra": [0.540],
                                "nonlinear state space": [0.343]}),
    Benchmark("Silverbox", "SNLS80mV.csv", ["V1", "V2"],
              Record(["V1"], ["V2"], (40_650, 109_650)),
              [Record(["V1"], ["V2"], (109_650, 127_400)), Record(["V1"], ["V2"], (100, 40_575))],
              50, "mV", 1000, [7.00, 14.2]),
    Benchmark("Wiener-Hammerstein 2009", "WienerHammerBenchmark.csv", ["uBenchMark", "yBenchMark"],
              Record(["uBenchMark"], ["yBenchMark"], (5_200, 100_000)),
              [Record(["uBenchMark"], ["yBenchMark"], (100_000, 178_800))], 50, "mV", 1000, [44.0]),
    Benchmark("F-16 vibration", "f-16.txt", ["x1", "x2", "y"],
              Record(["x1", "x2"], ["y"], (0, 16_384)),
              [Record(["x1", "x2"], ["y"], (16_384, 32_768))], 50, "g", 1, [0.0554],
              {"order 10": [0.0553]}),
    Benchmark("cylinders", "cylinders.csv", ["t", "r0", "r1", "y0", "y1"],
              Record(["r0", "r1"], ["y0", "y1"], (0, 1593)),
              [Record(["r0", "r1"], ["y0", "y1"], (1593, 2390))], 50, "", 1, [0.259, 0.316]),
]


def number(text):
    try:
        return float(text)
    except ValueError:
        return None


def read_columns(file, names):
    """Columns by name; those of `names` where the first line is no header. A column ends at its
    first cell that is no number."""
    lines = file.read_text(encoding="utf-8-sig").splitlines()
    separator = next((mark for mark in ",;\t" if mark in lines[0]), None)
    rows = [[cell.strip() for cell in cells] for cells in
            (csv.reader(lines, delimiter=separator) if separator else map(str.split, lines))]
    if number(rows[0][0]) is None:
        names, rows = rows[0], rows[1:]
    columns = {}
    for place, name in enumerate(names):
        values = (number(row[place]) if place < len(row) else None for row in rows)
        columns[name] = list(iter(lambda: next(values, None), None))
    return columns


def part_of(columns, record, file):
    """Input and output columns of a record, or an error that says what the file lacks."""
    for name in record.inputs + record.outputs:
        found = len(columns.get(name, []))
        if found < record.rows[1]:
            raise ToolFailed(f"{file} has {found} numbers in a column {name}: {record.rows[1]} are "
                             "needed; is it the published file?")
    return [rows_of([columns[name] for name in names], *record.rows)
            for names in (record.inputs, record.outputs)]


def measure(tools, benchmark, columns, folder):
    inputs, outputs = part_of(columns, benchmark.identify, benchmark.file)
    file = folder / "identify.csv"
    names = benchmark.identify.inputs, benchmark.identify.outputs
    write_csv(file, names[0] + names[1], inputs + outputs)
    rows = f"0:{len(inputs[0])}"
    begin = time.monotonic()
    model = json.loads(run([tools.reident, "identify", file, "--input", *names[0], "--output",
                            *names[1], "--identify", rows, "--validate", rows, "--json"]))
    elapsed = time.monotonic() - begin
    errors = []
    for record in benchmark.validate:
        samples = folder / "validate.samples"
        write_samples(samples, *part_of(columns, record, benchmark.file))
        scored = tools.score(samples, model, folder,
                             (benchmark.state_rows, record.rows[1] - record.rows[0]),
                             benchmark.state_rows)
        errors += [error * benchmark.scale for error in scored["rmse"]]
    return {"rmse": errors, "best_linear": benchmark.best_linear, "unit": benchmark.unit,
            "published": benchmark.published, "order": model["order"],
            "horizon": model["horizon"], "weighting": model["weighting"],
            "refined": model["recipe"]["refinement_steps"] > 0,
            "left_out": model["left_out"], "seconds": round(elapsed, 2)}


def line_of(name, found):
    def text(values):
        return ", ".join(f"{value:.4g}" for value in values)
    published = "; ".join(f"{what} {text(values)}" for what, values in found["published"].items())
    return [name, f"{text(found['rmse'])} {found['unit']}", text(found["best_linear"]), published,
            found["order"], f"{found['seconds']} s"]


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("build", type=Path, help="folder that the programs were built in")
    parser.add_argument("data", type=Path, help="folder of the published files")
    arguments = parser.parse_args()
    tools = Tools(arguments.build.resolve())
    figures, lines, left_out = {}, [], {}
    for benchmark in BENCHMARKS:
        file = arguments.data / benchmark.file
        if not file.exists():
            left_out[benchmark.name] = f"there is no file {benchmark.file}"
            continue
        try:
            with tempfile.TemporaryDirectory(prefix="reident-field-") as name:
                columns = read_columns(file, benchmark.columns)
                figures[benchmark.name] = measure(tools, benchmark, columns, Path(name))
        except ToolFailed as failure:
            left_out[benchmark.name] = str(failure)
            continue
        lines.append(line_of(benchmark.name, figures[benchmark.name]))
    for name, why in left_out.items():
        print(f"{name} is left out: {why}", flush=True)
    print("\n" + table(["data set", "free run, root mean square error", "best linear model",
                        "published", "order", "time of the choice"], lines) + "\n", flush=True)
    print(json.dumps({"sets": figures, "left_out": left_out}))
    return 0 if figures else 1


if __name__ == "__main__":
    sys.exit(main())
