"""The programs, and a real service with champions."""

import json
import os
import random
import signal
import sqlite3
import subprocess
import time
from contextlib import contextmanager
from typing import NamedTuple

DEADLINE_S = 120
SPACECRAFT = "BENCH"
INPUTS = ["U1", "U2", "U3", "U4"]
OUTPUT = "Y"
START_S = 1_600_000_200  # a multiple of the slide
# The loopback configuration of the programs themselves holds.
ENVIRONMENT = {key: value for key, value in os.environ.items() if key != "CYCLONEDDS_URI"}


class Scale(NamedTuple):
    pairs: int
    repetitions: int
    steps: int
    swaps: int
    flips: int
    ping_s: int
    simulators: int
    cycles: int


class Programs:
    def __init__(self, build):
        service, bench = build / "service", build / "tests/bench/simulator"
        self.daemon = service / "daemon/reidentd"
        self.reident = service / "cli/reident"
        self.replay = service / "satcs/satcs-replay"
        self.simulator = service / "client/reident-simulator"
        self.step = bench / "reident_step_bench"
        self.swap = bench / "reident_swap_bench"
        self.jump = bench / "reident_jump_bench"


def wait_until(condition, what):
    end = time.monotonic() + DEADLINE_S
    while not condition():
        if time.monotonic() > end:
            raise SystemExit(f"after {DEADLINE_S} s still not: {what}")
        time.sleep(0.01)


def telemetry(count):
    """A plant of order 6 at 1 Hz, as CSV."""
    generator = random.Random(1)
    poles = [0.95, 0.9, 0.8, 0.7, 0.5, 0.3]
    mix = [[generator.uniform(-1, 1) for _ in INPUTS] for _ in poles]
    states, levels = [0.0] * len(poles), [0.0] * len(INPUTS)
    lines = ["unix_s," + ",".join(INPUTS) + "," + OUTPUT]
    for k in range(count):
        for i in range(len(INPUTS)):
            if k % (7 + 4 * i) == 0:
                levels[i] = generator.uniform(-1, 1)
        y = 20 + sum(states) + generator.gauss(0, 0.01)
        lines.append(f"{START_S + k}," + ",".join(f"{u:.9g}" for u in levels) + f",{y:.9g}")
        states = [p * x + (1 - p) * sum(b * u for b, u in zip(row, levels))
                  for p, row, x in zip(poles, mix, states)]
    return "\n".join(lines) + "\n"


class Service:
    def __init__(self, programs, folder, equipment):
        self.programs, self.folder = programs, folder
        self.domain = random.SystemRandom().randint(1, 90)  # whose ports the kernel gives to nobody
        self.partition = f"bench-{os.getpid()}"
        self.endpoint = ["--domain", str(self.domain), "--partition", self.partition]
        tables = "".join(
            f'[[spacecraft.equipment]]\nname = "{name}"\ninputs = {json.dumps(INPUTS)}\n'
            f'outputs = ["{OUTPUT}"]\norder = 6\nsample_period = "1s"\nwindow = "10min"\n'
            'slide = "5min"\ncycle = "1min"\nmax_mrse = 20.0\n' for name in equipment)
        (folder / "reident.toml").write_text(
            f'[archive]\ndatabase = "reident.db"\n[dds]\ndomain = {self.domain}\n'
            f'partition = "{self.partition}"\n[limits]\nsettle = "300ms"\n'
            f'[[spacecraft]]\nname = "{SPACECRAFT}"\n{tables}')
        self.log = folder / "reidentd.log"
        with open(self.log, "w", encoding="utf-8") as log:
            self.process = subprocess.Popen(
                [programs.daemon, "--config", folder / "reident.toml"], stdout=log, stderr=log,
                env=ENVIRONMENT)
        wait_until(lambda: "service: started" in self.log.read_text(), "reidentd has started")

    def run(self, *words):
        done = subprocess.run([*map(str, words)], capture_output=True, text=True, env=ENVIRONMENT,
                              timeout=DEADLINE_S, check=False)
        if done.returncode != 0:
            raise SystemExit(f"{words}\n{done.stdout}{done.stderr}\n{self.log.read_text()[-4000:]}")
        return done.stdout

    def replay(self, rows):
        file = self.folder / "telemetry.csv"
        file.write_text(rows)
        self.run(self.programs.replay, file, "--spacecraft", SPACECRAFT, "--speed", "max",
                 *self.endpoint)
        self.run(self.programs.reident, "status", "--wait", "idle", "--timeout", DEADLINE_S,
                 *self.endpoint)

    def champions(self):
        """{equipment: version}"""
        connection = sqlite3.connect(f"file:{self.folder / 'reident.db'}?mode=ro", uri=True)
        try:
            return dict(connection.execute("SELECT equipment, version FROM champion"))
        finally:
            connection.close()

    def resident_mib(self):
        with open(f"/proc/{self.process.pid}/status", encoding="ascii") as lines:
            return next(int(line.split()[1]) for line in lines if line.startswith("VmRSS")) / 1024

    def stop(self):
        if self.process.poll() is None:
            self.process.send_signal(signal.SIGTERM)
            self.process.wait(DEADLINE_S)


@contextmanager
def running(programs, folder, equipment):
    service = Service(programs, folder, equipment)
    try:
        yield service
    finally:
        service.stop()
