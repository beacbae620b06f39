"""Simulators with good and bad services, and without any: they keep the last good version, say why
and go on, and `reident simulators` shows it."""

import fcntl
import json
import os
import pty
import struct
import subprocess
import termios
import unittest

import plant
from harness import BIN, DEADLINE_S, EndToEnd, wait_until

PARAMETERS = {"drive": ("V", 0, 2), "load": ("A", -1, 1), "out": ("V", 0, 20)}


def model(gain=1.0, equipment="PLANT", **changes):
    """The plant itself, as service/model/model_json.hpp has it."""

    def signals(names):
        return [{"name": name, "unit": PARAMETERS[name][0], "low": PARAMETERS[name][1],
                 "high": PARAMETERS[name][2]} for name in names]

    return {"spacecraft": "SAT", "equipment": equipment, "inputs": signals(plant.INPUTS),
            "outputs": signals(plant.OUTPUTS), "order": 2, "sample_period_s": 1.0,
            "hold_ns": 3_000_000_000, "A": [[0.8, 0.1], [-0.1, 0.7]], "B": [[0.3, 0], [0, 0.2]],
            "C": [[gain, 0.5 * gain]], "D": [[0, 0]], "K": [], "input_offset": [0, 0],
            "output_offset": [5], "identified_from": {"begin_ns": 0, "end_ns": 1},
            "validated_on": {"begin_ns": 1, "end_ns": 2},
            "validation": {"mrse_percent": [1.0], "fit_percent": [90.0], "rows": 1},
            "method": "the plant", **changes}


class Service:
    """Publishes the versions that a test gives it, good and bad."""

    def __init__(self, test, name):
        pipe = test.folder / f"{name}.pipe"
        os.mkfifo(pipe)
        self.process = test.start("publish_versions", pipe, test.domain, test.partition, name=name)
        self.orders = open(pipe, "w", encoding="utf-8")
        test.addCleanup(self.orders.close)
        self.published = 0

    def publish(self, number, **order):
        self.orders.write(json.dumps({"number": number, "model": model(), **order}) + "\n")
        self.orders.flush()
        self.published += 1
        wait_until(lambda: len(self.process.out.read_text().splitlines()) >= self.published,
                   f"version {number} is published")


class Simulators(EndToEnd):
    def service(self, name="service"):
        return Service(self, name)

    def start_telemetry(self, name="live", **keywords):
        """Much faster than life, and longer than any test; no archive is waited for."""
        csv = plant.write(self.folder / f"{name}.csv", plant.rows(40_000, **keywords))
        return self.replay(csv, "--speed", "60", "--wait-readers", 0)

    def start_running(self, name="trainer", cache=None):
        return self.start_simulator(name, "--report", "0.2", cache=cache)

    def events(self, simulator, kind):
        lines = simulator.out.read_text().split("\n")[:-1]
        return [event for event in map(json.loads, lines) if event["event"] == kind]

    def wait_for(self, simulator, kind, count):
        return wait_until(lambda: self.events(simulator, kind)[count - 1:count],
                          f"event {count} {kind}")[0]

    def assert_goes_on(self, simulator, version):
        """It makes steps with the version from now on."""
        before = len(self.events(simulator, "running"))

        def went_on():
            steps = [event["ticks"] for event in self.events(simulator, "running")[before:]
                     if event["version"] == version]
            return steps and steps[-1] > steps[0]

        wait_until(went_on, f"the simulator goes on with version {version}")

    def simulators(self, *options, expect=0):
        """The list, once the command ends as expected."""

        def listed():
            status, text = self.reident("simulators", "--json", *self.endpoint(), *options)
            return status == expect and text

        return json.loads(wait_until(listed, f"reident simulators {options} exits {expect}"))

    def wait_for_row(self, what, **fields):
        """The only simulator, once it is listed so."""

        def row():
            rows = self.simulators()["simulators"]
            return [one for one in rows if fields.items() <= one.items()]

        return wait_until(row, what)[0]

    # -- bad versions

    def test_a_bad_version_is_refused_with_the_reason_and_the_good_one_goes_on(self):
        self.start_telemetry()
        service = self.service()
        service.publish(2)
        simulator = self.start_running()
        self.wait_for(simulator, "adopted", 1)
        self.assert_goes_on(simulator, 2)
        unstable = model(A=[[1.2, 0], [0, 0.7]])
        bad = [({"spoil": "digest"}, "digest"), ({"spoil": "truncated"}, "2 x 2 are due"),
               ({"spoil": "order"}, "3 x 3 are due"), ({"spoil": "format"}, "format 4"),
               ({"spoil": "nan"}, "not finite"), ({"spoil": "number"}, "number"),
               ({"model": unstable}, "spectral radius")]
        for count, (order, reason) in enumerate(bad, 1):
            with self.subTest(order=order):
                service.publish(2 + count, **order)
                refused = self.wait_for(simulator, "refused", count)
                self.assertIn(reason, refused["reason"])
        service.publish(1)
        self.assertIn("older than version 2",
                      self.wait_for(simulator, "refused", len(bad) + 1)["reason"])
        self.assert_goes_on(simulator, 2)
        row = self.wait_for_row("the running version stands beside the refused one", version=2)
        self.assertEqual(row["refused"]["version"], 1)
        self.assertIn("older than version 2", row["refused"]["reason"])
        service.publish(20)
        self.wait_for(simulator, "adopted", 2)
        self.assert_goes_on(simulator, 20)
        self.wait_for_row("a good version ends the refusal", version=20, state="current",
                          refused=None)
        self.assertEqual(self.runs(simulator), [2, 20])

    def test_of_two_services_the_first_content_of_a_number_and_the_newest_number_run(self):
        self.start_telemetry()
        one, other = self.service("one"), self.service("other")
        one.publish(1)
        simulator = self.start_running()
        self.wait_for(simulator, "adopted", 1)
        other.publish(1, model=model(gain=2.0))
        self.assertIn("two services", self.wait_for(simulator, "refused", 1)["reason"])
        self.assert_goes_on(simulator, 1)
        wait_until(lambda: self.simulators()["services"] == 2, "both services are seen")
        row = self.wait_for_row("the refusal is listed", version=1)
        self.assertIn("two services", row["refused"]["reason"])
        other.publish(3, model=model(gain=2.0))
        self.wait_for(simulator, "adopted", 2)  # two writers have no order of their own
        one.publish(2)
        self.assertIn("older than version 3", self.wait_for(simulator, "refused", 2)["reason"])
        self.assert_goes_on(simulator, 3)
        self.assertEqual(self.runs(simulator), [1, 3])

    # -- failures around it

    def test_a_service_that_is_killed_and_restarted_in_mid_swap_disturbs_no_run(self):
        self.start_telemetry()
        service = self.service("first")
        service.publish(1)
        simulator = self.start_running()
        self.assert_goes_on(simulator, 1)
        service.publish(2, model=model(gain=1.5))
        self.wait_for(simulator, "adopted", 2)
        service.process.kill()
        again = self.service("again")
        again.publish(2, model=model(gain=1.5))
        self.assert_goes_on(simulator, 2)
        again.publish(3)
        self.wait_for(simulator, "adopted", 3)
        self.assert_goes_on(simulator, 3)
        self.assertEqual(self.runs(simulator), [1, 2, 3])
        self.assertEqual(self.events(simulator, "refused"), [])

    def test_a_clock_that_goes_back_stops_no_run(self):
        late = self.start_telemetry("late", first=100_000)
        service = self.service()
        service.publish(1, decided_ns=4_000_000_000_000_000_000)  # of the year 2096
        simulator = self.start_running()
        self.assertEqual(self.wait_for(simulator, "adopted", 1)["age"], "0s")
        self.assert_goes_on(simulator, 1)
        service.publish(2, decided_ns=1)
        self.wait_for(simulator, "adopted", 2)
        self.assert_goes_on(simulator, 2)
        late.kill()
        self.start_telemetry("early")
        wait_until(lambda: self.events(simulator, "running")[-1]["clock_jumps"] > 0,
                   "the jump is told")
        self.assert_goes_on(simulator, 2)
        self.wait_for_row("it runs the champion", version=2, state="current")

    # -- the folder of last good versions

    def test_without_a_service_the_kept_version_runs_and_its_age_is_said(self):
        self.start_telemetry()
        service = self.service("first")
        service.publish(4)
        simulator = self.start_running()
        self.wait_for(simulator, "adopted", 1)
        wait_until(lambda: list((self.folder / "cache-trainer").rglob("*.json")), "it is kept")
        self.assertEqual(simulator.terminate()[0], 0)
        service.process.kill()

        again = self.start("reident-simulator", "--spacecraft", "S*", "--equipment", "P?ANT",
                           "--name", "again", "--json", "--report", "0.2", "--cache",
                           self.folder / "cache-trainer", *self.endpoint())
        adopted = self.wait_for(again, "adopted", 1)
        self.assertTrue(adopted["from_cache"])
        self.assertRegex(adopted["age"], r"^\d+(s|min|h|d)$")
        self.assert_goes_on(again, 4)
        row = self.wait_for_row("it runs from the file", simulator="again", state="from_file")
        self.assertIsNone(row["champion"])
        status, text = self.reident("simulators", *self.endpoint())
        self.assertEqual(status, 0, text)
        self.assertIn("from file, approved 2020-09-13T12:26:40Z", text)
        self.assertIn("which version is champion is not known", text)
        self.simulators("--old", expect=4)

        self.service("second").publish(4)
        self.wait_for(again, "confirmed", 1)
        self.wait_for_row("the service has confirmed it", state="current", from_file=False)
        self.assertEqual(self.runs(again), [4])

    def small_disk(self):
        disk = self.folder / "disk"
        disk.mkdir()
        if subprocess.run(["mount", "-t", "tmpfs", "-o", "size=64k", "tmpfs", disk],
                          capture_output=True, check=False).returncode != 0:
            self.skipTest("a small disk needs the right to mount one")
        self.addCleanup(subprocess.run, ["umount", disk], check=True)
        return disk

    def test_a_full_folder_is_told_once_and_every_version_runs(self):
        disk = self.small_disk()
        ballast = disk / "ballast"
        with self.assertRaises(OSError), open(ballast, "wb") as file:
            file.write(b"\0" * 128 * 1024)
        self.start_telemetry()
        service = self.service()
        simulator = self.start_running("trainer", disk / "cache")
        for number in (1, 2, 3):
            service.publish(number)
            self.wait_for(simulator, "adopted", number)
        self.assertRegex(self.wait_for(simulator, "cache", 1)["reason"], "No space|no room")
        self.assert_goes_on(simulator, 3)
        self.assertEqual(len(self.events(simulator, "cache")), 1)
        ballast.unlink()
        service.publish(4)
        wait_until(lambda: list(disk.rglob("*.json")), "it is kept once there is room")
        self.assertEqual(list(disk.rglob("*.part")), [])

    def test_a_read_only_folder_is_told_once_and_what_it_has_is_used(self):
        disk = self.small_disk()
        self.start_telemetry()
        service = self.service()
        service.publish(1)
        first = self.start_running("trainer", disk / "cache")
        self.wait_for(first, "adopted", 1)
        wait_until(lambda: list(disk.rglob("*.json")), "it is kept")
        self.assertEqual(first.terminate()[0], 0)
        subprocess.run(["mount", "-o", "remount,ro", disk], check=True)
        second = self.start_running("second", disk / "cache")
        self.assertTrue(self.wait_for(second, "adopted", 1)["from_cache"])
        for number in (2, 3):
            service.publish(number)
            self.wait_for(second, "adopted", number)
        self.assert_goes_on(second, 3)
        (fault,) = self.events(second, "cache")
        self.assertIn("Read-only file system", fault["reason"])

    # -- the list

    def test_simulators_that_end_or_die_leave_the_list(self):
        self.service().publish(1)
        ends, dies = self.start_running("ends"), self.start_running("dies")
        wait_until(lambda: len(self.simulators()["simulators"]) == 2, "both are listed")
        self.assertEqual(ends.terminate()[0], 0)
        dies.kill()
        wait_until(lambda: not self.simulators()["simulators"], "none is listed")
        status, text = self.reident("simulators", *self.endpoint())
        self.assertEqual(status, 0, text)
        self.assertIn(f"no simulator is there on domain {self.domain}", text)

    def test_the_list_says_who_runs_something_old_also_on_a_narrow_terminal(self):
        service = self.service()
        service.publish(1)
        self.start_running("aside")
        stopped = self.start_running("behind")
        wait_until(lambda: len(self.simulators()["simulators"]) == 2, "both run version 1")
        self.simulators("--old")
        service.publish(3, spoil="digest")
        wait_until(lambda: all(row["old"] and row["refused"]
                               for row in self.simulators()["simulators"]), "both are behind")
        wait_until(lambda: [row["simulator"] for row in
                            self.simulators("PLANT", "--old", expect=1)["simulators"]] ==
                   ["aside", "behind"], "both are listed, in order")
        self.assertEqual(self.simulators("SAT/OTHER", "--old")["simulators"], [])
        text = self.on_terminal(80, "simulators", *self.endpoint())
        self.assertIn("old by 2 versions: 3 is out", " ".join(text.split()))
        self.assertTrue(all(len(line) <= 80 for line in text.splitlines()), text)
        wide = self.on_terminal(400, "simulators", *self.endpoint()).splitlines()
        self.assertEqual(wide[0].split()[:3], ["simulator", "host", "equipment"])
        self.assertEqual([line.split()[0] for line in wide[1:3]], ["aside", "behind"])
        self.assertEqual(stopped.terminate()[0], 0)

    def test_what_was_withdrawn_is_shown_as_no_longer_published(self):
        config = self.configure([plant.equipment()])
        self.start_daemon()
        self.replay_rows("first", count=1900)
        champion = self.champion()
        simulator = self.start_running()
        self.wait_for(simulator, "adopted", 1)
        self.wait_for_row("it runs the champion", version=champion, state="current")
        status, text = self.reident("withdraw", "SAT/PLANT", champion, "--reason", "wrong sensor",
                                    "--config", config)
        self.assertEqual(status, 0, text)
        for version in reversed(range(1, champion)):  # a withdrawal brings the one before back
            self.reident("withdraw", "SAT/PLANT", version, "--reason", "all", "--config", config)
        self.assertIsNone(self.champion())
        self.wait_for_row("nothing is published", champion=None, state="unpublished", old=True)
        status, text = self.reident("simulators", "--config", config)
        self.assertEqual(status, 0, text)
        self.assertIn("no champion: what runs is no longer published", text)

    def on_terminal(self, columns, *arguments):
        master, slave = pty.openpty()
        fcntl.ioctl(slave, termios.TIOCSWINSZ, struct.pack("HHHH", 50, columns, 0, 0))
        process = subprocess.Popen([str(BIN / "reident"), *map(str, arguments)], stdout=slave,
                                   stdin=subprocess.DEVNULL)
        os.close(slave)
        text = b""
        while True:
            try:
                part = os.read(master, 65536)
            except OSError:  # the terminal's other end is closed
                break
            if not part:
                break
            text += part
        os.close(master)
        self.assertEqual(process.wait(DEADLINE_S), 0)
        return text.decode().replace("\r\n", "\n")


if __name__ == "__main__":
    unittest.main()
