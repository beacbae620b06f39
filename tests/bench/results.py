"""The page of measured results, which is made of the files that record.py writes.

    results.py              writes RESULTS.md from results/*.json
    results.py --check      exits 1 where RESULTS.md is not what the files give

A file has `command`, `commit`, `date`, `machine` and `figures`, what the benchmark printed. It may
have `stated` (where the figures come from, instead of the commit), `notes` (sentences that hold for
this measurement) and `earlier` (rows of commit, command and result).
"""

import json
import sys
import textwrap
from decimal import Context, Decimal
from pathlib import Path

HERE = Path(__file__).resolve().parent
FOLDER, PAGE = HERE / "results", HERE / "RESULTS.md"
SECTIONS = {}  # by the file's name: title, paragraphs, function from figures to tables

HEAD = """# Measured results
`tests/bench/results.py` writes this page from the files in [results](results).
`tests/bench/run.sh record WHAT` measures again and stores the figures in such a file, with commit,
date and machine.

- MRSE is the size of a model's error over the size of the output, 100 ‖y − ŷ‖ / ‖y‖, as the mean
  over the outputs.
- Fit is 100 (1 − ‖y − ŷ‖ / ‖y − mean(y)‖).
- Both are of free-run simulations, which get the inputs alone, unless a table says otherwise.
- Integral feedback, or tracking, is a run that also corrects itself by the output of the samples
  before.
- The baseline is the simulator's own, hand-written model, as its telemetry shows it.
- "The paper" is "Identification and control techniques applied to an operational satellite
  simulator", INPE's paper on CBERS-4.
- FILE, FOLDER and DATA_FOLDER in a command stand for recorded telemetry, which is not part of the
  repository."""


def section(name, title, *paragraphs):
    def register(tables):
        SECTIONS[name] = title, paragraphs, tables
        return tables
    return register


def figure(value, digits=3):
    """At most so many significant digits. A number of a file keeps the zeros at its end."""
    return "-" if value is None else format(Context(prec=digits).create_decimal(value), "f")


def scaled(value, digits):
    """Without so many digits before the point: 6 for millions."""
    return figure(None if value is None else Decimal(value).scaleb(-digits))


def millions(value):
    return scaled(value, 6)


def table(header, rows):
    lines = ["| " + " | ".join(header) + " |", "|" + "---|" * len(header)]
    lines += ["| " + " | ".join(str(cell) for cell in row) + " |" for row in rows]
    return "\n".join(lines)


def fill(text, indent=""):
    return textwrap.fill(text, 100, initial_indent=indent, subsequent_indent=" " * len(indent),
                         break_long_words=False, break_on_hyphens=False)


@section("loop", "Real telemetry through the whole loop",
         "BUPT-1 is a CubeSat. The file has 12 days of its power subsystem. Its segments have 1.6 "
         "to 3.5 h. `satcs-replay` sends it over DDS at full speed to `reidentd` with "
         "`deploy/bupt1.toml` and to one simulator.")
def loop(figures):
    rows = []
    for name, tried in figures["equipment"].items():
        score = "-"
        if tried["approved"]:
            score = "{} ({}), {} ({})".format(*(figure(tried[what][which]) for what in
                                              ("mrse_percent", "fit_percent")
                                              for which in ("median", "worst")))
        outcomes = ", ".join(f"`{outcome}` {n}" for outcome, n in tried["outcomes"].items())
        rows.append([name, tried["tried"], tried["approved"], outcomes, score])
    same = "holds exactly" if figures["archive_exact"] else "DIFFERS FROM"
    return [table(["what", "figure"],
                  [["frames replayed", f"{figures['frames']:,} in {figure(figures['replay_s'])} s"],
                   ["archive", f"{same} the {figures['samples']:,} samples of the files"],
                   ["windows decided", f"{figures['windows']}, {figure(figures['decided_s'])} s "
                    "after the start"],
                   ["versions that the simulator adopted", figures["versions_adopted"]]]),
            table(["equipment", "windows tried", "approved", "not approved, by outcome",
                   "approved: MRSE %, fit % on unseen data (median, worst)"], rows)]


@section("derived", "A derived input",
         "A converter passes power on. The output current of MPPT2 follows "
         "`mppt2_uin * mppt2_iin / bus_u`, which no linear model of the two inputs can form. "
         "`deploy/bupt1.toml` declares it in `[[spacecraft.equipment.derived]]`; a CSV file takes "
         "`--derive`.",
         "The table has the free-run error in percent on the last third of each file. \"Derived\" "
         "has the quotient in the place of the input current. \"Apart\" is "
         "`--input mppt2_uin_mv mppt2_iin_ma` without `--derive`. \"Quotient alone\" is "
         "`--input P`.")
def derived(figures):
    return [table(["file", "apart", "derived", "quotient alone"],
                  [[file, *(figure(errors[way]) for way in ("apart", "derived", "quotient"))]
                   for file, errors in figures.items()])]


@section("followed", "Approved versions on the telemetry after them",
         "Three files of BUPT-1 were imported, and backfill decided on them as the loop does. Then each "
         "version ran freely on the telemetry from its approval until the next one, of which nothing "
         "is excluded. Next to it are the version that it replaced, the outputs' means over its "
         "window, and a static regression of its window. All errors are MRSE in percent.",
         "The bus voltage hardly moves, so that its mean is hard to beat there. The service says of its "
         "champion that it fails (`champion_failed`), in log, status, overview and metrics.")
def followed(figures):
    def error(row, of):
        return figure(row[of]["mrse_percent"]) if of in row else "-"
    return [table(["version", "rows", "fit %", "version: error %", "replaced", "mean", "static"],
                  [[f"{row['equipment']} {row['version']}", row["rows"],
                    figure(row["errors"]["fit_percent"]), error(row, "errors"),
                    error(row, "replaced_errors"), error(row, "mean"),
                    error(row, "static_regression")]
                   for row in figures["followed"] if "rows" in row])]


@section("derived_loop", "A derived input in the loop",
         "The loop tries windows of 95 min. The error is the median MRSE of the models of every "
         "slide, approved or not: `slides` in the loop's last line. \"Apart\" is `deploy/bupt1.toml` "
         "with `inputs = [\"mppt2_uin\", \"mppt2_iin\"]`.")
def derived_loop(figures):
    return [table(["file", "apart: error %", "derived: error %", "apart: windows that gave a model",
                   "derived: windows that gave a model"],
                  [[file, figure(ways["apart"]["median"], 4), figure(ways["derived"]["median"], 4),
                    ways["apart"]["models"], ways["derived"]["models"]]
                   for file, ways in figures.items()])]


@section("archive", "The archive compared with a plain table",
         "The plain table is SQLite's best for the same samples: key parameter and time, WITHOUT "
         "ROWID, WAL, prepared inserts. Both get the same batches of 512 frames of 629 parameters "
         "with `synchronous = FULL`.",
         "`avg(value)` asks a virtual table for each of 2.6 million rows. SQLite's own part of "
         "that is more than a third of what the plain table takes. So no virtual table can be more "
         "than about twice as fast in this way.",
         "The publishers' ratio compares with appends of the same frames alone, measured in the "
         "same run. With small frames the middleware's cost for each frame counts. ddsperf packs "
         "messages together.")
def archive(figures):
    def size(name):
        own, plain = figures[f"bytes_per_sample_{name}"], figures["bytes_per_sample_plain" + (
            "_bupt" if name == "bupt" else "")]
        if own is None:
            return ["-", "-", "-"]
        return [figure(own), figure(plain), f"{plain / own:.0f}"]
    get, disk = figures.get, figures["machine"]
    rows = [
        [f"bytes a sample, all of the file counted: BUPT-1, {millions(get('samples_bupt'))} "
         "million samples", *size("bupt")],
        ["the same: a day of the reference spacecraft", *size("reference")],
        ["appended and flushed, million samples a second, compaction included",
         millions(get("append_per_s")), millions(get("append_plain_per_s")),
         figure(get("append_vs_plain"))],
        [f"the same, behind {millions(get('large_samples'))} million samples, over that from an "
         "empty file", figure(get("append_large_over_empty")), "", ""],
        ["a window of 15,000 samples of 5 parameters, read into arrays, among "
         f"{millions(get('window_samples'))} million", figure(get("window_read_ms")) + " ms", "",
         figure(get("window_read_vs_plain"))],
        [f"the same among {millions(get('large_samples'))} million, over that among a million",
         figure(get("window_read_large_over_small")), "", ""],
        ["mean of a parameter over 30 days in SQL: `telemetry_summary`", "", "",
         figure(get("sql_month_vs_plain"))],
        ["the same: `avg(value)` of `telemetry`", "", "", figure(get("sql_month_rows_vs_plain"))]]
    for count, ending in ((629, ""), (16, "_16")):
        rows.append([f"two publishers over DDS into the daemon, frames of {count} samples, million "
                     "samples a second", millions(get("end_to_end_per_s" + ending)), "",
                     figure(get("end_to_end_over_append" + ending)) + " of appends"])
    rows += [
        ["samples lost, doubled or changed on that way", get("end_to_end_lost"), "", ""],
        ["messages of a 629-sample frame's size that ddsperf sends, thousand a second",
         scaled(get("ddsperf_messages_per_s"), 3), "", ""],
        ["the longest append of 512 frames with its step of compaction",
         figure(get("longest_append_ms")) + " ms", "", ""],
        ["memory of the writer, at most", figure(get("writer_peak_mib")) + " MiB", "", ""]]
    return [fill(f"File system {disk['file_system']}; writing and flushing 4 KiB takes "
                 f"{figure(disk['fdatasync_ms'])} ms."),
            table(["what", "archive", "plain table", "ratio"], rows)]


@section("import", "Importing a file",
         "Processor time of `reident import` of a file of BUPT-1, each into a new database, in turns "
         "with the SQLite shell's `.import`, which takes the cells as texts, and with the build of "
         "another commit.")
def import_file(figures):
    get = figures.get
    rows = [["`reident import`", figure(get("import_s")) + " s",
             f"{millions(get('samples_a_second'))} million samples a second"],
            ["the same, of the other commit", figure(get("other_s")) + " s",
             f"ratio {figure(get('import_over_other'))}"],
            ["SQLite's `.import`", figure(get("sqlite_s")) + " s",
             f"ratio {figure(get('import_over_sqlite'))}"]]
    return [table([f"{get('samples'):,} samples in {get('file_bytes'):,} bytes", "time", ""], rows)]


@section("simulator", "The simulators' side",
         "A model of order 6 with 4 inputs and 1 output. `ddsperf ping` sends messages of a "
         "version's size. Pings back to back have threads that never sleep.")
def simulator(figures):
    get = figures.get
    trips = get("roundtrip_us") or [None, None]
    memory = get("memory_mib")
    return [table(["what", "reident", "compared with", "ratio"], [
        ["from the service's write to the first step on the version in another process that steps "
         f"without a pause, median of {get('flips')}", figure(get("publish_to_step_us")) + " us",
         f"round trip of `ddsperf ping` at 10 Hz: {figure(trips[0])} us before, {figure(trips[1])} "
         "us after", figure(get("publish_to_step_over_roundtrip"))],
        ["the same", figure(get("publish_to_step_us")) + " us",
         f"pings back to back: {figure(get('roundtrip_back_to_back_us'))} us",
         figure(get("publish_to_step_over_back_to_back"))],
        ["a step, with its checks and the history for a swap", figure(get("step_ns")) + " ns",
         f"the unrolled products alone: {figure(get('handwritten_ns'))} ns",
         figure(get("step_over_handwritten"))],
        [f"allocations and system calls in {get('steps'):,} steps with {get('swaps')} swaps",
         f"{get('step_allocations')}, {get('system_calls')}", "", ""],
        [f"{get('simulators')} simulators at once, until the last has all {get('champions')} "
         f"champions: worst of {get('cycles')} times, median",
         f"{figure(get('late_100_seconds'))} s, {figure(get('late_median_seconds'))} s", "", ""],
        ["memory of the service: before they come, after the first time, after "
         f"{get('cycles')} times", ", ".join(map(figure, memory)) + " MiB", "", ""],
        [f"the output's largest change in a step through a swap, {get('pairs')} pairs of versions",
         "", "the larger model's own largest change", figure(get("swap_jump_max"))]])]


def families(figures):
    return {name: figures[name] for name in ("power", "platform") if name in figures}


def share_of_changes(figures, key):
    if not figures["changes"] or key not in figures:
        return ""
    return f"{round(figures[key] * figures['changes'])} of {figures['changes']}"


def recovered(figures):
    return share_of_changes(figures, "recovered_fraction")


def recovered_or_asked(figures):
    return share_of_changes(figures, "recovered_or_asked_fraction")


def trust_rows(figures):
    return [[name, of["scenarios"], of["versions"], of["wrong"], figure(of["wrong_upper_percent"]),
             recovered(of), recovered_or_asked(of), of["recovery_median_orbits"], figure(of["regret"]),
             figure(of["regret_p90"])] for name, of in families(figures).items()]


TRUST_COLUMNS = ["family", "scenarios", "versions", "wrong", "at most, % (95 %)", "recovered",
                 "or asked", "orbits, median", "regret", "in nine of ten"]


@section("trust", "Did any simulator get a worse model?",
         "[The trust suite](../trust/README.md) scores the service on two families of equipment "
         "that age and fail, and whose telemetry has faults, against a truth that the service does "
         "not see. Scenarios have 31 days, with seeds that were drawn for this run.",
         "A version is wrong where it errs more than what it replaced over the next 30 orbits. The "
         "difference has to be above a tenth of that error, and above what its sensor can show. "
         "\"Recovered\" are true changes that mattered, within 20 orbits. "
         "\"Or asked\" counts those too of which an operator was asked by then, since a sensor's "
         "bias might look the same. Regret is the champion's error over the least one of any version "
         "known by then. 1 is perfect hindsight. The figures are no promise for every seed.")
def trust(figures):
    lives = [[f"{family}: {life.replace('_', ' ')}", of["scenarios"], of["versions"], of["wrong"],
              recovered(of), recovered_or_asked(of), figure(of["regret"])]
             for family, all_lives in families(figures).items()
             for life, of in all_lives["lives"].items()]
    quiet = ", ".join(f"{figure(of['publications_per_month'])} ({name})"
                      for name, of in families(figures).items())
    return [table(TRUST_COLUMNS, trust_rows(figures)),
            table(["what happens", "scenarios", "versions", "wrong", "recovered", "or asked", "regret"],
                  lives),
            fill(f"When nothing changes, an equipment got so many versions a month: {quiet}.")]


@section("trust_dds", "Scenarios of the trust suite over DDS",
         "Some scenarios of both families run with the real processes and a database on a real disk. "
         "The same score reads the database.")
def trust_dds(figures):
    return [table(TRUST_COLUMNS, trust_rows(figures))]


@section("month", "A month in minutes",
         "30 days of the reference spacecraft go over DDS into the real service, nine equipment at "
         "1 Hz, until no window is pending.")
def month(figures):
    return [table(["days", "samples stored, million", "windows tried", "time"],
                  [[figures["days"], millions(figures["samples_stored"]), figures["windows"],
                    f"{figure(figures['month_seconds'])} s"]])]


# Simulator, identified, pole placement, integral feedback: MRSE in percent, as printed there.
PAPER = {"BDR": ["16.4", "11.75", "6.94", "0.046"],
         "BAT1": ["3.3", "2.25", "no improvement", "no improvement"],
         "MEA": ["none", "13.48", "2.64", "5.8e-13"]}
PICTURES = """Three orbits of the rows that validate, as
`tests/bench/run.sh paper --pictures FOLDER` draws them:

![BDR: measured, hand-written, identified and with integral feedback](paper/pictures/bdr.svg)
![BAT1: the same](paper/pictures/bat1.svg)
![MEA: the same; the hand-written simulator has no error amplifier](paper/pictures/mea.svg)"""


@section("paper", "The paper's table",
         "MRSE in percent on rows that nothing was chosen on. The first table has the reference "
         "spacecraft for 150,000 s (seed 1) and the paper's CBERS-4: 15,000 rows identify, the "
         "next 15,000 tune the poles, 120,000 validate. In the second one, of BUPT-1, the first "
         "15,000 rows of a file identify, the next 5,000 tune and the rest validates.",
         "\"None\" under the simulator: it has no such output. \"None\" elsewhere: no placement "
         "lowered the error on the tuning rows by 1 %. \"By power\" has the one input "
         "U_in I_in / U_bus instead of U_in and I_in.",
         "Within a line the simulator's, the identified and the placed model may be compared: all "
         "are free-run simulations on the same rows. Integral feedback has seen the output up to "
         "the sample before. It is to be compared with the column \"the sample before\" alone.",
         "A line of the reference spacecraft and one of the paper may not be compared. They have "
         "another spacecraft, other rows, and a reference that we simulated. They share the "
         "direction of each step.",
         "The paper's 5.8e-13 % needs a loop in which the output of a sample corrects itself. No "
         "loop that gets the output afterwards can have it "
         "([METHOD.md](../../identification/METHOD.md) 14). Pole placement may win on the tuning "
         "rows and lose on the rows that validate, as on MPPT2, file c: the identified models are "
         "refined on their simulated output already.")
def paper(figures):
    def error(part):
        return figure(part["mrse_percent"]) if part and part["mrse_percent"] is not None else "none"

    def errors(line, kinds):
        return [error(line[kind]) for kind in kinds]
    kinds = ["identified", "pole_placement", "integral_feedback", "last_sample"]
    header = ["identified", "pole placement", "integral feedback", "the sample before"]
    reference, recorded = [], []
    for name, line in figures.items():
        if name in PAPER:
            reference.append([name, line["order"], *errors(line, ["baseline", *kinds])])
            reference.append([f"the paper's {name}", "", *PAPER[name], ""])
        else:
            recorded.append([name, line["order"], f"{line['rows']['validate']:,}",
                             *errors(line, kinds)])
    tables = [table(["equipment", "order", "simulator's own", *header], reference), PICTURES]
    if recorded:
        tables.append(table(["equipment, file", "order", "rows that validate", *header], recorded))
    return tables


SIZES = {  # rows, figures that compare one shot and the slid window with SLICOT
    "15k": ("15,000", "one_shot_15k_vs_slicot", "slide_15k_vs_slicot"),
    "150k": ("150,000", "one_shot_150k_vs_slicot", "slide_150k_vs_slicot"),
    "million": ("1,000,000", "million_vs_slicot", None)}
DATA_SETS = {"hairdryer": "hair dryer", "glassfurnace": "glass furnace", "evaporator": "evaporator",
             "ballbeam": "ball and beam", "thermic_wall": "thermic wall"}


@section("identification", "Identification compared with other tools",
         "One run, one thread each. SLICOT is Debian's libslicot on OpenBLAS, with the fastest of "
         "its algorithms C, F and Q for the rows. The telemetry is simulated: 4 inputs, 1 output, "
         "20 block rows, order 4. Times are medians of processor time. The error is of a free-run "
         "simulation on 15,000 unseen rows.",
         "Both tools fit B, D and x0 to the simulated output in the first table. Both also have a "
         "faster, less accurate way: from the compression. The slid window takes that way. The "
         "second table compares it.",
         "There most of what is left of reident's time is the lag products of every sample. For a "
         "slid window it is the Cholesky factor of 201 Hankel rows.",
         "In the last table reident chooses order, horizon, weighting and the way of B and D by "
         "itself, on rows held out of the identification. The other tools have the order and the "
         "block rows of Van Overschee and De Moor's book, set by hand. The rows and the "
         "preprocessing are the book's. The table has the free-run error on the validation rows in "
         "percent.",
         "These are published validation rows. The last tie rule and the search budget were set "
         "with this table in view; the folds and thresholds were settled on other data "
         "([METHOD.md](../../identification/METHOD.md) 7). Ball and beam validates on its own "
         "identification rows, by that protocol.")
def identification(figures):
    def times(ratios, key):
        return figure(ratios[key]) + " times faster" if key else ""
    compressed = figures["against_slicot_with_b_d_of_the_compression"]
    speed, faster = [], []
    for size, (rows, one_shot, slide) in SIZES.items():
        ms, errors = figures["cpu_ms"][size], figures["free_run_error_percent"][size]
        for name, label, ratio in (
                ("slicot", "SLICOT", ""),
                ("reident one-shot", "reident, one shot", times(figures, one_shot)),
                ("reident slide", "reident, slid by 500 rows", times(figures, slide)),
                ("reident automatic", "reident, all chosen",
                 figure(figures["automatic_15k_slicot_calls"]) + " calls of SLICOT")):
            if name in ms:
                error = f"{errors[name]:.3f} %" if name in errors else ""
                speed.append([rows, label, figure(ms[name], 4) + " ms", error, ratio])
        faster.append([rows, figure(ms.get("slicot, B D of the compression")) + " ms",
                       times(compressed, one_shot), times(compressed, slide)])
    tables = [table(["rows", "tool", "processor time", "free-run error", "compared with SLICOT"],
                    speed),
              fill("A refresh at 150,000 rows costs "
                   f"{figure(figures['slide_150k_over_15k'])} times the one at 15,000. "
                   "With 1,000,000 rows reident takes "
                   f"{figure(figures['million_extra_mib'])} MiB above the data."),
              table(["rows", "SLICOT from the compression", "reident, one shot",
                     "reident, slid by 500 rows"], faster)]
    if "accuracy" in figures:
        tables.append(table(
            ["data set", "identify, validate rows", "reident", "Octave n4sid",
             "SLICOT, B and D by simulation",
             "best of subid, SLICOT, SIPPY and nfoursid (reference)"],
            [[DATA_SETS[name], found["rows"], *(figure(found[tool], 4) for tool in
              ("reident", "octave_n4sid", "slicot_b_d_by_simulation", "best_of_others"))]
             for name, found in figures["accuracy"].items()]))
    return tables


@section("field", "Benchmark data of the identification literature",
         "reident gets the identification rows alone and chooses everything. The model then runs "
         "over the validation record, from a state that the record's first rows give, which are "
         "not scored. The error is the root mean square. Files, rows and published figures stand "
         "in `tests/bench/field.py`. The data are not part of the repository.",
         "No linear model reaches the published figures of nonlinear ones on these sets. The best "
         "linear model is the one that its authors or peers found, with the order set by hand.")
def field(figures):
    def values(numbers):
        return ", ".join(figure(value) for value in numbers)
    tables = [table(["data set", "reident", "its order", "best linear model", "published"],
                    [[name, f"{values(found['rmse'])} {found['unit']}", found["order"],
                      values(found["best_linear"]),
                      "; ".join(f"{what} {values(numbers)}"
                                for what, numbers in found["published"].items())]
                     for name, found in figures["sets"].items()])]
    if figures["left_out"]:
        tables.append("\n".join(fill(f"Left out: {name}: {why}.", "- ")
                                for name, why in figures["left_out"].items()))
    return tables


def screening(figures):
    def stretches(one):
        return ", ".join(f"`{kind}` {n}" for kind, n in one["stretches"].items())
    measured = {"now": figures, **({"before": figures["other"]} if "other" in figures else {})}
    tables = [table(["screening", "rows excluded", "stretches by kind"],
                    [[name, f"{figure(one['rows_left_out_percent'])} %", stretches(one)]
                     for name, one in measured.items()])]
    if "injected" in figures:
        columns = [column for name in measured for column in (
            f"found, {name}", f"other rows excluded, {name}")]
        tables.append(table(["what was put in", "times", *columns], [
            [kind, now["faults"],
             *(cell for one in measured.values() for cell in (
                 one["injected"][kind]["found"],
                 f"{figure(one['injected'][kind]['other_rows_percent'])} %"))]
            for kind, now in figures["injected"].items()]))
    return tables


for equipment in ("MPPT2", "BUS"):
    section(f"screening_{equipment.lower()}", f"Telemetry that screening excludes: {equipment}",
            "Screening may take for a fault what is none. Which of the excluded rows are faults is "
            "not known. `screening = \"off\"` leaves an equipment's telemetry as it is. The second "
            "table has faults that were put into this telemetry, one at a time. One is found where "
            "at least half of its rows are excluded. Many cannot show: a value that is repeated in "
            "eclipse, or a pulse no higher than those of the loads.")(screening)


@section("build", "Time to build and to test",
         "Programs and tests are built in one tree, build/release.")
def build(figures):
    names = {"release_cpu_s": "processor time of building the programs",
             "tests_cpu_s": "processor time of building programs and tests",
             "rebuilt_objects": "objects of the programs that the tests' build compiles again",
             "release_wall_s": "time of building the programs",
             "tests_wall_s": "time of building programs and tests",
             "suite_wall_s": "time of running the tests"}
    return [table(["what", "figure"],
                  [[label, figure(figures[key], 4) + (" s" if key.endswith("_s") else "")]
                   for key, label in names.items() if key in figures])]


def pair_tables(figures):
    get = figures.get
    return [table(["what", "median", "at most", "in time"], [
        [f"kill -9 of the leader, {get('takeovers')} times; 1.5 s",
         figure(get("takeover_median_s")) + " s", figure(get("takeover_s")) + " s",
         get("takeovers_in_time")],
        [f"SIGSTOP of the leader, {get('hangs')} times; 3 s", figure(get("hang_median_s")) + " s",
         figure(get("hang_s")) + " s", get("hangs_in_time")]]),
        table(["random kills", "take-overs", "decisions", "commands", "versions", "lost",
               "overruled", "numbers with two contents"],
              [[get(key) for key in ("kills", "kill_takeovers", "decisions_committed",
                                     "commands_answered", "versions", "decisions_lost",
                                     "decisions_overruled", "split_numbers")]])]


@section("operations", "Operation in a failing world",
         "Packages were installed on a bare Debian 12 under its own systemd. The network between a "
         "source, which does not wait, and the service was cut for 60 s at 100 frames a second, and "
         "lost packets in both directions.",
         "Two real services of a pair ran on loopback. Times are from the failure of the one that "
         "leads to the publication by the other one, as a simulator in another process hears it.",
         "The random kills hit either service while an operator gives one command after the other. "
         "The next one comes once both are in step again. What is lost are decisions that were ever "
         "committed, commands that were answered and versions that were published, and that are not "
         "in the registry at the end. Decisions that were overruled are counted apart.")
def operations(figures):
    names = {"exposure": "worst exposure of a unit (`systemd-analyze security`)",
             "lintian_errors": "errors that lintian finds in the packages",
             "lintian_warnings": "warnings that it finds",
             "restart_after_kill_s": "from SIGKILL until the service runs again",
             "restart_after_hang_s": "from a hang until it runs again",
             "restart_after_upgrade_s": "from the end of an upgrade until it runs again",
             "cut_missing": 'frames missing behind the cut, `cut = "60s"`, `rate = "100/s"`',
             "cut_delay_s": "time that the source lost by it",
             "plain_cut_missing": "the same without the two keys: frames missing",
             "plain_cut_counted_at_source": "the same, as the source counts them",
             "plain_cut_counted_at_service": "the same, as the service counts them",
             "loss_5_missing": "frames missing, 5 % of packets lost",
             "loss_5_frames_per_s": "frames a second then",
             "loss_20_missing": "frames missing, 20 % of packets lost",
             "loss_20_frames_per_s": "frames a second then",
             "intruder_seen": "samples that seven kinds of intruders saw, on twelve topics",
             "intruder_taken": "samples of theirs that were taken",
             "secured_ratio": "frames of 629 samples, sender to archive: secured over plain"}
    rows = [[label, figure(figures[key]) + (" s" if key.endswith("_s") and "frames" not in key else "")]
            for key, label in names.items() if key in figures]
    steps = [[name.replace("_", " "), "passed" if passed else "failed"]
             for name, passed in [*figures.get("package_steps", {}).items(),
                                  *((name, figures[name]) for name in ("manifest_valid",
                                                                       "container_serves")
                                    if name in figures)]]
    tables = [table(["what", "figure"], rows)]
    if steps:
        tables.append(table(["step of a package's life, and of the image's", "its test"], steps))
    if "takeovers" in figures:
        tables += pair_tables(figures)
    if "soak_minutes" in figures:
        tables += soak(figures)
    if figures["left_out"]:
        tables.append("\n".join(fill(f"Left out: {what}: {why}.", "- ")
                                for what, why in figures["left_out"].items()))
    return tables


@section("soak", "A soak",
         "Two services of a pair on machines of their own (network namespaces with disks in memory "
         "and clocks of their own) took telemetry at many times real time. An operator gave one "
         "command after the other, and a simulator followed. One thing after the other failed at "
         "random: a service was killed, stopped or hung, a disk was full, a clock was set, a "
         "network was cut.",
         "At the end the archives of both services were compared with what was sent, and their "
         "registries with each other and with all that was ever committed, answered or published.")
def soak(figures):
    failures = ", ".join(f"{name.replace('_', ' ')} {count}"
                         for name, count in figures["soak_failures"].items())
    names = {"samples": "samples sent", "samples_missing": "samples missing or doubled in an archive",
             "decisions_committed": "decisions that were ever committed",
             "decisions_lost": "of them gone", "decisions_overruled": "of them overruled and visible",
             "commands_answered": "commands answered", "commands_lost": "of them gone",
             "numbers_doubled": "numbers of versions with two contents",
             "publications": "publications heard",
             "publications_undecided": "of them of a version that was not decided",
             "memory_growth_mib": "growth of a process's memory after its first minute, at most, MiB",
             "files_growth": "growth of its open files, at most"}
    rows = [["telemetry, days", figure(figures["soak_days_of_telemetry"])],
            ["times real time", figure(figures["soak_speed"])],
            ["so many minutes, where nothing holds it up", figure(figures["soak_minutes"])],
            ["failures", failures], ["seed", figures["soak_seed"]],
            *([label, figures[f"soak_{key}"]] for key, label in names.items())]
    return [table(["what", "figure"], rows)]


CURVES = {"over_samples": ["samples", "bytes", "append a million, processor s",
                           "window of 15,000 rows, processor ms", "`reident backup`, s",
                           "`reident verify`, s"],
          "over_equipment": ["equipment", "`reident overview`, processor s",
                             "`reident history`, processor s", "`reident waiting`, processor s"]}


@section("scale", "A constellation, and a billion samples",
         "What an archive costs is processor time. That of an append and of a window is over the same "
         "in an archive of a million samples, that of a month's question over one of a month. Split "
         "and verify are elapsed time. A shard has the telemetry of a closed year.")
def scale(figures):
    names = {"discovery_s": "services and simulators until all have found each other, s",
             "idle_core": "idle: share of a core",
             "fleet_status_s": "`reident fleet status` of all, median, s",
             "service_mib": "memory of a service, MiB",
             "fleet_spacecraft": "spacecraft at real time, 72 parameters and 9 equipment each",
             "fleet_windows": "windows of theirs that were due in the same second",
             "fleet_lag": "until the last of these was decided, slides",
             "fleet_gib": "memory of the services, at most, GiB",
             "fleet_core": "their share of a core meanwhile",
             "fleet_lost": "samples lost",
             "windows": "windows of the sweep",
             "one_core_s": "the sweep on one core, s", "two_cores_s": "on two, s",
             "sweep_speedup": "one over two",
             "two_cores_equal": "two cores give the bits of one",
             "sweep_equal": "a Slurm array of two nodes does, with tasks requeued and a node drained",
             "growth_samples": "samples of the large archive", "growth_bytes": "its bytes",
             "billion_append": "append", "billion_window": "window of 15,000 rows",
             "billion_month": "a month in SQL", "billion_append_of_shards": "append, with a shard",
             "billion_window_of_shards": "window, with a shard",
             "billion_month_of_shards": "a month in SQL, with a shard",
             "split_s": "`reident archive split` of a year, s",
             "verify_day_s": "`reident verify --known` after a day more, s"}
    cell = lambda value: {True: "yes", False: "no"}[value] if isinstance(value, bool) else (
        f"{value:,}" if isinstance(value, int) else figure(value))
    tables = [table(["what", "figure"], [[label, cell(figures[key])]
                                         for key, label in names.items() if key in figures])]
    for key, header in CURVES.items():
        if key in figures:
            tables.append(table(header, [map(cell, row.values()) for row in figures[key]]))
    return tables


@section("web", "The operators' page",
         "A year of one parameter at 1 Hz has 31.5 million samples. The plot of a year has five "
         "signals, the champions and all decisions. Times are the 95 % quantile of 30, unless the "
         "table says otherwise, in Debian's Chromium or of the answer alone.")
def web(figures):
    rows = [("bytes of the page in all, gzip", "bytes", 90_000), ("requests for it", "requests", 8),
            ("of them to another origin", "foreign", 0),
            ("overview of 20 equipment, empty cache, until it can be used, median, ms",
             "overview_ms", 600),
            ("the same, ms", "overview_p95_ms", 1000),
            ("the tenth tab of one browser, ms", "tenth_tab_ms", 1000),
            ("a year of one parameter: answer, ms", "year_ms", 200),
            ("the same: bytes", "year_bytes", 16384),
            ("plot of a year, until it is drawn, ms", "plot_year_ms", 1000),
            ("the same, median, ms", "plot_year_median_ms", "-"),
            ("from a key that moves it until the next frame is done, ms", "pan_ms", "-"),
            ("decision until 50 viewers have heard it, ms", "decision_to_viewers_ms", 1500),
            ("100 viewers: memory of the page's server, MiB", "viewers_mib", 64),
            ("the same: share of a core", "viewers_core", 0.1),
            ("the same: an overview's answer, ms", "viewers_answer_ms", 100),
            ("ingest with 100 viewers and 4 endless year queries, over ingest without",
             "ingest_ratio", "at least 0.95"),
            ("SQLite's log meanwhile, at most, MiB", "log_mib", 64),
            ("normal requests with 200 slow connections of each kind, ms", "slow_p95_ms", 100),
            *((f"until 200 connections with a slow {kind} are closed, s", f"slow_{kind}_closed_s", 15)
              for kind in ("head", "body", "read")),
            ("a tab's heap after 86,400 updates, MB more", "heap_mb", 5),
            ("scrape of 100 equipment, ms", "scrape_ms", 20),
            ("the same: bytes", "scrape_bytes", 200_000)]
    return [table(["what", "measured", "bound"],
                  [[label, figure(figures[key]) if isinstance(figures[key], Decimal)
                    else figures[key], bound] for label, key, bound in rows])]


@section("fuzz", "Fuzzing",
         "libFuzzer. Most inputs run without sanitizers, which take several times as long. What was worth "
         "keeping, and more, runs with the address and undefined-behaviour sanitizers. Every target "
         "goes on from what earlier runs kept. What was found before has tests.")
def fuzz(figures):
    rows = [[f"`{name}`", one["inputs"], one["with_sanitizers"], one["kept"], one["found"],
             figure(Decimal(one["wall_s"]) / 60, 2)]
            for name, one in figures["targets"].items()]
    return [table(["target", "inputs", "of these with sanitizers", "kept", "finds", "minutes"], rows)]


def parse(text):
    return json.loads(text, parse_float=Decimal)


def render(name, result):
    title, paragraphs, tables = SECTIONS[name]
    origin = result.get("stated") or f"commit {result['commit']}"
    blocks = [f"## {title}\n" + fill(paragraphs[0]), *map(fill, paragraphs[1:]),
              f"```\n{result['command']}\n```",
              fill(f"Measured: {origin}, {result['date']}, {result['machine']}."),
              *tables(result["figures"])]
    if "notes" in result:
        blocks.append("\n".join(fill(note, "- ") for note in result["notes"]))
    if "earlier" in result:
        blocks.append(table(["other commits", "command", "result"], result["earlier"]))
    return "\n\n".join(blocks)


def page():
    results = {file.stem: parse(file.read_text()) for file in FOLDER.glob("*.json")}
    for name in results:
        if name not in SECTIONS:
            sys.exit(f"tests/bench/results/{name}.json has no section in results.py")
    return "\n\n".join([HEAD, *(render(name, results[name])
                                for name in SECTIONS if name in results)]) + "\n"


def main():
    if sys.argv[1:] == ["--check"]:
        if PAGE.read_text() == page():
            return 0
        print("tests/bench/RESULTS.md is not what tests/bench/results/*.json give; "
              "python3 tests/bench/results.py writes it")
        return 1
    if sys.argv[1:]:
        sys.exit(__doc__)
    PAGE.write_text(page())
    return 0


if __name__ == "__main__":
    sys.exit(main())
