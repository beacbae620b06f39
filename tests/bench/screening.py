"""Runs the screening benchmark, and that of another commit with the same arguments.

    screening.py PROGRAM [--other PROGRAM] ARGUMENT...

The last line is the JSON object of PROGRAM, with that of the other one as "other".
"""

import argparse
import json
import subprocess


def figures(program, arguments):
    run = subprocess.run([program, *arguments], stdout=subprocess.PIPE, text=True, check=True)
    return json.loads(run.stdout.splitlines()[-1])


def main():
    parser = argparse.ArgumentParser(description=__doc__, allow_abbrev=False,
                                     formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("program")
    parser.add_argument("--other", help="the same of another commit")
    known, arguments = parser.parse_known_args()
    result = figures(known.program, arguments)
    if known.other:
        result["other"] = figures(known.other, arguments)
    print(json.dumps(result))


if __name__ == "__main__":
    main()
