"""A hundred simulators that come at once, late, and go again; and what the service keeps of them."""

import signal
import statistics
import subprocess
import time

from service import DEADLINE_S, ENVIRONMENT, SPACECRAFT, running, telemetry, wait_until

EQUIPMENT = [f"UNIT{number}" for number in range(5)]
KILLED_EACH = 10  # of so many cycles the last one ends without a word
LEASE_S = 10  # after which the middleware forgets who was killed


def measure(programs, folder, scale):
    with running(programs, folder, EQUIPMENT) as service:
        service.replay(telemetry(700))
        if set(service.champions()) != set(EQUIPMENT):
            raise SystemExit(f"no champions\n{service.log.read_text()[-4000:]}")
        before = service.resident_mib()
        times, memory = [], []
        for number in range(scale.cycles):
            times.append(cycle(programs, service, number, scale.simulators))
            memory.append(service.resident_mib())
        # The service looks once a second for simulators that have left.
        time.sleep(1.5 * LEASE_S if scale.cycles >= KILLED_EACH else 3)
        memory.append(service.resident_mib())
    print(f"{scale.simulators} simulators started at once beside a service with {len(EQUIPMENT)} "
          f"champions, {scale.cycles} times: all have every champion "
          f"{statistics.median(times):.2f} s after the first start (median), {max(times):.2f} s at "
          f"most\nmemory of the service: {before:.1f} MiB before the first came, {memory[0]:.1f} after "
          f"the first cycle, {memory[-1]:.1f} after the last\n", flush=True)
    return {"simulators": scale.simulators, "champions": len(EQUIPMENT), "cycles": scale.cycles,
            "late_100_seconds": max(times), "late_median_seconds": statistics.median(times),
            "memory_mib": [before, memory[0], memory[-1]],
            "memory_growth_mib": memory[-1] - before}


def cycle(programs, service, number, count):
    """Seconds from the first start until every simulator has every champion; then they leave."""
    outputs = [service.folder / f"simulator-{number}-{i}.out" for i in range(count)]
    begin = time.monotonic()
    simulators = []
    try:
        for i, path in enumerate(outputs):
            with open(path, "wb") as out:
                simulators.append(subprocess.Popen(
                    [programs.simulator, "--spacecraft", SPACECRAFT, "--name",
                     f"simulator-{number}-{i}", "--json", "--cache", "", *service.endpoint],
                    stdout=out, stderr=subprocess.STDOUT, env=ENVIRONMENT))
        late = list(outputs)

        def all_adopted():
            late[:] = [path for path in late
                       if path.read_bytes().count(b'"adopted"') < len(EQUIPMENT)]
            return not late

        wait_until(all_adopted, "every simulator has every champion")
        took = time.monotonic() - begin
    finally:
        way = signal.SIGKILL if number % KILLED_EACH == KILLED_EACH - 1 else signal.SIGTERM
        for simulator in simulators:
            simulator.send_signal(way)
        for simulator in simulators:
            simulator.wait(DEADLINE_S)
    for path in outputs:
        path.unlink()
    return took
