"""Operators decide: over DDS while the service runs, on its database while it does not."""

import json
import random
import subprocess
import sys
import threading
import unittest

import plant
from harness import BIN, DEADLINE_S, EndToEnd, wait_until


class Operators(EndToEnd):
    def order(self, *arguments, actor="Ana"):
        """Runs an operator's command; returns its exit status and its JSON object."""
        done = subprocess.run(
            [str(BIN / "reident"), *map(str, arguments), "--actor", actor, "--json", "--config",
             str(self.folder / "reident.toml"), "--timeout", str(DEADLINE_S)],
            capture_output=True, text=True, timeout=2 * DEADLINE_S, check=False)
        self.assertTrue(done.stdout, f"{done.returncode}: {done.stderr}")
        return done.returncode, json.loads(done.stdout)

    def done(self, *arguments, **keywords):
        status, answer = self.order(*arguments, **keywords)
        self.assertEqual((status, answer["ok"]), (0, True), answer)
        return answer

    def refused(self, *arguments, **keywords):
        status, answer = self.order(*arguments, **keywords)
        self.assertEqual((status, answer["ok"]), (2, False), answer)
        return answer["reply"]

    def statuses(self):
        return dict(self.query("SELECT version, status FROM model_version ORDER BY version"))

    def waiting(self):
        return [version for version, status in self.statuses().items() if status == "waiting"]

    def champions(self, count):
        """Flies so many plants, each unlike the one before; returns the versions approved."""
        for i in range(count):
            self.replay_rows(f"plant-{i}", count=1900, first=1900 * i, gain=1.0 + i)
        approved = [version for version, in self.query(
            "SELECT version FROM decision WHERE kind = 'approve' ORDER BY id")]
        self.assertGreaterEqual(len(approved), count, self.query("SELECT * FROM history"))
        return approved

    def test_a_waiting_candidate_is_approved_over_dds_and_reaches_the_simulator(self):
        self.configure([plant.equipment(approval="by_hand")])
        self.start_daemon()
        simulator = self.start_simulator("trainer")
        self.replay_rows("first", count=1900)
        waiting = self.waiting()
        self.assertGreater(len(waiting), 1, self.statuses())
        self.assertIsNone(self.champion())
        self.assertEqual(self.runs(simulator), [])

        first, second = waiting[:2]
        answer = self.done("approve", "PLANT", first, "--reason", "seen on two passes")
        self.assertEqual(answer["by"], "service")
        wait_until(lambda: self.runs(simulator) == [first], "the simulator runs it")
        self.assertEqual(self.champion(), first)
        self.assertIn("it is the champion, approved by Ana at ",
                      self.refused("approve", "SAT/PLANT", first, "--reason", "again"))
        self.done("reject", "PLANT", second, "--reason", "judged too early")
        self.assertEqual(self.statuses()[second], "rejected")

    def test_rollback_withdrawal_and_hold_reach_simulators(self):
        self.configure([plant.equipment()])
        self.start_daemon()
        simulator = self.start_simulator("trainer")
        versions = self.champions(3)
        last, before = versions[-1], versions[-2]
        wait_until(lambda: self.runs(simulator)[-1:] == [last], "the champion runs")

        self.assertIn("'reident hold SAT/PLANT'", self.done("rollback", "PLANT")["reply"])
        wait_until(lambda: self.runs(simulator)[-1] == before, "the simulator rolled back")
        self.done("rollback", "PLANT", "--to", last)
        wait_until(lambda: self.runs(simulator)[-1] == last, "and forth")
        self.done("withdraw", "PLANT", last, "--reason", "wrong sensor")
        wait_until(lambda: self.runs(simulator)[-1] == before, "the previous one is back")
        self.assertIn("it was withdrawn by Ana",
                      self.refused("rollback", "PLANT", "--to", last))
        self.assertIn("it was withdrawn by Ana",
                      self.refused("withdraw", "PLANT", last, "--reason", "again"))

        self.done("hold", "PLANT", "--reason", "training")
        self.replay_rows("held", count=1900, first=1900 * 3, gain=5.0)
        self.assertEqual(self.champion(), before)
        self.assertEqual(self.runs(simulator)[-1], before)
        self.assertIn("is held already by Ana", self.refused("hold", "PLANT", actor="Bo"))
        # A console that has neither the configuration nor the database.
        status, text = self.reident("release", "PLANT", "--actor", "Bo", *self.endpoint())
        self.assertEqual(status, 0, text)
        self.assertIn("it was held by Ana", text)
        self.replay_rows("released", count=1900, first=1900 * 4, gain=5.0)
        self.assertGreater(self.champion(), last)
        wait_until(lambda: self.runs(simulator)[-1] == self.champion(), "the next one runs")

    def test_an_operator_asks_for_the_window_that_ends_where_telemetry_ends(self):
        self.configure([plant.equipment()])
        self.start_daemon()
        self.replay_rows("first", count=1300)
        windows = self.query("SELECT window_end FROM attempt ORDER BY id")
        self.assertIn("is due now", self.done("identify-now", "PLANT")["reply"])
        self.wait_idle()
        after = self.query("SELECT window_end, cause FROM attempt ORDER BY id")
        self.assertEqual([end for end, _ in after[:-1]], [end for end, in windows])
        end, cause = after[-1]
        self.assertGreater(end, windows[-1][0])
        self.assertLess(end - windows[-1][0], 300 * 10**9, "it ends between two slides")
        self.assertEqual(cause, "asked by Ana")

    def test_without_any_champion_late_simulators_get_none_and_running_ones_go_on(self):
        self.configure([plant.equipment()])
        daemon = self.start_daemon()
        early = self.start_simulator("early")
        for version in reversed(self.champions(1)):
            last = self.done("withdraw", "PLANT", version, "--reason", "wrong sensor")
        self.assertIn("no champion is left", last["reply"])
        self.assertIsNone(self.champion())
        running = self.runs(early)[-1]
        late = self.start_simulator("late")
        daemon.terminate()
        self.start_daemon()
        self.replay_rows("next", count=1300, first=1300, gain=2.0)
        wait_until(lambda: self.runs(late), "the next champion runs")
        self.assertGreater(min(self.runs(late)), running)

    def test_of_two_operators_at_once_one_decides_and_the_other_is_told(self):
        self.configure([plant.equipment(approval="by_hand")])
        self.start_daemon()
        self.replay_rows("first", count=1900)
        version = self.waiting()[0]
        answers = {}

        def decide(actor, action):
            answers[actor] = self.order(action, "PLANT", version, "--reason", "mine", actor=actor)

        threads = [threading.Thread(target=decide, args=pair)
                   for pair in (("Ana", "approve"), ("Bo", "reject"))]
        for thread in threads:
            thread.start()
        for thread in threads:
            thread.join()
        (winner,) = [actor for actor, (status, _) in answers.items() if status == 0]
        (loser,) = [actor for actor, (status, _) in answers.items() if status == 2]
        self.assertRegex(answers[loser][1]["reply"],
                         f"is not waiting: it .*(approved|rejected) by {winner} at ")
        self.assertEqual(self.query("SELECT actor FROM decision WHERE version = ? AND actor != 'gate'",
                                    version), [(winner,)])

    def test_without_a_service_the_database_is_decided_on_and_the_next_service_publishes_it(self):
        self.configure([plant.equipment()])
        daemon = self.start_daemon()
        versions = self.champions(2)
        self.assertEqual(daemon.terminate()[0], 0)
        answer = self.done("rollback", "PLANT")
        self.assertEqual((answer["by"], answer["version"]), ("file", versions[-2]))
        before = self.query("SELECT count(*) FROM command")
        status, text = self.reident("at", "2100-01-01", "--database", self.database, "--json")
        self.assertEqual(status, 0, text)
        champion = json.loads(text)["equipment"][0]["champion"]
        self.assertEqual((champion["version"], champion["actor"]), (versions[-2], "Ana"))
        self.start_daemon()
        simulator = self.start_simulator("late")
        wait_until(lambda: self.runs(simulator) == [versions[-2]], "what was decided is published")
        self.assertEqual(self.query("SELECT count(*) FROM command"), before)

    def test_killed_at_any_moment_a_service_publishes_what_was_decided(self):
        self.configure([plant.equipment()])
        daemon = self.start_daemon()
        versions = self.champions(3)
        moments = random.Random(20170717)
        sent = 0
        for crash in range(5):
            stop = threading.Event()
            answers = []

            def operate():
                while not stop.is_set():
                    target = versions[len(answers) % len(versions)]
                    answers.append(self.order("rollback", "PLANT", "--to", target))

            operator = threading.Thread(target=operate)
            operator.start()
            wait_until(lambda: answers, "an operator is at work")
            stop.wait(moments.uniform(0, 0.3))
            daemon.kill()
            stop.set()
            operator.join()  # the last command was answered by the service, or on its file
            sent += len(answers)
            decided = self.champion()
            daemon = self.start_daemon()
            simulator = self.start_simulator(f"late-{crash}")
            wait_until(lambda: self.runs(simulator), "a champion is published")
            self.assertEqual(self.runs(simulator), [decided])
            self.assertEqual(self.champion(), decided)
            simulator.terminate()
        self.assertEqual(self.query("SELECT count(*), sum(ok) FROM command"),
                         self.query("SELECT ?, count(*) FROM decision WHERE actor = 'Ana'", sent),
                         "each command was carried out once")


if __name__ == "__main__":
    sys.exit(unittest.main())
