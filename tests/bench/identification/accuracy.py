"""Free-run errors on DaISy data sets, compared with Octave, SLICOT and SLICOT's published figures.

Preprocessing, rows, block rows and orders are those of P. Van Overschee and B. De Moor, Subspace
Identification for Linear Systems, Kluwer 1996, chapter 6. reident is given the rows alone and
chooses the rest. An error is 100 ||y - yhat|| / ||y|| over the validation rows, the mean over the
outputs, of one simulation over the whole record. It starts from the initial state of the model for
reident and from one that is estimated from the first rows, three times the order, for the others.
"""

import csv
import json
from dataclasses import dataclass
from pathlib import Path

from tools import ToolFailed, run, table, write_samples

SCRIPT = Path(__file__).parent / "octave_n4sid.m"


@dataclass
class Protocol:
    name: str
    identify: tuple
    validate: tuple
    horizon: int
    order: int
    others: float  # lowest error of subid, SLICOT, SIPPY and nfoursid under the same protocol, %
    centred: bool = True
    differenced: bool = False  # the outputs; each keeps the inputs of the earlier row


PROTOCOLS = [
    Protocol("hairdryer", (0, 500), (500, 1000), 15, 4, 10.6),
    Protocol("glassfurnace", (0, 900), (900, 1247), 10, 5, 54.2),
    Protocol("evaporator", (0, 3300), (3300, 6305), 10, 4, 48.1, centred=False),
    Protocol("ballbeam", (0, 999), (0, 999), 20, 2, 48.1, differenced=True),
    Protocol("thermic_wall", (0, 1200), (1200, 1680), 20, 3, 16.1),
]


def read_columns(file):
    """Inputs and outputs of a data set, lists of columns."""
    with open(file, newline="") as text:
        header, *rows = csv.reader(text)
    columns = dict(zip(header, ([float(cell) for cell in column] for column in zip(*rows))))
    return ([columns[name] for name in header if name.startswith("u")],
            [columns[name] for name in header if name.startswith("y")])


def centred(column):
    mean = sum(column) / len(column)
    return [value - mean for value in column]


def preprocessed(protocol, inputs, outputs):
    if protocol.differenced:
        outputs = [[b - a for a, b in zip(column, column[1:])] for column in outputs]
        inputs = [column[:-1] for column in inputs]
    if protocol.centred:
        inputs, outputs = ([centred(column) for column in columns]
                           for columns in (inputs, outputs))
    return inputs, outputs


def rows_of(columns, begin, end):
    return [column[begin:end] for column in columns]


def write_csv(file, header, columns):
    with open(file, "w", newline="") as text:
        writer = csv.writer(text)
        if header:
            writer.writerow(header)
        writer.writerows([repr(value) for value in row] for row in zip(*columns))


def reident_result(tools, protocol, inputs, outputs, folder):
    """The command as a user runs it, with nothing chosen by hand."""
    names = [f"u{i + 1}" for i in range(len(inputs))], [f"y{i + 1}" for i in range(len(outputs))]
    file = folder / f"{protocol.name}.csv"
    write_csv(file, names[0] + names[1], inputs + outputs)
    try:
        found = json.loads(run([tools.reident, "identify", file, "--input", *names[0], "--output",
                                *names[1], "--identify", "{}:{}".format(*protocol.identify),
                                "--validate", "{}:{}".format(*protocol.validate), "--json"]))
    except ToolFailed as failure:
        return {"reident": None, "failure": str(failure)}
    errors = found["mrse_percent"]["validate"]
    return {"reident": sum(errors) / len(errors), "order": found["order"],
            "horizon": found["horizon"], "weighting": found["weighting"],
            "stable": found["stable"]}


def error_of(identify):
    """None where the tool gives no model."""
    try:
        return identify()
    except ToolFailed as failure:
        print(f"no model: {failure}", flush=True)
        return None


def other_results(tools, protocol, inputs, outputs, folder):
    """Errors of the other tools with the order and the block rows of the book."""
    samples, part = folder / "all.samples", folder / "part.samples"
    own = rows_of(inputs, *protocol.identify), rows_of(outputs, *protocol.identify)
    write_samples(samples, inputs, outputs)
    write_samples(part, *own)
    write_csv(folder / "part.csv", None, own[0] + own[1])

    def error(model):
        return tools.score(samples, model, folder, protocol.validate)["mrse_percent"]

    def slicot(*way):
        return error(tools.slicot_identify(part, "--order", protocol.order, "--horizon",
                                           protocol.horizon, "--algorithm", "Q", *way))

    def octave():
        return error(tools.octave_identify(SCRIPT, folder / "part.csv", len(inputs),
                                           protocol.order, protocol.horizon))

    return {"octave_n4sid": error_of(octave) if tools.octave else None,
            "slicot": error_of(slicot) if tools.slicot else None,
            "slicot_b_d_by_simulation":
                error_of(lambda: slicot("--simulation-b-d")) if tools.slicot else None}


def number(value):
    return "-" if value is None else f"{value:.2f}"


def compare(tools, data, folder):
    """Prints the table; results by data set."""
    results, lines = {}, []
    for protocol in PROTOCOLS:
        file = data / f"daisy_{protocol.name}.csv"
        if not file.exists():
            print(f"{protocol.name} is left out: {file} does not exist", flush=True)
            continue
        inputs, outputs = preprocessed(protocol, *read_columns(file))
        rows = "{}:{}, {}:{}".format(*protocol.identify, *protocol.validate)
        result = {"rows": rows,
                  **reident_result(tools, protocol, inputs, outputs, folder),
                  **other_results(tools, protocol, inputs, outputs, folder),
                  "best_of_others": protocol.others}
        results[protocol.name] = result
        lines.append([protocol.name, rows,
                      number(result["reident"]),
                      result.get("failure") or
                      f"{result['order']}, {result['horizon']}, {result['weighting']}" +
                      ("" if result["stable"] else ", UNSTABLE"),
                      f"{protocol.order}, {protocol.horizon}", number(result["octave_n4sid"]),
                      number(result["slicot"]), number(result["slicot_b_d_by_simulation"]),
                      protocol.others])
    print("\n" + table(["data set", "identify, validate rows", "reident %",
                        "its order, horizon, weighting", "the book's order, block rows",
                        "octave n4sid %", "SLICOT %", "SLICOT, B D by simulation %",
                        "best of subid, SLICOT, SIPPY, nfoursid (reference) %"], lines) + "\n",
          flush=True)
    return results


# SLICOT's published results on raw data by MOESP: the example of IB01AD for the hair dryer.
PUBLISHED = [
    {"name": "hairdryer", "order": 4, "horizon": 15,
     "singular_values": [69.8841, 14.9963, 3.6675, 1.9677, 0.3000]},
    {"name": "powerplant", "order": 8, "horizon": 10,
     "singular_values": [4952.198873, 2189.606212, 1748.111169, 1108.751325, 717.6008697,
                         545.0351670, 245.6438117, 220.9266149],
     "pole_moduli": [.9722713, .9722713, .8713017, .8713017, .8238773, .8238773, .8136265,
                     .8136265]},
]


def check_published(tools, data, folder):
    """Prints what is found next to what is published; the largest differences."""
    results, lines = {}, []
    for case in PUBLISHED:
        file = data / f"daisy_{case['name']}.csv"
        if not file.exists():
            print(f"{case['name']} is left out: {file} does not exist", flush=True)
            continue
        samples = folder / "published.samples"
        write_samples(samples, *read_columns(file))
        size = ["--order", case["order"], "--horizon", case["horizon"]]
        found = {f"reident, from {way}": values for way, values in
                 tools.identify("subspace", samples, *size).items()}
        if tools.slicot:
            model = tools.slicot_identify(samples, *size, "--method", "moesp")
            found["SLICOT"] = {**model, **tools.score(samples, model, folder)}
        for what in ("singular_values", "pole_moduli"):
            published = case.get(what, [])
            for tool, values in found.items():
                if not published:
                    continue
                differ = max(abs(a - b) for a, b in zip(values[what], published))
                results.setdefault(case["name"], {}).setdefault(what, {})[tool] = differ
                lines.append([case["name"], what.replace("_", " "), tool,
                              " ".join(f"{v:.7g}" for v in values[what][:len(published)]),
                              " ".join(f"{v:.7g}" for v in published), f"{differ:.1e}"])
    print(table(["data set", "what", "tool", "found", "published", "largest difference"], lines) +
          "\n", flush=True)
    return results
