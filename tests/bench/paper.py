"""The paper's table: for each equipment the error of the simulator's own model, of the identified
one, with pole placement, and with integral feedback, on rows that nothing was chosen on. The error of
the output as it was a sample before stands next to that of integral feedback, which has seen it too.

    paper.py BUILD [DATA_FOLDER] [--pictures FOLDER]

BDR, BAT1 and MEA are those of the reference spacecraft; with DATA_FOLDER, which holds BUPT-1's
files, MPPT2 and BUS follow, of which there is no simulator. Prints a table as Markdown and, as the
last line, one JSON object of the figures. With --pictures the reference spacecraft's lines are
drawn there, as SVG.
"""

import argparse
import json
import subprocess
import sys
import tempfile
from pathlib import Path

REFERENCE = [
    ("BDR", ["I_BDRIN1", "I_BDRIN2"], "I_BDROUT"),
    ("BAT1", ["I_BAT1", "I_SAG1A", "I_SGBCHC", "V_BUS"], "V_BAT1"),
    ("MEA", ["I_BDROUT", "I_SG2", "I_BUS", "V_BUS"], "V_MEA"),
]
SIMULATED = {"BDR", "BAT1"}  # the hand-written model has no error amplifier
BUPT = [
    ("MPPT2", ["mppt2_uin_mv", "mppt2_iin_ma"], "mppt2_iout_ma", []),
    ("MPPT2 by power", ["power"], "mppt2_iout_ma",
     ["power=mppt2_uin_mv*mppt2_iin_ma/bus_u_mv"]),
    ("BUS", ["bus_i_ma", "mppt1_iout_ma", "mppt2_iout_ma", "payload_i_ma"], "bus_u_mv", []),
]
FILES = {"a": "bupt1_eps_a_20230429_20230511.csv", "b1": "bupt1_eps_b1_20230613_20230616.csv",
         "c": "bupt1_eps_c_20230626_20230705.csv"}


def run(command):
    done = subprocess.run([str(word) for word in command], capture_output=True, text=True)
    if done.returncode != 0:
        sys.exit(f"{' '.join(str(word) for word in command)}\n{done.stderr}")
    return done.stdout


def line(build, file, inputs, output, identify, validate, more):
    return json.loads(run([
        build / "tests/bench/paper/reident_paper_bench", file, "--input", *inputs,
        "--output", output, "--identify", f"0:{identify}", "--validate", validate, *more]))


def reference_lines(build, folder, rows, identify, tune, pictures):
    simulator = build / "service/satcs/satcs-reference"
    real, simulated = folder / "real.csv", folder / "simulated.csv"
    run([simulator, "--duration", f"{rows}s", "--csv", real])
    run([simulator, "--duration", f"{rows}s", "--csv", simulated, "--simulated"])
    for name, inputs, output in REFERENCE:
        more = ["--time", "unix_s"]
        if name in SIMULATED:
            more += ["--baseline", simulated]
        if pictures:
            more += ["--picture", pictures / f"{name.lower()}.svg",
                     "--unit", {"V": "V", "I": "A"}[output[0]]]
        yield name, line(build, real, inputs, output, identify, f"{identify + tune}:{rows}", more)


def recorded_lines(build, data):
    for name, inputs, output, derived in BUPT:
        for letter, file in FILES.items():
            with open(data / file) as text:
                rows = sum(1 for _ in text) - 1
            more = ["--time", "unix_s"] + [word for d in derived for word in ("--derive", d)]
            yield (f"{name}, file {letter}",
                   line(build, data / file, inputs, output, 15000, f"20000:{rows}", more))


def figure(part):
    return f"{part['mrse_percent']:.4g}" if part and part["mrse_percent"] is not None else "none"


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("build", type=Path, help="folder that the programs were built in")
    parser.add_argument("data", type=Path, nargs="?", help="folder of BUPT-1's files")
    parser.add_argument("--pictures", type=Path, help="folder to draw the lines to")
    parser.add_argument("--quick", action="store_true",
                        help="few rows, to test the table itself: the figures say nothing")
    arguments = parser.parse_args()
    sizes = (6000, 3000, 1000) if arguments.quick else (150000, 15000, 15000)
    if arguments.pictures:
        arguments.pictures.mkdir(parents=True, exist_ok=True)
    with tempfile.TemporaryDirectory(prefix="reident-paper-") as folder:
        lines = list(reference_lines(arguments.build.resolve(), Path(folder), *sizes,
                                     arguments.pictures))
    if arguments.data:
        lines += recorded_lines(arguments.build.resolve(), arguments.data)
    print("| equipment | order | rows to identify, tune, validate | simulator's own | identified |"
          " pole placement | integral feedback | the sample before |")
    print("|---|---|---|---|---|---|---|---|")
    for name, part in lines:
        print(f"| {name} | {part['order']} | {', '.join(str(n) for n in part['rows'].values())} | "
              + " | ".join(figure(part[kind]) for kind in
                           ("baseline", "identified", "pole_placement", "integral_feedback",
                            "last_sample"))
              + " |")
    print(json.dumps(dict(lines)))


if __name__ == "__main__":
    main()
