"""Telemetry that is sent over DDS arrives complete in SQLite, whatever happens on the way."""

import json
import signal
import sys
import time
import unittest

import plant
from harness import BIN, EndToEnd, Process, wait_until

NS = 1_000_000_000


def parameters(table):
    """{(parameter, time): value} of CSV rows, as they have to be archived."""
    names = ["drive", "load", "out"]
    return {(name, row[0] * NS): value
            for row in table for name, value in zip(names, row[1:])}


class Ingest(EndToEnd):
    def stored_values(self):
        return {key: value for key, (value, _) in self.samples().items()}

    def assert_stored(self, expected):
        stored = self.stored_values()
        missing, surplus = expected.keys() - stored.keys(), stored.keys() - expected.keys()
        times = sorted({at for _, at in missing})
        self.assertEqual((len(missing), times[:1], times[-1:]), (0, [], []), "samples are missing")
        self.assertEqual(len(surplus), 0, "samples were never sent")
        self.assertEqual([key for key in expected if expected[key] != stored[key]], [])

    def missing_sequences(self):
        return self.query("SELECT sum(CAST(missing AS INTEGER)) FROM telemetry_source")[0][0]

    def test_every_cell_of_a_replayed_file_is_archived_once(self):
        table = list(plant.rows(3000))
        lines = [list(row) for row in table]
        lines[10][1] = ""          # blank
        lines[11][2] = "n/a"       # not a number
        lines[12][3] = "nan"
        csv = plant.write(self.folder / "t.csv", lines)
        self.configure([plant.equipment(window="1h", slide="1h")])
        self.start_daemon()
        summary = self.replay_all(csv, "--invalid-blanks")
        self.assertEqual((summary["frames"], summary["samples"]), (3000, 9000))
        state = self.wait_idle()
        self.assertEqual(state["samples_stored"], 9000)

        samples = self.samples()
        invalid = {key for key, (_, quality) in samples.items() if quality == "invalid"}
        times = {i: lines[i][0] * NS for i in (10, 11, 12)}
        self.assertEqual(invalid, {("drive", times[10]), ("load", times[11]), ("out", times[12])})
        self.assertTrue(all(samples[key][0] is None for key in invalid), "blanks are not zeros")
        expected = {key: value for key, value in parameters(table).items() if key not in invalid}
        self.assertEqual({k: v for k, (v, _) in samples.items() if k not in invalid}, expected)
        self.assertEqual(self.missing_sequences(), 0)

    def test_a_second_replay_adds_nothing(self):
        table = list(plant.rows(500))
        csv = plant.write(self.folder / "t.csv", table)
        self.configure([plant.equipment(window="1h", slide="1h")])
        self.start_daemon()
        self.replay_all(csv)
        self.replay_all(csv)
        self.assertEqual(self.wait_idle()["duplicates"], 1500)
        self.assert_stored(parameters(table))

    def test_a_stop_in_the_middle_takes_two_seconds_at_most_and_loses_nothing(self):
        table = list(plant.rows(40_000))
        csv = plant.write(self.folder / "t.csv", table)
        self.configure([plant.equipment(window="1h", slide="1h")])
        daemon = self.start_daemon()
        replay = self.replay(csv, "--speed", "max")
        wait_until(self.stored,
                   "telemetry is being stored")
        self.assertTrue(replay.running(), "the replay is still at work")
        status, seconds = daemon.terminate()
        self.assertEqual(status, 0, daemon.text())
        self.assertLess(seconds, 2)
        self.start_daemon()
        self.assertEqual(replay.wait(), 0, replay.text())
        self.wait_idle()
        self.assert_stored(parameters(table))
        self.assertEqual(self.missing_sequences(), 0)

    def test_a_kill_in_the_middle_keeps_what_was_committed_and_history_brings_the_rest(self):
        table = list(plant.rows(40_000))
        csv = plant.write(self.folder / "t.csv", table)
        self.configure([plant.equipment(window="1h", slide="1h")])
        daemon = self.start_daemon()
        replay = self.replay(csv, "--speed", "max", "--history", 50_000)
        wait_until(self.stored,
                   "telemetry is being stored")
        self.assertTrue(replay.running(), "the replay is still at work")
        daemon.kill()
        committed = self.stored_values()
        self.assertGreater(len(committed), 0)
        self.start_daemon()
        self.assertLessEqual(committed.items(), self.stored_values().items())
        self.assertEqual(replay.wait(), 0, replay.text())
        self.wait_idle()
        self.assert_stored(parameters(table))
        self.assertEqual(self.missing_sequences(), 0)

    def test_a_replay_waits_for_an_archive_and_not_for_a_simulator(self):
        table = list(plant.rows(240))
        csv = plant.write(self.folder / "t.csv", table)
        self.start("reident-simulator", "--spacecraft", "SAT", "--equipment", "PLANT", "--name",
                   "trainer", "--cache", self.folder / "cache", *self.endpoint())
        replay = self.replay(csv, "--speed", "max", "--history", 100, "--linger", "60s")
        wait_until(lambda: "waiting for readers" in replay.text(), "the replay waits")
        self.configure([plant.equipment(window="1h", slide="1h")])
        self.start_daemon()
        wait_until(lambda: self.stored() == 720, "every row is archived")
        wait_until(lambda: "every frame is written" in replay.text(), "the replay lingers")
        replay.signal(signal.SIGTERM)
        self.assertEqual(replay.wait(), 0, replay.text())
        self.assertEqual(json.loads(replay.out.read_text())["frames_missed"], 0)
        self.assert_stored(parameters(table))
        self.assertEqual(self.missing_sequences(), 0)

    def test_what_left_the_history_before_the_archive_came_is_counted_on_both_sides(self):
        table = list(plant.rows(240))
        csv = plant.write(self.folder / "t.csv", table)
        replay = self.replay(csv, "--speed", "max", "--wait-readers", 0, "--history", 100,
                             "--linger", "60s")
        wait_until(lambda: "every frame is written" in replay.text(), "the replay lingers")
        self.configure([plant.equipment(window="1h", slide="1h")])
        daemon = self.start_daemon()
        wait_until(lambda: self.stored() == 300, "the history is archived")
        replay.signal(signal.SIGTERM)
        self.assertEqual(replay.wait(), 0, replay.text())
        self.assertEqual(json.loads(replay.out.read_text())["frames_missed"], 140)
        self.assert_stored(parameters(table[140:]))
        self.assertEqual(self.wait_idle()["sequence_missing"], 140)
        self.assertEqual(self.query("SELECT first, last FROM telemetry_gap"), [(1, 140)])
        self.assertIn("first_sequence=141 missing=140", daemon.text())

    def test_a_second_service_on_the_same_archive_is_refused(self):
        self.configure([plant.equipment()])
        first = self.start_daemon()
        second = self.start("reidentd", "--config", self.folder / "reident.toml")
        self.assertEqual(second.wait(), 1)
        self.assertIn(f"process {first.process.pid}", second.text())
        self.assertIn("reident.db", second.text())
        self.assertTrue(first.running())


class Faults(EndToEnd):
    """Frames that no good source would send, together with good ones."""

    def publish(self, messages, source="station"):
        path = self.folder / f"frames-{len(self.processes)}.jsonl"
        path.write_text("".join(json.dumps(message) + "\n" for message in messages))
        sender = Process(self.folder, path.stem, [BIN / "publish_frames", path, self.domain,
                                                  self.partition, "SAT", source])
        self.processes.append(sender)
        self.assertEqual(sender.wait(), 0, sender.text())

    def test_bad_frames_are_counted_and_survived(self):
        self.configure([plant.equipment(window="1h", slide="1h")], max_frame_samples=1000)
        daemon = self.start_daemon()
        second = 1_600_000_000 * NS

        def frame(sequence, at, samples, **more):
            return {"frame": {"sequence": sequence, "time": at, "samples": samples, **more}}

        self.publish([
            {"descriptor": {"id": 1, "name": "drive", "unit": "V"}},
            frame(1, second, [[1, 1.0]]),
            frame(1, second, [[1, 1.0]]),                           # duplicated
            frame(2, second + NS, [[1, 2.0]]),
            frame(2, second + NS, [[1, 2.5]]),                      # conflicting
            frame(4, second + 3 * NS, [[1, 4.0]]),
            frame(3, second + 2 * NS, [[1, 3.0]]),                  # reordered
            frame(5, second + 4 * NS, [[1, "nan"], [2, "inf"], [3, "-inf"]]),
            frame(6, second + 5 * NS, []),                          # empty
            frame(7, second + 6 * NS, [[1, 9.0]], repeat=5000),     # absurdly large
            frame(8, second + 7 * NS, [[4_000_000_000, 8.0]]),      # never described
            frame(9, 4_000_000_000 * NS, [[1, 7.0]]),               # a clock decades ahead
            frame(10, -(2**63), [[1, -1.0]]),                       # the ends of the scale
            frame(11, 2**63 - 1, [[1, -2.0]]),
            frame(2**64 - 1, second + 8 * NS, [[1, 8.0]]),          # an absurd jump of the count
            frame(12, second + 9 * NS, [[1, 9.0]]),
        ])
        state = self.wait_idle()
        self.assertTrue(daemon.running(), daemon.text())
        self.assertEqual(state["frames_rejected"], 1)
        self.assertEqual(state["duplicates"], 1)
        self.assertEqual(state["conflicts"], 1)
        self.assertEqual(state["clock_jumps"], 2)
        self.assertGreater(state["late"], 0)

        samples = self.samples()
        drive = {at: value for (name, at), (value, _) in samples.items() if name == "drive"}
        self.assertEqual(drive, {
            second: 1.0, second + NS: 2.0, second + 2 * NS: 3.0, second + 3 * NS: 4.0,
            second + 4 * NS: None, 4_000_000_000 * NS: 7.0, -(2**63): -1.0, 2**63 - 1: -2.0,
            second + 8 * NS: 8.0, second + 9 * NS: 9.0})
        self.assertEqual(samples["drive", second + NS], (2.0, "disputed"))
        infinite = [quality for (_, at), (_, quality) in samples.items() if at == second + 4 * NS]
        self.assertEqual(infinite, ["invalid"] * 3)
        self.assertIn((4_000_000_000, second + 7 * NS),
                      {(int(n) if str(n).isdigit() else n, at) for n, at in samples})

    def test_descriptors_that_cannot_be_taken_are_counted_with_the_reason(self):
        self.configure([plant.equipment(window="1h", slide="1h")])
        daemon = self.start_daemon()
        self.publish([{"descriptor": {"id": 1, "name": "drive", "unit": "V"}},
                      {"descriptor": {"id": 2, "name": ""}},
                      {"descriptor": {"id": 3, "name": "n" * 256}},
                      {"frame": {"sequence": 1, "time": 1_600_000_000 * NS, "samples": [[1, 1.0]]}}])
        wait_until(lambda: self.wait_idle()["descriptors_rejected"] == 2, "two are counted")
        self.assertIn("name is longer than 255 bytes", daemon.text())
        self.assertEqual(self.query("SELECT name FROM parameter"), [("drive",)])

    def test_good_telemetry_is_identified_in_spite_of_clock_jumps_and_late_frames(self):
        self.configure([plant.equipment()])
        self.start_daemon()
        table = list(plant.rows(1300))
        order = list(range(1300))
        order[400:500] = []                       # comes late
        order += list(range(400, 500))
        names = [[1, "drive"], [2, "load"], [3, "out"]]
        messages = [{"descriptor": {"id": i, "name": n}} for i, n in names]
        for sequence, index in enumerate(order):
            row = table[index]
            messages.append({"frame": {"sequence": sequence, "time": row[0] * NS, "samples":
                                       [[i + 1, value] for i, value in enumerate(row[1:])]}})
            if sequence == 700:
                messages.append({"frame": {"source": "broken", "sequence": 1,
                                           "time": 5_000_000_000 * NS, "samples": [[1, 0.5]]}})
        self.publish(messages)
        state = self.wait_idle()
        self.assertEqual(state["clock_jumps"], 1)
        outcomes = self.query("SELECT window_end, outcome FROM attempt ORDER BY id")
        self.assertIn("challenger", [outcome for _, outcome in outcomes])
        self.assertLess(max(end for end, _ in outcomes), 1_700_000_000 * NS,
                        "no window follows a clock that ran away")

    def test_frames_that_cannot_be_sent_again_are_counted_on_both_sides(self):
        self.configure([plant.equipment()])
        daemon = self.start_daemon()
        source = self.start("satcs-reference", "--spacecraft", "SAT", "--speed", 100, "--duration",
                            "10d", "--wait-readers", 0, "--history", 20, "--json", *self.endpoint())
        wait_until(lambda: self.stored() > 0, "telemetry comes")
        daemon.terminate()
        before, since = self.stored(), time.monotonic()
        wait_until(lambda: time.monotonic() - since > 4, "400 frames are sent meanwhile")
        self.start_daemon()
        wait_until(lambda: self.stored() > before, "telemetry comes again")
        self.assertEqual(source.terminate()[0], 128 + signal.SIGTERM, source.text())
        self.wait_idle()
        lost = json.loads(source.out.read_text())["lost"][-1]  # before, some may have come too early
        *early, (first, last, before, after) = self.query(
            "SELECT first, last, time_before, time_after FROM telemetry_gap ORDER BY first")
        self.assertLessEqual(len(early), 1, early)
        self.assertEqual(after - before, (last - first + 2) * NS, "a frame each second")
        # The source learns a moment later who hears it, and who does not.
        self.assertAlmostEqual(lost["frames"], last - first + 1, delta=100)
        self.assertIn(f"first_time={lost['first_time']}", source.log.read_text())


if __name__ == "__main__":
    sys.exit(unittest.main())
