"""What a build from nothing costs: processor seconds by the operating system, and wall time.

usage: build.py SOURCE_FOLDER [--suite]     (--suite also runs the tests)

Builds the release preset in a folder of its own, without a compiler cache: first without tests, as
deploy/demo.sh does, then with them, as tests/run.sh does. The last line is one JSON object:
release_cpu_s, release_wall_s, tests_cpu_s and tests_wall_s (all of tests/run.sh's build: both
steps), rebuilt_objects (objects of the first step that the second one compiled again) and
suite_wall_s.
"""

import json
import os
import resource
import subprocess
import sys
import tempfile
import time
from pathlib import Path


class Clock:
    def __init__(self):
        self.wall, self.cpu = time.monotonic(), self.children()

    @staticmethod
    def children():
        used = resource.getrusage(resource.RUSAGE_CHILDREN)
        return used.ru_utime + used.ru_stime

    def spent(self):
        return round(self.children() - self.cpu, 1), round(time.monotonic() - self.wall, 1)


def objects(folder):
    return {path: path.stat().st_mtime_ns for path in folder.rglob("*.o")}


def build(source, folder, testing):
    environment = {**os.environ, "CCACHE_DISABLE": "1"}
    for command in (["cmake", "--preset", "release", "-B", folder, f"-DBUILD_TESTING={testing}"],
                    ["cmake", "--build", folder]):
        subprocess.run(command, cwd=source, env=environment, check=True,
                       stdout=subprocess.DEVNULL)


def main():
    source = Path(sys.argv[1]).resolve()
    figures = {}
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        folder.chmod(0o755)  # a test runs the programs as a user with fewer rights
        clock = Clock()
        build(source, folder, "OFF")
        figures["release_cpu_s"], figures["release_wall_s"] = clock.spent()
        before = objects(folder)
        build(source, folder, "ON")
        figures["tests_cpu_s"], figures["tests_wall_s"] = clock.spent()
        after = objects(folder)
        figures["rebuilt_objects"] = sum(after.get(path) != made for path, made in before.items())
        for key, value in figures.items():
            print(f"{key:16} {value}")
        if "--suite" in sys.argv:
            subprocess.run(["npm", "ci", "--prefix", source / "tests/e2e/browser", "--no-audit",
                            "--no-fund"], stdout=subprocess.DEVNULL, check=True)
            clock = Clock()
            suite = subprocess.run(["ctest", "--test-dir", folder, "-j", str(3 * os.cpu_count()),
                                    "--output-on-failure"], stdout=subprocess.PIPE, text=True,
                                   check=False)
            if suite.returncode != 0:
                sys.exit(f"{suite.stdout[-20000:]}\nthe suite failed: nothing is recorded")
            figures["suite_wall_s"] = clock.spent()[1]
            print(f"suite_wall_s     {figures['suite_wall_s']}")
    print(json.dumps(figures))


if __name__ == "__main__":
    main()
