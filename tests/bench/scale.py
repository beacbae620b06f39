"""A constellation: many services on a machine, and sweeps over several spacecraft on one core, on
two, and as a Slurm array.

    scale.py BUILD DEPLOY [--services N] [--spacecraft N] [--days N] [--samples N] [--folder FOLDER]

site_of_services.py says what is measured of the services (--services 0 leaves them out), and
archive/growth.py what of an archive of N samples (0 leaves it out).

Each spacecraft is satcs-reference with another seed, and with a string of its array lost in the
middle. The cluster has two emulated nodes (slurmctld and two slurmd of this machine, started and
ended here); a node is drained and the tasks that run are requeued in the middle. Prints what was
measured and, as the last line, one JSON object of the figures:

  sweep_equal     whether the Slurm array gave the registries of one machine, to the bit
  sweep_speedup   wall time on one core over that on two, both undisturbed
  load_of_sweeps  other work of the machine before the two runs [processes]
  billion_append, billion_window, billion_month  costs of an archive of N samples over those of a
                  small one; _of_shards: with a year in a shard
  verify_day_s    `reident verify --known` of that archive after a day of telemetry more
  split_s         elapsed time of `reident archive split` of that archive
  over_samples, over_equipment  what grows with either: see archive/curves.py
"""

import argparse
import json
import os
import signal
import subprocess
import sys
import tempfile
import time
from pathlib import Path

HERE = Path(__file__).resolve().parent
sys.path.insert(0, str(HERE.parent / "e2e"))
sys.path.insert(0, str(HERE / "archive"))

import curves  # noqa: E402: found in the folder archive
import growth  # noqa: E402: found in the folder archive
import programs  # noqa: E402: found in the folder archive
import site_of_services  # noqa: E402: found in this folder
import slurm  # noqa: E402: found in the folder above

CHANGE = "window=400min"


def run(*arguments, **options):
    return subprocess.run([str(one) for one in arguments], check=True, text=True,
                          stdout=subprocess.PIPE, **options).stdout


class Constellation:
    def __init__(self, arguments, folder):
        self.folder = folder
        self.reident = Path(arguments.build) / "service/cli/reident"
        source = Path(arguments.build) / "service/satcs/satcs-reference"
        template = (Path(arguments.deploy) / "reference.toml").read_text()
        self.configs = []
        for number in range(1, arguments.spacecraft + 1):
            name = f"SAT-{number}"
            csv, database = folder / f"{name}.csv", folder / f"{name}.db"
            run(source, "--csv", csv, "--duration", f"{arguments.days}d", "--seed", number,
                "--life", f"lost_string@+{arguments.days / 2:g}d#4")
            run(self.reident, "import", csv, "--db", database, "--spacecraft", name, "--json",
                stderr=subprocess.DEVNULL)
            csv.unlink()
            config = folder / f"{name}.toml"
            config.write_text(template.replace('"REFERENCE"', f'"{name}"')
                              .replace('"reference.db"', f'"{database.name}"'))
            self.configs.append(config)
            print(f"{name}: {database.stat().st_size / 1e6:.0f} MB", flush=True)

    def question(self, name, *options):
        return [self.reident, "sweep", self.folder / name, "--config", *self.configs, "--set",
                CHANGE, *options]

    def report(self, name):
        return json.loads(run(self.reident, "sweep", self.folder / name, "--json"))

    def on_cores(self, name, cores):
        """Wall seconds, and how much else ran."""
        load, begin = os.getloadavg()[0], time.monotonic()
        run("taskset", "--cpu-list", ",".join(map(str, range(cores))), *self.question(name))
        seconds = time.monotonic() - begin
        print(f"on {cores} cores: {seconds:.0f} s, load before {load:.1f}", flush=True)
        return seconds, load

    def on_slurm(self, name):
        cluster = slurm.Cluster(self.folder / "slurm")
        try:
            begin = time.monotonic()
            run(*self.question(name, "--slurm"), env=cluster.environment)
            cluster.wait(lambda: len(cluster.running()) == 2, "both nodes work")
            requeued = list(cluster.running())
            for task in requeued:
                cluster.command("scontrol", "requeue", task)
            cluster.command("scontrol", "update", "NodeName=n2", "State=DRAIN", "Reason=benchmark")
            cluster.wait(lambda: len(cluster.running()) == 1, "the node is drained")
            cluster.command("scontrol", "update", "NodeName=n2", "State=RESUME")
            cluster.wait(cluster.idle, "all jobs have ended", 24 * 3600)
            print(f"as a Slurm array: {time.monotonic() - begin:.0f} s, {len(requeued)} tasks "
                  "requeued, a node drained meanwhile", flush=True)
        finally:
            cluster.end()


def digests(report):
    return {one["name"]: one["registry_sha256"] for one in report["spacecraft"]}


def measure_sweeps(arguments, folder):
    constellation = Constellation(arguments, folder)
    one, load_one = constellation.on_cores("one", 1)
    two, load_two = constellation.on_cores("two", 2)
    report = constellation.report("one")
    figures = {"spacecraft": arguments.spacecraft, "days": arguments.days,
               "equipment": report["equipment"], "windows": report["windows"],
               "one_core_s": round(one, 1), "two_cores_s": round(two, 1),
               "sweep_speedup": round(one / two, 2),
               "load_of_sweeps": [round(load_one, 1), round(load_two, 1)],
               "two_cores_equal": digests(constellation.report("two")) == digests(report)}
    if why := slurm.missing():
        print(f"without Slurm: {why}")
    else:
        constellation.on_slurm("array")
        figures["sweep_equal"] = digests(constellation.report("array")) == digests(report)
    return figures


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("build")
    parser.add_argument("deploy")
    parser.add_argument("--services", type=int, default=100)
    parser.add_argument("--spacecraft", type=int, default=6)
    parser.add_argument("--days", type=float, default=30)
    parser.add_argument("--samples", type=float, default=1e9)
    parser.add_argument("--folder", default=None)
    arguments = parser.parse_args()
    signal.signal(signal.SIGTERM, lambda *_: sys.exit(1))  # what was started is ended all the same
    with tempfile.TemporaryDirectory(prefix="reident-scale-", dir=arguments.folder) as folder:
        figures = {}
        if arguments.services:
            (site := Path(folder) / "site").mkdir()
            figures |= site_of_services.measure(arguments.build, arguments.services, site)
            (live := Path(folder) / "live").mkdir()
            figures |= site_of_services.measure_live(arguments.build, arguments.services, live)
            print(figures, flush=True)
        if arguments.spacecraft:
            (sweeps := Path(folder) / "sweeps").mkdir()
            figures |= measure_sweeps(arguments, sweeps)
        if arguments.samples:
            (archives := Path(folder) / "archives").mkdir()
            build = Path(arguments.build).resolve()
            tools = programs.Programs(build), build / "service/cli/reident", archives
            figures |= growth.measure(*tools, arguments.samples)
            figures["over_samples"] = curves.over_samples(growth.Growth(*tools), arguments.samples)
            figures["over_equipment"] = curves.over_equipment(
                build / "tests/bench/web/reident_web_archive", *tools[1:])
        print(json.dumps(figures))


if __name__ == "__main__":
    main()
