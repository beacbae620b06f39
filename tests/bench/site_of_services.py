"""Many services on this machine, each in a partition of its own. The middleware is configured by
what `reident fleet init` writes.

measure(): each service has a champion, and its simulator takes it: the moment of that is when the
two have found each other. The figures:

  discovery_s      from the start of the first program until every simulator runs its model
  idle_core        processor time of all services over wall time, while nothing comes
  fleet_status_s   `reident fleet status` of all of them, the median of five
  fleet_status_cpu_s  the processor time of one
  service_mib      resident memory of a service, the median
  load             other work of the machine at the begin [processes]

measure_live(): each service is that of the reference spacecraft, whose telemetry comes at real time,
and windows of all equipment are due in the same moment. The figures:

  fleet_windows    windows that were decided
  fleet_lag        from the last telemetry of a window to its decision, the longest [slides]
  fleet_gib        memory of all services, at most
  fleet_core       processor time of all services over wall time, windows included
  fleet_lost       samples that were sent and are in no archive
"""

import datetime
import json
import os
import signal
import sqlite3
import statistics
import subprocess
import sys
import time
from pathlib import Path

HERE = Path(__file__).resolve().parent
sys.path.insert(0, str(HERE.parent / "e2e"))

import plant  # noqa: E402: found in the folder above

DEADLINE_S = 120
IDLE_S = 20
DOMAIN = 60
# Of the reference spacecraft's configuration.
EQUIPMENT, WINDOW_S, SLIDE_S = 9, 500 * 60, 5 * 3600
DUE = datetime.datetime.fromtimestamp(83275 * SLIDE_S, datetime.timezone.utc)  # a window's end


def wait_until(condition, what, deadline_s=DEADLINE_S):
    end = time.monotonic() + deadline_s
    while not condition():
        if time.monotonic() > end:
            raise SystemExit(f"after {deadline_s} s still not: {what}")
        time.sleep(0.05)  # poll


def before_due(seconds):
    return DUE - datetime.timedelta(seconds=seconds)


def time_text(time):
    return time.strftime("%Y-%m-%dT%H:%M:%SZ")


def cpu_s(process):
    """By the scheduler's clock: an idle thread's wakeups are shorter than a tick."""
    tasks = Path(f"/proc/{process.pid}/task").glob("*/schedstat")
    return sum(int(task.read_text().split()[0]) for task in tasks) / 1e9


def resident_mib(process):
    return int(Path(f"/proc/{process.pid}/statm").read_text().split()[1]) / 256


def proportional_mib(process):
    """A page that several programs share counts once in all."""
    lines = Path(f"/proc/{process.pid}/smaps_rollup").read_text().splitlines()
    return next(int(line.split()[1]) for line in lines if line.startswith("Pss:")) / 1024


class Site:
    """Folders and configurations of so many spacecraft with the equipment of this TOML."""

    def __init__(self, build, folder, count, equipment):
        self.service, self.folder = Path(build) / "service", folder
        self.names = [f"SAT-{number:03}" for number in range(1, count + 1)]
        self.processes = []
        (folder / "satellite.toml").write_text(f'[[spacecraft]]\nname = "ANY"\n{equipment}')
        (folder / "fleet.toml").write_text(
            f"[fleet]\nconfiguration = \"satellite.toml\"\ndomain = {DOMAIN}\n"
            f"data = \"{folder}/data/{{}}\"\n[fleet.network]\nhost = \"127.0.0.1\"\n" +
            "".join(f"[[spacecraft]]\nname = \"{name}\"\n" for name in self.names))
        self.reident("fleet", "init", folder / "fleet.toml", "--root", folder)
        self.configurations = folder / "etc/reident"
        for name in self.names:
            (folder / "data" / name).mkdir(parents=True)

    def database(self, name):
        return self.folder / "data" / name / "reident.db"

    def reident(self, *arguments, check=True):
        return subprocess.run([self.service / "cli/reident", *arguments], check=check, text=True,
                              capture_output=True).stdout

    def start(self, program, name, middleware, *arguments):
        uri = f"file://{self.configurations}/cyclonedds/{middleware}.xml"
        environment = dict(os.environ, CYCLONEDDS_URI=uri)
        log = self.folder / f"{Path(program).name}-{name}.log"
        with open(log, "wb") as out:
            process = subprocess.Popen([self.service / program, *arguments], stdout=out, stderr=out,
                                       stdin=subprocess.DEVNULL, env=environment,
                                       start_new_session=True)
        self.processes.append(process)
        return process, log

    def start_services(self):
        return [self.start("daemon/reidentd", name, name, "--config",
                           self.configurations / f"{name}.toml")[0] for name in self.names]

    def start_source(self, name, *arguments):
        return self.start("satcs/satcs-reference", name, f"{name}-clients", "--spacecraft", name,
                          "--domain", str(DOMAIN), "--partition", f"operations/{name}",
                          *arguments)

    def measure(self):
        load, begin = os.getloadavg()[0], time.monotonic()
        services = self.start_services()
        logs = [self.start("client/reident-simulator", name, f"{name}-clients",
                           "--spacecraft", name, "--equipment",
                           "PLANT", "--name", "trainer", "--domain", str(DOMAIN), "--partition",
                           f"operations/{name}", "--json", "--cache",
                           self.folder / "cache")[1] for name in self.names]
        started = time.monotonic() - begin
        waiting = set(logs)

        def all_run():
            waiting.difference_update(
                [log for log in waiting if b'"adopted"' in log.read_bytes()])
            return not waiting

        wait_until(all_run, "every simulator runs the model of its service")
        discovery = time.monotonic() - begin
        before, begin = sum(map(cpu_s, services)), time.monotonic()
        wait_until(lambda: time.monotonic() - begin > IDLE_S, "the time has passed")
        idle = (sum(map(cpu_s, services)) - before) / (time.monotonic() - begin)
        times, cpu = [], os.times()
        for _ in range(5):
            begin = time.monotonic()
            report = json.loads(self.reident("fleet", "status", self.configurations, "--json",
                                             check=False))
            times.append(time.monotonic() - begin)
        cpu = [after - before for before, after in zip(cpu, os.times())]
        assert all(one["service"] and one["with_champion"] for one in report["instances"])
        return {"services": len(services), "simulators": len(logs),
                "started_s": round(started, 2), "discovery_s": round(discovery, 2),
                "idle_core": round(idle, 3), "fleet_status_s": round(statistics.median(times), 3),
                "fleet_status_cpu_s": round((cpu[2] + cpu[3]) / len(times), 3),
                "service_mib": round(statistics.median(map(resident_mib, services)), 1),
                "load": round(load, 1)}

    def measure_live(self, until_due_s):
        """The archives lack so many seconds of the windows that end at DUE."""
        services = self.start_services()
        used, begin, now = sum(map(cpu_s, services)), time.monotonic(), time.time()
        sources = [self.start_source(name, "--start", time_text(before_due(until_due_s)),
                                     "--duration", f"{2 * until_due_s}s", "--json")
                   for name in self.names]
        most, waiting, looked = 0, set(self.names), 0

        def all_decided():
            nonlocal most, looked
            if time.monotonic() < looked + 1:
                return False
            most, looked = max(most, sum(map(proportional_mib, services))), time.monotonic()
            waiting.difference_update(
                [name for name in waiting if len(self.decided(name)) >= EQUIPMENT])
            return not waiting and all(source.poll() is not None for source, _ in sources)

        wait_until(all_decided, "the windows of all equipment are decided", SLIDE_S)
        core = (sum(map(cpu_s, services)) - used) / (time.monotonic() - begin)
        lost = sum(self.lost(name, json.loads(log.read_text().splitlines()[-1])["samples"])
                   for name, (_, log) in zip(self.names, sources))
        decided = [at for name in self.names for at in self.decided(name)]
        lag = max(decided) / 1e9 - (now + until_due_s)
        return {"fleet_spacecraft": len(services), "fleet_windows": len(decided),
                "fleet_lag": round(lag / SLIDE_S, 5), "fleet_gib": round(most / 1024, 2),
                "fleet_core": round(core, 3), "fleet_lost": lost}

    def decided(self, name):
        """When the windows that end at DUE were, nanoseconds."""
        with sqlite3.connect(f"file:{self.database(name)}?mode=ro", uri=True) as database:
            return [at for at, in database.execute(
                "SELECT time FROM attempt WHERE window_end = ?", [int(DUE.timestamp()) * 10**9])]

    def lost(self, name, sent):
        """What is not stored of so many samples. Batches and heartbeats come each second."""
        stored = []

        def all_stored():
            status = self.reident("status", "--domain", str(DOMAIN), "--partition",
                                  f"operations/{name}", "--json")
            stored.append(int(json.loads(status)["samples_stored"]))
            return stored[-1] == sent or len(stored) > 5

        wait_until(all_stored, f"the status of {name}")
        return sent - stored[-1]

    def end(self):
        for process in self.processes:
            process.send_signal(signal.SIGTERM)
        for process in self.processes:
            try:
                process.wait(60)
            except subprocess.TimeoutExpired:
                process.kill()
                process.wait()


def plant_site(build, folder, count):
    """The plant of the tests, of which each service has a champion."""
    site = Site(build, folder, count, "[[spacecraft.equipment]]\n" + "".join(
        f"{key} = {json.dumps(value)}\n"
        for key, value in plant.equipment(bias="approve", baseline_mrse=50.0).items()))
    csv = plant.write(folder / "rows.csv", plant.rows(2400))
    for name in site.names:
        site.reident("import", csv, "--db", site.database(name), "--spacecraft", name)
        site.reident("backfill", "--config", site.configurations / f"{name}.toml")
    return site


def reference_site(build, folder, count, until_due_s):
    """The reference spacecraft, so many seconds before windows of all equipment end."""
    text = (HERE.parents[1] / "deploy/reference.toml").read_text()
    site = Site(build, folder, count, text[text.index("[[spacecraft.equipment]]"):])
    csv = folder / "rows.csv"
    subprocess.run([site.service / "satcs/satcs-reference", "--csv", csv, "--start",
                    time_text(before_due(WINDOW_S)), "--duration", f"{WINDOW_S - until_due_s}s"], check=True,
                   stdout=subprocess.DEVNULL)
    for name in site.names:
        site.reident("import", csv, "--db", site.database(name), "--spacecraft", name)
    return site


def measure(build, services, folder):
    site = plant_site(build, folder, services)
    try:
        return site.measure()
    finally:
        site.end()


def measure_live(build, services, folder, until_due_s=60):
    site = reference_site(build, folder, services, until_due_s)
    try:
        return site.measure_live(until_due_s)
    finally:
        site.end()
