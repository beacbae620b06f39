"""A month of the whole reference subsystem through the real processes: satcs-reference at full speed
over DDS to reidentd with deploy/reference.toml, until no window is pending.

    month.py PROGRAMS CONFIGURATION [--days N] [--speed N|max]

PROGRAMS is the folder service of a build; the database is made next to it, on the disk of the build,
and thrown away. Prints one JSON object: wall seconds for the month, what was stored, tried and
approved, and where processor time went, in seconds.
"""

import argparse
import collections
import json
import os
import tempfile
import time
from pathlib import Path

from real_service import RealService

TICKS_A_SECOND = os.sysconf("SC_CLK_TCK")


def processor_seconds(stat):
    """Of a text of /proc: user and system time."""
    fields = stat.rpartition(")")[2].split()
    return (int(fields[11]) + int(fields[12])) / TICKS_A_SECOND


def processor_seconds_of_threads(process):
    """By the name of the thread."""
    seconds = collections.Counter()
    for task in Path(f"/proc/{process.pid}/task").iterdir():
        seconds[(task / "comm").read_text().strip()] += processor_seconds(
            (task / "stat").read_text())
    return {name: round(spent, 1) for name, spent in seconds.most_common() if spent >= 0.5}


def measure(programs, configuration, folder, days, speed):
    with RealService(programs, folder, configuration.read_text()) as service:
        began = time.monotonic()
        before = os.times()
        sent = service.receive("--duration", f"{days}d", speed=speed)
        after = os.times()
        ingested = time.monotonic() - began
        status = service.wait_idle()
        seconds = time.monotonic() - began
        threads = processor_seconds_of_threads(service.process)
        total = processor_seconds(Path(f"/proc/{service.process.pid}/stat").read_text())
    attempts = service.run("cli/reident", "history", "--database", folder / "reference.db")[
        "attempts"]
    outcomes = collections.Counter(
        (attempt["equipment"], attempt["trigger"], attempt["outcome"]) for attempt in attempts)
    phases = collections.Counter()
    for attempt in attempts:
        phases.update(attempt["evidence"].get("timing_ms", {}))
    spacecraft = after.children_user + after.children_system - (
        before.children_user + before.children_system)
    return {
        "month_seconds": round(seconds, 1), "days": days, "until_sent_s": round(ingested, 1),
        "frames": sent["frames"], "samples": sent["samples"],
        "samples_stored": status["samples_stored"],
        "windows": len(attempts),
        "approved": sum(decision["kind"] == "approve" for attempt in attempts
                        for decision in attempt.get("decisions", [])),
        "outcomes": {" ".join(key): count for key, count in sorted(outcomes.items())},
        "phases_of_windows_s": {phase: round(spent / 1000, 1)
                                for phase, spent in phases.most_common()},
        "processor_s": {"total": round(spacecraft + total, 1),
                        "satcs-reference": round(spacecraft, 1), "reidentd": round(total, 1),
                        "reidentd_threads": threads},
    }


def main():
    parser = argparse.ArgumentParser(description=__doc__,
                                     formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("programs", type=Path)
    parser.add_argument("configuration", type=Path)
    parser.add_argument("--days", type=int, default=30)
    parser.add_argument("--speed", default="max")
    chosen = parser.parse_args()
    with tempfile.TemporaryDirectory(prefix="month-", dir=chosen.programs.parent) as folder:
        print(json.dumps(measure(chosen.programs.resolve(), chosen.configuration, Path(folder),
                                 chosen.days, chosen.speed)))


if __name__ == "__main__":
    main()
