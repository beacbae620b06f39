"""Recorded BUPT-1 telemetry through the real loop: satcs-replay at full speed, reidentd with
deploy/bupt1.toml, one simulator. Checks that the archive holds exactly the samples of the files and
prints what was tried, approved and rejected, as Markdown.

    loop.py PROGRAMS CONFIGURATIONS FILE.csv...
"""

import collections
import csv
import json
import os
import random
import re
import signal
import statistics
import subprocess
import sys
import tempfile
import time
from pathlib import Path


def read_samples(path):
    """{(parameter, time in ns): value}: units at the ends of names do not count."""
    with open(path, newline="") as file:
        rows = csv.reader(file)
        header = [re.sub("_(ma|mv)$", "", name) for name in next(rows)]
        return {(name, int(row[0]) * 10**9): float(cell)
                for row in rows for name, cell in zip(header[1:], row[1:])}


def archived(programs, database):
    query = programs.parent / "tests/support/query"
    lines = subprocess.run(
        [query, database, "SELECT parameter, time, value FROM telemetry WHERE quality = 'good'"],
        stdout=subprocess.PIPE, text=True, check=True).stdout.splitlines()
    return {(name, at): value for name, at, value in map(json.loads, lines)}


def table(attempts):
    lines = ["| equipment | windows tried | approved | rejected, by reason | "
             "approved: MRSE %, fit % on unseen data (median, worst) |",
             "|---|---|---|---|---|"]
    by_equipment = collections.defaultdict(list)
    for attempt in attempts:
        by_equipment[attempt["equipment"]].append(attempt)
    for name, tried in by_equipment.items():
        good = [a for a in tried if a["outcome"] == "approved"]
        reasons = collections.Counter(a["outcome"] for a in tried if a["outcome"] != "approved")
        mrse = [a["mrse_percent"] for a in good]
        fit = [a["fit_percent"] for a in good]
        score = (f"{statistics.median(mrse):.2f} ({max(mrse):.2f}), "
                 f"{statistics.median(fit):.1f} ({min(fit):.1f})") if good else "-"
        lines.append(f"| {name} | {len(tried)} | {len(good)} | " + ", ".join(
            f"{reason} {count}" for reason, count in reasons.most_common()) + f" | {score} |")
    return "\n".join(lines)


def every_model(attempts):
    """The median error of the models of each slide, whatever the gate said of them."""
    errors = collections.defaultdict(list)
    for attempt in attempts:
        if attempt["trigger"] == "slide" and attempt.get("mrse_percent") is not None:
            errors[attempt["equipment"]].append(attempt["mrse_percent"])
    return "The model of every slide, median MRSE on unseen data: " + ", ".join(
        f"{name} {statistics.median(some):.2f} % of {len(some)}" for name, some in errors.items())


def main():
    programs, configurations, files = Path(sys.argv[1]), Path(sys.argv[2]), sys.argv[3:]
    environment = {k: v for k, v in os.environ.items() if k != "CYCLONEDDS_URI"}
    domain = str(random.SystemRandom().randint(1, 200))
    endpoint = ["--domain", domain, "--partition", "bench"]
    with tempfile.TemporaryDirectory(prefix="reident-loop-") as name:
        folder = Path(name)
        text = (configurations / "bupt1.toml").read_text()
        (folder / "bupt1.toml").write_text(
            f'[dds]\ndomain = {domain}\npartition = "bench"\n\n{text}')
        children = []

        def start(program, *arguments, output):
            with open(folder / output, "w") as out:
                children.append(subprocess.Popen([programs / program, *arguments], stdout=out,
                                                 stderr=subprocess.STDOUT, env=environment))

        def run(program, *arguments):
            return subprocess.run([programs / program, *arguments], check=True, env=environment,
                                  capture_output=True, text=True).stdout

        try:
            start("daemon/reidentd", "--config", folder / "bupt1.toml", output="reidentd.log")
            start("client/reident-simulator", "--name", "bench", "--spacecraft", "BUPT-1",
                  "--equipment", "MPPT2", "BUS", "--json", "--cache", "", *endpoint, output="simulator.out")
            expected, began, replay_s, frames = {}, time.monotonic(), 0.0, 0
            for file in files:
                summary = json.loads(run("satcs/satcs-replay", file, "--spacecraft", "BUPT-1",
                                         "--speed", "max", "--wait-readers", "2", "--json",
                                         *endpoint))
                expected.update(read_samples(file))
                replay_s += summary["wall_s"]
                frames += summary["frames"]
            run("cli/reident", "status", "--wait", "idle", "--timeout", "600", *endpoint)
            seconds = time.monotonic() - began
            history = json.loads(run("cli/reident", "history", "--database", folder / "bupt1.db",
                                     "--json"))
        finally:
            for child in children:
                child.send_signal(signal.SIGTERM)
            for child in children:
                child.wait()
        same = archived(programs, folder / "bupt1.db") == expected
        adopted = [json.loads(line) for line in (folder / "simulator.out").read_text().splitlines()
                   if '"adopted"' in line]
        print(f"{frames} frames replayed in {replay_s:.1f} s; archive "
              f"{'holds exactly' if same else 'DIFFERS FROM'} the {len(expected)} samples of the "
              f"files; {len(history['attempts'])} windows decided {seconds:.0f} s after the start; "
              f"the simulator took {len(adopted)} versions.\n")
        print(table(history["attempts"]))
        print("\n" + every_model(history["attempts"]))
        return 0 if same else 1


if __name__ == "__main__":
    sys.exit(main())
