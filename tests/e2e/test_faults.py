"""What the archive makes of telemetry whose times, order, sender or validity are wrong."""

import csv
import json
import unittest

from harness import EndToEnd

NS = 1_000_000_000
START_S = 1_498_867_200  # of satcs-reference
MINUTE_NS = 60 * NS


class Contract:
    """The archive as the contract has it: the better quality wins, then the first.

    A good value that another good one contradicts is disputed."""

    def __init__(self):
        self.samples = {}
        self.disputed = set()
        self.duplicates = self.conflicts = 0

    def take(self, samples, later_ns=0):
        for (parameter, at), value in samples.items():
            key = parameter, at + later_ns
            if key not in self.samples:
                self.samples[key] = value
            elif self.samples[key] == value:
                self.duplicates += 1
            else:
                self.conflicts += 1
                self.disputed.add(key)


class Faults(EndToEnd):
    def setUp(self):
        super().setUp()
        self.configure([{"name": "BDR", "inputs": ["I_BDRIN1", "I_BDRIN2"],
                         "outputs": ["I_BDROUT"], "sample_period": "1s", "window": "6h",
                         "slide": "3h"}], spacecraft="REFERENCE")
        self.start_daemon()

    def publish(self, duration, *faults):
        options = [option for fault in faults for option in ("--fault", fault)]
        reference = self.start("satcs-reference", "--duration", duration, "--speed", "max",
                               "--json", *options, *self.endpoint())
        self.assertEqual(reference.wait(), 0, reference.text())
        return json.loads(reference.out.read_text())

    def truth(self, duration, *options):
        """{(parameter, time): value} of what satcs-reference sends without faults."""
        path = self.folder / "truth.csv"
        writer = self.start("satcs-reference", "--duration", duration, "--csv", path, "--replace",
                            *options)
        self.assertEqual(writer.wait(), 0, writer.text())
        with open(path, newline="", encoding="ascii") as file:
            return {(name, int(row["unix_s"]) * NS): float(cell)
                    for row in csv.DictReader(file)
                    for name, cell in row.items() if name != "unix_s" and cell}

    def of_source(self, name):
        return self.query("SELECT frames, CAST(missing AS INTEGER), out_of_order, restarts "
                          "FROM telemetry_source WHERE source = ?", name)[0]

    def test_times_order_and_senders_give_what_the_contract_says(self):
        truth = self.truth("30min")

        def minutes(begin, end):
            return {key: value for key, value in truth.items()
                    if begin <= (key[1] - START_S * NS) / MINUTE_NS < end}

        summary = self.publish(
            "30min", "repeated_day@+1min/+2min*180", "time_jump@+5min/+6min*1e9",
            "backwards_playback@+10min/+15min*30", "two_stations@+16min/+26min*-3",
            "simulated_as_real@+27min/+28min", "time_jump@+29min/+30min*-60")
        state = self.wait_idle()

        contract = Contract()
        contract.take(minutes(0, 5))
        contract.take(minutes(1, 2))  # again
        contract.take(minutes(5, 6), later_ns=10**9 * NS)
        contract.take(minutes(6, 29))
        contract.take(minutes(16 + 20 / 6, 16 + 40 / 6))  # heard by both stations
        simulated = self.truth("1min", "--simulated", "--start", START_S + 27 * 60)
        contract.take(simulated)
        contract.take(minutes(29, 30), later_ns=-MINUTE_NS)
        self.assertEqual(summary["frames"], 1800 + 60 + 200 + 60)
        self.assertEqual(state["samples_stored"], len(contract.samples))
        self.assertEqual(state["duplicates"], contract.duplicates)
        self.assertEqual(state["conflicts"], contract.conflicts)
        self.assertEqual(state["clock_jumps"], 60)

        samples = self.samples()
        self.assertEqual({key for key, (_, quality) in samples.items() if quality != "good"},
                         contract.disputed)
        stored = {key: value for key, (value, _) in samples.items()}
        # DDS keeps the order within a sender alone: between two, either may be the first.
        for key, value in simulated.items():
            self.assertIn(stored[key], (value, truth[key]))
            stored[key] = contract.samples[key]
        self.assertEqual(stored, contract.samples)

        # 200 s were heard by the second station alone; what came backwards or again is not missing.
        self.assertEqual(self.of_source("reference"), (1800 + 60 - 200, 200, 360, 0))
        self.assertEqual(self.of_source("reference-2"), (400, 0, 0, 0))
        self.assertEqual(self.of_source("simulator"), (60, 0, 0, 0))

    def test_a_better_quality_replaces_a_worse_one_and_a_wrong_good_one_stays(self):
        truth = self.truth("5min")
        self.publish("5min", "wrong_validity@+1min/+4min*0.5")
        self.wait_idle()
        flagged = self.samples()
        invalid = {key for key, (_, quality) in flagged.items() if quality == "invalid"}
        wrong = {key: value for key, (value, _) in flagged.items() if value != truth[key]}
        self.assertGreater(min(len(invalid), len(wrong)), 500)
        self.assertEqual(invalid & wrong.keys(), set())

        self.publish("5min")
        state = self.wait_idle()
        self.assertEqual(state["conflicts"], len(wrong))
        self.assertEqual(state["duplicates"], len(truth) - len(wrong))
        stored = self.samples()
        self.assertEqual({key for key, (_, quality) in stored.items() if quality == "disputed"},
                         wrong.keys())
        self.assertEqual({quality for _, quality in stored.values()}, {"good", "disputed"})
        self.assertEqual({key: value for key, (value, _) in stored.items()}, truth | wrong)


if __name__ == "__main__":
    unittest.main()
