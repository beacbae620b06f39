"""What a simulator builds with: the library's symbols and needs, and the page about it."""

import os
import re
import subprocess
import unittest
from pathlib import Path

REPOSITORY = Path(__file__).resolve().parents[3]
CLIENT = REPOSITORY / "service/client"
EXAMPLES = CLIENT / "examples"
LIBRARY = Path(os.environ["REIDENT_CLIENT_LIBRARY"])


def output(*words):
    done = subprocess.run([str(word) for word in words], capture_output=True, text=True, check=False)
    if done.returncode != 0:
        raise AssertionError(done.stdout + done.stderr)
    return done.stdout


class Library(unittest.TestCase):
    def test_exports_the_functions_of_the_header_and_nothing_else(self):
        header = (CLIENT / "include/reident/client.h").read_text()
        declared = re.findall(r"^REIDENT_API[^(]*?\b(reident_\w+)\(", header, re.MULTILINE)
        exported = [line.split()[-1] for line in
                    output("nm", "-D", "--defined-only", LIBRARY).splitlines()]
        self.assertEqual(sorted(exported), sorted(declared))

    def test_is_named_by_the_version_of_its_abi_and_needs_no_database_and_no_program(self):
        dynamic = output("readelf", "-d", LIBRARY)
        self.assertEqual(re.findall(r"SONAME.*\[(.*)\]", dynamic), ["libreident-client.so.0"])
        needed = {re.sub(r"\.so.*", "", name)
                  for name in re.findall(r"NEEDED.*\[(.*)\]", dynamic)}
        allowed = {"libddsc", "libspdlog", "libfmt", "libcrypto", "libstdc++", "libm", "libgcc_s",
                   "libc", "ld-linux-x86-64"}
        self.assertIn("libddsc", needed)
        self.assertLessEqual(needed, allowed)


class Page(unittest.TestCase):
    def test_shows_the_examples_as_they_are(self):
        page = (CLIENT / "README.md").read_text()
        for language, name in (("cpp", "simulator.cpp"), ("c", "simulator.c"),
                               ("python", "simulator.py")):
            example = (EXAMPLES / name).read_text()
            self.assertIn(f"```{language}\n{example}```\n", page, name)
            self.assertLess(len(example.splitlines()), 40, name)


if __name__ == "__main__":
    unittest.main()
