"""Runs a benchmark and stores its figures for RESULTS.md.

    record.py [--as NAME] WHAT [ARGUMENT...]

Runs tests/bench/run.sh WHAT ARGUMENT..., or for trust, month and trust_dds tests/trust/run.sh.
Stores the JSON object of its last line in results/NAME.json (default: WHAT.json), with the command,
the commit, the date and the machine, and writes RESULTS.md.
"""

import datetime
import json
import os
import subprocess
import sys
from pathlib import Path

import results

ROOT = results.HERE.parents[1]
WRITTEN = ["tests/bench/results", "tests/bench/RESULTS.md"]  # by a recording before this one
TRUST = {"trust": [], "month": ["--month"], "trust_dds": ["--dds"]}


def git(*words):
    return subprocess.run(["git", *words], stdout=subprocess.PIPE, text=True, check=False)


def commit():
    changed = git("diff", "--quiet", "HEAD", "--", ".", *(f":!{name}" for name in WRITTEN))
    return git("describe", "--always").stdout.strip() + ("-dirty" if changed.returncode else "")


def machine():
    """The processor as lscpu names it."""
    lines = subprocess.run(["lscpu"], stdout=subprocess.PIPE, text=True, check=True,
                           env=dict(os.environ, LC_ALL="C")).stdout.splitlines()
    model = next(line.split(":", 1)[1].strip() for line in lines if line.startswith("Model name"))
    return f"{model}, {os.cpu_count()} cores"


def shown(word):
    """An argument without the folders of this machine."""
    path = Path(word).resolve()
    if not path.exists() or path.is_relative_to(ROOT):
        return word
    return path.name if path.is_file() else "DATA_FOLDER"


def run(command):
    """The last line of its output, which is printed as it comes."""
    last = ""
    with subprocess.Popen(command, stdout=subprocess.PIPE, text=True) as running:
        for last in running.stdout:
            print(last, end="", flush=True)
    if running.returncode != 0:
        sys.exit(f"{command[0]} failed: nothing is recorded")
    return last


def main():
    words = sys.argv[1:]
    name = words[1] if words[:1] == ["--as"] and len(words) > 2 else None
    what, *arguments = words[2:] if name else words or sys.exit(__doc__)
    name = name or what
    if name not in results.SECTIONS:
        sys.exit(f"{name} has no section in results.py; those are {', '.join(results.SECTIONS)}")
    program = ["tests/bench/run.sh", what]
    if what in TRUST:
        program = ["tests/trust/run.sh", *TRUST[what]]
    os.chdir(ROOT)  # as these scripts do: relative arguments start there
    measured = {"command": " ".join([*program, *map(shown, arguments)]), "commit": commit(),
                "date": datetime.date.today().isoformat(), "machine": machine()}
    measured["figures"] = json.loads(run([*program, *arguments]))
    text = json.dumps(measured, indent=1, ensure_ascii=False) + "\n"
    results.render(name, results.parse(text))  # fails where the figures are not the section's
    (results.FOLDER / f"{name}.json").write_text(text)
    results.PAGE.write_text(results.page())


if __name__ == "__main__":
    main()
