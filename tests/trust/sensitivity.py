"""What half and double of each constant of the rule that is not configured change (service/DESIGN.md,
"Constants that are not configured").

    sensitivity.py FOLDER [--draw D] [--power N] [--platform N] [--constant NAME]...

Builds the trust suite in FOLDER as it is committed, and again with each constant changed. All run the
same scenarios of one draw: N of each family, spread over its numbers. A run that was interrupted goes
on in the same FOLDER. Of a share, "half" and "double" are those of its odds.

Prints a table, and one JSON object: for each constant and value what the suite counts, and regret over
that with the constant as it is: the geometric mean by scenario with its 95 % interval.
"""

import argparse
import json
import math
import os
import re
import shutil
import statistics
import subprocess
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]

# Name, file, the text that has the value, and what takes the place of {}: as it is, half, double.
CONSTANTS = [
    ("blocks of a cycle", "service/windows/block_reader.hpp", "int blocks_of_cycle = {};", "4", "2", "8"),
    ("cycles before", "service/windows/block_reader.hpp", "int cycles_before = {};", "4", "2", "8"),
    ("fault limit", "service/windows/block_reader.cpp", "most_faults = {};", "1.0 / 400", "1.0 / 800",
     "1.0 / 200"),
    ("most", "service/windows/window_data.hpp", "double most = {};", "0.5", "1.0 / 3", "2.0 / 3"),
    ("width of a regime", "identification/statistics/operating_regimes.cpp", "regime_width = {};", "0.25",
     "0.125", "0.5"),
    ("reference", "identification/statistics/betting.hpp", "cycles_to_measure = {};", "8", "4", "16"),
    ("reach of a sensor", "service/judgement/scores.hpp", "deviations_of_sensor = {};", "3", "1.5", "6"),
    ("share behind a change", "service/judgement/league_rule.cpp", "share_behind = {},", "0.75", "0.6",
     "6.0 / 7"),
]


def run(*command, **options):
    return subprocess.run([str(word) for word in command], check=True, text=True, **options)


def numbers(first, last, count):
    """`count` scenarios of first to last, as evenly as they go."""
    step = (last + 1 - first) / max(count, 1)
    return [first + int(i * step) for i in range(count)]


def regrets(log):
    """Of each scenario in the suite's words: the geometric mean over its equipment."""
    found = {}
    for line in log.splitlines():
        if scenario := re.match(r"scenario (\d+): ", line):
            number = int(scenario[1])
        if regret := re.search(r"; regret ([\d.]+)", line):
            found.setdefault(number, []).append(math.log(float(regret[1])))
    return {number: statistics.mean(logs) for number, logs in found.items()}


def measure(folder, name, draw, scenarios):
    """Builds what is in the tree, and runs it. Returns the suite's figures and the regrets."""
    outcomes = folder / name
    log = folder / f"{name}.log"
    if not log.exists():
        run("cmake", "--build", folder / "build", "--target", "reident_trust", "-j", os.cpu_count(),
            stdout=subprocess.DEVNULL)
        program = folder / "build/tests/trust/reident_trust"
        kept = shutil.copy(program, folder / f"{name}.program")
        with open(folder / f"{name}.part", "w", encoding="utf-8") as part:
            run(kept, "--draw", draw, "--jobs", os.cpu_count(), "--outcomes", outcomes, "--scenario",
                *scenarios, stdout=part, stderr=part)
        (folder / f"{name}.part").rename(log)
    text = log.read_text(encoding="utf-8")
    return json.loads(text.splitlines()[-1]), regrets(text)


def compare(other, own):
    """The ratio of regrets, and its 95 % interval by scenario."""
    differences = [other[number] - own[number] for number in own if number in other]
    mean = statistics.mean(differences)
    half = 2 * statistics.stdev(differences) / math.sqrt(len(differences))
    return [round(math.exp(x), 4) for x in (mean, mean - half, mean + half)]


def main():
    parser = argparse.ArgumentParser(description=__doc__,
                                     formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("folder", type=Path)
    parser.add_argument("--draw", type=int, default=1)
    parser.add_argument("--power", type=int, default=24)
    parser.add_argument("--platform", type=int, default=24)
    parser.add_argument("--constant", action="append", choices=[row[0] for row in CONSTANTS])
    options = parser.parse_args()
    folder = options.folder.resolve()
    tree = folder / "tree"
    folder.mkdir(parents=True, exist_ok=True)
    if not tree.exists():
        run("git", "-C", ROOT, "worktree", "prune")
        run("git", "-C", ROOT, "worktree", "add", "--detach", tree, "HEAD")
    run("git", "-C", tree, "checkout", "--quiet", ".")
    launcher = ["-DCMAKE_CXX_COMPILER_LAUNCHER=ccache"] if shutil.which("ccache") else []
    run("cmake", "--preset", "release", "-S", tree, "-B", folder / "build", "-DBUILD_TESTING=ON", *launcher,
        stdout=subprocess.DEVNULL)
    scenarios = numbers(1, 350, options.power) + numbers(1001, 1195, options.platform)
    figures, own = measure(folder, "as-it-is", options.draw, scenarios)
    rows = [{"constant": "as it is", "value": "", "figures": figures, "regret_ratio": [1, 1, 1]}]
    for name, path, text, value, *others in CONSTANTS:
        if options.constant and name not in options.constant:
            continue
        file = tree / path
        source = file.read_text(encoding="utf-8")
        if source.count(text.format(value)) != 1:
            raise SystemExit(f"{path} does not have {text.format(value)!r} once")
        for other in others:
            file.write_text(source.replace(text.format(value), text.format(other)), encoding="utf-8")
            figures, theirs = measure(folder, re.sub(r"\W+", "-", f"{name}-{other}"), options.draw, scenarios)
            rows.append({"constant": name, "value": other, "figures": figures,
                         "regret_ratio": compare(theirs, own)})
        file.write_text(source, encoding="utf-8")
    for row in rows:
        families = {name: row["figures"][name] for name in ("power", "platform") if name in row["figures"]}
        print(f"{row['constant']} {row['value']}: regret {row['regret_ratio']}", *(
            f"{name}: {of['wrong']} wrong of {of['versions']}, {of['recovered_fraction']:.3f} of "
            f"{of['changes']} recovered, regret {of['regret']:.3f}" for name, of in families.items()), sep="; ")
    keys = ("scenarios", "versions", "wrong", "changes", "recovered_fraction", "regret")
    print(json.dumps({"draw": options.draw, "rows": [
        {**row, "figures": {family: {key: of[key] for key in keys}
                            for family, of in row["figures"].items() if family in ("power", "platform")}}
        for row in rows]}))


if __name__ == "__main__":
    main()
