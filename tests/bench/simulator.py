"""Simulators and the versions that they run: how soon, at what cost, with what jump, and how many.

    simulator.py BUILD [--quick]

Every time stands over another one of the same run. Prints what was measured and, as the last line,
one JSON object of the figures.
"""

import argparse
import json
import statistics
import subprocess
import sys
import tempfile
from pathlib import Path

sys.path.insert(0, str(Path(__file__).parent / "simulator"))

import crowd  # noqa: E402: found in the folder above
import swaps  # noqa: E402
from service import Programs, Scale  # noqa: E402

FULL = Scale(pairs=200, repetitions=201, steps=1_000_000, swaps=100, flips=200, ping_s=10,
             simulators=100, cycles=100)
QUICK = Scale(pairs=10, repetitions=3, steps=10_000, swaps=3, flips=4, ping_s=2, simulators=8,
              cycles=2)


def jumps(programs, scale):
    """A swap in the middle of a smooth run, over seeded pairs of versions."""
    lines = subprocess.run([programs.jump, str(scale.pairs)], stdout=subprocess.PIPE, text=True,
                           check=True).stdout.split()
    values = sorted(map(float, lines))
    print(f"swap in mid-run, {len(values)} pairs of versions: the output moves in a step by "
          f"{statistics.median(values):.2f} (median) and at most {values[-1]:.2f} times the larger "
          "model's own\n", flush=True)
    return {"pairs": len(values), "swap_jump_max": values[-1]}


def steps(programs, scale):
    """The time of a step, and what a thread that steps and swaps asks for."""
    done = subprocess.run([programs.step, str(scale.repetitions), str(scale.steps),
                           str(scale.swaps)], stdout=subprocess.PIPE, text=True, check=True)
    found = json.loads(done.stdout)
    ratio = found["step_ns"] / found["handwritten_ns"]
    print(f"reident_step, order 6, 4 inputs, 1 output: {found['step_ns']:.1f} ns, the unrolled "
          f"products of the same matrices {found['handwritten_ns']:.1f} ns (medians of "
          f"{scale.repetitions} turns of 20,000 steps each): {ratio:.2f} times\n"
          f"{found['steps']} steps with {found['swaps']} swaps: {found['allocations']} calls of "
          f"malloc, calloc, realloc, free and their relatives, counted in the process, and "
          f"{found['system_calls']} system calls, by seccomp\n", flush=True)
    return {**{key: found[key] for key in ("step_ns", "handwritten_ns", "steps", "swaps",
                                           "system_calls")},
            "step_over_handwritten": ratio, "step_allocations": found["allocations"]}


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("build", type=Path, help="folder that the programs were built in")
    parser.add_argument("--quick", action="store_true",
                        help="little of each, to test the measurement itself: the figures say "
                        "nothing")
    arguments = parser.parse_args()
    programs = Programs(arguments.build.resolve())
    scale = QUICK if arguments.quick else FULL
    figures = jumps(programs, scale) | steps(programs, scale)
    with tempfile.TemporaryDirectory(prefix="reident-simulator-") as name:
        figures |= swaps.measure(programs, Path(name), scale)
    with tempfile.TemporaryDirectory(prefix="reident-simulator-") as name:
        figures |= crowd.measure(programs, Path(name), scale)
    print(json.dumps(figures))


if __name__ == "__main__":
    main()
