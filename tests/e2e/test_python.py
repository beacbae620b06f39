"""The Python module against a real service."""

import array
import math
import os
import sys
import unittest

import plant
from harness import EndToEnd, wait_until

sys.path.insert(0, f"{os.environ['REIDENT_BUILD']}/service/client/python")
import reident  # noqa: E402

PLANT = {"inputs": {"drive": "V", "load": "A"}, "outputs": {"out": "V"}}


class PythonModule(EndToEnd):
    def open(self, **options):
        client = reident.Client(simulator="python", domain=self.domain, partition=self.partition,
                                cache_folder=str(self.folder / "cache"), **options)
        self.addCleanup(client.close)
        return client

    def make_champion(self):
        self.configure([plant.equipment()])
        self.start_daemon()
        self.replay_rows("first", count=700)

    def step_until(self, runner, flag):
        """Steps with quiet inputs until one says `flag`; its outputs and flags."""
        steps = []

        def says():
            steps.append(runner.step([1.0, 0.0]))
            return flag in steps[-1][1]

        wait_until(says, f"a step says {flag!r}")
        return steps[-1]

    def test_runs_the_champion_and_says_what_it_does(self):
        client = self.open(spacecraft="SAT", equipment=["PL*"])
        runner = client.runner("SAT", "PLANT", **PLANT)
        y, flags = runner.step([1.0, 0.0])
        self.assertTrue(math.isnan(y[0]))
        self.assertEqual(flags, reident.Flags.NO_MODEL)
        self.make_champion()
        y, flags = self.step_until(runner, reident.Flags.SWAPPED)
        self.assertTrue(math.isfinite(y[0]))
        state = runner.state()
        self.assertEqual((state.version, state.sample_period_s), (self.champion(), 1.0))
        self.assertFalse(state.following or state.from_cache)
        kinds = {event.kind: event for event in client.events(timeout=1)}
        swapped = kinds[reident.EventKind.SWAPPED]
        self.assertEqual((swapped.spacecraft, swapped.equipment, swapped.version),
                         ("SAT", "PLANT", self.champion()))
        self.assertIn(f"version {self.champion()}", swapped.text)
        self.assertIn(reident.EventKind.AVAILABLE, kinds)
        model = client.version("SAT", "PLANT")
        self.assertEqual(model["version"], self.champion())
        self.assertEqual([one["name"] for one in model["model"]["inputs"]], ["drive", "load"])
        self.assertIsNone(client.version("SAT", "NONE"))

    def test_takes_any_vector_and_flags_inputs_by_name(self):
        self.make_champion()
        runner = self.open().runner("SAT", "PLANT", **PLANT)
        self.step_until(runner, reident.Flags.SWAPPED)
        runner.step((1, 0))
        runner.step(array.array("d", [1.0, 0.0]))
        _, flags = runner.step([1.0, math.nan])
        self.assertIn(reident.Flags.INPUT_MISSING, flags)
        self.assertEqual(runner.input_flags("drive"), reident.Flags(0))
        self.assertIn(reident.Flags.INPUT_MISSING, runner.input_flags("load"))
        _, flags = runner.step([1e6, 0.0])
        self.assertIn(reident.Flags.INPUT_OUTSIDE, flags)
        runner.observe([5.0])
        _, flags = runner.follow([1.0, 0.0], [math.nan])
        self.assertIn(reident.Flags.NOT_FOLLOWING, flags)
        with self.assertRaisesRegex(reident.Unavailable, "."):
            runner.accept()

    def test_takes_numpy_arrays(self):
        try:
            import numpy
        except ImportError:
            self.skipTest("NumPy is not installed")
        self.make_champion()
        runner = self.open().runner("SAT", "PLANT", **PLANT)
        self.step_until(runner, reident.Flags.SWAPPED)
        for kind in (numpy.float64, numpy.float32, numpy.int32):
            y, flags = runner.follow(numpy.array([1, 0], kind), numpy.array([5], kind))
            self.assertTrue(math.isfinite(y[0]))

    def test_starts_at_once_from_what_an_earlier_run_kept(self):
        self.make_champion()
        with self.open() as client:
            self.step_until(client.runner("SAT", "PLANT", **PLANT), reident.Flags.SWAPPED)
        self.processes[0].terminate()
        runner = self.open().runner("SAT", "PLANT", **PLANT)
        self.step_until(runner, reident.Flags.SWAPPED)
        self.assertTrue(runner.state().from_cache)

    def test_asks_for_history_page_by_page(self):
        self.make_champion()
        rows = list(self.open().history("versions", spacecraft="SAT", page_size=1))
        self.assertIn(self.champion(), [row["version"] for row in rows])

    def test_says_what_is_wrong_with_a_request(self):
        client = self.open()
        with self.assertRaisesRegex(reident.Unavailable, "."):
            list(client.history(timeout=0.2))
        with self.assertRaisesRegex(reident.BadArgument, "twice"):
            client.runner("SAT", "PLANT", ["drive", "drive"], ["out"])
        runner = client.runner("SAT", "PLANT", ["drive", "load"], ["out"])
        with self.assertRaisesRegex(ValueError, "1 values for drive, load; give 2"):
            runner.step([1.0])
        with self.assertRaisesRegex(reident.BadArgument, "no input volume"):
            runner.input_flags("volume")
        client.close()
        with self.assertRaisesRegex(reident.ClientError, "closed"):
            runner.step([1.0, 0.0])
        with self.assertRaisesRegex(reident.ClientError, "closed"):
            client.next_event()
        with self.assertRaisesRegex(reident.ClientError, "domain"):
            reident.Client(domain=100_000)


if __name__ == "__main__":
    unittest.main()
