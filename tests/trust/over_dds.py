"""Scenarios of the trust suite through the real processes: satcs-reference, first as the hand-written
simulator and then as the spacecraft with its life and its faults, over DDS to reidentd, until no window
is pending. The suite's own score then reads the database; the service never sees the truth.

    over_dds.py BUILD [--scenario N...]

BUILD is the folder of a build; the databases are made in it and thrown away. Without --scenario the
suite's handful is run. The last line is one JSON object, that of reident_trust.
"""

import argparse
import json
import subprocess
import sys
import tempfile
import time
from pathlib import Path

from real_service import RealService


def run(build, recipe, folder):
    """Leaves the database <number>.db in `folder`."""
    number = recipe["scenario"]
    own = folder / f"run-{number}"
    own.mkdir()
    began = time.monotonic()
    with RealService(build / "service", own, recipe["configuration"]) as service:
        service.receive(*recipe["simulator"])
        sent = service.receive(*recipe["spacecraft"])
        status = service.wait_idle()
    (own / "reference.db").rename(folder / f"{number}.db")
    print(f"scenario {number}: {sent['frames']} frames sent, {status['samples_stored']} samples "
          f"stored in {time.monotonic() - began:.0f} s", file=sys.stderr, flush=True)


def score(build, choice, folder):
    """What reident_trust prints of the scenarios in `folder`."""
    suite = build / "tests/trust/reident_trust"
    recipes = subprocess.run([suite, *choice, "--recipe"], check=True, stdout=subprocess.PIPE,
                             text=True).stdout.splitlines()
    for recipe in map(json.loads, recipes):
        run(build, recipe, folder)
    return subprocess.run([suite, *choice, "--databases", folder], check=True,
                          stdout=subprocess.PIPE, text=True).stdout


def main():
    parser = argparse.ArgumentParser(description=__doc__,
                                     formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("build", type=Path)
    parser.add_argument("--scenario", nargs="+", default=[])
    chosen = parser.parse_args()
    choice = ["--scenario", *chosen.scenario] if chosen.scenario else ["--handful"]
    build = chosen.build.resolve()
    with tempfile.TemporaryDirectory(prefix="over-dds-", dir=build) as folder:
        print(score(build, choice, Path(folder)), end="")


if __name__ == "__main__":
    main()
