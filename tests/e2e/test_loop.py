"""Telemetry in, an approved model out to a simulator."""

import json
import random
import sys
import time
import unittest
from xml.etree import ElementTree

import plant
from harness import EndToEnd, wait_until


SVG = "{http://www.w3.org/2000/svg}"


class Loop(EndToEnd):
    def history(self):
        status, text = self.reident("history", "--database", self.database, "--json")
        self.assertEqual(status, 0, text)
        return json.loads(text)["attempts"]

    def attempts(self):
        return self.query("SELECT * FROM attempt ORDER BY id")

    def test_two_versions_reach_a_simulator_that_started_late(self):
        self.configure([plant.equipment()])
        daemon = self.start_daemon()
        self.replay_rows("first", count=1900)
        first = self.champion()
        self.assertIsNotNone(first, self.history())

        simulator = self.start_simulator("late")
        wait_until(lambda: self.runs(simulator) == [first], "the simulator runs the champion")
        self.replay_rows("second", count=1900, first=1900, gain=2.0)
        second = self.champion()
        self.assertGreater(second, first)
        wait_until(lambda: self.runs(simulator)[-1] == second, "the simulator swapped")
        wait_until(lambda: f"simulator=late equipment=SAT/PLANT version={second}" in daemon.text(),
                   "the service knows what the simulator runs")
        self.assertEqual(simulator.terminate()[0], 0, simulator.text())

    def test_after_a_kill_the_champion_is_published_again_and_every_window_is_tried(self):
        self.configure([plant.equipment()])
        daemon = self.start_daemon()
        self.replay_rows("first", count=1900)
        self.assertIsNotNone(self.champion())
        csv = plant.write(self.folder / "second.csv", plant.rows(16_000, first=1900))
        self.replay_all(csv)
        # What was acknowledged and not committed dies with the service; its source has ended.
        wait_until(lambda: self.stored() == 3 * (1900 + 16_000), "all telemetry is stored")
        daemon.kill()
        before = self.attempts()
        self.assertLess(len(before), (1900 + 16_000) // 300, "identification was still at work")
        self.start_daemon()
        simulator = self.start_simulator("after")
        wait_until(lambda: self.runs(simulator), "a champion was published again")
        self.wait_idle()
        after = self.attempts()
        self.assertTrue(after[:len(before)] == before, "what was decided stays as it was")
        ends = [row[4] for row in after]
        self.assertEqual(len(ends), (1900 + 16_000) // 300)
        self.assertEqual(len(ends), len(set(ends)), "each window once")

    def test_killed_between_block_decision_and_publication_it_decides_as_backfill_does(self):
        self.configure([plant.equipment()])
        daemon = self.start_daemon()
        lines = [*plant.rows(9000), *plant.rows(6000, first=9000, gain=1.6)]
        csv = plant.write(self.folder / "all.csv", lines)
        self.replay_all(csv)
        wait_until(lambda: self.stored() == 3 * len(lines), "all telemetry is stored")
        moments = random.Random(20170717)
        for crash in range(4):
            daemon.kill()
            decided = self.champion()
            simulator = self.start_simulator(f"late-{crash}")
            daemon = self.start_daemon()
            if decided:
                wait_until(lambda: self.runs(simulator), "a champion is published")
                self.assertGreaterEqual(self.runs(simulator)[0], decided)
            scored = self.query("SELECT count(*) FROM score")
            until = time.monotonic() + moments.uniform(0, 0.5)
            wait_until(lambda: time.monotonic() > until or
                       self.query("SELECT count(*) FROM score") != scored, "a block was scored")
            simulator.terminate()
        self.wait_idle()
        simulator = self.start_simulator("after")
        wait_until(lambda: self.runs(simulator) == [self.champion()], "published is what was decided")
        daemon.terminate()
        with_kills = self.records()
        self.assertGreater(len({row[0] for row in with_kills["decisions"] if row[1] == "approve"}), 1)

        self.database.rename(self.folder / "with-kills.db")
        status, text = self.reident("import", csv, "--db", self.database, "--spacecraft", "SAT")
        self.assertEqual(status, 0, text)
        status, text = self.reident("backfill", "--config", self.folder / "reident.toml")
        self.assertEqual(status, 0, text)
        for what, rows in self.records().items():
            self.assertEqual(rows, with_kills[what], what)

    def records(self):
        """What versions were scored with, to the last bit, and what was decided."""
        return {
            "blocks": self.query("SELECT begin_time, rows, believed, hex(output_square) FROM block "
                                 "ORDER BY begin_time"),
            "scores": self.query("SELECT version, begin_time, hex(error_square), hex(state) "
                                 "FROM score ORDER BY version, begin_time"),
            "decisions": self.query("SELECT version, kind FROM decision ORDER BY id")}

    def test_bad_windows_are_rejected_with_a_reason_and_reach_nobody(self):
        self.configure([plant.equipment()])
        self.start_daemon()
        simulator = self.start_simulator("alone")
        self.replay_rows("noise", count=1900, noise=30.0)
        attempts = self.history()
        self.assertGreater(len(attempts), 2)
        self.assertNotIn("challenger", {attempt["outcome"] for attempt in attempts})
        self.assertTrue(all(attempt["reason"] for attempt in attempts))
        self.assertIsNone(self.champion())
        self.assertEqual(self.runs(simulator), [])

    def test_a_model_of_a_derived_input_is_published_and_run(self):
        derived = [{"name": "both", "expression": "0.3 * drive + load / 2", "unit": "V"}]
        self.configure([plant.equipment(inputs=["both", "load"], derived=derived,
                                        margin=99.0)])
        self.start_daemon()
        self.replay_rows("first", count=1900)
        champion = self.champion()
        self.assertIsNotNone(champion, self.history())
        status, text = self.reident("show", "SAT/PLANT", "--database", self.database)
        self.assertEqual(status, 0, text)
        self.assertIn("both = 0.3 * drive + load / 2", text)

        simulator = self.start_simulator("derived", "--report", "0.2")
        wait_until(lambda: self.runs(simulator) == [champion], "the simulator runs the champion")

        def events(kind):
            lines = simulator.out.read_text().splitlines()
            return [event for event in map(json.loads, filter(None, lines))
                    if event.get("event") == kind]

        # Who has no descriptors yet passes over frames: a source stays until they have come.
        names = self.replay(plant.write(self.folder / "names.csv", plant.rows(count=10, first=1900)),
                            "--speed", "max", "--source", "names", "--linger", "1h")
        wait_until(lambda: [event["undescribed"] for event in events("running")][-1:] == [[]],
                   "the simulator has the descriptors")
        names.terminate()
        self.replay_rows("second", readers=2, count=1890, first=1910)
        wait_until(lambda: any(event["ticks"] > 1000 for event in events("running")),
                   "the simulator has run over the telemetry")
        self.assertEqual(simulator.terminate()[0], 0, simulator.text())
        last = events("finished")[-1]
        self.assertLess(last["mrse_percent"][0], 5, "the simulator computes what the service did")

    def test_two_versions_are_compared_and_drawn(self):
        self.configure([plant.equipment()])
        self.start_daemon()
        self.replay_rows("first", count=1900)
        first = self.champion()
        self.replay_rows("second", count=1900, first=1900, gain=2.0)
        second = self.champion()
        status, text = self.reident("compare", "SAT/PLANT", first, second, "--database",
                                    self.database, "--json")
        self.assertEqual(status, 0, text)
        compared = json.loads(text)
        old, new = compared["versions"]
        self.assertEqual((old["version"], new["version"]), (first, second))
        self.assertLess(new["errors"]["mrse_percent"][0], old["errors"]["mrse_percent"][0])
        ((evidence,),) = self.query(
            "SELECT evidence_json FROM attempt JOIN version ON version.attempt = attempt.id "
            "WHERE number = ?", second)
        gate = json.loads(evidence)
        self.assertAlmostEqual(new["errors"]["mrse_percent"][0], gate["mrse_percent"], places=3)
        self.assertEqual(compared["input_differences"], [])
        for channel in compared["channels"]:
            gains, steps = channel["static_gain"], channel["step_response"]
            self.assertAlmostEqual(gains[1] / gains[0], 2, delta=0.1, msg="the other satellite")
            for gain, step in zip(gains, steps):
                self.assertAlmostEqual(step[-1], gain, delta=0.02 * abs(gain))
        status, text = self.reident("compare", "SAT/PLANT", first, second, "--database",
                                    self.database)
        self.assertEqual(status, 0, text)
        self.assertIn("inputs: the same", text)

        status, text = self.reident("score", "SAT/PLANT", "--database", self.database, "--json")
        self.assertEqual(status, 0, text)
        scored = json.loads(text)["versions"]
        self.assertEqual([row["version"] for row in scored[:1] + scored[-1:]], [first, second])
        self.assertEqual(scored[0]["end"], scored[1]["begin"], "until the next one")
        for before, row in zip(scored, scored[1:]):
            self.assertEqual(row["replaced"], before["version"])
        self.assertLess(3 * scored[-1]["errors"]["mrse_percent"],
                        scored[-1]["replaced_errors"]["mrse_percent"], "the gain is another")
        for row in scored:
            self.assertLess(row["errors"]["mrse_percent"], row["mean"]["mrse_percent"])
            self.assertLess(row["errors"]["mrse_percent"],
                            row["static_regression"]["mrse_percent"], "the plant has a state")
        status, text = self.reident("score", "--span", "1min", "--database", self.database)
        self.assertEqual(status, 0, text)
        self.assertIn(" 1min ", text)

        drawing = self.folder / "plant.svg"
        status, text = self.reident("plot", f"SAT/PLANT@{second}", "-o", drawing, "--database",
                                    self.database)
        self.assertEqual(status, 0, text)
        self.assertLess(drawing.stat().st_size, 500_000)
        root = ElementTree.parse(drawing).getroot()
        groups = {group.get("id"): group for group in root.iter(f"{SVG}g")}
        self.assertLessEqual({"output-1-real", "output-1-simulated", "output-1-error", "poles"},
                             set(groups))
        for name in ("real", "simulated", "error"):
            points = "".join(line.get("points") for line in groups[f"output-1-{name}"])
            self.assertGreaterEqual(len(points.split()), 300, name)  # half a window
        shaded = {rect.get("class") for rect in root.iter(f"{SVG}rect")}
        self.assertLessEqual({"identify", "tune", "validate"}, shaded)
        self.assertEqual(len(list(groups["poles"])), new["order"])
        status, text = self.reident("plot", f"SAT/PLANT@{first}", "-o", drawing,
                                    "--replace", "--database", self.database)
        self.assertEqual(status, 0, text)
        drawn = {group.get("id") for group in ElementTree.parse(drawing).getroot().iter(f"{SVG}g")}
        self.assertIn("singular-values", drawn, "of a version that is identified, not adapted")

        for status, says, *words in [
                (2, "99", "plot", "SAT/PLANT@99"),
                (2, "no row with every parameter valid", "plot", "SAT/PLANT", "--begin",
                 "2030-01-01", "--end", "2030-01-02"),
                (2, "ends later", "plot", "SAT/PLANT", "--end", "2001-01-01"),
                (2, "is no time", "plot", "SAT/PLANT", "--begin", "soon"),
                (1, "cannot be written", "plot", "SAT/PLANT", "-o", self.folder / "no" / "x.svg"),
                (2, "x is no version", "compare", "SAT/PLANT", first, "x"),
                (2, "nothing is known about SAT/NONE", "compare", "SAT/NONE", 1, 2),
                (2, "nothing is known about SAT/NONE", "score", "SAT/NONE"),
                (2, "is no length of time", "score", "--span", "soon")]:
            with self.subTest(words=words):
                done, text = self.reident(*words, "--database", self.database)
                self.assertEqual((done, text.count("\n")), (status, 1), text)
                self.assertIn(says, text)

    def test_by_hand_a_candidate_waits(self):
        self.configure([plant.equipment(approval="by_hand")])
        self.start_daemon()
        self.replay_rows("first", count=1300)
        self.assertIsNone(self.champion())
        self.assertIn("waits_for_operator", self.codes("wait"))


if __name__ == "__main__":
    sys.exit(unittest.main())
