"""A month of telemetry at speed, while what can fail fails at random: two real services of a pair on
machines of their own, and the ground, which sends, orders and runs a simulator.

    soak.py BUILD [--minutes N] [--speed N] [--seed N] [--quick]

A machine is a network namespace with a disk in memory and, with libfaketime, a clock of its own. One
thing fails at a time: a service is killed, stopped, hangs; a disk is full; a clock is set; a network
is cut. It is mended, and the next one comes once both services are in step again. At 300 times real
time 144 minutes are a month. Needs root. The last line is one JSON object.
"""

import argparse
import csv
import json
import os
import random
import re
import signal
import subprocess
import sys
import time
from collections import Counter
from contextlib import suppress
from pathlib import Path

HERE = Path(__file__).resolve().parent
sys.path.insert(0, str(HERE.parents[1] / "e2e"))

FAKETIME = "/usr/lib/x86_64-linux-gnu/faketime/libfaketimeMT.so.1"
DISK_MIB = 600
START = "2017-07-01T00:00:00Z"
EQUIPMENT = {"name": "BDR", "inputs": ["I_BDRIN1", "I_BDRIN2"], "outputs": ["I_BDROUT"],
             "sample_period": "1s", "window": "200min", "slide": "100min", "cycle": "6016s"}
SETTLED_S = 60  # of a process, before its memory counts
MEMORY = 1.25, 32 << 10  # what it may grow to: times what it was, and KiB
KEPT_S, FRAME_KIB = 75, 6  # what a source keeps for a cut of 60 s


def parsed():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("build", type=Path, help="folder that the programs were built in")
    parser.add_argument("--minutes", type=float, help="how long telemetry flows (default 20)")
    parser.add_argument("--speed", type=int, default=300, help="times real time")
    parser.add_argument("--seed", type=int, default=random.SystemRandom().randint(1, 10**6))
    parser.add_argument("--quick", action="store_true", help="3 minutes, to try this script")
    arguments = parser.parse_args()
    arguments.minutes = arguments.minutes or (3 if arguments.quick else 20)
    os.environ["REIDENT_BIN"] = str(arguments.build / "tests/e2e/bin")
    os.environ.setdefault("REIDENT_E2E_DEADLINE", "180")
    return arguments


ARGUMENTS = parsed()

from harness import BIN, wait_until  # noqa: E402: found in the folder above
from pair import Host, Operator, PairOfServices, can_make_hosts  # noqa: E402


def run(*words):
    subprocess.run([*map(str, words)], check=True, capture_output=True)


def make_network(test, names):
    """Machines on one switch, by name; they go with the test."""
    addresses = {name: f"192.0.2.{number}" for number, name in enumerate(names, 1)}
    spaces = {name: f"reident-{os.getpid()}-{name}" for name in [*names, "switch"]}
    for space in spaces.values():
        run("ip", "netns", "add", space)
        test.addCleanup(subprocess.run, ["ip", "netns", "delete", space], check=False)
    switch = ["ip", "-n", spaces["switch"], "link"]
    run(*switch, "add", "bridge", "type", "bridge")
    run(*switch, "set", "bridge", "up")
    hosts = {}
    for name in names:
        run(*switch, "add", f"port-{name}", "type", "veth", "peer", "name", "cable", "netns",
            spaces[name])
        run(*switch, "set", f"port-{name}", "master", "bridge", "up")
        others = [address for other, address in addresses.items() if other != name]
        host = hosts[name] = Host(spaces[name], addresses[name], others)
        host.run("ip", "address", "add", f"{host.address}/24", "dev", "cable")
        for link in "lo", "cable":
            host.run("ip", "link", "set", link, "up")
    return hosts


class Machine:
    """Where a service of the pair runs."""

    def __init__(self, test, host, folder):
        self.host, self.disk, self.clock = host, folder / "disk", folder / "clock"
        self.disk.mkdir(parents=True)
        run("mount", "-t", "tmpfs", "-o", f"size={DISK_MIB}m", "tmpfs", self.disk)
        test.addCleanup(run, "umount", "-l", self.disk)
        self.set_clock(0)
        if Path(FAKETIME).exists():
            host.prefix += ["env", f"LD_PRELOAD={FAKETIME}", "DONT_FAKE_MONOTONIC=1",
                            f"FAKETIME_TIMESTAMP_FILE={self.clock}", "FAKETIME_NO_CACHE=1"]

    def set_clock(self, seconds):
        new = self.clock.with_suffix(".new")
        new.write_text(f"{seconds:+d}\n")
        new.rename(self.clock)

    def fill(self):
        with open(self.disk / "ballast", "wb", buffering=0) as file, suppress(OSError):
            while True:
                file.write(bytes(1 << 20))

    def make_room(self):
        (self.disk / "ballast").unlink()


class Life:
    """What a process takes while it lives; `kept_kib` it may keep for others."""

    def __init__(self, process, kept_kib=0):
        self.process, self.kept_kib = process, kept_kib
        self.began, self.looks = time.monotonic(), []

    def look(self):
        folder = Path(f"/proc/{self.process.process.pid}")
        try:
            kib = int(re.search(r"VmRSS:\s+(\d+)", (folder / "status").read_text())[1])
            files = len(list((folder / "fd").iterdir()))
        except (OSError, TypeError):
            return
        self.looks.append((time.monotonic() - self.began, kib, files))

    def settled(self):
        return [look for look in self.looks if look[0] > SETTLED_S]

    def growth(self):
        """Growth of memory [KiB] and files, from the first look at the settled process to the last."""
        looks = self.settled()
        return (looks[-1][1] - looks[0][1], looks[-1][2] - looks[0][2]) if looks else (0, 0)

    def grew(self):
        looks = self.settled()
        if not looks:
            return False
        times, more = MEMORY
        may_be = looks[0][1] * times + more + self.kept_kib
        return looks[-1][1] > may_be or looks[-1][2] > looks[0][2] + 8


class Soak(PairOfServices):
    def setUp(self):
        super().setUp()
        self.randoms = random.Random(ARGUMENTS.seed)
        self.hosts = make_network(self, ["2", "1", "ground"])
        self.ground = self.hosts["ground"]
        self.machines = {side: Machine(self, self.hosts[str(side)], self.folder / str(side))
                         for side in (2, 1)}
        self.sides, self.lives, self.failures = {}, [], Counter()
        self.committed, self.contents = set(), set()
        self.rate = ARGUMENTS.speed
        text = self.configure([EQUIPMENT], spacecraft="REFERENCE").read_text()
        text = text.replace("[dds]", f'[dds]\ncut = "60s"\nrate = "{self.rate}/s"')
        for side, machine in self.machines.items():
            (self.folder / f"{side}.toml").write_text(
                text.replace('"reident.db"', f'"{machine.disk}/{side}.db"').replace(
                    '"debug"', '"info"').replace(
                    "[service]", f"[service]\nstandby = true\nstrength = {side}"))

    def database_of(self, side):
        return self.machines[side].disk / f"{side}.db"

    def start_side(self, strength, **options):
        super().start_side(strength, host=self.machines[strength].host, **options)
        self.lives.append(Life(self.sides[strength]))

    def statuses(self, host=None):
        return super().statuses(host or self.ground)

    # -- what fails, and is mended

    def kill(self, side):
        self.sides[side].kill()
        self.note_rows(side)
        time.sleep(self.randoms.choice((0, 0, 1, 4)))
        self.start_side(side)

    def stop(self, side):
        status, _ = self.sides[side].terminate()
        self.assertEqual(status, 0, self.sides[side].text()[-2000:])
        self.note_rows(side)
        time.sleep(self.randoms.choice((0, 2)))
        self.start_side(side)

    def hang(self, side):
        self.sides[side].signal(signal.SIGSTOP)
        time.sleep(self.randoms.uniform(0.3, 8))
        self.sides[side].signal(signal.SIGCONT)

    def fill_disk(self, side):
        self.machines[side].fill()
        time.sleep(self.randoms.uniform(1, 9))
        self.note_rows(side)
        self.machines[side].make_room()

    def set_clock(self, side):
        self.machines[side].set_clock(self.randoms.choice((-1, 1)) *
                                      self.randoms.choice((90, 7200, 3 * 86400)))

    def cut(self, side):
        host = self.hosts[str(side)]
        others = self.randoms.choice((host.others, [self.hosts[str(3 - side)].address],
                                      [self.ground.address]))
        host.cut(others)
        time.sleep(self.randoms.uniform(0.5, 15))
        for one in 1, 2:
            self.note_rows(one)
        host.heal()

    def fail_once(self):
        what = self.randoms.choice((self.kill, self.kill, self.stop, self.hang, self.fill_disk,
                                    self.cut, self.cut, self.set_clock))
        side = self.randoms.choice((1, 2))
        self.failures[what.__name__] += 1
        print(f"{time.monotonic() - self.began:7.1f} s: {what.__name__} {side}", flush=True)
        what(side)

    # -- what must hold

    def note_rows(self, side):
        """What was committed by now, wherever it goes."""
        self.committed |= set(self.ask(side, "SELECT version, kind, actor, time FROM decision"))
        self.contents |= set(self.ask(
            side, "SELECT number, time || digest FROM version JOIN attempt ON attempt.id = attempt"))

    def in_step(self):
        for process in self.sides.values():
            self.assertTrue(process.running(), process.text()[-3000:])
        return any(self.leads(side, follower=3 - side) for side in (1, 2))

    def look_at_processes(self):
        for life in self.lives:
            if life.process.running():
                life.look()

    def run_failures(self, source):
        self.began = time.monotonic()
        while source.running():
            self.fail_once()
            wait_until(self.in_step, "one leads and the other has all rows")
            self.look_at_processes()
            time.sleep(self.randoms.uniform(0, 4))
            self.look_at_processes()

    def assert_all_telemetry(self, frames):
        truth = self.folder / "truth.csv"
        run(BIN / "satcs-reference", "--start", START, "--duration", f"{frames}s", "--seed",
            ARGUMENTS.seed, "--csv", truth)
        with open(truth, newline="", encoding="ascii") as file:
            rows = csv.reader(file)
            names = next(rows)
            column = names.index("V_BUS")
            cells, values = 0, []
            for row in rows:
                cells += sum(cell != "" for cell in row) - 1
                values.append(float(row[column]))
        for side in 1, 2:
            def stored(side=side):
                return self.ask(side, "SELECT sum(samples) FROM series")[0][0]
            try:
                wait_until(lambda: stored() == cells, f"side {side} has all samples")
            except AssertionError:
                self.fail(f"side {side} has {stored()} of {cells} samples")
            self.assertEqual(self.ask(side, "SELECT sum(missing) FROM telemetry_source"), [(0,)])
            out = self.folder / f"{side}.csv"
            status, text = self.reident("export", self.database_of(side), "--parameter", "V_BUS",
                                        "-o", out)
            self.assertEqual(status, 0, text)
            with open(out, newline="", encoding="utf-8") as file:
                exported = [float(row["value"]) for row in csv.DictReader(file)]
            self.assertEqual(len(exported), frames)
            self.assertTrue(exported == values, f"side {side} has other values of V_BUS")
        return cells

    def registry_figures(self, operator):
        """Decisions and numbers that are gone or given twice."""
        for side in 1, 2:
            self.note_rows(side)
        final = set(self.ask(1, "SELECT version, kind, actor, time FROM decision"))
        overruled = set(self.ask(1, "SELECT version, kind, actor, time FROM overruled_decision"))
        kept = {actor for actor, in self.ask(
            1, "SELECT actor FROM command UNION "
               "SELECT row_json ->> 'actor' FROM overruled WHERE kind = 'command'")}
        numbers = Counter(number for number, _ in self.contents)
        known = set(self.ask(
            1, "SELECT number, digest FROM version UNION "
               "SELECT row_json ->> 'number', row_json ->> 'digest' FROM overruled "
               "WHERE kind = 'version'"))
        heard = [json.loads(line) for line in self.heard.out.read_text().splitlines()[1:] if line]
        return {"decisions_committed": len(self.committed), "decisions_overruled": len(overruled),
                "decisions_lost": len(self.committed - final - overruled),
                "commands_answered": len(operator.answered),
                "commands_lost": len(set(operator.answered) - kept),
                "numbers_doubled": sum(count > 1 for count in numbers.values()),
                "publications": len(heard),
                "publications_undecided": sum((one["version"], one["digest"]) not in known
                                              for one in heard)}

    def test_soak(self):
        frames = round(ARGUMENTS.minutes * 60 * ARGUMENTS.speed)
        self.start_both()
        self.heard = self.start("hear_versions", self.domain, self.partition, name="heard",
                                host=self.ground)
        trainer = self.start("reident-simulator", "--spacecraft", "REFERENCE", "--equipment", "BDR",
                             "--name", "trainer", "--json", "--cache", self.folder / "cache",
                             *self.endpoint(), name="trainer", host=self.ground)
        source = self.start(
            "satcs-reference", "--start", START, "--duration", f"{frames}s", "--seed",
            ARGUMENTS.seed, "--speed", ARGUMENTS.speed, "--cut", "60s", "--rate",
            f"{self.rate}/s", "--wait-readers", 1, "--linger", "30s", "--json", *self.endpoint(),
            name="source", host=self.ground)
        operator = Operator(self, "BDR", self.ground, pause_s=3)
        operator.start()
        self.lives += [Life(source, KEPT_S * self.rate * FRAME_KIB), Life(trainer), Life(self.heard)]
        try:
            self.run_failures(source)
        finally:
            operator.stopping = True
            operator.join()
        self.assertEqual(source.wait(), 0, source.text()[-2000:])
        wait_until(self.in_step, "one leads and the other has all rows")
        for side in 1, 2:
            self.assert_verified(side)
        cells = self.assert_all_telemetry(frames)
        self.assert_same_rows()
        champion = self.champion_of(1)
        wait_until(lambda: not champion or self.runs(trainer)[-1:] == [champion],
                   "what runs is what was decided")
        figures = self.registry_figures(operator)
        grown = [life for life in self.lives if life.grew()]
        self.figures = {
            "soak_minutes": ARGUMENTS.minutes, "soak_speed": ARGUMENTS.speed,
            "soak_seed": ARGUMENTS.seed,
            "soak_days_of_telemetry": round(frames / 86400, 2), "soak_samples": cells,
            "soak_samples_missing": 0, "soak_failures": dict(sorted(self.failures.items())),
            **{f"soak_{name}": value for name, value in figures.items()},
            "soak_memory_growth_mib": round(max(life.growth()[0] for life in self.lives
                                                if not life.kept_kib) / 1024, 1),
            "soak_files_growth": max(life.growth()[1] for life in self.lives)}
        print(json.dumps(self.figures), flush=True)
        for name in "decisions_lost", "commands_lost", "numbers_doubled", "publications_undecided":
            self.assertEqual(figures[name], 0, name)
        self.assertEqual([(life.process.log.stem, life.looks) for life in grown], [])

    def assert_verified(self, side):
        status, text = self.reident("verify", self.database_of(side))
        self.assertEqual(status, 0, text)


def main():
    print(f"seed: {ARGUMENTS.seed}", flush=True)
    if not can_make_hosts():
        print(json.dumps({"left_out": {"soak": "needs root, ip, nft and network namespaces"}}))
        return
    case = Soak("test_soak")
    result = case.run()
    if not result.wasSuccessful():
        sys.exit("\n".join(text for _, text in result.errors + result.failures))
    left_out = {} if Path(FAKETIME).exists() else {
        "clocks that are set": "without libfaketime (package faketime)"}
    print(json.dumps({**case.figures, "left_out": left_out}))


if __name__ == "__main__":
    main()
