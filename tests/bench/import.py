"""How long an import of a file of telemetry takes, compared with SQLite's own and another build's.

    import.py BUILD FILE [--other BUILD] [--runs N]

`reident import FILE`, that of the other build, and the SQLite shell's `.import`, which takes the
cells as texts, go in turns, each into a new database. Costs are processor seconds, the least of the
runs. Prints a table and, as the last line, one JSON object.
"""

import argparse
import json
import resource
import shutil
import subprocess
import tempfile
from pathlib import Path


def processor_s(*command):
    """Of one run; and what it prints."""
    before = resource.getrusage(resource.RUSAGE_CHILDREN)
    done = subprocess.run(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True,
                          check=False)
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    if done.returncode != 0:
        raise SystemExit(f"{' '.join(map(str, command))}\n{done.stderr}")
    return after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime, done.stdout


def measure(ways, runs):
    """Least processor seconds by name, and the last output."""
    least, printed = dict.fromkeys(ways, float("inf")), {}
    with tempfile.TemporaryDirectory(prefix="reident-import-") as folder:
        database = Path(folder) / "import.db"
        for _ in range(runs):
            for name, command in ways.items():
                seconds, printed[name] = processor_s(*command(database))
                least[name] = min(least[name], seconds)
                for file in Path(folder).iterdir():
                    file.unlink()
    return least, printed


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("build", type=Path, help="folder that the programs were built in")
    parser.add_argument("file", type=Path)
    parser.add_argument("--other", type=Path, help="the same of another commit")
    parser.add_argument("--runs", type=int, default=7)
    arguments = parser.parse_args()

    def importing(build):
        return lambda database: [build / "service/cli/reident", "import", arguments.file, "--db",
                                 database, "--spacecraft", "BENCH", "--json"]

    ways = {"reident": importing(arguments.build)}
    if arguments.other:
        ways["other"] = importing(arguments.other)
    if sqlite := shutil.which("sqlite3"):
        ways["sqlite"] = lambda database: [sqlite, database, ".mode csv",
                                           f'.import "{arguments.file}" telemetry']
    else:
        print("without the SQLite shell: install sqlite3")
    least, printed = measure(ways, arguments.runs)
    samples = json.loads(printed["reident"])["samples"]
    figures = {"file_bytes": arguments.file.stat().st_size, "samples": samples,
               "import_s": round(least["reident"], 3),
               "samples_a_second": round(samples / least["reident"])}
    for name in ("other", "sqlite"):
        if name in least:
            figures |= {f"{name}_s": round(least[name], 3),
                        f"import_over_{name}": round(least["reident"] / least[name], 3)}
    for name, seconds in least.items():
        print(f"{name:8} {seconds:.3f} s")
    print(json.dumps(figures))


if __name__ == "__main__":
    main()
