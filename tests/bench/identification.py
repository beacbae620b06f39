"""reident's identification beside SLICOT's and Octave's, in one run, each on one core.

    identification.py BUILD [DATA_FOLDER]

Prints tables as Markdown and, as the last line, one JSON object of the figures. Without SLICOT or
Octave it says what it leaves out; the figures that need it are null. DATA_FOLDER holds DaISy data
sets as daisy_NAME.csv with the columns u1.. y1..
"""

import json
import sys
import tempfile
from pathlib import Path

sys.path.insert(0, str(Path(__file__).parent / "identification"))

import accuracy  # noqa: E402: found in the folder above
import speed  # noqa: E402
from tools import Tools  # noqa: E402


def main():
    tools = Tools(Path(sys.argv[1]).resolve())
    for sentence in tools.left_out():
        print(sentence, flush=True)
    with tempfile.TemporaryDirectory(prefix="reident-identification-") as name:
        folder = Path(name)
        figures = speed.compare(tools, folder)
        if len(sys.argv) > 2:
            data = Path(sys.argv[2]).resolve()
            figures["accuracy"] = accuracy.compare(tools, data, folder)
            figures["published"] = accuracy.check_published(tools, data, folder)
    print(json.dumps(figures))


if __name__ == "__main__":
    main()
