"""What a candidate is judged by: the simulator's own telemetry, a champion that drifts, the past."""

import json
import sys
import unittest

import plant
from harness import EndToEnd, wait_until


class Judgement(EndToEnd):
    def attempts(self):
        return self.query("SELECT equipment, cause, outcome, window_end, evidence_json "
                          "FROM attempt ORDER BY id")

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
        approved = [json.loads(row[4]) for row in self.attempts() if row[2] == "approved"]
        self.assertTrue(approved, self.attempts())
        baseline = approved[0]["baseline"]
        self.assertEqual(baseline["rows"], approved[0]["rows_validated"])
        self.assertGreater(baseline["rival_mrse_percent"], 5)
        self.assertGreater(baseline["sure_reduction_percent"], 50)
        status, text = self.reident("why", "SAT/PLANT", "--database", self.database)
        self.assertEqual(status, 0, text)
        self.assertIn("Beside the simulator's own telemetry", text)

    def test_a_simulator_that_is_right_keeps_its_own_model(self):
        self.configure([plant.equipment()])
        self.start_daemon()
        self.simulate(gain=1.0)
        self.replay_rows("real", count=1900)
        self.assertIsNone(self.champion())
        self.assertIn("not_better_than_baseline", {row[2] for row in self.attempts()})

    def test_a_champion_that_drifts_is_noticed_before_the_next_slide(self):
        self.configure([plant.equipment(window="40min", slide="20min")])
        daemon = self.start_daemon()
        self.replay_rows("before", count=4900)
        champion = self.champion()
        self.assertIsNotNone(champion, self.attempts())
        self.assertNotIn("drift", {row[1] for row in self.attempts()})
        self.replay_rows("after", count=900, first=4900, gain=1.5)
        wait_until(lambda: "drift" in {row[1] for row in self.attempts()},
                   "a window was tried because the champion drifts")
        self.assertIn("the champion drifts", daemon.text())
        end_s = next(row[3] for row in self.attempts() if row[1] == "drift") // 10**9
        self.assertLess(end_s, plant.START_S + 4900 + 900)
        self.assertNotEqual(end_s % 1200, 0, "it does not wait for the slide")

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
        self.assertEqual((status, json.loads(text)["windows"]), (0, 0), "each window once")
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
