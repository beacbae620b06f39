"""What the service does when its database cannot be written, is taken away or is damaged."""

import json
import os
import resource
import shutil
import sqlite3
import subprocess
import sys
import unittest

import plant
from harness import EndToEnd, wait_until

NOBODY = 65534
ROWS = 20_000
NEW_YEAR = 1_609_459_200 - plant.START_S  # 2021


class ArchiveFaults(EndToEnd):
    """The service with little room between the middleware and the archive."""

    @property
    def database(self):
        return self.folder / "disk" / "reident.db"

    def setUp(self):
        super().setUp()
        self.database.parent.mkdir()

    def set_up(self, batch_frames=64, **changes):
        path = self.configure([plant.equipment(**changes)], queue_frames=256)
        path.write_text(path.read_text().replace(
            'database = "reident.db"',
            f'database = "disk/reident.db"\nbatch_frames = {batch_frames}'))

    def status(self):
        code, text = self.reident("status", "--json", *self.endpoint())
        self.assertEqual(code, 0, text)
        return json.loads(text)

    def wait_for_error(self, words):
        return wait_until(lambda: words in self.status()["last_error"], f"status says: {words}")

    def write_csv(self, count=ROWS, first=0):
        return plant.write(self.folder / f"t{first}.csv", plant.rows(count, first=first))

    def assert_all_stored_once(self, rows=ROWS):
        state = self.wait_idle()
        self.assertEqual(state["last_error"], "")
        self.assertEqual(self.stored(), 3 * rows)
        frames, samples, duplicates, missing = self.query(
            "SELECT frames, samples, duplicates, CAST(missing AS INTEGER) FROM telemetry_source")[0]
        self.assertEqual((frames, samples, duplicates, missing), (rows, 3 * rows, 0, 0))

    def assert_held_back_until(self, daemon, words, mend):
        """The replay that runs cannot end before `mend`; then nothing is lost or doubled."""
        replay = self.processes[-1]
        self.wait_for_error(words)
        waits = self.status()["queue_waits"]
        wait_until(lambda: self.status()["queue_waits"] > 0, "the queue is full")
        self.assertGreaterEqual(self.status()["queue_waits"], waits)
        self.assertTrue(replay.running(), "the sender waits")
        self.assertIn("it is kept and tried again", daemon.text())
        mend()
        self.assertEqual(replay.wait(), 0, replay.text())
        self.assert_all_stored_once()
        self.assertIn("storing again", daemon.text())
        self.assertTrue(daemon.running())
        self.assertEqual(daemon.terminate()[0], 0, daemon.text())

    # -- no room

    def test_a_full_disk_holds_the_sources_back_until_there_is_room(self):
        disk = self.database.parent
        if subprocess.run(["mount", "-t", "tmpfs", "-o", "size=24m", "tmpfs", disk],
                          capture_output=True, check=False).returncode != 0:
            self.skipTest("a small disk needs the right to mount one")
        self.addCleanup(subprocess.run, ["umount", disk], check=True)
        self.set_up(window="1h", slide="1h")
        daemon = self.start_daemon()
        ballast = disk / "ballast"
        ballast.write_bytes(b"\0" * (shutil.disk_usage(disk).free - 500_000))
        self.replay(self.write_csv(), "--speed", "max")
        self.assert_held_back_until(daemon, "has no room to grow", ballast.unlink)

    def test_a_file_size_limit_holds_the_sources_back_until_it_is_raised(self):
        self.set_up(window="1h", slide="1h")
        daemon = self.start_daemon()
        limits = resource.prlimit(daemon.process.pid, resource.RLIMIT_FSIZE)

        def limit(size):
            resource.prlimit(daemon.process.pid, resource.RLIMIT_FSIZE, (size, limits[1]))

        limit(500_000)
        self.replay(self.write_csv(), "--speed", "max")
        self.assert_held_back_until(daemon, "has no room to grow", lambda: limit(limits[0]))

    def test_storage_that_fails_is_an_alarm_until_it_works(self):
        self.set_up(window="1h", slide="1h")
        daemon = self.start_daemon()
        self.replay_all(self.write_csv(200))
        self.wait_idle()

        def overview():
            code, text = self.reident("overview", "--config", self.folder / "reident.toml",
                                      "--json")
            return code, [alarm["code"] for alarm in json.loads(text)["alarms"]]

        def change(statement):
            with sqlite3.connect(self.database) as connection:
                connection.execute(statement)
            connection.close()

        self.assertNotIn("disk", overview()[1])
        change("CREATE TRIGGER fault BEFORE INSERT ON recent BEGIN "
               "SELECT RAISE(FAIL, 'a fault of the test'); END")
        self.replay(self.write_csv(200, first=200), "--speed", "max", "--first-sequence", 201)
        self.wait_for_error("a fault of the test")
        wait_until(lambda: overview() == (1, ["disk"]), "the overview shows the alarm")
        change("DROP TRIGGER fault")
        wait_until(lambda: "disk" not in overview()[1], "the alarm is cleared")
        self.assert_all_stored_once(400)
        self.assertEqual(daemon.terminate()[0], 0, daemon.text())

    # -- rights

    def user(self):
        """Somebody whom file permissions bind."""
        if os.geteuid() != 0:
            return None
        if subprocess.run(["setpriv", f"--reuid={NOBODY}", f"--regid={NOBODY}", "--clear-groups",
                           os.environ["REIDENT_BIN"] + "/reidentd", "--version"],
                          capture_output=True, check=False).returncode != 0:
            self.skipTest("another user may not run the programs")
        for path in [self.folder, *self.folder.rglob("*")]:
            os.chown(path, NOBODY, NOBODY)
        return NOBODY

    def test_lost_permissions_stop_no_running_service_and_are_named_at_the_next_start(self):
        self.set_up(window="1h", slide="1h")
        user = self.user()
        daemon = self.start_daemon(user)
        disk = self.database.parent
        self.addCleanup(disk.chmod, 0o755)
        self.database.chmod(0o444)
        disk.chmod(0o555)
        self.replay_all(self.write_csv())
        self.assert_all_stored_once()
        self.assertEqual(daemon.terminate()[0], 0, daemon.text())

        refused = self.start("reidentd", "--config", self.folder / "reident.toml", user=user)
        self.assertEqual(refused.wait(), 1)
        self.assertIn("cannot be written", refused.text())
        self.assertIn("permissions", refused.text())
        disk.chmod(0o755)
        self.database.chmod(0o644)
        self.start_daemon(user)
        self.assert_all_stored_once()

    # -- files that are taken away or cut while the service runs

    def test_a_database_that_is_moved_away_is_missed_and_taken_up_again(self):
        self.set_up(window="1h", slide="1h")
        daemon = self.start_daemon()
        away = self.folder / "away.db"
        self.replay(self.write_csv(), "--speed", "max")
        wait_until(self.stored, "telemetry is being stored")
        self.database.rename(away)
        self.assert_held_back_until(daemon, "deleted or moved while it was in use",
                                    lambda: away.rename(self.database))

    def test_a_log_that_is_deleted_is_missed_and_its_commits_are_saved_at_the_stop(self):
        self.set_up(window="1h", slide="1h")
        daemon = self.start_daemon()
        csv = self.write_csv()
        replay = self.replay(csv, "--speed", "max")
        wait_until(self.stored, "telemetry is being stored")
        (self.folder / "disk" / "reident.db-wal").unlink()
        self.wait_for_error("stop process")
        stored = self.status()["samples_stored"]
        self.assertTrue(replay.running(), "the sender waits")
        self.assertEqual(daemon.terminate()[0], 1, "what was queued could not be stored")
        self.assertIn("telemetry could not be stored", daemon.text())
        replay.kill()
        self.start_daemon()
        self.assertEqual(self.stored(), stored)
        self.replay_all(csv)
        self.wait_idle()
        self.assertEqual(self.stored(), 3 * ROWS)

    def test_a_database_that_is_cut_is_not_written_any_more(self):
        self.set_up(window="1h", slide="1h")
        self.start_daemon().terminate()
        daemon = self.start_daemon()
        replay = self.replay(self.write_csv(), "--speed", "max")
        wait_until(self.stored, "telemetry is being stored")
        os.truncate(self.database, 8192)
        self.wait_for_error("was cut short")
        self.assertTrue(replay.running(), "the sender waits")
        self.assertEqual(daemon.terminate()[0], 1)
        self.assertGreater((self.folder / "disk" / "reident.db-wal").stat().st_size, 0)
        self.assert_refused("was cut short")

    # -- damage that is found at the start

    def assert_refused(self, *words):
        refused = self.start("reidentd", "--config", self.folder / "reident.toml")
        self.assertEqual(refused.wait(), 1, refused.text())
        for word in (*words, str(self.database)):
            self.assertIn(word, refused.text())

    def test_a_database_that_cannot_be_used_is_refused_with_what_would_mend_it(self):
        self.set_up(window="1h", slide="1h")
        daemon = self.start_daemon()
        self.replay_all(self.write_csv(200))
        self.wait_idle()
        daemon.terminate()
        whole = self.database.read_bytes()

        def newer():
            with sqlite3.connect(self.database) as connection:
                connection.execute("PRAGMA user_version = 99")
            connection.close()

        link = self.folder / "link.db"
        table = [
            (newer, "use a newer reident"),
            (lambda: self.database.write_bytes(b"time,V_BUS\n" * 999), "is not a database"),
            (lambda: self.database.write_bytes(b""), "restore a backup"),
            (lambda: self.database.write_bytes(whole[:8192]), "restore a backup"),
            (lambda: self.database.write_bytes(whole[:-1]), "restore a backup"),
            (lambda: self.database.write_bytes(whole[:100] + b"\xff" + whole[101:]), "is damaged"),
            (lambda: os.link(self.database, link), "hard links"),
        ]
        for damage, words in table:
            with self.subTest(words):
                damage()
                self.assert_refused(words)
                link.unlink(missing_ok=True)
                self.database.write_bytes(whole)
        self.start_daemon()
        self.assertEqual(self.stored(), 600)

    def test_a_second_writer_is_refused_and_told_who_writes(self):
        self.set_up(window="1h", slide="1h")
        daemon = self.start_daemon()
        link = self.folder / "other-name.db"
        link.symlink_to(self.database)
        other = self.folder / "other.toml"
        other.write_text((self.folder / "reident.toml").read_text().replace(
            "disk/reident.db", "other-name.db"))
        for config in (self.folder / "reident.toml", other):
            code, text = self.reident("backfill", "--config", config)
            self.assertNotEqual(code, 0)
            self.assertIn(f"is in use by process {daemon.process.pid}", text)

    # -- a shard that is lost

    def alarms(self):
        text = self.reident("overview", "--json", "--config", self.folder / "reident.toml")[1]
        return [alarm["text"] for alarm in json.loads(text)["alarms"] if alarm["code"] == "damage"]

    def test_late_samples_of_a_lost_shard_wait_and_hold_nothing_back(self):
        self.set_up()
        daemon = self.start_daemon()
        self.replay_rows("old", count=600, first=NEW_YEAR - 1200)
        daemon.terminate()
        code, text = self.reident("archive", "split", self.database, "--before", 2021)
        self.assertEqual(code, 0, text)
        shards = self.database.with_name("reident.db.shards")
        away = shards.rename(self.folder / "away")

        daemon = self.start_daemon()
        self.replay_rows("late", count=50, first=NEW_YEAR - 900)
        self.replay_rows("now", count=100, first=NEW_YEAR)
        self.assertEqual(self.stored(), 3 * 700, "what is of now is stored")
        self.assertEqual(self.query("SELECT count(*) FROM postponed_sample")[0][0], 3 * 50)
        wait_until(lambda: any(str(shards) in text for text in self.alarms()), "an alarm names it")

        daemon.terminate()
        away.rename(shards)
        self.start_daemon()
        self.replay_rows("more", count=10, first=NEW_YEAR + 100)
        self.assertEqual(self.query("SELECT count(*) FROM postponed_sample")[0][0], 0)
        wait_until(lambda: not self.alarms(), "the alarm is over")
        self.assertEqual(self.stored(), 3 * 710)
        code, text = self.reident("verify", self.database)
        self.assertEqual(code, 0, text)

    # -- damaged samples

    def damage(self, table, column, condition="1"):
        """Flips a bit in the middle of blobs, as a disk does; returns how many."""
        with sqlite3.connect(self.database) as connection:
            rows = connection.execute(
                f"SELECT rowid, {column} FROM {table} WHERE {condition}").fetchall()
            for row, blob in rows:
                middle = len(blob) // 2
                bad = blob[:middle] + bytes([blob[middle] ^ 1]) + blob[middle + 1:]
                connection.execute(f"UPDATE {table} SET {column} = ? WHERE rowid = ?", (bad, row))
        connection.close()
        return len(rows)

    def test_a_damaged_chunk_gives_its_windows_a_verdict_and_stops_nothing_else(self):
        self.set_up(batch_frames=2, window="20min")  # small batches fill chunks soon
        daemon = self.start_daemon()
        self.replay_rows("first", count=1300)
        approved = self.champion()
        self.assertIsNotNone(approved)
        daemon.terminate()
        damaged = self.damage("chunk_data", "bytes", "id IN (SELECT data FROM chunk JOIN series ON "
                              "series.id = chunk.series WHERE parameter = (SELECT id FROM parameter "
                              "WHERE name = 'out'))")
        self.assertGreater(damaged, 0)

        self.set_up(batch_frames=512, window="20min")
        daemon = self.start_daemon()
        self.replay_rows("second", count=300, first=1300)
        outcomes = self.query("SELECT outcome, reason FROM history WHERE cause = 'slide' "
                              "ORDER BY window_end DESC")
        self.assertEqual(outcomes[0][0], "telemetry_damaged")
        self.assertIn("samples of out of SAT", outcomes[0][1])
        self.assertEqual(self.champion(), approved, "what was published stays")

        self.assertTrue(daemon.running())
        daemon.terminate()

        self.set_up(batch_frames=2, window="20min")
        daemon = self.start_daemon()
        self.replay_rows("third", count=2400, first=1600)
        self.assertTrue(daemon.running())
        self.assertIn("set damaged samples aside", daemon.text())
        self.assertIn("samples of out of SAT", self.status()["last_error"])
        self.assertGreater(self.query("SELECT count(*) FROM damaged_chunk")[0][0], 0)
        newest = self.query("SELECT outcome FROM history ORDER BY window_end DESC LIMIT 1")[0][0]
        self.assertNotEqual(newest, "telemetry_damaged", "windows behind the damage are tried")
        self.assertEqual(self.query("SELECT frames FROM telemetry_source")[0][0], 4000)

        daemon.terminate()
        with sqlite3.connect(self.database) as connection:
            connection.execute("DROP TRIGGER attempt_update")
            connection.execute("UPDATE attempt SET spacecraft = 'ANOTHER' WHERE id = "
                               "(SELECT attempt FROM version WHERE number = ?)", (approved,))
        connection.close()
        status, text = self.reident("show", f"SAT/PLANT@{approved}", "--config",
                                    self.folder / "reident.toml")
        self.assertEqual(status, 1, text)
        self.assertIn("has lost its attempt", text)


if __name__ == "__main__":
    sys.exit(unittest.main())
