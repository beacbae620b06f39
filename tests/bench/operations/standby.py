"""Two real services of a pair: how soon the other one takes over, and what is lost.

    standby.py BUILD [--quick] [--kills=N]

Prints what was measured and, as the last line, one JSON object. Times are from the kill, or from
SIGSTOP, to the publication by the other service as a simulator in another process hears it.
"""

import argparse
import json
import os
import random
import signal
import statistics
import sys
import time
from pathlib import Path

HERE = Path(__file__).resolve().parent
sys.path.insert(0, str(HERE.parents[1] / "e2e"))

SEED = 37


def other(strength):
    return 3 - strength


def parsed():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("build", type=Path, help="folder that the programs were built in")
    parser.add_argument("--quick", action="store_true", help="a few of each, to try this script")
    parser.add_argument("--kills", type=int, help="random kills (default 200)")
    arguments = parser.parse_args()
    arguments.turns = 3 if arguments.quick else 20
    arguments.kills = arguments.kills or (10 if arguments.quick else 200)
    os.environ["REIDENT_BIN"] = str(arguments.build / "tests/e2e/bin")
    return arguments


ARGUMENTS = parsed()

from harness import wait_until  # noqa: E402: found in the folder above
from pair import Operator, PairOfServices  # noqa: E402


class Standby(PairOfServices):
    """One measurement; its figures are in `figures`."""

    def setUp(self):
        super().setUp()
        self.configure_pair()
        self.start_both()
        self.leader = 2
        self.heard = self.start("hear_versions", self.domain, self.partition, name="heard")
        wait_until(lambda: self.heard.out.read_text(), "a simulator listens")
        self.replay_flight("first", 2, count=1900)
        wait_until(lambda: self.champion_of(1) and self.leads(2, follower=1),
                   "there is a champion, and both have it")

    def versions_heard(self):
        return [json.loads(line) for line in self.heard.out.read_text().splitlines()[1:] if line]

    def seconds_until_published(self, fail):
        """From the failure of the leader to what the other one publishes."""
        before = len(self.versions_heard())
        begin = time.monotonic()
        fail()
        version = wait_until(lambda: self.versions_heard()[before:], "a publication")[0]
        self.leader = other(self.leader)
        return version["at"] - begin

    def turns(self, fail, mend):
        times = []
        for _ in range(ARGUMENTS.turns):
            side = self.leader
            times.append(self.seconds_until_published(lambda side=side: fail(side)))
            mend(side)
            wait_until(lambda: self.leads(self.leader, follower=other(self.leader)),
                       "the old leader follows")
        return times

    def test_take_over(self):
        times = self.turns(lambda side: self.sides[side].kill(), self.start_side)
        self.report("kill -9 of the leader", times, 1.5)
        self.figures = {"takeover_s": max(times), "takeover_median_s": statistics.median(times),
                        "takeovers": len(times),
                        "takeovers_in_time": sum(one <= 1.5 for one in times)}

    def test_hang(self):
        times = self.turns(lambda side: self.sides[side].signal(signal.SIGSTOP),
                           lambda side: self.sides[side].signal(signal.SIGCONT))
        self.report("SIGSTOP of the leader", times, 3)
        self.figures = {"hang_s": max(times), "hang_median_s": statistics.median(times),
                        "hangs": len(times), "hangs_in_time": sum(one <= 3 for one in times)}

    @staticmethod
    def report(what, times, limit):
        print(f"{what}, {len(times)} times: the other one's publication is heard after "
              f"{statistics.median(times):.2f} s (median), {max(times):.2f} s at most; "
              f"{sum(one <= limit for one in times)} within {limit} s", flush=True)

    # -- random kills

    def decisions_of(self, strength):
        return set(self.ask(strength, "SELECT version, kind, actor, time FROM decision"))

    def contents(self, strength):
        """(number, what it is) of every version that the side knows, overruled ones too."""
        return set(self.ask(
            strength,
            "SELECT number, time || digest FROM version JOIN attempt ON attempt.id = attempt "
            "UNION SELECT version.row_json ->> 'number', "
            "             (attempt.row_json ->> 'time') || (version.row_json ->> 'digest') "
            "FROM overruled AS version JOIN overruled AS attempt "
            "  ON attempt.kind = 'attempt' AND attempt.service = version.service "
            " AND attempt.row_json ->> 'id' = version.row_json ->> 'attempt' "
            " AND attempt.position = version.position - 1 "
            "WHERE version.kind = 'version'"))

    def test_random_kills(self):
        randoms = random.Random(SEED)
        print(f"seed of the kills: {SEED}", flush=True)
        replay = self.start("satcs-replay", self.folder / "first.csv", "--spacecraft", "SAT",
                            *self.endpoint(), "--speed", "1")
        operator = Operator(self, "PLANT")
        operator.start()
        committed, contents, takeovers = set(), set(), 0
        try:
            for _ in range(ARGUMENTS.kills):
                time.sleep(randoms.uniform(0, 1))
                side = randoms.choice((1, 2))
                self.sides[side].kill()
                committed |= self.decisions_of(side)
                contents |= self.contents(side)
                time.sleep(randoms.choice((0, 0, 0.5, 1.5)))
                self.start_side(side)
                follower = self.wait_until_in_step()
                takeovers += follower != other(self.leader)
                self.leader = other(follower)
        finally:
            operator.stopping = True
            operator.join()
        replay.kill()
        wait_until(lambda: self.leads(self.leader, follower=other(self.leader)), "both are in step")
        self.assert_same_rows()
        self.count(committed, contents, operator.answered, takeovers)

    def wait_until_in_step(self):
        """The side that follows."""
        def follower():
            for side in 1, 2:
                if self.leads(other(side), follower=side):
                    return side
            return None

        return wait_until(follower, "one leads and one follows")

    def count(self, committed, contents, answered, takeovers):
        final = self.decisions_of(1)
        overruled = set(self.ask(1, "SELECT version, kind, actor, time FROM overruled_decision"))
        kept = {actor for actor, in self.ask(1, "SELECT actor FROM command")}
        contents |= self.contents(1) | self.contents(2)
        numbers = {}
        for number, content in contents:
            numbers.setdefault(number, set()).add(content)
        known = {number: digest for number, digest in self.ask(1, "SELECT number, digest FROM version")}
        heard = self.versions_heard()
        lost = len(committed - final - overruled)
        unanswered = [actor for actor in answered if actor not in kept]
        unknown = [one for one in heard if known.get(one["version"]) != one["digest"]]
        split = sum(len(one) > 1 for one in numbers.values())
        self.figures = {
            "kills": ARGUMENTS.kills, "kill_takeovers": takeovers, "decisions_committed": len(committed),
            "decisions_overruled": len(overruled), "commands_answered": len(answered),
            "decisions_lost": lost + len(unanswered) + len(unknown), "versions": len(numbers),
            "split_numbers": split}
        print(f"{ARGUMENTS.kills} random kills, {takeovers} of them with a take-over: of "
              f"{len(committed)} decisions that were ever committed {lost} are gone, "
              f"{len(overruled)} are overruled and visible; of {len(answered)} commands that were "
              f"answered {len(unanswered)} are not in the registry; of {len(heard)} publications "
              f"{len(unknown)} are not; of {len(numbers)} numbers {split} have two contents",
              flush=True)


def main():
    figures = {}
    for name in "take_over", "hang", "random_kills":
        case = Standby(f"test_{name}")
        result = case.run()
        if not result.wasSuccessful():
            sys.exit("\n".join(text for _, text in result.errors + result.failures))
        figures |= case.figures
    print(json.dumps(figures))


if __name__ == "__main__":
    main()
