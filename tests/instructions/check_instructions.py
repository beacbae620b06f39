"""Counts the instructions of hot calls by callgrind and compares them with the recorded ones.

    check_instructions.py PROGRAM RECORDED.json            fails where a call takes over 10 % more
    check_instructions.py PROGRAM RECORDED.json --record   stores the counts of now
"""

import json
import re
import subprocess
import sys
import tempfile
from pathlib import Path

ALLOWED = 1.10


def instructions(program, call):
    with tempfile.TemporaryDirectory(prefix="reident-instructions-") as folder:
        out = Path(folder) / "out"
        subprocess.run(["valgrind", "--tool=callgrind", "--collect-atstart=no",
                        f"--callgrind-out-file={out}", program, call],
                       check=True, capture_output=True)
        return int(re.search(r"^(?:totals|summary): (\d+)", out.read_text(), re.M).group(1))


def main():
    program, recorded = sys.argv[1], Path(sys.argv[2])
    names = subprocess.run([program], check=True, capture_output=True, text=True).stdout.split()
    counts = {name: instructions(program, name) for name in names}
    if "--record" in sys.argv:
        recorded.write_text(json.dumps(counts, indent=2) + "\n")
        return 0
    known = json.loads(recorded.read_text())
    slower = []
    for name in sorted(counts.keys() | known.keys()):
        ratio = counts.get(name, 0) / known[name] if known.get(name) else float("inf")
        print(f"{name:12} {counts.get(name, 0):>14,} of {known.get(name, 0):>14,}  {ratio:.3f}")
        if ratio > ALLOWED or name not in counts:
            slower.append(name)
    if slower:
        print(f"more than {ALLOWED - 1:.0%} over the recorded counts, or not known: "
              f"{', '.join(slower)}. Find the commit; where it is worth its price, record: "
              f"check_instructions.py {program} {recorded} --record")
    return 1 if slower else 0


if __name__ == "__main__":
    sys.exit(main())
