"""Operation in a failing and hostile world: packages under a real systemd, networks that are cut, a
pair of services whose leader is killed or hangs, intruders, and a soak.

    operations.py BUILD [PART...] [--quick]
    operations.py BUILD PART OPTION...

Runs the parts (the programs in the folder operations, all of them by default) one after the other.
Options but `--quick` are those of one part.
Each prints one JSON object as its last line. What a part cannot measure on this machine it names in
`left_out`, with the reason. The last line here is the union of all, and the exit status is 1 where
one of them failed, after which the others go on.
"""

import json
import subprocess
import sys
from pathlib import Path

FOLDER = Path(__file__).resolve().with_suffix("")


def run(part, arguments):
    """Whether it succeeded, and the object of its last line, if it has one."""
    last = ""
    with subprocess.Popen([sys.executable, str(FOLDER / f"{part}.py"), *arguments],
                          stdout=subprocess.PIPE, text=True) as running:
        for last in running.stdout:
            print(last, end="", flush=True)
    try:
        figures = json.loads(last)
    except json.JSONDecodeError:
        return False, {}
    return running.returncode == 0, figures


def main():
    build, *rest = sys.argv[1:]
    count = next((i for i, word in enumerate(rest) if word.startswith("-")), len(rest))
    wanted, options = rest[:count], rest[count:]
    if options not in ([], ["--quick"]) and len(wanted) != 1:
        sys.exit(f"{' '.join(options)}: options but --quick are those of one part; name that one")
    parts = sorted(path.stem for path in FOLDER.glob("[a-z]*.py"))
    if unknown := set(wanted) - set(parts):
        sys.exit(f"no such part: {', '.join(unknown)}; there are {', '.join(parts)}")
    figures, left_out, failed = {}, {}, []
    for part in wanted or parts:
        succeeded, of_part = run(part, [build, *options])
        if not succeeded:
            print(f"{part} failed", flush=True)
            failed.append(part)
        left_out.update(of_part.pop("left_out", {}))
        figures.update(of_part)
    left_out.update({part: "not asked for" for part in parts if wanted and part not in wanted})
    print(json.dumps({**figures, "failed": failed, "left_out": left_out}))
    sys.exit(bool(failed))


if __name__ == "__main__":
    main()
