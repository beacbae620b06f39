"""Operation in a failing and hostile world: each part is a script of the folder operations.

    operations.py BUILD [PART...] [--quick]

Runs the parts, or those that are named, each with BUILD and what else was given. Every part says
what it leaves out, and its last line is one JSON object. The last line here is one of all of them.
"""

import json
import subprocess
import sys
from pathlib import Path

FOLDER = Path(__file__).parent / "operations"


def run(part, arguments):
    """The part's figures; what it prints before them is printed."""
    done = subprocess.Popen([sys.executable, str(FOLDER / f"{part}.py"), *arguments],
                            stdout=subprocess.PIPE, text=True)
    last = ""
    for line in done.stdout:
        if last:
            print(last, end="", flush=True)
        last = line
    if done.wait() != 0:
        sys.exit(f"{part} failed with status {done.returncode}")
    return json.loads(last)


def main():
    build, *rest = sys.argv[1:] or sys.exit(__doc__)
    named = [argument for argument in rest if not argument.startswith("-")]
    options = [argument for argument in rest if argument.startswith("-")]
    parts = sorted(path.stem for path in FOLDER.glob("*.py"))
    for name in named:
        if name not in parts:
            sys.exit(f"there is no part {name}; there are {', '.join(parts)}")
    figures = {}
    for part in named or parts:
        print(f"-- {part}", flush=True)
        figures |= run(part, [build, *options])
    print(json.dumps(figures))


if __name__ == "__main__":
    main()
