"""A network that is cut and one that loses packets, between a source of telemetry and the service.

    cuts.py BUILD

Both run in a network namespace of its own, joined by a pair of virtual interfaces; nftables drops
packets. The source does not wait for readers. Needs root and nftables. The last line is one JSON
object; frames are `missing` that the source sent and the archive has not.
"""

import json
import os
import shutil
import signal
import sqlite3
import subprocess
import sys
import tempfile
import time
from pathlib import Path

from packages import wait_until

TOOLS = ["ip", "nft"]
RATE, CUT_S, BEFORE_S, AFTER_S = 100, 60, 10, 25
XML = ('<CycloneDDS><Domain Id="any"><General><Interfaces><NetworkInterface name="veth"/></Interfaces>'
       '</General></Domain></CycloneDDS>')
EQUIPMENT = """
[[spacecraft]]
name = "CBERS-4"
[[spacecraft.equipment]]
name = "BDR"
inputs = ["I_BDRIN1", "I_BDRIN2"]
outputs = ["I_BDROUT"]
sample_period = "1s"
window = "500min"
"""


def run(*words):
    return subprocess.run([*map(str, words)], capture_output=True, text=True, check=True).stdout


class Sides:
    """Two machines' worth of network, with one wire between them."""

    def __init__(self):
        self.names = [f"reident-{os.getpid()}-{side}" for side in "ab"]

    def __enter__(self):
        for name in self.names:
            run("ip", "netns", "add", name)
        run("ip", "-n", self.names[0], "link", "add", "veth", "type", "veth", "peer", "name", "veth",
            "netns", self.names[1])
        for number, name in enumerate(self.names, 1):
            run("ip", "-n", name, "address", "add", f"192.0.2.{number}/24", "dev", "veth")
            run("ip", "-n", name, "link", "set", "veth", "up")
            run("ip", "-n", name, "link", "set", "lo", "up")
            self.nft(name, "add table inet wire")
            self.nft(name, "add chain inet wire input { type filter hook input priority 0 ; }")
        return self

    def __exit__(self, *_):
        for name in self.names:
            run("ip", "netns", "delete", name)

    def nft(self, name, words):
        run("ip", "netns", "exec", name, "nft", words)

    def drop(self, condition):
        for name in self.names:
            self.nft(name, f"add rule inet wire input iifname veth {condition} drop")

    def heal(self):
        for name in self.names:
            self.nft(name, "flush chain inet wire input")

    def start(self, side, log, *words):
        with open(log, "ab") as out:
            return subprocess.Popen(["ip", "netns", "exec", self.names[side], *map(str, words)],
                                    stdin=subprocess.DEVNULL, stdout=out, stderr=subprocess.STDOUT,
                                    env={**os.environ, "CYCLONEDDS_URI": XML})


def stored(database, what):
    with sqlite3.connect(f"file:{database}?mode=ro", uri=True, timeout=10) as connection:
        return connection.execute(what).fetchone()[0] or 0


def measure(sides, programs, cut, source_options, frames, disturb):
    """What the source summed up, and what the archive has and counts as missing."""
    with tempfile.TemporaryDirectory(prefix="reident-cuts-") as name:
        folder = Path(name)
        dds = '\n[dds]\ncut = "60s"\nrate = "100/s"\n' if cut else ""
        (folder / "reident.toml").write_text(
            f'[archive]\ndatabase = "reident.db"\n{dds}{EQUIPMENT}')
        service = sides.start(1, folder / "service.log", programs / "daemon/reidentd", "--config",
                              folder / "reident.toml")
        wait_until(lambda: "service: started" in (folder / "service.log").read_text()
                   or service.poll() is not None, "the service started")
        source = sides.start(0, folder / "source.log", programs / "satcs/satcs-reference",
                             "--duration", f"{frames}s", "--json", *source_options)
        try:
            disturb(folder / "reident.db")
            source.wait(600)
            service.send_signal(signal.SIGTERM)
            service.wait(60)
            said = (folder / "source.log").read_text().splitlines()
            database = folder / "reident.db"
            came = stored(database, "SELECT max(samples) FROM series")
            return {"source": json.loads(said[-1]), "missing": frames - came,
                    "counted": stored(database, "SELECT sum(missing) FROM telemetry_source")}
        finally:
            sides.heal()
            for process in source, service:
                if process.poll() is None:
                    process.kill()
                    process.wait()


def cut_for_a_minute(sides):
    def disturb(database):
        wait_until(lambda: stored(database, "SELECT sum(samples) FROM series"), "telemetry comes")
        time.sleep(BEFORE_S)
        sides.drop("")
        time.sleep(CUT_S)
        sides.heal()
    return disturb


def lossy(sides, percent):
    return lambda _: sides.drop(f"numgen random mod 100 < {percent}")


def all_figures(sides, programs):
    frames = RATE * (BEFORE_S + CUT_S + AFTER_S)
    paced = ["--speed", RATE, "--wait-readers", 0]
    covered = measure(sides, programs, True, [*paced, "--cut", "60s", "--rate", "100/s", "--linger",
                                              "10s"], frames, cut_for_a_minute(sides))
    print("with cut = 60s:", covered, flush=True)
    plain = measure(sides, programs, False, [*paced, "--linger", "10s"], frames,
                    cut_for_a_minute(sides))
    print("without:", plain, flush=True)
    figures = {"cut_missing": covered["missing"],
               "cut_delay_s": round(covered["source"]["wall_s"] - frames / RATE - 10, 2),
               "plain_cut_missing": plain["missing"],
               "plain_cut_counted_at_service": plain["counted"],
               "plain_cut_counted_at_source":
                   sum(lost["frames"] for lost in plain["source"]["lost"])}
    for percent in 5, 20:
        lossless = measure(sides, programs, False, ["--speed", "max"], 21600, lossy(sides, percent))
        print(f"{percent} % loss:", lossless, flush=True)
        figures[f"loss_{percent}_missing"] = lossless["missing"]
        figures[f"loss_{percent}_frames_per_s"] = round(21600 / lossless["source"]["wall_s"])
    return figures


def main():
    programs = Path(sys.argv[1]).resolve() / "service"
    missing = [tool for tool in TOOLS if not shutil.which(tool)]
    if os.geteuid() != 0 or missing:
        reason = "needs root" if os.geteuid() != 0 else f"without {', '.join(missing)}"
        print(json.dumps({"left_out": {"cuts": reason}}))
        return
    with Sides() as sides:
        print(json.dumps(all_figures(sides, programs)))


if __name__ == "__main__":
    main()
