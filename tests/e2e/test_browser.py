"""The operators' page in Debian's Chromium: tests/e2e/browser has what it looks at."""

import json
import os
import subprocess
import sys
import unittest
from pathlib import Path

import plant
import test_web
from harness import BIN, DEADLINE_S

BROWSER = Path(__file__).parent / "browser"
PAGE = Path(__file__).parents[2] / "service" / "web" / "page"


class Browser(test_web.WebCase):
    def look(self, **environment):
        done = subprocess.run(
            ["node", str(BROWSER / "page.mjs"), f"http://127.0.0.1:{self.port}/", "SAT/PLANT",
             *([os.environ["REIDENT_PICTURES"]] if "REIDENT_PICTURES" in os.environ else [])],
            capture_output=True, text=True, timeout=9 * DEADLINE_S, check=False,
            env={**os.environ, **environment})
        self.assertEqual(done.returncode, 0, done.stderr[-3000:])
        return json.loads(done.stdout.splitlines()[-1])

    def test_every_view_in_every_theme_keyboard_zones_and_ten_tabs(self):
        self.with_accounts()
        report = self.look(REIDENT_ACCOUNT="Ana:Ana's secret")
        self.assertEqual([report[key] for key in ("axe", "errors", "foreign", "failures")],
                         [[], [], [], []])
        self.assertGreaterEqual(report["views"], 40)
        self.assertLessEqual(report["requests"], 8)
        self.assertEqual(self.query("SELECT kind, actor, reason FROM decision WHERE actor != 'gate'"),
                         [("approve", "Ana", "seen on two passes")])

    def test_open_mct_has_the_telemetry_versions_and_decisions_as_they_come(self):
        self.flown(approval="by_hand")
        self.start_web()
        version = self.query("SELECT min(version) FROM model_version WHERE status = 'waiting'")[0][0]
        with subprocess.Popen(
                ["node", str(BROWSER / "openmct.mjs"), f"http://127.0.0.1:{self.port}/", "SAT",
                 "PLANT", "out", str(PAGE.parent / "openmct-reident.js")],
                stdout=subprocess.PIPE, text=True) as look:
            self.addCleanup(look.kill)
            self.assertEqual(look.stdout.readline(), "listening\n")
            csv = plant.write(self.folder / "more.csv", plant.rows(first=1900, count=20))
            self.replay_all(csv, "--wait-readers", 1)
            status, text = self.reident("approve", "PLANT", version, "--reason", "seen in Open MCT",
                                        "--actor", "Ana", *self.endpoint())
            self.assertEqual(status, 0, text)
            report = json.loads(look.stdout.readline())
        self.assertEqual((report["failures"], report["errors"]), ([], []))

    def test_the_bundle_is_that_of_its_sources(self):
        subprocess.run(["npm", "ci", "--no-audit", "--no-fund"], cwd=PAGE, check=True,
                       capture_output=True, timeout=4 * DEADLINE_S)
        before = {file.name: file.read_bytes() for file in (PAGE / "dist").iterdir()}
        subprocess.run(["npm", "run", "check"], cwd=PAGE, check=True, timeout=2 * DEADLINE_S)
        target = self.folder / "dist"
        subprocess.run(["node", "bundle.mjs", str(target)], cwd=PAGE, check=True,
                       timeout=2 * DEADLINE_S)
        made = {file.name: file.read_bytes() for file in target.iterdir()}
        # Names alone: a difference of the bytes themselves takes minutes to print.
        self.assertEqual([name for name in made | before if made.get(name) != before.get(name)], [])


if __name__ == "__main__":
    sys.exit(unittest.main())
