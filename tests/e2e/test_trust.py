"""A scenario of the trust suite over DDS, scored by the suite against the truth."""

import json
import os
import sys
import unittest
from pathlib import Path

from harness import EndToEnd

sys.path.insert(0, str(Path(__file__).resolve().parent.parent / "trust"))
import over_dds  # noqa: E402: found in that folder


class Trust(EndToEnd):
    def test_over_dds_no_simulator_gets_a_worse_model_and_a_change_is_followed(self):
        build = Path(os.environ["REIDENT_BUILD"])
        said = over_dds.score(build, ["--scenario", "0"], self.folder)
        figures = json.loads(said.splitlines()[-1])["power"]
        self.assertEqual(figures["scenarios"], 1)
        self.assertEqual(figures["wrong"], 0, said)
        self.assertGreaterEqual(figures["versions"], 2, said)
        self.assertEqual((figures["changes"], figures["recovered_fraction"]), (1, 1.0), said)


if __name__ == "__main__":
    unittest.main()
