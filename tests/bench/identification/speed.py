"""Time and memory compared with SLICOT on simulated telemetry: 4 inputs, 1 output, 20 block rows,
order 4.

The sizes run one after the other. Within a size the programs alternate, so that a slow minute of
the machine falls on all of them, and times are processor times, so that other load counts little.
The free-run error is that of each tool's model on the rows after those that it was identified from,
which for the sliding window are others than for the rest.

Both tools have two ways to B and D. From the compression: SLICOT in ib01bd, with x0 alone from
ib01cd. From the simulated output, the more accurate one: SLICOT in ib01cd, with x0. The figures compare
with the second, which is what identify() does unless told otherwise; those against the first stand
beside them.
"""

import statistics

from tools import table

ORDER, HORIZON, STEP = 4, 20, 500
# The first rows are not scored: the initial state is estimated from a few of them, and what it
# lacks has died out at the end.
UNSCORED_ROWS, SCORED_ROWS = 1_000, 15_000
UNSEEN_ROWS = UNSCORED_ROWS + SCORED_ROWS
FIXED = ["--order", ORDER, "--horizon", HORIZON]
# SLICOT's N4SID projects off the future inputs as its MOESP does and finds the same poles.
OWN_FIXED = [*FIXED, "--weighting", "moesp"]
OF_COMPRESSION = ["--response", "subspace"]
# name in the keys, rows, rounds, repeats a round
SIZES = [("15k", 15_000, 9, 5), ("150k", 150_000, 7, 3), ("million", 1_000_000, 3, 1)]
QUICK_SIZES = [("15k", 1_500, 1, 1), ("150k", 3_000, 1, 1), ("million", 6_000, 1, 1)]
WAYS = [["--algorithm", algorithm, "--method", method, *batch]
        for algorithm in "CF" for method in ("n4sid", "moen4")
        for batch in ([], ["--batch", 4_000], ["--batch", 20_000])
        ] + [["--algorithm", "Q", "--method", "n4sid"]]


class Series:
    """Repeats of one program over the rounds, and its last model."""

    def __init__(self):
        self.cpu_ms, self.wall_ms = [], []
        self.model, self.peak_extra_mib = None, 0

    def add(self, model):
        self.cpu_ms += model["cpu_ms"]
        self.wall_ms += model["wall_ms"]
        self.model = model
        self.peak_extra_mib = max(self.peak_extra_mib, model["peak_extra_mib"])

    @property
    def median(self):
        return statistics.median(self.cpu_ms)


def fastest_way(tools, samples, rows):
    """Options of SLICOT's fastest compression for these rows, and the time of the fastest of each
    algorithm."""
    tried = []
    for way in WAYS:
        if "--batch" in way and way[-1] > rows / 2:
            continue
        repeats = 1 if "Q" in way else 3
        found = tools.slicot_identify(samples, *FIXED, *way, "--repeats", repeats)
        tried.append((min(found["cpu_ms"]), way))
    by_algorithm = {algorithm: min(ms for ms, way in tried if algorithm in way)
                    for algorithm in "CFQ"}
    return min(tried, key=lambda pair: pair[0])[1], by_algorithm


def programs(tools, size, rows, samples, longer, repeats, way):
    """What alternates: name, function that runs it once."""
    listed = []
    if tools.slicot:
        listed += [
            ("slicot, B D of the compression",
             lambda: tools.slicot_identify(samples, *FIXED, *way, *repeats)),
            ("slicot",
             lambda: tools.slicot_identify(samples, *FIXED, *way, "--simulation-b-d", *repeats))]
    listed.append(("reident one-shot",
                   lambda: tools.identify("one-shot", samples, *OWN_FIXED, *repeats)))
    listed.append(("reident one-shot, B D of the compression",
                   lambda: tools.identify("one-shot", samples, *OWN_FIXED, *OF_COMPRESSION,
                                          *repeats)))
    if size != "million":
        listed.append(("reident slide",
                       lambda: tools.identify("slide", longer, *OWN_FIXED, *OF_COMPRESSION,
                                              "--window", rows, "--step", STEP, *repeats)))
    if size == "15k":
        listed.append(("reident automatic",
                       lambda: tools.identify("automatic", samples, "--repeats", 1)))
    return listed


def measure_size(tools, folder, size, rows, rounds, repeats):
    """Series by name, and lines of the table."""
    samples, unseen = folder / f"{size}.samples", folder / f"{size}.unseen"
    longer, beyond = folder / f"{size}.longer", folder / f"{size}.beyond"
    tools.identify("generate", samples, unseen, "--rows", rows, "--unseen-rows", UNSEEN_ROWS)
    if size != "million":
        tools.identify("generate", longer, beyond, "--rows", rows + STEP * (repeats + 1),
                       "--unseen-rows", UNSEEN_ROWS)
    way, by_algorithm = [], {}
    if tools.slicot:
        way, by_algorithm = fastest_way(tools, samples, rows)
        print(f"SLICOT, {rows} rows, fastest call of each algorithm, ms: " + ", ".join(
            f"{name} {ms:.2f}" for name, ms in by_algorithm.items()) +
            "; chosen: " + " ".join(str(word) for word in way), flush=True)
    listed = programs(tools, size, rows, samples, longer, ["--repeats", repeats], way)
    series = {name: Series() for name, _ in listed}
    for _ in range(rounds):
        for name, once in listed:
            series[name].add(once())
    errors = {name: tools.score(beyond if name == "reident slide" else unseen, s.model, folder,
                                (UNSCORED_ROWS, UNSEEN_ROWS))["mrse_percent"]
              for name, s in series.items()}
    lines = [[rows, name, f"{min(s.cpu_ms):.2f}", f"{s.median:.2f}",
              f"{statistics.median(s.wall_ms):.2f}", f"{s.peak_extra_mib:.1f}",
              f"{errors[name]:.4f}"] for name, s in series.items()]
    for file in (samples, unseen, longer, beyond):
        file.unlink(missing_ok=True)
    return series, errors, lines


def ratio(over, under):
    return round(over.median / under.median, 3) if over and under else None


def compare(tools, folder, sizes):
    """Prints the table; the figures by their keys, with ratios of medians."""
    measured, lines, errors = {}, [], {}
    for size, rows, rounds, repeats in sizes:
        measured[size], errors[size], more = measure_size(tools, folder, size, rows, rounds,
                                                          repeats)
        lines += more
    if tools.slicot:
        print("\nSLICOT's BLAS: " + measured["15k"]["slicot"].model["blas"], flush=True)
    header = ["rows", "program", "best ms", "median ms", "median wall ms", "MiB above the data",
              f"free-run error on {SCORED_ROWS} unseen rows, %"]
    print("\n" + table(header, lines) + "\n", flush=True)

    def series(size, name):
        return measured[size].get(name)

    def against(slicot, one_shot):
        figures = {}
        for size in ("15k", "150k"):
            figures[f"one_shot_{size}_vs_slicot"] = ratio(series(size, slicot),
                                                          series(size, one_shot))
            figures[f"slide_{size}_vs_slicot"] = ratio(series(size, slicot),
                                                       series(size, "reident slide"))
        figures["million_vs_slicot"] = ratio(series("million", slicot),
                                             series("million", one_shot))
        figures["automatic_15k_slicot_calls"] = ratio(series("15k", "reident automatic"),
                                                      series("15k", slicot))
        return figures

    return {**against("slicot", "reident one-shot"),
            "slide_150k_over_15k": ratio(series("150k", "reident slide"),
                                         series("15k", "reident slide")),
            "million_extra_mib": round(measured["million"]["reident one-shot"].peak_extra_mib, 1),
            "against_slicot_with_b_d_of_the_compression": against(
                "slicot, B D of the compression", "reident one-shot, B D of the compression"),
            "cpu_ms": {size: {name: round(s.median, 3) for name, s in group.items()}
                       for size, group in measured.items()},
            "free_run_error_percent": errors}
