"""Many services and simulators on this machine, each pair in a partition of its own.

Each service has a champion, and its simulator takes it: the moment of that is when the two have
found each other. The middleware is configured by what `reident fleet init` writes.
The figures:

  discovery_s      from the start of the first program until every simulator runs its model
  idle_core        processor time of all services over wall time, while nothing comes
  fleet_status_s   `reident fleet status` of all of them, the median of five
  fleet_status_cpu_s  the processor time of one
  service_mib      resident memory of a service, the median
  load             other work of the machine at the begin [processes]
"""

import json
import os
import signal
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


def wait_until(condition, what):
    end = time.monotonic() + DEADLINE_S
    while not condition():
        if time.monotonic() > end:
            raise SystemExit(f"after {DEADLINE_S} s still not: {what}")
        time.sleep(0.05)  # poll


def cpu_s(process):
    """By the scheduler's clock: an idle thread's wakeups are shorter than a tick."""
    tasks = Path(f"/proc/{process.pid}/task").glob("*/schedstat")
    return sum(int(task.read_text().split()[0]) for task in tasks) / 1e9


def resident_mib(process):
    return int(Path(f"/proc/{process.pid}/statm").read_text().split()[1]) / 256


class Site:
    def __init__(self, build, folder, count):
        self.service, self.folder = Path(build) / "service", folder
        self.names = [f"SAT-{number:03}" for number in range(1, count + 1)]
        self.processes = []
        satellite = folder / "satellite.toml"
        satellite.write_text("[[spacecraft]]\nname = \"ANY\"\n[[spacecraft.equipment]]\n" + "".join(
            f"{key} = {json.dumps(value)}\n"
            for key, value in plant.equipment(bias="approve", baseline_mrse=50.0).items()))
        (folder / "fleet.toml").write_text(
            f"[fleet]\nconfiguration = \"satellite.toml\"\ndomain = {DOMAIN}\n"
            f"data = \"{folder}/data/{{}}\"\n[fleet.network]\nhost = \"127.0.0.1\"\n" +
            "".join(f"[[spacecraft]]\nname = \"{name}\"\n" for name in self.names))
        self.reident("fleet", "init", folder / "fleet.toml", "--root", folder)
        self.configurations = folder / "etc/reident"
        csv = plant.write(folder / "rows.csv", plant.rows(2400))
        for name in self.names:
            (folder / "data" / name).mkdir(parents=True)
            self.reident("import", csv, "--db", folder / "data" / name / "reident.db",
                         "--spacecraft", name)
            self.reident("backfill", "--config", self.configurations / f"{name}.toml")

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

    def measure(self):
        load, begin = os.getloadavg()[0], time.monotonic()
        services = [self.start("daemon/reidentd", name, name, "--config",
                               self.configurations / f"{name}.toml")[0] for name in self.names]
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

    def end(self):
        for process in self.processes:
            process.send_signal(signal.SIGTERM)
        for process in self.processes:
            try:
                process.wait(60)
            except subprocess.TimeoutExpired:
                process.kill()
                process.wait()


def measure(build, services, folder):
    site = Site(build, folder, services)
    try:
        return site.measure()
    finally:
        site.end()
