"""Runs the libFuzzer targets of tests/fuzz.

    fuzz.py BUILD [TARGET...] [--runs N] [--seconds N]

Each target (all of them by default) runs so many inputs, or for so long where that ends first, as
many targets at a time as there are cores, at the lowest priority. It goes on from the inputs that
earlier runs found worth keeping (BUILD/corpus). What it finds is left in BUILD/finds. The last line
is one JSON object; the exit status is 1 where something was found.
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


def fuzz(build, name, arguments):
    corpus, finds = build / "corpus" / name, build / "finds" / name
    for folder in corpus, finds:
        folder.mkdir(parents=True, exist_ok=True)
    begin = time.monotonic()
    with tempfile.TemporaryDirectory(dir=MEMORY if MEMORY.is_dir() else None) as folder:
        done = subprocess.run(
            ["nice", "-n", "19", build / "tests/fuzz" / name, corpus, f"-runs={arguments.runs}",
             f"-max_total_time={arguments.seconds}", f"-max_len={LONGEST.get(name, 512)}",
             f"-timeout={SLOWEST_S}", "-rss_limit_mb=3000", f"-artifact_prefix={finds}/",
             "-print_final_stats=1", "-verbosity=0", *OPTIONS.get(name, [])],
            stdin=subprocess.DEVNULL, stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True,
            errors="replace", check=False, env={**os.environ, "TMPDIR": folder})
    if done.returncode != 0:
        print(f"{name}:\n{done.stderr[-6000:]}", flush=True)
    runs = re.search(r"stat::number_of_executed_units:\s*(\d+)", done.stderr)
    figures = {"inputs": int(runs[1]) if runs else 0, "found": int(done.returncode != 0),
               "kept": len(list(corpus.iterdir())), "wall_s": round(time.monotonic() - begin)}
    print(name, figures, flush=True)
    return figures


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("build", type=Path)
    parser.add_argument("targets", nargs="*")
    parser.add_argument("--runs", type=int, default=10_000_000)
    parser.add_argument("--seconds", type=int, default=3600)
    arguments = parser.parse_args()
    build = arguments.build.resolve()
    known = sorted(path.name for path in (build / "tests/fuzz").glob("*_fuzz"))
    if unknown := set(arguments.targets) - set(known):
        sys.exit(f"no such target: {', '.join(unknown)}; there are {', '.join(known)}")
    targets = arguments.targets or known
    with concurrent.futures.ThreadPoolExecutor(os.cpu_count()) as pool:
        figures = dict(zip(targets, pool.map(lambda name: fuzz(build, name, arguments), targets)))
    print(json.dumps({"targets": figures}))
    sys.exit(any(one["found"] for one in figures.values()))


if __name__ == "__main__":
    main()
