"""Telemetry that comes from a file and telemetry that comes over DDS are the same telemetry."""

import json
import sys
import unittest

import plant
from harness import EndToEnd


class Transfer(EndToEnd):
    def import_file(self, csv):
        return self.reident("import", csv, "--db", self.database, "--spacecraft", "SAT")

    def test_a_file_that_was_imported_brings_nothing_new_when_it_is_replayed(self):
        csv = plant.write(self.folder / "t.csv", plant.rows(2000))
        status, text = self.import_file(csv)
        self.assertEqual(status, 0, text)
        self.configure([plant.equipment(window="1h", slide="1h")])
        self.start_daemon()
        self.assertEqual(self.replay_all(csv)["samples"], 6000)
        state = self.wait_idle()
        self.assertEqual((state["samples_stored"], state["duplicates"], state["conflicts"]),
                         (0, 6000, 0))
        self.assertEqual(self.stored(), 6000)

    def test_while_the_service_runs_an_import_is_refused_and_the_rest_works(self):
        table = list(plant.rows(3000))
        lost = table[:1000] + table[1600:]
        csv = plant.write(self.folder / "t.csv", lost)
        self.configure([plant.equipment(window="1h", slide="1h")])
        self.start_daemon()
        self.replay_all(csv)
        self.wait_idle()

        status, text = self.import_file(csv)
        self.assertEqual(status, 2, text)
        self.assertIn("reident.db", text)

        status, text = self.reident("completeness", self.database, "--by", "hour", "--json")
        self.assertEqual(status, 0, text)
        bins = json.loads(text)["telemetry"][0]["bins"]
        self.assertEqual(sum(one["came"] for one in bins), 3 * 2400)
        self.assertEqual(sum(one["expected"] for one in bins), 3 * 3000)
        self.assertEqual([one["gaps"] for one in bins if one["gaps"]], [1])

        status, text = self.reident("export", self.database, "-o", self.folder / "all.csv")
        self.assertEqual(status, 0, text)
        status, text = self.reident("import", self.folder / "all.csv", "--db",
                                    self.folder / "copy.db")
        self.assertEqual(status, 0, text)
        self.assertIn("7200 stored", text)
        again = [self.reident("export", file)[1] for file in (self.database, self.folder / "copy.db")]
        self.assertEqual(again[0], again[1])


if __name__ == "__main__":
    sys.exit(unittest.main())
