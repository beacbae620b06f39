"""Sweeps with real processes: tasks that are killed, that run twice, and those of a Slurm cluster."""

import json
import signal
import subprocess
import unittest

import plant
import slurm
from harness import BIN, EndToEnd, wait_until

SPACECRAFT = ["SAT-1", "SAT-2"]


class Sweep(EndToEnd):
    def setUp(self):
        super().setUp()
        self.configs = []
        for number, spacecraft in enumerate(SPACECRAFT):
            self.configure([plant.equipment(slide="2min", bias="approve", baseline_mrse=50.0)],
                           spacecraft=spacecraft)
            config = self.folder / f"{spacecraft}.toml"
            database = self.folder / f"{spacecraft}.db"
            config.write_text((self.folder / "reident.toml").read_text()
                              .replace('"reident.db"', f'"{database.name}"'))
            self.configs.append(config)
            csv = plant.write(self.folder / "rows.csv",
                              list(plant.rows(2400, seed=number)) +
                              list(plant.rows(1500, first=2400, gain=1.4, seed=number)))
            self.ok("import", csv, "--db", database, "--spacecraft", spacecraft)
            self.ok("backfill", "--config", config)
        self.files = {file: file.read_bytes() for file in self.folder.glob("SAT-*.db")}

    def ok(self, *arguments):
        status, text = self.reident(*arguments)
        self.assertEqual(status, 0, text)
        return text

    def sweep(self, name, *arguments):
        return self.ok("sweep", self.folder / name, *arguments)

    def question(self):
        return ["--config", *self.configs, "--set", "window=12min"]

    def digests(self, name):
        report = json.loads(self.sweep(name, "--json"))
        return {one["name"]: one["registry_sha256"] for one in report["spacecraft"]}

    def in_one_process(self):
        self.sweep("one", *self.question())
        return self.digests("one")

    def test_killed_and_doubled_tasks_change_nothing(self):
        expected = self.in_one_process()
        report = json.loads(self.sweep("one", "--json"))
        self.assertGreaterEqual(min(one["windows"] for one in report["spacecraft"]), 3900 // 120)
        for one in report["spacecraft"]:
            was, would = (one["equipment"][0][side]["publications"] for side in ("was", "would"))
            self.assertGreaterEqual(len(was), 2, "the backfill published")
            self.assertNotEqual(was, would, "a longer window gives other versions")
        self.assertEqual({file: file.read_bytes() for file in self.files}, self.files,
                         "archives are only read")

        first = self.start("reident", "sweep", self.folder / "torn", *self.question())
        candidates = self.folder / "torn" / "candidates"
        wait_until(lambda: list(candidates.glob("*.json")), "a result is there")
        first.kill()
        status = json.loads(self.reident("sweep", self.folder / "torn", "--status", "--json")[1])
        self.assertGreater(status["candidates"]["left"] + status["judgement"]["left"], 0)
        twins = [self.start("reident", "sweep", self.folder / "torn") for _ in range(2)]
        self.assertEqual([twin.wait() for twin in twins], [0, 0])
        self.assertEqual(self.digests("torn"), expected)

        judged = self.folder / "torn" / "judged"
        (judged / "SAT-1.json").unlink()
        judge = self.start("reident", "sweep", self.folder / "torn", "--judge", 0)
        wait_until(lambda: list(judged.glob("SAT-1.db.*/registry.db")) or not judge.running(),
                   "the judgement has begun")
        judge.signal(signal.SIGKILL)
        judge.wait()
        self.assertEqual(self.digests("torn"), expected)

    def test_a_failed_task_is_named_and_repeated(self):
        archive = self.folder / "SAT-2.db"
        self.sweep_plan_only("broken")
        moved = archive.rename(self.folder / "away.db")
        status, text = self.reident("sweep", self.folder / "broken")
        self.assertEqual(status, 1, text)
        state = json.loads(self.reident("sweep", self.folder / "broken", "--status", "--json")[1])
        self.assertGreater(len(state["candidates"]["failures"]), 0)
        self.assertIn("SAT-2.db", state["candidates"]["failures"][0]["reason"])
        self.assertEqual(state["judgement"]["done"], 1, "SAT-1 does not wait for SAT-2")
        moved.rename(archive)
        self.assertEqual(self.digests("broken"), self.in_one_process())

    def test_a_folder_that_cannot_be_written_is_named(self):
        self.sweep_plan_only("sealed")
        candidates = self.folder / "sealed" / "candidates"
        candidates.rename(self.folder / "away")
        candidates.write_text("a file")
        status, text = self.reident("sweep", self.folder / "sealed")
        self.assertEqual(status, 1, text)
        self.assertIn("sealed/candidates", text)

    def sweep_plan_only(self, name):
        """Plans, and does nothing but the first task."""
        status, text = self.reident("sweep", self.folder / name, *self.question(), "--task", 0)
        self.assertEqual(status, 0, text)

    def submit(self, name, *arguments):
        """Returns the cluster that has the tasks now."""
        cluster = slurm.Cluster(self.folder / "slurm")
        self.addCleanup(cluster.end)
        done = subprocess.run(
            [BIN / "reident", "sweep", self.folder / name, *arguments, "--slurm", "--json"],
            env=cluster.environment, capture_output=True, text=True, timeout=60, check=False)
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertEqual(len(done.stdout.splitlines()), 2, "two arrays")
        return cluster

    @unittest.skipIf(slurm.missing(), slurm.missing())
    def test_a_slurm_array_gives_the_bits_of_one_machine(self):
        expected = self.in_one_process()
        cluster = self.submit("array", *self.question(), "--copy")
        cluster.wait(lambda: len(cluster.running()) == 2, "both nodes work")
        for task in cluster.running():
            cluster.command("scontrol", "requeue", task)
        cluster.command("scontrol", "update", "NodeName=n2", "State=DRAIN", "Reason=test")
        cluster.wait(cluster.idle, "all jobs have ended", 180)
        status, text = self.reident("sweep", self.folder / "array", "--status", "--json")
        self.assertEqual(status, 0, text + "".join(
            log.read_text() for log in (self.folder / "array/logs").iterdir()))
        self.assertEqual(self.digests("array"), expected)

    @unittest.skipIf(slurm.missing(), slurm.missing())
    def test_tasks_that_fail_in_a_slurm_array_keep_no_other_spacecraft(self):
        self.sweep_plan_only("array")
        (self.folder / "SAT-2.db").rename(self.folder / "away.db")
        cluster = self.submit("array")
        cluster.wait(cluster.idle, "all jobs have ended", 180)
        state = json.loads(self.reident("sweep", self.folder / "array", "--status", "--json")[1])
        self.assertEqual(state["judgement"]["done"], 1)
        self.assertEqual([one["task"] for one in state["judgement"]["failures"]], [1])
        self.assertIn("candidates task", state["judgement"]["failures"][0]["reason"])


if __name__ == "__main__":
    unittest.main()
