"""The archive in SQL, as the README says: its examples run as they stand there, in the sqlite3 shell
and in Python, while the service writes."""

import os
import re
import shutil
import subprocess
import sys
import unittest
from pathlib import Path

import plant
from harness import DEADLINE_S, EndToEnd

README = Path(__file__).parents[2] / "README.md"
SHELL = shutil.which("sqlite3")
# Pythons from elsewhere are often built without loadable extensions.
PYTHON = os.environ["REIDENT_SYSTEM_PYTHON"]
EXTENSION = os.environ["REIDENT_TELEMETRY_EXTENSION"]


def example(language):
    section = README.read_text().split("## Ask in SQL")[1].split("\n## ")[0]
    return re.search(f"```{language}\n(.*?)```", section, re.S)[1]


class Sql(EndToEnd):
    def here(self, text):
        """An example with the files of this test in the place of the demo's."""
        moved = text.replace("build/demo/reident.db", str(self.database)).replace(
            "build/release/storage/sql/reident_telemetry", EXTENSION)
        self.assertIn(EXTENSION, moved)
        return moved

    def run_program(self, *command, text=None):
        done = subprocess.run(command, input=text, capture_output=True, text=True,
                              timeout=DEADLINE_S, check=False)
        self.assertEqual((done.returncode, done.stderr), (0, ""))
        return done.stdout.splitlines()

    def fly(self):
        """Three hours of the reference spacecraft; the service goes on running."""
        self.configure([plant.equipment()], spacecraft="CBERS-4")
        self.start_daemon()
        flight = self.start("satcs-reference", "--spacecraft", "CBERS-4", "--duration", "3h",
                            "--speed", "max", "--wait-readers", 1, *self.endpoint())
        self.assertEqual(flight.wait(), 0, flight.text())
        self.wait_idle()

    def test_the_examples_of_the_readme_run_in_the_shell(self):
        self.fly()
        load, *questions = self.here(example("sql")).split("\n\n")
        answers = [self.run_program(SHELL, "-readonly", str(self.database),
                                    text=f"{load}\n{question}\n") for question in questions]
        last, days, champions = answers
        self.assertEqual(len(last), 10)
        self.assertTrue(last[0].startswith("2017-07-01T02:59:59.000000000Z|"), last[0])
        self.assertEqual(last, sorted(last, reverse=True))
        self.assertEqual([line.split("|")[:2] for line in days],
                         [["2017-07-01T00:00:00.000000000Z", "10800"]])
        self.assertEqual(champions, [], "nothing of this spacecraft was identified")

    def test_the_example_of_the_readme_runs_in_python(self):
        self.fly()
        lines = self.run_program(PYTHON, "-c", self.here(example("python")))
        self.assertEqual(len(lines), 3600)
        self.assertEqual(lines, sorted(lines))

    def test_an_aggregate_of_rows_and_the_summary_agree(self):
        self.fly()
        load = f".load {EXTENSION}\n"
        rows = self.run_program(
            SHELL, str(self.database), text=load +
            "SELECT parameter, count(*), min(value), max(value), round(avg(value), 6) FROM telemetry "
            "GROUP BY parameter ORDER BY parameter;\n")
        summary = self.run_program(
            SHELL, str(self.database), text=load +
            "SELECT parameter, samples, least, greatest, round(mean, 6) FROM telemetry_summary "
            "ORDER BY parameter;\n")
        self.assertGreater(len(rows), 20)
        self.assertEqual(rows, summary)


if __name__ == "__main__":
    sys.exit(unittest.main())
