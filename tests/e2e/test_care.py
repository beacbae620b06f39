"""The database is backed up, verified and kept small while the service writes it."""

import json
import sqlite3
import subprocess
import sys
import unittest

import plant
from harness import BIN, EndToEnd, wait_until


class Care(EndToEnd):
    def tables(self, path):
        connection = sqlite3.connect(f"file:{path}?mode=ro", uri=True)
        try:
            names = [name for (name,) in connection.execute(
                "SELECT name FROM sqlite_master WHERE type = 'table' AND name NOT LIKE 'sqlite_%'")]
            return {name: sorted(connection.execute(f"SELECT * FROM {name}"), key=repr)
                    for name in names}
        finally:
            connection.close()

    def test_a_backup_at_full_speed_is_sound_and_holds_what_was_sent(self):
        # Enough rows that they are still being sent when a backup on a busy machine ends.
        csv = plant.write(self.folder / "t.csv", list(plant.rows(160_000)))
        copy = self.folder / "copy.db"
        self.configure([plant.equipment(window="8h", slide="8h")])
        daemon = self.start_daemon()
        replay = self.replay(csv, "--speed", "max", "--history", 170_000)
        wait_until(self.stored, "telemetry is being stored")
        status, text = self.reident("backup", self.database, copy, "--json")
        self.assertEqual(status, 0, text)
        self.assertTrue(replay.running(), "the replay is still at work")
        copied = json.loads(text)["samples"]
        self.assertGreater(copied, 0)
        self.assertEqual(self.reident("verify", copy)[0], 0, self.reident("verify", copy)[1])
        status, text = self.reident("verify", self.database)
        self.assertEqual(status, 0, text)

        self.assertEqual(replay.wait(), 0, replay.text())
        self.wait_idle()
        self.assertEqual(self.stored(), 480_000)
        status, text = self.reident("backup", self.database, copy, "--replace")
        self.assertEqual(status, 0, text)
        self.assertEqual(self.tables(copy), self.tables(self.database))
        self.assertEqual(daemon.terminate()[0], 0, daemon.text())

    def test_a_service_goes_on_from_a_backup_as_if_the_rest_had_not_come_yet(self):
        csv = plant.write(self.folder / "t.csv", list(plant.rows(40_000)))
        copy = self.folder / "copy.db"
        self.configure([plant.equipment(window="1h", slide="1h")])
        daemon = self.start_daemon()
        replay = self.replay(csv, "--speed", "max")
        wait_until(self.stored, "telemetry is being stored")
        status, text = self.reident("backup", self.database, copy, "--json")
        self.assertEqual(status, 0, text)
        copied = json.loads(text)["samples"]
        self.assertEqual(replay.wait(), 0, replay.text())
        self.assertEqual(daemon.terminate()[0], 0, daemon.text())

        for suffix in ("", "-wal", "-shm"):
            self.database.with_name(self.database.name + suffix).unlink(missing_ok=True)
        copy.rename(self.database)
        self.start_daemon()
        self.replay_all(csv)
        state = self.wait_idle()
        self.assertEqual(state["conflicts"], 0)
        self.assertEqual((state["duplicates"], state["samples_stored"]),
                         (copied, 120_000 - copied))
        status, text = self.reident("verify", self.database)
        self.assertEqual(status, 0, text)

    def test_old_telemetry_goes_while_the_service_runs_and_versions_stay_reproducible(self):
        # Small batches, so that samples are in chunks soon.
        config = self.configure([plant.equipment(window="1h", slide="50min", margin=90)])
        plain = config.read_text()
        config.write_text(plain.replace("[dds]", "batch_frames = 32\n[dds]"))
        daemon = self.start_daemon()
        self.replay_rows("flight", count=50_000)
        version = self.champion()
        self.assertIsNotNone(version)
        self.assertEqual(daemon.terminate()[0], 0, daemon.text())
        before = self.stored()

        config.write_text(plain.replace("[dds]", 'keep = "2h"\n[dds]'))
        daemon = self.start_daemon()
        wait_until(lambda: "old telemetry removed" in daemon.text(), "telemetry was removed")
        removed = self.query("SELECT sum(samples) FROM telemetry_removed")[0][0]
        self.assertEqual(self.stored(), before - removed)
        self.assertGreater(removed, 3 * 8000)
        for number, in self.query("SELECT DISTINCT version FROM decision WHERE kind = 'approve'"):
            status, text = self.reident("reproduce", f"SAT/PLANT@{number}", "--config", config)
            self.assertEqual(status, 0, text)
        status, text = self.reident("verify", self.database)
        self.assertEqual(status, 0, text)
        status, text = self.reident("retain", self.database, "--keep", "3h")
        self.assertEqual(status, 2)
        self.assertIn("of its own configuration", text)

    def test_a_verify_decodes_what_changed_since_the_last_one(self):
        known = self.folder / "reident.sound"

        def add(name, **keywords):
            csv = plant.write(self.folder / name, plant.rows(20_000, **keywords))
            status, text = self.reident("import", csv, "--db", self.database, "--spacecraft", "SAT")
            self.assertEqual(status, 0, text)

        def verify():
            done = subprocess.run([BIN / "reident", "verify", self.database, "--known", known,
                                   "--json"], capture_output=True, text=True, check=True)
            report = json.loads(done.stdout)
            return report["chunks"], report["chunks_known"], report["samples"], done.stderr

        add("one.csv")
        chunks, skipped, samples, _ = verify()
        self.assertEqual((skipped, samples), (0, 60_000))
        self.assertEqual(verify()[:3], (chunks, chunks, 0))
        add("two.csv", first=20_000)
        more, skipped, samples, _ = verify()
        self.assertGreater(more, chunks)
        self.assertGreater(skipped, 0)
        self.assertGreaterEqual(samples, 60_000)
        self.assertLess(samples, 120_000)
        known.write_text(known.read_text()[1:])
        _, skipped, samples, words = verify()
        self.assertEqual((skipped, samples), (0, 120_000))
        self.assertIn("reident.sound", words)
        self.assertEqual(verify()[1], more)


if __name__ == "__main__":
    sys.exit(unittest.main())
