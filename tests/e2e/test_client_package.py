"""A simulator outside of this repository: the installed package, its examples, a real service."""

import os
import random
import subprocess
import sys
import unittest
from pathlib import Path

from harness import DEADLINE_S, EndToEnd

EXAMPLES = Path(__file__).resolve().parents[2] / "service/client/examples"
BUILD = os.environ["REIDENT_BUILD"]
WARNINGS = ["-Wall", "-Wextra", "-pedantic", "-Werror"]


class ClientPackage(EndToEnd):
    def setUp(self):
        super().setUp()
        self.prefix = self.folder / "prefix"
        for component in ("reident_client", "reident_client_dev", "reident_python"):
            self.output("cmake", "--install", BUILD, "--prefix", self.prefix, "--component",
                        component)
        self.library = next(self.prefix.rglob("libreident-client.so.0"))
        self.module = self.prefix / "lib/python3/dist-packages"

    def output(self, *words, **environment):
        done = subprocess.run([*map(str, words)], capture_output=True, text=True, check=False,
                              timeout=DEADLINE_S, env={**os.environ, **environment})
        self.assertEqual(done.returncode, 0, done.stdout + done.stderr)
        return done.stdout

    def build_by_find_package(self):
        build = self.folder / "by_cmake"
        self.output("cmake", "-S", EXAMPLES, "-B", build, f"-DCMAKE_PREFIX_PATH={self.prefix}",
                    f"-DCMAKE_C_FLAGS={' '.join(WARNINGS)}",
                    f"-DCMAKE_CXX_FLAGS={' '.join(WARNINGS)}")
        self.output("cmake", "--build", build)
        return [[build / "simulator_c"], [build / "simulator_cpp"]]

    def build_by_pkg_config(self):
        folder = next(self.prefix.rglob("pkgconfig"))
        flags = self.output("pkg-config", "--cflags", "--libs", "reident-client",
                            PKG_CONFIG_PATH=str(folder)).split()
        programs = []
        for compiler, standard, source in (("gcc", "c11", "simulator.c"),
                                           ("g++", "c++17", "simulator.cpp")):
            programs.append([self.folder / f"by_{compiler}"])
            self.output(compiler, f"-std={standard}", *WARNINGS, EXAMPLES / source, "-o",
                        programs[-1][0], *flags)
        return programs

    def make_champion(self):
        """A version of CBERS-4's BDR from telemetry of a first-order plant."""
        generator = random.Random(1)
        x, rows = 0.0, ["unix_s,I_BDRIN1_a,I_BDRIN2_a,I_BDROUT_a"]
        for k in range(700):
            u = [generator.uniform(0.5, 2), generator.uniform(0, 1)]
            rows.append(f"{1_600_000_200 + k},{u[0]},{u[1]},{x + generator.gauss(0, 0.01)}")
            x = 0.8 * x + 0.15 * u[0] + 0.1 * u[1]
        (self.folder / "bdr.csv").write_text("\n".join(rows) + "\n")
        self.configure([{"name": "BDR", "inputs": ["I_BDRIN1", "I_BDRIN2"],
                         "outputs": ["I_BDROUT"], "sample_period": "1s", "window": "10min",
                         "slide": "5min", "max_mrse": 20.0}], spacecraft="CBERS-4")
        self.start_daemon()
        self.replay_all(self.folder / "bdr.csv", spacecraft="CBERS-4")
        self.wait_idle()
        self.assertIsNotNone(self.champion())

    def test_its_examples_build_and_run_the_champion(self):
        programs = self.build_by_find_package() + self.build_by_pkg_config()
        programs.append([sys.executable, EXAMPLES / "simulator.py"])
        self.make_champion()
        running = []
        self.addCleanup(lambda: [process.kill() for process in running])
        for number, program in enumerate(programs):
            environment = {**os.environ, "XDG_CACHE_HOME": str(self.folder / f"cache-{number}"),
                           "LD_LIBRARY_PATH": str(self.library.parent),
                           "PYTHONPATH": str(self.module)}
            running.append(subprocess.Popen(
                [*map(str, program), "3", str(self.domain), self.partition], env=environment,
                stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True))
        for program, process in zip(programs, running):
            said = process.communicate(timeout=DEADLINE_S)[0]
            self.assertEqual(process.returncode, 0, said)
            steps = [line for line in said.splitlines() if line.startswith("step ")]
            self.assertEqual(len(steps), 3, said)
            self.assertRegex(steps[-1], rf"^step 2: version {self.champion()}, I_BDROUT \d+\.\d+ A$")
            self.assertRegex(said, r"(?m)^BDR: .*version", f"no event: {program}")

    def test_is_not_found_by_who_asks_for_another_interface(self):
        (self.folder / "CMakeLists.txt").write_text(
            "cmake_minimum_required(VERSION 3.25)\nproject(asks LANGUAGES NONE)\n"
            "find_package(reident-client 99.0 REQUIRED)\n")
        done = subprocess.run(["cmake", "-S", self.folder, "-B", self.folder / "asks",
                               f"-DCMAKE_PREFIX_PATH={self.prefix}"], capture_output=True,
                              text=True, check=False)
        self.assertNotEqual(done.returncode, 0)
        self.assertIn('compatible with requested version "99.0"', done.stderr)


if __name__ == "__main__":
    unittest.main()
