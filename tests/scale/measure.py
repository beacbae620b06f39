"""What a constellation takes, measured with few spacecraft and drawn out to many.

    unshare --net python3 tests/scale/measure.py BUILD [--counts 1,2,4,8] [--seconds 20]
                                                 [--folder FOLDER]

In a network namespace of its own, whose counters then show these programs alone. For each count
there are as many services, each with its database and its simulator, by the files of `reident fleet
init`; then the simulators end, and a reference spacecraft sends to each service at real time. Last,
one spacecraft's windows are identified. README.md beside this file says what is assumed. Prints what
was measured and, as the last line, one JSON object.
"""

import argparse
import json
import os
import signal
import statistics
import subprocess
import sys
import tempfile
import time
from pathlib import Path

HERE = Path(__file__).resolve().parent
sys.path.insert(0, str(HERE.parent / "bench"))

from site_of_services import DOMAIN, cpu_s, plant_site, resident_mib, wait_until  # noqa: E402

DRAWN_OUT_TO = (10, 100, 1000)
HOURS_OF_WINDOWS = 14  # two windows of each equipment of the reference spacecraft


def traffic():
    """Packets and bytes that the loopback interface has carried."""
    lines = Path("/proc/net/dev").read_text().splitlines()
    fields = next(line for line in lines if line.strip().startswith("lo:")).split(":")[1].split()
    return int(fields[1]), int(fields[0])


class Interval:
    """Traffic and processor time of some processes between begin and end."""

    def __init__(self, processes):
        self.processes = processes
        self.time, self.traffic, self.cpu = time.monotonic(), traffic(), sum(map(cpu_s, processes))

    def rates(self):
        seconds = time.monotonic() - self.time
        packets, size = (now - before for now, before in zip(traffic(), self.traffic))
        cpu = sum(map(cpu_s, self.processes)) - self.cpu
        return {"packets_per_s": packets / seconds, "bytes_per_s": size / seconds,
                "cores": cpu / seconds}


def wait_s(seconds):
    end = time.monotonic() + seconds
    wait_until(lambda: time.monotonic() > end, "the time has passed")


def constellation(arguments, folder, count):
    site = plant_site(arguments.build, folder, count)
    try:
        found, before, begin = {}, traffic(), time.monotonic()
        services = site.start_services()
        simulators = [site.start("client/reident-simulator", name, f"{name}-clients",
                                 "--spacecraft", name, "--equipment", "PLANT", "--name", "trainer",
                                 "--domain", str(DOMAIN), "--partition", f"operations/{name}",
                                 "--json", "--cache", site.folder / "cache")
                      for name in site.names]
        wait_until(lambda: all(b'"adopted"' in log.read_bytes() for _, log in simulators),
                   "every simulator runs the model of its service")
        packets, size = (now - then for now, then in zip(traffic(), before))
        found["discovery"] = {"s": time.monotonic() - begin, "packets": packets, "bytes": size}
        wait_s(5)
        idle, ends = Interval(services), Interval([process for process, _ in simulators])
        wait_s(arguments.seconds)
        found["idle"] = idle.rates()
        found["idle"]["cores_of_simulators"] = ends.rates()["cores"]
        found["mib"] = {"service": statistics.median(map(resident_mib, services)),
                        "simulator": statistics.median(resident_mib(one) for one, _ in simulators)}
        for process, _ in simulators:
            process.send_signal(signal.SIGTERM)
        for process, _ in simulators:
            process.wait(60)
        sources = [site.start_source(name, "--speed", "1")[0] for name in site.names]
        wait_s(10)
        live, own = Interval(services), Interval(sources)
        wait_s(arguments.seconds)
        found["live"] = live.rates()
        found["live"]["cores_of_sources"] = own.rates()["cores"]
        assert all(source.poll() is None for source in sources), "a source ended"
        return found
    finally:
        site.end()


def identification(arguments, folder):
    """Processor seconds of a window of the reference spacecraft, its telemetry read again."""
    service = Path(arguments.build) / "service"
    csv, database = folder / "reference.csv", folder / "reference.db"
    subprocess.run([service / "satcs/satcs-reference", "--csv", csv, "--duration",
                    f"{HOURS_OF_WINDOWS}h"], check=True, stdout=subprocess.DEVNULL)
    subprocess.run([service / "cli/reident", "import", csv, "--db", database, "--spacecraft",
                    "REFERENCE"], check=True, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
    config = folder / "reference.toml"
    config.write_text((HERE.parents[1] / "deploy/reference.toml").read_text())
    before = os.times()
    subprocess.run([service / "cli/reident", "backfill", "--config", config], check=True,
                   stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
    after = os.times()
    seconds = after[2] + after[3] - before[2] - before[3]
    rows = subprocess.run([service / "cli/reident", "history", "--config", config, "--json"],
                          check=True, text=True, capture_output=True).stdout
    windows = len(json.loads(rows)["attempts"])
    return {"windows": windows, "processor_s_per_window": seconds / windows}


def line(points):
    """Least squares: what there is without a spacecraft, and what each adds."""
    xs, ys = [x for x, _ in points], [y for _, y in points]
    x, y = statistics.fmean(xs), statistics.fmean(ys)
    slope = sum((a - x) * (b - y) for a, b in points) / sum((a - x) ** 2 for a in xs)
    return y - slope * x, slope


def drawn_out(measured):
    rows = {}
    for part in ("discovery", "idle", "live"):
        for key in measured[min(measured)][part]:
            if key == "s":
                continue
            base, each = line([(count, found[part][key]) for count, found in measured.items()])
            rows[f"{part} {key}"] = {"each": each, **{
                count: found[part][key] for count, found in measured.items()}, **{
                count: base + each * count for count in DRAWN_OUT_TO}}
    return rows


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("build")
    parser.add_argument("--counts", default="1,2,4,8")
    parser.add_argument("--seconds", type=float, default=20)
    parser.add_argument("--folder", default=None)
    arguments = parser.parse_args()
    signal.signal(signal.SIGTERM, lambda *_: sys.exit(1))  # what was started is ended all the same
    subprocess.run(["ip", "link", "set", "lo", "up"], check=True)
    measured = {}
    with tempfile.TemporaryDirectory(prefix="reident-scale-", dir=arguments.folder) as folder:
        for count in map(int, arguments.counts.split(",")):
            (own := Path(folder) / str(count)).mkdir()
            measured[count] = constellation(arguments, own, count)
            print(count, json.dumps(measured[count]), flush=True)
        (own := Path(folder) / "windows").mkdir()
        windows = identification(arguments, own)
    rows = drawn_out(measured)
    for name, row in rows.items():
        print(f"{name:30} " + " ".join(f"{key}: {value:.4g}" for key, value in row.items()))
    print(json.dumps({"load": os.getloadavg()[0], "measured": measured, "rows": rows,
                      "identification": windows}))


if __name__ == "__main__":
    main()
