"""Runs the libFuzzer targets of tests/fuzz.

    fuzz.py BUILD QUICK [TARGET...] [--runs N] [--seconds N]

Each target (all of them by default) runs so many inputs in the build QUICK, without sanitizers, or
for so long where that ends first. Then the build BUILD, with sanitizers, runs what was found worth
keeping, and a fiftieth as many inputs more: an input takes it several times as long. As many targets
run at a time as there are cores, at the lowest priority. They go on from what earlier runs kept
(BUILD/corpus). What is found is left in BUILD/finds. The last line is one JSON object; the exit
status is 1 where something was found.
"""

import argparse
import concurrent.futures
import json
import os
import re
import subprocess
import sys
import tempfile
import time
from pathlib import Path

# The largest input: what is read is longer for some than for others.
LONGEST = {"config_fuzz": 2048}
# The reader of files has so many branches that weighing its inputs by what is rare in them takes as
# long as running them.
OPTIONS = {"csv_fuzz": ["-entropic=0"]}
SLOWEST_S = 60  # an input that takes longer is a find
MEMORY = Path("/dev/shm")  # for the databases of some, which each input writes again


def run(program, corpus, finds, runs, seconds):
    """How many inputs ran, and whether something was found."""
    name = program.name
    with tempfile.TemporaryDirectory(dir=MEMORY if MEMORY.is_dir() else None) as folder:
        done = subprocess.run(
            ["nice", "-n", "19", program, corpus, f"-runs={runs}", f"-max_total_time={seconds}",
             f"-max_len={LONGEST.get(name, 512)}", f"-timeout={SLOWEST_S}", "-rss_limit_mb=3000",
             f"-artifact_prefix={finds}/", "-print_final_stats=1", "-verbosity=0",
             *OPTIONS.get(name, [])],
            stdin=subprocess.DEVNULL, stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True,
            errors="replace", check=False, env={**os.environ, "TMPDIR": folder})
    if done.returncode != 0:
        print(f"{name}:\n{done.stderr[-6000:]}", flush=True)
    count = re.search(r"stat::number_of_executed_units:\s*(\d+)", done.stderr)
    return int(count[1]) if count else 0, done.returncode != 0


def fuzz(name, arguments):
    corpus, finds = arguments.build / "corpus" / name, arguments.build / "finds" / name
    for folder in corpus, finds:
        folder.mkdir(parents=True, exist_ok=True)
    begin = time.monotonic()
    quick, found = run(arguments.quick / "tests/fuzz" / name, corpus, finds, arguments.runs,
                       arguments.seconds)
    checked, found_too = run(arguments.build / "tests/fuzz" / name, corpus, finds,
                             len(list(corpus.iterdir())) + arguments.runs // 50, arguments.seconds)
    figures = {"inputs": quick + checked, "with_sanitizers": checked,
               "found": int(found) + int(found_too), "kept": len(list(corpus.iterdir())),
               "wall_s": round(time.monotonic() - begin)}
    print(name, figures, flush=True)
    return figures


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("build", type=lambda text: Path(text).resolve())
    parser.add_argument("quick", type=lambda text: Path(text).resolve())
    parser.add_argument("targets", nargs="*")
    parser.add_argument("--runs", type=int, default=10_000_000)
    parser.add_argument("--seconds", type=int, default=3600)
    arguments = parser.parse_args()
    known = sorted(path.name for path in (arguments.build / "tests/fuzz").glob("*_fuzz"))
    if unknown := set(arguments.targets) - set(known):
        sys.exit(f"no such target: {', '.join(unknown)}; there are {', '.join(known)}")
    targets = arguments.targets or known
    with concurrent.futures.ThreadPoolExecutor(os.cpu_count()) as pool:
        figures = dict(zip(targets, pool.map(lambda name: fuzz(name, arguments), targets)))
    print(json.dumps({"targets": figures}))
    sys.exit(any(one["found"] for one in figures.values()))


if __name__ == "__main__":
    main()
