"""A console that has no file sees over DDS what the file says."""

import os
import signal
import subprocess
import sys
import tempfile
import time
import unittest
from pathlib import Path

import plant
from harness import BIN, DEADLINE_S, EndToEnd, wait_until


class Remote(EndToEnd):
    def setUp(self):
        super().setUp()
        self.console = tempfile.TemporaryDirectory(prefix="reident-console-")
        self.addCleanup(self.console.cleanup)

    def run_in(self, folder, *arguments):
        """Exit status, output and error output of a command that is run in a folder."""
        environment = {key: value for key, value in os.environ.items() if key != "CYCLONEDDS_URI"}
        done = subprocess.run([str(BIN / "reident"), *map(str, arguments)], cwd=folder,
                              capture_output=True, timeout=DEADLINE_S, check=False, env=environment)
        return done.returncode, done.stdout, done.stderr

    def remote(self, *arguments):
        return self.run_in(self.console.name, *arguments, "--remote", *self.endpoint())

    def assert_same(self, *arguments, archive=False):
        """The same on the file and from the console, and something at all."""
        local = self.run_in(self.folder, *([arguments[0], "reident.db", *arguments[1:]]
                                           if archive else arguments))
        self.assertEqual(self.remote(*arguments), local, arguments)
        self.assertTrue(local[1] or local[2], arguments)
        return local

    def fly(self):
        self.configure([plant.equipment()])
        daemon = self.start_daemon()
        self.replay_rows("first", count=1300)
        self.replay_rows("second", count=1300, first=1300, gain=2.0)
        self.assertGreater(self.query("SELECT count(*) FROM version")[0][0], 1)
        return daemon

    def test_every_command_that_reads_prints_the_same_without_the_file(self):
        self.fly()
        status, text = self.reident("hold", "PLANT", "--actor", "Zoë", "--reason", "a \"word\"",
                                    *self.endpoint())
        self.assertEqual(status, 0, text)
        begin, = self.query("SELECT min(window_begin) FROM attempt")[0]
        versions = self.query("SELECT version FROM model_version ORDER BY version")
        first, last = versions[0][0], versions[-1][0]
        at = begin // 10**9 + 1600
        for as_json in ([], ["--json"]):
            self.assert_same("history", *as_json)
            self.assert_same("history", "--last", 2, "--equipment", "SAT/PLANT", *as_json)
            self.assert_same("history", "--versions-only", *as_json)
            self.assert_same("history", "--equipment", "NONE", *as_json)
            for subject in ("PLANT", f"SAT/PLANT@{first}", "PLANT@99", "NONE"):
                self.assert_same("show", subject, *as_json)
                self.assert_same("why", subject, *as_json)
            for time in (0, at, 4_000_000_000):
                self.assert_same("at", time, *as_json)
            self.assert_same("at", at, "SAT/PLANT", *as_json)
            self.assert_same("compare", "PLANT", first, last, *as_json)
            self.assert_same("score", "PLANT", *as_json)
            for options in ([], ["--by", "hour", "--parameters"]):
                self.assert_same("completeness", *options, *as_json, archive=True)
        status, picture, _ = self.assert_same("plot", "PLANT", "-o", "-")
        self.assertEqual((status, picture[-7:]), (0, b"</svg>\n"))
        self.assert_same("export-model", "PLANT", "--json", "-")
        self.assert_same("export", archive=True)
        self.assert_same("export", "--wide", "--parameter", "out", "drive", archive=True)
        self.assert_same("export", "--parameter", "none", archive=True)

    def test_remote_stands_before_the_command_or_behind_it_and_needs_no_options_with_a_config(self):
        self.fly()
        config = self.folder / "reident.toml"
        local = self.run_in(self.folder, "history")
        self.database.rename(self.folder / "elsewhere.db")
        self.assertEqual(self.run_in(self.folder, "--remote", "history"), local)
        self.assertEqual(self.run_in(self.console.name, "history", "--config", config, "--remote"),
                         local)

    def test_what_cannot_be_asked_over_dds_is_refused_with_the_reason(self):
        for command, why in (("verify", "works on the database file itself"),
                             ("backup", "works on the database file itself"),
                             ("check-config", "none of the commands that read")):
            for words in (["--remote", command, "x"], [command, "x", "--remote"]):
                status, _, error = self.run_in(self.console.name, *words)
                self.assertEqual(status, 2, error)
                self.assertIn(why, error.decode())
                self.assertEqual(error.count(b"\n"), 1, error)
        status, _, error = self.run_in(self.console.name, "--remote", "history")
        self.assertIn(b"name the service's configuration with --config FILE", error)
        status, _, error = self.remote("history", "--database", "some.db")
        self.assertIn(b"leave out some.db, or --remote", error)
        status, _, error = self.run_in(self.console.name, "history", *self.endpoint())
        self.assertIn(b"add --remote", error)
        status, _, error = self.remote("history", "--timeout", "0.2")
        self.assertEqual(status, 4)
        self.assertIn(b"check that reidentd runs", error)

    def fly_long(self):
        """A service with some dozens of pages of telemetry."""
        self.configure([plant.equipment()])
        daemon = self.start_daemon()
        self.replay_all(plant.write(self.folder / "long.csv", plant.rows(60_000)),
                        spacecraft="OTHER")
        wait_until(lambda: self.stored() == 180_000, "all is archived")
        return daemon

    def test_a_service_that_is_killed_between_two_pages_is_missed_in_time(self):
        daemon = self.fly_long()
        export = subprocess.Popen(
            [str(BIN / "reident"), "--remote", "export", "--timeout", "2",
             *map(str, self.endpoint())], cwd=self.console.name, stdout=subprocess.PIPE,
            stderr=subprocess.PIPE)
        try:
            begun = export.stdout.read(1000)  # the rest waits for room in the pipe
            daemon.kill()
            rest, error = export.communicate(timeout=DEADLINE_S)
        finally:
            export.kill()
        self.assertEqual(export.returncode, 4, error)
        self.assertIn(b"within 2 s", error)
        rows = (begun + rest).count(b"\n")
        self.assertGreater(rows, 1)
        self.assertLess(rows, 180_000)

    @unittest.skipIf(os.environ.get("REIDENT_SANITIZERS"), "a sanitizer keeps what is freed")
    def test_questions_cost_the_service_no_memory_that_stays(self):
        daemon = self.fly()

        def ask(subject, questions, consoles):
            asker = self.start("ask_history", *map(str, self.endpoint()[1::2]), subject, questions,
                               consoles)
            self.assertEqual(asker.wait(), 0, asker.text())
            self.assertGreaterEqual(int(asker.out.read_text()), questions)

        def resident_kib():
            status = Path(f"/proc/{daemon.process.pid}/status").read_text()
            return int(status.split("VmRSS:")[1].split()[0])

        ask("attempts", 200, 20)
        before = resident_kib()
        ask("attempts", 1000, 20)
        grown = resident_kib() - before
        print(f"{grown} KiB after 1000 questions")
        self.assertLess(grown, 2048)

    def test_a_console_that_hangs_holds_no_other_up(self):
        self.fly_long()
        hung = subprocess.Popen(
            [str(BIN / "reident"), "--remote", "export", *map(str, self.endpoint())],
            cwd=self.console.name, stdout=subprocess.PIPE, stderr=subprocess.DEVNULL)
        try:
            hung.stdout.read(1000)
            hung.send_signal(signal.SIGSTOP)
            begin = time.monotonic()
            status, out, error = self.remote("export", "--parameter", "out")
            print(f"{time.monotonic() - begin:.1f} s beside a console that hangs")
            self.assertEqual((status, out.count(b"\n")), (0, 60_001), error)
        finally:
            hung.kill()
            hung.communicate()


if __name__ == "__main__":
    sys.exit(unittest.main())
