"""reident's identification compared with SLICOT's and Octave's, in one run, each on one thread.

Prints tables as Markdown and, as the last line, one JSON object of the figures. Without SLICOT or
Octave it says what it leaves out; the figures that need it are null.
"""

import argparse
import json
import sys
import tempfile
from pathlib import Path

sys.path.insert(0, str(Path(__file__).parent / "identification"))

import accuracy  # noqa: E402: found in the folder above
import speed  # noqa: E402
from tools import Tools  # noqa: E402


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("build", type=Path, help="folder that the programs were built in")
    parser.add_argument("data", type=Path, nargs="?",
                        help="folder of DaISy data sets daisy_NAME.csv, columns u1.. y1..")
    parser.add_argument("--quick", action="store_true",
                        help="few rows, to test the comparison itself: the figures say nothing")
    arguments = parser.parse_args()
    tools = Tools(arguments.build.resolve())
    for sentence in tools.left_out():
        print(sentence, flush=True)
    with tempfile.TemporaryDirectory(prefix="reident-identification-") as name:
        folder = Path(name)
        sizes = speed.QUICK_SIZES if arguments.quick else speed.SIZES
        figures = speed.compare(tools, folder, sizes)
        if arguments.data:
            figures["accuracy"] = accuracy.compare(tools, arguments.data, folder)
            figures["published"] = accuracy.check_published(tools, arguments.data, folder)
    print(json.dumps(figures))


if __name__ == "__main__":
    main()
