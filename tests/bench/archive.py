"""The archive compared with a plain SQLite table, and telemetry over DDS into it, in one run.

    archive.py BUILD [DATA_FOLDER] [--billion | --samples N] [--folder FOLDER]

Both files get the same frames in the same batches with the same durability. Prints tables as
Markdown and, as the last line, one JSON object of the figures; those that could not be measured are
null, and a sentence says why.
"""

import argparse
import json
import sys
import tempfile
from pathlib import Path

sys.path.insert(0, str(Path(__file__).parent / "archive"))

import end_to_end  # noqa: E402: found in the folder above
import files  # noqa: E402
import machine  # noqa: E402
import sql  # noqa: E402
from programs import Programs  # noqa: E402


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("build", type=Path, help="folder that the programs were built in")
    parser.add_argument("data", type=Path, nargs="?", help="folder of BUPT-1's files")
    parser.add_argument("--samples", type=float, default=1e8, metavar="N",
                        help="samples of the large archive (default: 1e8)")
    parser.add_argument("--billion", action="store_const", const=1e9, dest="samples",
                        help="a large archive of a billion samples")
    parser.add_argument("--folder", type=Path, help="where the files are made (default: a "
                        "temporary one; the large files take 30 bytes a sample)")
    parser.add_argument("--quick", action="store_true",
                        help="few samples, to test the measurement itself: the figures say nothing")
    arguments = parser.parse_args()
    programs = Programs(arguments.build.resolve())
    scale = files.QUICK if arguments.quick else files.scale(arguments.samples)
    figures = {}
    with tempfile.TemporaryDirectory(prefix="reident-archive-", dir=arguments.folder) as name:
        folder = Path(name)
        figures["machine"] = machine.describe(folder)
        figures |= files.sizes(programs, folder, arguments.data, scale)
        figures |= end_to_end.measure(programs, folder, scale)
        figures |= files.appends_and_reads(programs, folder, scale)
        figures |= sql.month(programs, folder, scale)
    print(json.dumps(figures))


if __name__ == "__main__":
    main()
