"""Two publishers at full speed, the real service, and what its archive then holds."""

import json
import random
import re
import shutil
import signal
import sqlite3
import statistics
import subprocess
import time

from files import remove
from programs import ENVIRONMENT, spread, table

# Samples of a frame, and frames of a commit: what the service's bounds of 4096 frames and 5 MiB
# make of them.
BATCHES = {629: 512, 100: 3072, 16: 4096}
SPACECRAFT = ["BENCH-1", "BENCH-2"]
DEADLINE_S = 120
# The service wants some equipment; no telemetry of this one comes, so that nothing is identified.
IDLE_EQUIPMENT = '''
[[spacecraft]]
name = "ANOTHER"
[[spacecraft.equipment]]
name = "IDLE"
inputs = ["U"]
outputs = ["Y"]
sample_period = "1s"
window = "1h"
slide = "1h"
'''


def wait_until(condition, what):
    end = time.monotonic() + DEADLINE_S
    while not condition():
        if time.monotonic() > end:
            raise SystemExit(f"after {DEADLINE_S} s still not: {what}")
        time.sleep(0.01)


def measure(programs, folder, scale):
    print("Two publishers at full speed, one process each, into reidentd with nothing to identify, "
          "with the service's default batches; beside it the archive's own appends of the same "
          "frames, without DDS, and ddsperf, which packs messages together, from two publishers "
          "with the same bytes a message\n")
    rows, figures = [], {}
    for parameters in BATCHES:
        frames = max(100, scale.end_to_end_samples // (2 * parameters))
        if parameters < 629:  # bound by messages, not by samples
            frames = min(frames, 100_000)
        repeats = scale.repeats if parameters == 629 else 1
        runs = []
        for _ in range(repeats):
            own = own_rate(programs, folder, parameters, frames)
            runs.append((own, *over_dds(programs, folder, parameters, frames)))
        own = [run[0] for run in runs]
        stored = [run[1] for run in runs]
        ratios = [run[1] / run[0] for run in runs]
        wrong = sum(run[2] for run in runs)
        ddsperf = ddsperf_rate(96 + 13 * parameters) if scale.repeats > 1 else None
        rows.append([parameters, frames * 2, BATCHES[parameters],
                     spread([r / 1e6 for r in stored]), spread([r / 1e6 for r in own]),
                     spread(ratios, "{:.2f}"), wrong,
                     spread([r / parameters for r in stored], "{:.0f}"),
                     f"{ddsperf:.0f}" if ddsperf else "not measured"])
        suffix = "" if parameters == 629 else f"_{parameters}"
        figures[f"end_to_end_per_s{suffix}"] = statistics.median(stored)
        figures[f"end_to_end_over_append{suffix}"] = statistics.median(ratios)
        figures["end_to_end_lost"] = figures.get("end_to_end_lost", 0) + wrong
        figures[f"ddsperf_messages_per_s{suffix}"] = ddsperf
    table(["samples a frame", "frames", "frames a commit", "stored, million samples a second",
           "archive alone, the same", "ratio", "lost, doubled or wrong", "frames a second",
           "ddsperf, messages a second"], rows)
    return figures


def own_rate(programs, folder, parameters, frames):
    """What the service's archive thread could do at most: the same frames, as they would come."""
    file = folder / "own.db"
    result = programs.measure("append", "archive", file, "--frames", frames, "--parameters",
                              parameters, "--batch", BATCHES[parameters], "--leave",
                              "--spacecraft", *SPACECRAFT)
    remove(file)
    return result["samples"] / result["append_s"]


def over_dds(programs, folder, parameters, frames):
    """Samples stored a second from the first write on, and samples lost, doubled or wrong."""
    domain, partition = random.SystemRandom().randint(1, 200), "bench"
    file = folder / "reident.db"
    (folder / "reident.toml").write_text(
        f'[archive]\ndatabase = "reident.db"\n[dds]\ndomain = {domain}\npartition = "{partition}"\n'
        + IDLE_EQUIPMENT)
    children = []
    with open(folder / "reidentd.log", "w", encoding="utf-8") as log:
        children.append(subprocess.Popen([programs.daemon, "--config", folder / "reident.toml"],
                                         stdout=log, stderr=log, env=ENVIRONMENT))
    try:
        publishers = [subprocess.Popen(
            [programs.publisher, "--domain", str(domain), "--partition", partition,
             "--spacecraft", name, "--frames", str(frames), "--parameters", str(parameters)],
            stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True, env=ENVIRONMENT)
            for name in SPACECRAFT]
        children += publishers
        for publisher in publishers:
            if publisher.stdout.readline() != "ready\n":
                raise SystemExit((folder / "reidentd.log").read_text())
        for publisher in publishers:
            publisher.stdin.write("\n")
            publisher.stdin.flush()
        expected = frames * parameters * len(SPACECRAFT)
        ended = wait_for_samples(file, expected)
        began = min(json.loads(p.communicate(timeout=DEADLINE_S)[0])["began"] for p in publishers)
    finally:
        for child in children:
            if child.poll() is None:
                child.send_signal(signal.SIGTERM)
                child.wait(DEADLINE_S)
    content = programs.measure("content", file, "--frames", frames, "--parameters", parameters,
                               "--spacecraft", *SPACECRAFT)
    remove(file)
    wrong = sum(content[key] for key in ("lost", "wrong", "surplus", "received_again"))
    return expected / (ended - began), wrong + abs(content["samples"] - content["expected"])


def wait_for_samples(file, expected):
    """When the last sample was committed, or nothing more came."""
    connection = sqlite3.connect(f"file:{file}?mode=ro", uri=True, timeout=10)
    stored, changed = 0, time.monotonic()
    try:
        while stored < expected and time.monotonic() - changed < DEADLINE_S / 4:
            now = connection.execute("SELECT coalesce(sum(samples), 0) FROM series").fetchone()[0]
            if now != stored:
                stored, changed = now, time.monotonic()
            else:
                time.sleep(0.01)
    finally:
        connection.close()
    return changed


def ddsperf_rate(size):
    """Messages a second from two publishers with `size` bytes each; None without ddsperf."""
    if not shutil.which("ddsperf"):
        return None
    domain = str(random.SystemRandom().randint(1, 200))
    common = ["ddsperf", "-i", domain, "-D", "6"]
    environment = dict(ENVIRONMENT, CYCLONEDDS_URI=LOOPBACK)
    publishers = [subprocess.Popen([*common, "pub", "size", str(size)], env=environment,
                                   stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
                  for _ in SPACECRAFT]
    heard = subprocess.run([*common, "-1", "sub"], env=environment, capture_output=True, text=True)
    for publisher in publishers:
        publisher.wait(DEADLINE_S)
    rates = [float(found) * 1e3 for found in re.findall(r"rate ([0-9.]+) kS/s", heard.stdout)]
    return statistics.median(rates) if rates else None


# As service/dds/loopback.xml, which the programs of the project have built in.
LOOPBACK = ('<Domain Id="any"><General><Interfaces><NetworkInterface address="127.0.0.1" '
            'multicast="false"/></Interfaces><AllowMulticast>false</AllowMulticast>'
            '<MaxMessageSize>65500B</MaxMessageSize><FragmentSize>64000B</FragmentSize></General>'
            '<Discovery><ParticipantIndex>auto</ParticipantIndex><MaxAutoParticipantIndex>119'
            '</MaxAutoParticipantIndex><Peers><Peer address="127.0.0.1"/></Peers></Discovery>'
            '</Domain>')
