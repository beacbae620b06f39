"""What an installation brings in addition to the programs: units, users, a configuration."""

import os
import re
import shutil
import subprocess
import unittest

from harness import DEADLINE_S, EndToEnd

BUILD = os.environ["REIDENT_BUILD"]
UNITS = ["reidentd.service", "reidentd@.service", "reident-web.service"]
MOST_EXPOSURE = 1.5


class Deploy(EndToEnd):
    def setUp(self):
        super().setUp()
        self.prefix = self.folder / "opt"
        for component in "reident", "reident_web":
            self.output("cmake", "--install", BUILD, "--prefix", self.prefix, "--component",
                        component)
        self.units = self.prefix / "lib/systemd/system"

    def output(self, *words):
        done = subprocess.run([*map(str, words)], capture_output=True, text=True, check=False,
                              timeout=DEADLINE_S)
        self.assertEqual(done.returncode, 0, done.stdout + done.stderr)
        return done.stdout

    def test_the_installed_units_name_the_installed_programs(self):
        for unit in UNITS:
            text = (self.units / unit).read_text()
            programs = re.findall(r"(?m)^Exec(?:Start|StartPre)=(\S+)", text)
            self.assertTrue(programs)
            for program in programs:
                self.assertTrue(program.startswith(f"{self.prefix}/bin/"), program)
                self.output(program, "--version")

    @unittest.skipUnless(shutil.which("systemd-analyze"), "systemd-analyze is not there")
    def test_the_units_leave_little_exposed(self):
        for unit in UNITS:
            text = self.output("systemd-analyze", "security", "--offline=yes", "--no-pager",
                               self.units / unit)
            exposure = float(re.search(r"exposure level for \S+: ([\d.]+)", text)[1])
            self.assertLessEqual(exposure, MOST_EXPOSURE, unit)


if __name__ == "__main__":
    unittest.main()
