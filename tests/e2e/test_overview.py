"""What an operator sees in one screen: how the models are now, and the alarms."""

import json
import unittest

import plant
from harness import EndToEnd, wait_until


class Overview(EndToEnd):
    def overview(self, *options):
        """The exit status and the JSON object."""
        config = [] if options else ["--config", self.folder / "reident.toml"]
        status, text = self.reident("overview", "--json", *config, *options)
        return status, json.loads(text)

    def alarms(self, *options):
        return {alarm["code"]: alarm for alarm in self.overview(*options)[1]["alarms"]}

    def until(self, what, *options, absent=()):
        """Waits until the alarms are those of `what`, without those of `absent`."""
        return wait_until(lambda: (alarms := self.alarms(*options)) and all(
            code in alarms for code in what) and not any(
            code in alarms for code in absent) and alarms, f"the alarms are {what}, not {absent}")

    def remote(self):
        return ["--remote", *self.endpoint()]

    def test_simulators_are_counted_while_they_live(self):
        self.configure([plant.equipment()])
        daemon = self.start_daemon()
        self.replay_rows("first", count=1900)
        champion = self.champion()
        self.assertIsNotNone(champion)
        status, view = self.overview()
        self.assertEqual((status, view["act"], view["alarms"]), (0, False, []), view)
        row, = view["equipment"]
        self.assertEqual(row["champion"], champion)
        self.assertGreater(row["mrse_percent"], 0)
        self.assertGreater(row["approved_mrse_percent"], 0)
        self.assertEqual(row["simulators"], 0)

        simulator = self.start_simulator("trainer")
        counts = lambda: [self.overview()[1]["equipment"][0][key]
                          for key in ("simulators_current", "simulators")]
        wait_until(lambda: counts() == [1, 1], "the simulator is counted")
        self.assertEqual(self.overview(*self.remote())[1]["equipment"][0]["simulators"], 1)
        simulator.kill()
        wait_until(lambda: counts() == [0, 0], "a simulator that was killed is not")
        rows = self.query("SELECT name, is_there, version FROM simulator ORDER BY id")
        self.assertIn(("trainer", 1, champion), rows)
        self.assertEqual(rows[-1][:2], ("trainer", 0))

        daemon.terminate()
        status, view = self.overview()
        self.assertEqual((status, [alarm["code"] for alarm in view["alarms"]]),
                         (1, ["no_service"]))

    def test_names_that_no_telemetry_has_and_telemetry_that_stays_away_are_alarms(self):
        other = plant.equipment(name="OTHER", inputs=["driev"], outputs=["out_of_reach"],
                                slide="3s")
        self.configure([plant.equipment(), other])
        self.start_daemon()
        self.replay_rows("first", count=700)
        alarms = self.until(["no_telemetry", "unknown_names"])
        self.assertEqual(alarms["unknown_names"]["equipment"], "OTHER")
        self.assertIn("driev (did you mean drive?); out_of_reach", alarms["unknown_names"]["text"])
        self.assertEqual(alarms["no_telemetry"]["equipment"], "OTHER")
        status, view = self.overview()
        self.assertEqual((status, view["equipment"][0]["equipment"]), (1, "OTHER"), "worst first")
        self.assertEqual(self.alarms(*self.remote()).keys(), alarms.keys())
        said = json.loads(self.reident("status", "--json", *self.endpoint())[1])
        self.assertTrue(any(line.startswith("unknown_names SAT/OTHER: ")
                            for line in said["alarms"]), said)
        kinds = self.query("SELECT DISTINCT kind FROM alarm")
        self.assertEqual(kinds, [("raise",)], "an alarm whose text stays is raised once")

        order = ["acknowledge", "--actor", "Ana", "--config", self.folder / "reident.toml"]
        for alarm in (["no_telemetry", "SAT/OTHER"], ["unknown_names"]):
            status, said = self.reident(*order, *alarm)
            self.assertEqual(status, 0, said)
            self.assertIn(f"{alarm[0]} of SAT/OTHER is acknowledged by Ana", said)
        self.assertEqual(self.reident(*order, "disk")[0], 2)
        status, view = self.overview()
        self.assertEqual((status, view["act"], {one["seen_by"] for one in view["alarms"]}),
                         (0, False, {"Ana"}), view)

    def test_a_second_service_is_an_alarm_of_both_until_it_ends(self):
        self.configure([plant.equipment()])
        first = self.start_daemon()
        text = (self.folder / "reident.toml").read_text()
        other = self.folder / "other.toml"
        other.write_text(text.replace("reident.db", "other.db").replace(
            "[service]", '[service]\nname = "other"'))
        second = self.start("reidentd", "--config", other, name="other")
        alarm = self.until(["two_services"])["two_services"]
        self.assertIn("Service other publishes SAT/PLANT too", alarm["text"])
        wait_until(lambda: "Service reident publishes" in second.text(), "the other says so too")
        said = json.loads(self.reident("status", "--json", *self.endpoint())[1])
        self.assertEqual({said["service"], *(one["service"] for one in said["others"])},
                         {"reident", "other"})
        second.terminate()
        wait_until(lambda: not self.alarms(), "the alarm is cleared")
        self.assertEqual(first.text().count("alarm: raised"), 1)


if __name__ == "__main__":
    unittest.main()
