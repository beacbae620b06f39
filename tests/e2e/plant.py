"""Telemetry with a known truth: a two-input, one-output plant of second order, written as CSV."""

import random

HEADER = ["unix_s", "drive_v", "load_a", "out_v"]
INPUTS, OUTPUTS = ["drive", "load"], ["out"]
START_S = 1_600_000_200  # a multiple of every slide that the tests use


def rows(count, first=0, gain=1.0, noise=0.01, seed=1):
    """Rows at 1 s from START_S + first on. `gain` scales the plant: another satellite."""
    generator = random.Random(seed + first)
    x1 = x2 = drive = load = 0.0
    for k in range(count):
        if k % 17 == 0:
            drive = generator.choice([0.0, 1.0, 2.0])
        if k % 29 == 0:
            load = generator.uniform(-1, 1)
        out = 5 + gain * (x1 + 0.5 * x2) + generator.gauss(0, noise)
        yield [START_S + first + k, round(drive, 6), round(load, 6), round(out, 6)]
        x1, x2 = 0.8 * x1 + 0.1 * x2 + 0.3 * drive, 0.7 * x2 - 0.1 * x1 + 0.2 * load


def write(path, lines):
    path.write_text("\n".join([",".join(HEADER), *(",".join(map(str, r)) for r in lines)]) + "\n")
    return path


def equipment(**changes):
    """A configuration table of the plant with windows of 10 minutes that slide by 5."""
    return {"name": "PLANT", "inputs": INPUTS, "outputs": OUTPUTS, "sample_period": "1s",
            "window": "10min", "slide": "5min", "cycle": "1min", "max_mrse": 20.0, **changes}
