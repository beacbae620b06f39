"""Operation in a hostile world: what intruders of a secured domain see and reach, and what security
costs.

    security.py BUILD [--rounds N] [--frames N] [--quick]

Prints what was measured and, as the last line, one JSON object of the figures.
"""

import argparse
import json
import os
import random
import sqlite3
import statistics
import subprocess
import sys
import tempfile
import time
from pathlib import Path

TESTS = Path(__file__).resolve().parents[2]
DEADLINE_S = 120
SAMPLES = 629  # of a frame
CONFIGURATION = '''[archive]
database = "reident.db"
[dds]
domain = {domain}
partition = "bench"
{security}
[[spacecraft]]
name = "ANOTHER"
[[spacecraft.equipment]]
name = "IDLE"
inputs = ["U"]
outputs = ["Y"]
sample_period = "1s"
window = "1h"
slide = "1h"
'''


class Programs:
    def __init__(self, build):
        self.bin = build / "tests/e2e/bin"
        self.publisher = build / "tests/bench/archive/reident_bench_publisher"
        self.environment = {key: value for key, value in os.environ.items()
                            if key not in ("CYCLONEDDS_URI", "REIDENT_SECURITY")}

    def reident(self, *arguments):
        subprocess.run([str(self.bin / "reident"), *map(str, arguments)], check=True,
                       stdout=subprocess.DEVNULL, env=self.environment)


def intruders(build):
    """The end-to-end test of the table, whose cells are all 0 or it fails."""
    environment = {**os.environ, "REIDENT_BIN": str(build / "tests/e2e/bin"),
                   "REIDENT_BUILD": str(build), "PYTHONDONTWRITEBYTECODE": "1"}
    done = subprocess.run(
        [sys.executable, "test_security.py", "Intruders.test_see_nothing_and_reach_nobody"],
        cwd=TESTS / "e2e", env=environment, capture_output=True, text=True, check=False)
    lines = [line for line in done.stdout.splitlines() if line.startswith("{")]
    if done.returncode != 0:
        raise SystemExit(done.stdout + done.stderr)
    figures = json.loads(lines[-1])
    print(f"Seven intruders by twelve topics, {figures['cells']} cells: {figures['intruder_seen']} "
          f"samples seen, {figures['intruder_taken']} of theirs taken")
    return {"intruder_seen": figures["intruder_seen"], "intruder_taken": figures["intruder_taken"]}


def stored(file):
    connection = sqlite3.connect(f"file:{file}?mode=ro", uri=True, timeout=10)
    try:
        return connection.execute("SELECT coalesce(sum(samples), 0) FROM series").fetchone()[0]
    finally:
        connection.close()


def samples_per_s(programs, folder, frames, site):
    """Samples stored a second, from the first write to the last commit. `site`: None is plain."""
    folder.mkdir()
    domain = random.SystemRandom().randint(1, 200)
    security = f'security = "{site / "members/service"}"' if site else ""
    (folder / "reident.toml").write_text(CONFIGURATION.format(domain=domain, security=security))
    own = ["--security", str(site / "members/gateway")] if site else []
    with open(folder / "reidentd.log", "w", encoding="utf-8") as log:
        daemon = subprocess.Popen([programs.bin / "reidentd", "--config", folder / "reident.toml"],
                                  stdout=log, stderr=log, env=programs.environment)
    try:
        publisher = subprocess.Popen(
            [programs.publisher, "--domain", str(domain), "--partition", "bench", "--spacecraft",
             "BENCH", "--frames", str(frames), "--parameters", str(SAMPLES), *own],
            stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True, env=programs.environment)
        if publisher.stdout.readline() != "ready\n":
            raise SystemExit((folder / "reidentd.log").read_text())
        publisher.stdin.write("\n")
        publisher.stdin.flush()
        end = time.monotonic() + DEADLINE_S
        while stored(folder / "reident.db") < frames * SAMPLES and time.monotonic() < end:
            time.sleep(0.01)
        ended = time.monotonic()
        began = json.loads(publisher.communicate(timeout=DEADLINE_S)[0])["began"]
    finally:
        daemon.terminate()
        daemon.wait(DEADLINE_S)
    lost = frames * SAMPLES - stored(folder / "reident.db")
    if lost:
        raise SystemExit(f"{lost} samples are missing")
    return frames * SAMPLES / (ended - began)


def cost(programs, rounds, frames):
    ratios = []
    with tempfile.TemporaryDirectory(prefix="reident-bench-") as name:
        folder = Path(name)
        site = folder / "site"
        programs.reident("security", "init", site)
        for role in "service", "gateway":
            programs.reident("security", "grant", site, role, role, "--partition", "bench")
        for i in range(rounds):
            plain = samples_per_s(programs, folder / f"plain-{i}", frames, None)
            secured = samples_per_s(programs, folder / f"secured-{i}", frames, site)
            ratios.append(secured / plain)
            print(f"{frames} frames of {SAMPLES} samples, sender to archive: plain {plain / 1e6:.2f}, "
                  f"secured {secured / 1e6:.2f} million samples a second, ratio {ratios[-1]:.2f}")
    return {"secured_ratio": statistics.median(ratios)}


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("build", type=Path)
    parser.add_argument("--rounds", type=int, default=5)
    parser.add_argument("--frames", type=int, default=8000)
    parser.add_argument("--quick", action="store_true", help="one round, to try this script")
    arguments = parser.parse_args()
    rounds = 1 if arguments.quick else arguments.rounds
    build = arguments.build.resolve()
    figures = intruders(build)
    figures |= cost(Programs(build), rounds, arguments.frames)
    print(json.dumps(figures))


if __name__ == "__main__":
    main()
