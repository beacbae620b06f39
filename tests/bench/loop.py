"""Recorded BUPT-1 telemetry through the real loop: satcs-replay at full speed, reidentd with
deploy/bupt1.toml, one simulator. Checks that the archive holds exactly the samples of the files and
prints what was tried, approved and rejected, and what approved versions erred on the telemetry after
them, as Markdown. The last line is one JSON object.

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


def was_approved(attempt):
    return any(decision["kind"] == "approve" for decision in attempt.get("decisions", []))


def summary(attempts):
    """By equipment; `slides` are the models of each slide, whatever the gate decided."""
    by_equipment = collections.defaultdict(list)
    for attempt in attempts:
        by_equipment[attempt["equipment"]].append(attempt)
    figures = {}
    for name, tried in by_equipment.items():
        good = [a for a in tried if was_approved(a)]
        others = collections.Counter(a["outcome"] for a in tried if not was_approved(a))
        figures[name] = {"tried": len(tried), "approved": len(good),
                         "outcomes": dict(others.most_common())}
        for what, worst in (("mrse_percent", max), ("fit_percent", min)):
            scores = [a[what] for a in good]
            if scores:
                figures[name][what] = {"median": statistics.median(scores), "worst": worst(scores)}
        errors = [a["mrse_percent"] for a in tried
                  if a["trigger"] == "slide" and a.get("mrse_percent") is not None]
        figures[name]["slides"] = {"median": statistics.median(errors) if errors else None,
                                   "models": len(errors)}
    return figures


def table(equipment):
    lines = ["| equipment | windows tried | approved | rejected, by reason | "
             "approved: MRSE %, fit % on unseen data (median, worst) |",
             "|---|---|---|---|---|"]
    for name, tried in equipment.items():
        score = "-"
        if tried["approved"]:
            mrse, fit = tried["mrse_percent"], tried["fit_percent"]
            score = (f"{mrse['median']:.2f} ({mrse['worst']:.2f}), "
                     f"{fit['median']:.1f} ({fit['worst']:.1f})")
        lines.append(f"| {name} | {tried['tried']} | {tried['approved']} | " + ", ".join(
            f"{reason} {count}" for reason, count in tried["outcomes"].items()) + f" | {score} |")
    return "\n".join(lines)


def followed_table(versions):
    lines = ["| version | rows after it | MRSE %, fit % | replaced | mean | static regression |",
             "|---|---|---|---|---|---|"]
    for row in versions:
        errors = {name: row.get(name) for name in
                  ("errors", "replaced_errors", "mean", "static_regression")}
        cells = [f"{error['mrse_percent']:.2f}, {error['fit_percent']:.1f}" if error else "-"
                 for error in errors.values()]
        lines.append(f"| {row['equipment']}@{row['version']} | {row.get('rows', 0)} | "
                     + " | ".join(cells) + " |")
    return "\n".join(lines)


def every_model(equipment):
    return "The model of every slide, median MRSE on unseen data: " + ", ".join(
        f"{name} {tried['slides']['median']:.2f} % of {tried['slides']['models']}"
        for name, tried in equipment.items() if tried["slides"]["models"])


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
                replay = json.loads(run("satcs/satcs-replay", file, "--spacecraft", "BUPT-1",
                                        "--speed", "max", "--wait-readers", "2", "--json",
                                        *endpoint))
                expected.update(read_samples(file))
                replay_s += replay["wall_s"]
                frames += replay["frames"]
            run("cli/reident", "status", "--wait", "idle", "--timeout", "600", *endpoint)
            seconds = time.monotonic() - began
            database = ["--database", folder / "bupt1.db", "--json"]
            history = json.loads(run("cli/reident", "history", *database))
            followed = json.loads(run("cli/reident", "score", *database))["versions"]
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
        equipment = summary(history["attempts"])
        print(table(equipment))
        print("\n" + every_model(equipment))
        print("\n" + followed_table(followed))
        print(json.dumps({
            "frames": frames, "replay_s": replay_s, "samples": len(expected),
            "archive_exact": same, "windows": len(history["attempts"]), "decided_s": seconds,
            "versions_adopted": len(adopted), "equipment": equipment, "followed": followed}))
        return 0 if same else 1


if __name__ == "__main__":
    sys.exit(main())
