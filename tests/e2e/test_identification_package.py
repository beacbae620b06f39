"""A program outside of this repository: the installed library of identification and its examples."""

import os
import re
import subprocess
import unittest
from pathlib import Path

from harness import EndToEnd

SOURCES = Path(__file__).resolve().parents[2] / "identification"
BUILD = os.environ["REIDENT_BUILD"]
WARNINGS = "-Wall -Wextra -Wpedantic -Wconversion -Wshadow -Werror"
INCLUDE = re.compile(r'#include "(identification/[^"]+)"')


class IdentificationPackage(EndToEnd):
    def setUp(self):
        super().setUp()
        self.prefix = self.folder / "prefix"
        self.output("cmake", "--install", BUILD, "--prefix", self.prefix, "--component",
                    "reident_identification")

    def output(self, *words):
        done = subprocess.run([*map(str, words)], capture_output=True, text=True, check=False,
                              timeout=200)
        self.assertEqual(done.returncode, 0, done.stdout + done.stderr)
        return done.stdout

    def figures_of_examples(self, flags, *examples):
        """What each example prints, as one list of numbers for each line."""
        build = self.folder / "examples"
        self.output("cmake", "-S", SOURCES / "examples", "-B", build,
                    f"-DCMAKE_PREFIX_PATH={self.prefix}", f"-DCMAKE_CXX_FLAGS={flags}")
        self.output("cmake", "--build", build, "--target", *examples)
        printed = [self.output(build / example) for example in examples]
        return [[[float(number) for number in re.findall(r"-?\d+(?:\.\d+)?(?:e-?\d+)?", line)]
                 for line in text.splitlines()] for text in printed], printed

    def check_continuous_time(self, lines, text):
        error, _, low, high = lines[0]
        self.assertLess(low, error)
        self.assertGreater(high, error)
        self.assertIn("residuals white; nothing of the input is left in them", text)
        steps, errors = zip(*lines[2:9])
        self.assertEqual(steps, (1, 2, 5, 10, 20, 50, 100))
        self.assertEqual(sorted(errors), list(errors), "errors grow towards that of the free run")
        self.assertLess(errors[-1], error)
        fast, slow = sorted(line[0] for line in lines[9:11])
        self.assertAlmostEqual(fast, 20, delta=2)
        self.assertAlmostEqual(slow, 300, delta=30)
        _, found, true, _, difference = lines[11]
        self.assertAlmostEqual(found, true, delta=0.05)
        self.assertLess(difference, 1e-9)

    def test_its_examples_build_and_print_their_figures(self):
        (identified, windows, continuous), printed = self.figures_of_examples(
            WARNINGS, "identify_and_simulate", "sliding_windows", "continuous_time")
        self.assertRegex(printed[0], r"^order 2, horizon \d+, weighting (n4sid|moesp|cva)\n")
        self.assertAlmostEqual(*identified[1], delta=10)
        for _, measured, simulated in identified[2:5]:
            self.assertAlmostEqual(measured, simulated, delta=0.2)
        error, fit = identified[5]
        self.assertLess(error, 0.5)
        self.assertGreater(fit, 97)

        self.assertEqual([line[:2] for line in windows],
                         [[3600 + 1200 * k, 1200 if k else 3600] for k in range(10)])
        for _, _, gain, true in windows:
            self.assertAlmostEqual(gain, true, delta=0.05)
        self.assertEqual(printed[1].count("the bits of all samples"), 10)
        self.check_continuous_time(continuous, printed[2])

    def test_serves_a_program_that_is_compiled_for_the_machine_at_hand(self):
        (lines,), (text,) = self.figures_of_examples("-O2 -march=native", "continuous_time")
        self.check_continuous_time(lines, text)

    def test_has_every_header_but_those_that_say_that_they_are_private(self):
        public = {f"identification/{header.relative_to(SOURCES)}": header.read_text()
                  for header in SOURCES.rglob("*.hpp")}
        public = {name: text for name, text in public.items() if "Private to" not in text}
        include = self.prefix / "include/reident"
        self.assertEqual({str(header.relative_to(include)) for header in include.rglob("*.hpp")},
                         set(public))
        for name, text in public.items():
            self.assertLessEqual(set(INCLUDE.findall(text)), set(public), name)

    def test_is_not_found_by_who_asks_for_another_interface(self):
        (self.folder / "CMakeLists.txt").write_text(
            "cmake_minimum_required(VERSION 3.25)\nproject(asks LANGUAGES NONE)\n"
            "find_package(reident-identification 99.0 REQUIRED)\n")
        done = subprocess.run(["cmake", "-S", self.folder, "-B", self.folder / "asks",
                               f"-DCMAKE_PREFIX_PATH={self.prefix}"], capture_output=True,
                              text=True, check=False)
        self.assertNotEqual(done.returncode, 0)
        self.assertIn('compatible with requested version "99.0"', done.stderr)


if __name__ == "__main__":
    unittest.main()
