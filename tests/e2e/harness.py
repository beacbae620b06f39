"""Real processes on a DDS domain and in a folder of their own.

Every program is started in a process group of its own and ended by its id. Waiting is for a
condition, with a deadline; nothing sleeps a guess.
"""

import json
import os
import shutil
import signal
import socket
import sqlite3
import subprocess
import tempfile
import time
import unittest
from pathlib import Path

import plant

BIN = Path(os.environ["REIDENT_BIN"])  # folder of the programs under test
DEADLINE_S = float(os.environ.get("REIDENT_E2E_DEADLINE", "60"))


def wait_until(condition, what, deadline_s=DEADLINE_S):
    """The first true value of condition()."""
    end = time.monotonic() + deadline_s
    while True:
        value = condition()
        if value:
            return value
        if time.monotonic() > end:
            raise AssertionError(f"after {deadline_s:g} s still not: {what}")
        time.sleep(0.02)  # poll


def claim_domain(domains):
    """One of these that no other test on this machine has, until the socket is closed or its process
    ends: (domain, socket)."""
    def claimed():
        for domain in domains:
            claim = socket.socket(socket.AF_UNIX)
            try:
                claim.bind(f"\0reident-test-domain-{domain}")
                return domain, claim
            except OSError:
                claim.close()
        return None

    return wait_until(claimed, "a domain of its own is free", 2 * DEADLINE_S)


class Process:
    """A program under test; its output is in files, so that no pipe can fill."""

    def __init__(self, folder, name, arguments, user=None, middleware=None, host=None):
        """`middleware`: the file that CYCLONEDDS_URI names. `host`: a network namespace with its
        middleware's configuration (pair.py)."""
        self.log = folder / f"{name}.log"
        self.out = folder / f"{name}.out"
        environment = {key: value for key, value in os.environ.items() if key != "CYCLONEDDS_URI"}
        if middleware:
            environment["CYCLONEDDS_URI"] = f"file://{middleware}"
        if host:
            environment["CYCLONEDDS_URI"] = host.uri
        with open(self.log, "ab") as log, open(self.out, "ab") as out:
            self.process = subprocess.Popen(
                [*(host.prefix if host else ()), str(BIN / arguments[0]), *map(str, arguments[1:])],
                stdin=subprocess.DEVNULL,
                stdout=out, stderr=log, env=environment, start_new_session=True, user=user,
                group=user)

    def text(self):
        return self.out.read_text() + self.log.read_text()

    def running(self):
        return self.process.poll() is None

    def signal(self, number):
        self.process.send_signal(number)

    def wait(self, deadline_s=DEADLINE_S):
        try:
            return self.process.wait(deadline_s)
        except subprocess.TimeoutExpired:
            raise AssertionError(f"still running after {deadline_s:g} s:\n{self.text()}") from None

    def terminate(self):
        """Asks it to stop; returns the exit status and the seconds that it took."""
        begin = time.monotonic()
        self.signal(signal.SIGTERM)
        return self.wait(), time.monotonic() - begin

    def kill(self):
        self.signal(signal.SIGKILL)
        self.process.wait()


class EndToEnd(unittest.TestCase):
    # Where set, a test shares its domain, and so its ports, with no other one.
    own_domains = None

    def setUp(self):
        self.folder = Path(tempfile.mkdtemp(prefix="reident-e2e-"))
        if self.own_domains:
            self.domain, claim = claim_domain(self.own_domains)
            self.addCleanup(claim.close)
        else:
            self.domain = 31 + os.getpid() % 170  # behind all own_domains
        self.partition = f"test-{os.getpid()}-{self._testMethodName}"[:60]
        self.processes = []
        self.addCleanup(self._end)

    def _end(self):
        for process in self.processes:
            if process.running():
                process.kill()
        result = self._outcome.result  # the outcome itself is that of this clean-up
        if all(test is not self for test, _ in result.failures + result.errors):
            shutil.rmtree(self.folder)
        else:
            for process in self.processes:
                print(f"---- {process.log.stem}\n{process.text()[-4000:]}")
            print(f"files: {self.folder}")

    # -- programs

    def start(self, *arguments, name=None, user=None, middleware=None, host=None):
        """`middleware` and `host` as Process has them."""
        name = name or f"{arguments[0]}-{len(self.processes)}"
        process = Process(self.folder, name, arguments, user, middleware, host)
        self.processes.append(process)
        return process

    def endpoint(self):
        return ["--domain", self.domain, "--partition", self.partition]

    @property
    def database(self):
        return self.folder / "reident.db"

    def configure(self, equipment, spacecraft="SAT", relations=(), **limits):
        """Writes the configuration; `equipment` are tables of [[spacecraft.equipment]], `relations`
        of [[spacecraft.relation]]."""

        def toml(value):
            if isinstance(value, list):
                return f"[{', '.join(map(toml, value))}]"
            if isinstance(value, dict):
                return f"{{{', '.join(f'{key} = {toml(one)}' for key, one in value.items())}}}"
            return json.dumps(value)

        lines = ["[service]", 'log_level = "debug"', "[archive]", 'database = "reident.db"',
                 "[dds]", f"domain = {self.domain}", f"partition = {toml(self.partition)}",
                 "[limits]", 'settle = "300ms"',
                 *(f"{key} = {toml(value)}" for key, value in limits.items()),
                 "[[spacecraft]]", f"name = {toml(spacecraft)}"]
        for kind, tables in ("equipment", equipment), ("relation", relations):
            for table in tables:
                lines += [f"[[spacecraft.{kind}]]",
                          *(f"{key} = {toml(value)}" for key, value in table.items())]
        path = self.folder / "reident.toml"
        path.write_text("\n".join(lines) + "\n")
        return path

    def start_daemon(self, user=None):
        daemon = self.start("reidentd", "--config", self.folder / "reident.toml", user=user)
        wait_until(lambda: "service: started" in daemon.text() or not daemon.running(),
                   "reidentd has started")
        self.assertTrue(daemon.running(), daemon.text())
        return daemon

    def replay(self, csv, *options, spacecraft="SAT"):
        return self.start("satcs-replay", csv, "--spacecraft", spacecraft, "--json",
                          *self.endpoint(), *options)

    def replay_all(self, csv, *options, **keywords):
        """Replays to the end at full speed; returns the summary."""
        replay = self.replay(csv, "--speed", "max", *options, **keywords)
        self.assertEqual(replay.wait(), 0, replay.text())
        return json.loads(replay.out.read_text())

    def reident(self, *arguments, host=None):
        """Runs a command of the command line; returns its exit status and its output. Beside an
        object of --json the middleware may have a warning to say, which is left out."""
        environment = {**os.environ, **({"CYCLONEDDS_URI": host.uri} if host else {})}
        done = subprocess.run([*(host.prefix if host else ()), str(BIN / "reident"),
                               *map(str, arguments)], capture_output=True, env=environment,
                              text=True, timeout=DEADLINE_S, check=False)
        is_object = "--json" in arguments and done.stdout
        return done.returncode, done.stdout + ("" if is_object else done.stderr)

    def wait_idle(self):
        status, text = self.reident("status", "--wait", "idle", "--timeout", DEADLINE_S, "--json",
                                    *self.endpoint())
        self.assertEqual(status, 0, text)
        return json.loads(text)

    # -- the plant's telemetry, and what simulators make of it

    def replay_rows(self, name, readers=1, **keywords):
        """`readers`: the service, and simulators that may not miss a row."""
        csv = plant.write(self.folder / f"{name}.csv", plant.rows(**keywords))
        self.replay_all(csv, "--wait-readers", readers)
        return self.wait_idle()

    def start_simulator(self, name, *options, cache=None, host=None):
        """By default with a folder of last good versions of its own."""
        return self.start("reident-simulator", "--spacecraft", "SAT", "--equipment", "PLANT",
                          "--name", name, "--json", "--cache",
                          cache or self.folder / f"cache-{name}", *self.endpoint(), *options,
                          name=name, host=host)

    def runs(self, simulator):
        """Versions that the simulator took up, in order."""
        events = [json.loads(line) for line in simulator.out.read_text().splitlines() if line]
        return [event["version"] for event in events if event.get("event") == "adopted"]

    # -- what is stored

    def codes(self, kind):
        """Codes of the reasons of the decisions of this kind that have some."""
        return [reason["code"] for text, in self.query(
            "SELECT evidence_json FROM decision WHERE kind = ? AND evidence_json != ''", kind)
            for reason in json.loads(text).get("reasons", [])]

    def champion(self):
        rows = self.query("SELECT version FROM champion")
        return rows[0][0] if rows else None

    def query(self, sql, *values):
        connection = sqlite3.connect(f"file:{self.database}?mode=ro", uri=True, timeout=10)
        try:
            return connection.execute(sql, values).fetchall()
        finally:
            connection.close()

    def stored(self):
        """How many samples are committed."""
        return self.query("SELECT sum(samples) FROM telemetry_series")[0][0] or 0

    def samples(self, origin="real"):
        """{(parameter, time): (value, quality)} of all that is archived."""
        lines = subprocess.run(
            [str(BIN / "query"), str(self.database), "SELECT parameter, time, value, quality "
             f"FROM telemetry WHERE origin = '{origin}'"],
            stdout=subprocess.PIPE, text=True, timeout=DEADLINE_S, check=True).stdout.splitlines()
        return {(parameter, at): (value, quality)
                for parameter, at, value, quality in map(json.loads, lines)}


def csv_lines(header, rows):
    return "\n".join([",".join(header), *(",".join(map(str, row)) for row in rows)]) + "\n"
