"""From the service's write of a version to another process's first step on it."""

import json
import re
import shutil
import statistics
import subprocess
from pathlib import Path

from service import DEADLINE_S, ENVIRONMENT, INPUTS, OUTPUT, SPACECRAFT, running, telemetry

LOOPBACK = Path(__file__).resolve().parents[3] / "service/dds/loopback.xml"
EQUIPMENT = "LOOP"
# About as often as versions come here. Back to back, threads and processors never go to sleep, and
# a round trip takes a fraction of the time.
SELDOM = ["10Hz"]


def measure(programs, folder, scale):
    with running(programs, folder, [EQUIPMENT]) as service:
        service.replay(telemetry(700))
        newest = 2
        if service.champions()[EQUIPMENT] < newest:
            service.run(programs.reident, "approve", f"{SPACECRAFT}/{EQUIPMENT}", newest,
                        "--reason", "a pair to swap", "--config", service.folder / "reident.toml")
        process = start(programs, service, scale.flips)
        try:
            size = payload(json.loads(process.stdout.readline()))
            trips = [round_trip(service.domain, size, scale.ping_s / 2, SELDOM)]
            delays = flip(programs, service, process, newest, scale.flips)
        finally:
            process.kill()
            process.wait()
        trips.append(round_trip(service.domain, size, scale.ping_s / 2, SELDOM))
        back_to_back = round_trip(service.domain, size, scale.ping_s / 2, [])
    return report(size, delays, trips, back_to_back)


def start(programs, service, flips):
    words = [programs.swap, service.domain, service.partition, SPACECRAFT, EQUIPMENT, flips + 1,
             OUTPUT, *INPUTS]
    return subprocess.Popen([*map(str, words)], stdout=subprocess.PIPE, text=True, env=ENVIRONMENT)


def flip(programs, service, process, newest, flips):
    """Microseconds from write to step, for each change of version that an operator orders."""
    process.stdout.readline()  # of the version that it began with
    delays = []
    for number in range(flips):
        service.run(programs.reident, "rollback", f"{SPACECRAFT}/{EQUIPMENT}", "--to",
                    newest - 1 + number % 2, "--config", service.folder / "reident.toml")
        swap = json.loads(process.stdout.readline())
        delays.append((swap["time_ns"] - swap["published_ns"]) / 1e3)
    return delays


def payload(value):
    """About how many bytes a version is as a message: 8 a number, a text and its length."""
    if isinstance(value, dict):
        return sum(map(payload, value.values()))
    if isinstance(value, list):
        return 4 + sum(map(payload, value))
    return len(value) + 5 if isinstance(value, str) else 8


def round_trip(domain, size, seconds, rate):
    """Median of ddsperf's round trips in microseconds; None without ddsperf."""
    if not shutil.which("ddsperf"):
        return None
    environment = dict(ENVIRONMENT, CYCLONEDDS_URI=f"file://{LOOPBACK}")
    common = ["ddsperf", "-i", str(domain + 100), "-D", str(seconds + 1)]
    pong = subprocess.Popen([*common, "pong"], env=environment, stdout=subprocess.DEVNULL,
                            stderr=subprocess.DEVNULL)
    said = subprocess.run([*common, "ping", *rate, "size", str(size)], env=environment,
                          capture_output=True, text=True, check=False, timeout=DEADLINE_S).stdout
    pong.wait(DEADLINE_S)
    # It prints one way, half of a round trip: mean * count is half of the time.
    halves = [float(value) for value in re.findall(r" 50% ([0-9.]+)us", said)]
    return 2 * statistics.median(halves) if halves else None


def report(size, delays, trips, back_to_back):
    median = statistics.median(delays)
    print(f"from the service's write to the first step on the version in another process that "
          f"steps without a pause, {len(delays)} swaps: {median:.1f} us (median; "
          f"{min(delays):.1f} to {max(delays):.1f})", flush=True)
    figures = {"flips": len(delays), "publish_to_step_us": median, "roundtrip_us": trips,
               "roundtrip_back_to_back_us": back_to_back, "publish_to_step_over_roundtrip": None,
               "publish_to_step_over_back_to_back": None}
    if None in [*trips, back_to_back]:
        print("no ddsperf (cyclonedds-tools) to compare it with\n", flush=True)
        return figures
    trip = statistics.mean(trips)
    print(f"round trip of ddsperf ping with {size} bytes at {SELDOM[0]}, before and after: "
          f"{trips[0]:.1f} and {trips[1]:.1f} us: {median / trip:.2f} times; back to back: "
          f"{back_to_back:.1f} us\n", flush=True)
    return figures | {"publish_to_step_over_roundtrip": median / trip,
                      "publish_to_step_over_back_to_back": median / back_to_back}
