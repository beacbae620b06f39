"""What a candidate is judged by: the simulator's own telemetry, a champion that drifts, the past."""

import json
import sys
import unittest
from xml.etree import ElementTree

import plant
from harness import EndToEnd, wait_until


SVG = "{http://www.w3.org/2000/svg}"


class Judgement(EndToEnd):
    def attempts(self):
        return self.query("SELECT equipment, cause, outcome, window_end, evidence_json "
                          "FROM attempt ORDER BY id")

    def slides(self):
        """Outcomes of the windows that slide; others come where a champion drifts."""
        return [row[2] for row in self.attempts() if row[1] == "slide"]

    def simulate(self, gain):
        """The simulator's telemetry of the plant, whose model has its own gain."""
        csv = plant.write(self.folder / "simulated.csv",
                          plant.rows(1900, gain=gain, noise=0.0))
        self.replay_all(csv, "--origin", "simulated", "--source", "simulator")

    def test_the_simulators_own_telemetry_is_the_baseline(self):
        self.configure([plant.equipment(baseline_mrse=0.001)])
        self.start_daemon()
        self.simulate(gain=0.5)
        self.replay_rows("real", count=1900)
        self.assertEqual(self.champion(), 1, self.attempts())
        evidence = json.loads(self.query("SELECT evidence_json FROM decision "
                                         "WHERE kind = 'approve'")[0][0])
        self.assertEqual(evidence["reasons"][-1]["code"], "first_version")
        self.assertGreater(evidence["baseline_mrse_percent"], 5)
        self.assertLess(evidence["mrse_percent"], 0.5 * evidence["baseline_mrse_percent"])

    def test_a_simulator_that_is_right_keeps_its_own_model(self):
        self.configure([plant.equipment()])
        self.start_daemon()
        self.simulate(gain=1.0)
        self.replay_rows("real", count=1900)
        self.assertIsNone(self.champion())
        self.assertIn("challenger", {row[2] for row in self.attempts()})

    def test_a_champion_that_drifts_is_identified_anew_from_telemetry_since_then(self):
        self.configure([plant.equipment(window="40min", slide="40min")])
        daemon = self.start_daemon()
        self.replay_rows("before", count=4900)
        champion = self.champion()
        self.assertIsNotNone(champion, self.attempts())
        self.assertNotIn("drift", {row[1] for row in self.attempts()})
        self.replay_rows("after", count=1800, first=4900, gain=1.5)
        wait_until(lambda: "drift" in {row[1] for row in self.attempts()},
                   "a window was tried because the champion drifts")
        self.assertIn("the equipment has changed", daemon.text())
        begin_s, end_s = (time // 10**9 for time in self.query(
            "SELECT window_begin, window_end FROM attempt WHERE cause = 'drift' ORDER BY id")[0])
        change_s = plant.START_S + 4900
        # The window begins behind the block of 240 s where the change shows: its own, or the next.
        self.assertTrue(change_s <= begin_s < change_s + 2 * 240, (begin_s, change_s))
        self.assertTrue(1200 <= end_s - begin_s < 2400, "half of a window is enough")
        self.assertNotEqual(end_s % 2400, 0, "it does not wait for the slide")

    def test_a_challenger_waits_for_telemetry_and_for_no_other_window(self):
        self.configure([plant.equipment(slide="10min", order=4)])
        daemon = self.start_daemon()
        self.replay_rows("before", count=601)
        self.assertEqual(self.champion(), 1, self.attempts())
        changed = {"gain": 1.3}
        self.replay_rows("after", first=601, count=640, **changed)
        self.assertEqual(self.slides(), ["challenger", "challenger"])
        self.replay_rows("later", first=1241, count=470, **changed)
        wait_until(lambda: self.champion() != 1, "what came after the window approves a version")
        self.assertEqual(self.slides(), ["challenger", "challenger"])
        wait_until(lambda: "decision=approve" in daemon.text(), "the log says so")

        better = self.champion()
        status, text = self.reident("why", f"SAT/PLANT@{better}", "--json", "--database",
                                    self.database)
        self.assertEqual(status, 0, text)
        verdict = json.loads(text)
        self.assertEqual([condition["holds"] for condition in verdict["conditions"]],
                         [True] * len(verdict["conditions"]), verdict["verdict"])
        drawing = self.folder / "record.svg"
        for where in (("--database", self.database), ("--remote", *self.endpoint())):
            status, text = self.reident("plot", f"SAT/PLANT@{better}", "--record", "-o", drawing,
                                        "--replace", *where)
            self.assertEqual(status, 0, text)
            groups = {group.get("id"): group
                      for group in ElementTree.parse(drawing).getroot().iter(f"{SVG}g")}
            self.assertLessEqual({"scores", "mean", "lower"}, set(groups))
            self.assertGreater(len(list(groups["scores"])), 10)
        status, text = self.reident("plot", "SAT/PLANT@1", "--record", "--database", self.database)
        self.assertEqual(status, 2, text)
        self.assertIn("has no record beside a champion", text)
        reasons = dict(self.query("SELECT code, count(*) FROM gate_reason GROUP BY code"))
        self.assertEqual(reasons["first_version"], 1)
        self.assertGreaterEqual(reasons["better"], 1)

    def replay_two_sensors(self, name, bias=0.0, **keywords):
        """The plant with a second sensor of its output; the first one lies by `bias`."""
        lines = [",".join([*plant.HEADER, "out_b_v"])]
        lines += [f"{at},{drive},{load},{out + bias:.6f},{out:.6f}"
                  for at, drive, load, out in plant.rows(**keywords)]
        path = self.folder / f"{name}.csv"
        path.write_text("\n".join(lines) + "\n")
        self.replay_all(path)
        self.wait_idle()

    def test_a_sensor_that_lies_is_found_by_its_relation_until_it_is_honest_again(self):
        pair = {"name": "two sensors", "expression": "out - out_b", "tolerance": 0.2}
        misspelt = {"name": "misspelt", "expression": "out - out_c", "tolerance": 0.2}
        self.configure([plant.equipment()], relations=[pair, misspelt])
        self.start_daemon()
        self.replay_two_sensors("honest", count=1600)
        self.replay_two_sensors("lying", count=1200, first=1600, bias=1.0)
        self.replay_two_sensors("again", count=1400, first=2800)
        tried = {end // 10**9 - plant.START_S: (outcome, json.loads(evidence))
                 for _, _, outcome, end, evidence in self.attempts()}

        outcome, evidence = tried[2400]  # of the lie alone
        self.assertEqual(outcome, "implausible")
        longest = evidence["implausible"]["longest"][0]
        self.assertEqual((longest["relation"], longest["parameters"]),
                         ("two sensors", ["out", "out_b"]))
        self.assertAlmostEqual(longest["residual"], 1.0, places=3)
        for end in 1500, 3600, 3900:  # of honest telemetry alone
            outcome, evidence = tried[end]
            self.assertIn("order", evidence, outcome)
            self.assertEqual(evidence["implausible"], {
                "stretches": 0, "ticks": 0,
                "not_applied": ["misspelt: telemetry has not described out_c"]})

        status, text = self.reident("history", "--long", "--database", self.database)
        self.assertEqual(status, 0, text)
        self.assertIn("relation two sensors (out - out_b) does not hold from", text)
        # The lie begins in the last third of this window, which is identified without it.
        version, = self.query("SELECT version FROM model_version WHERE window_end = ?",
                              (plant.START_S + 1800) * 10**9)[0]
        status, text = self.reident("why", f"SAT/PLANT@{version}", "--database", self.database)
        self.assertEqual(status, 0, text)
        self.assertRegex(" ".join(text.split()),
                         "left out: out, out_b from 2020-09-13T1[0-9:]+Z to 2020-09-13T1[0-9:]+Z, "
                         "where relation two sensors is 1 with a tolerance of 0.2")

    def test_the_past_is_tried_without_a_service_and_comes_out_the_same_to_the_last_bit(self):
        self.configure([plant.equipment()])
        daemon = self.start_daemon()
        self.replay_rows("real", count=6100)
        status, text = self.reident("backfill", "--config", self.folder / "reident.toml")
        self.assertEqual(status, 2, "the service holds the database")
        self.assertIn("is in use by process", text)
        self.assertEqual(daemon.terminate()[0], 0)
        self.configure([plant.equipment(), plant.equipment(name="LATER", slide="10min")])
        config = ("--config", self.folder / "reident.toml")
        status, text = self.reident("backfill", "SAT/LATER", "--json", *config)
        self.assertEqual(status, 0, text)
        self.assertEqual(json.loads(text)["windows"], 10)
        tried = [row for row in self.attempts() if row[0] == "LATER"]
        self.assertEqual([row[1] for row in tried], ["backfill"] * 10)
        status, text = self.reident("backfill", "--json", *config)
        again = json.loads(text)
        self.assertEqual((status, again["windows"]), (0, 0), "each window once")
        overview = json.loads(self.reident("overview", "--json", *config)[1])
        self.assertEqual((again["waiting"], again["alarms"] + 1),  # one of them: no service runs
                         (sum(len(row["waiting"]) for row in overview["equipment"]),
                          len(overview["alarms"])))
        for equipment in ("PLANT", "LATER"):
            status, text = self.reident("reproduce", f"SAT/{equipment}", "--json", *config)
            self.assertEqual(status, 0, text)
            self.assertTrue(json.loads(text)["same_model"])
        self.start_daemon()
        simulator = self.start("reident-simulator", "--spacecraft", "SAT", "--equipment", "LATER",
                               "--name", "late", "--json", "--cache", "", *self.endpoint(), name="late")
        wait_until(lambda: self.runs(simulator), "what was approved offline is published")


if __name__ == "__main__":
    sys.exit(unittest.main())
