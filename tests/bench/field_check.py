"""Checks field.py BUILD on files in the published formats, of linear systems whose noise is known."""

import json
import math
import random
import subprocess
import sys
import tempfile
from pathlib import Path

NOISE = 0.05


def tanks(rng, rows):
    """Levels held for 20 rows, and the lower one of two tanks in a row behind them, measured."""
    levels = [rng.uniform(1, 5) for _ in range(rows // 20 + 1)]
    inputs, outputs, upper, lower = [], [], 3.0, 3.0
    for k in range(rows):
        inputs.append(levels[k // 20])
        outputs.append(lower + rng.gauss(0, NOISE))
        upper, lower = 0.9 * upper + 0.1 * inputs[-1], 0.8 * lower + 0.2 * upper
    return inputs, outputs


def write_files(folder):
    rng = random.Random(5)
    estimation, validation = tanks(rng, 1024), tanks(rng, 1024)
    rows = [f"{a:.5f},{b:.5f},{c:.5f},{d:.5f},{4 if k == 0 else ''},"
            for k, (a, b, c, d) in enumerate(zip(estimation[0], validation[0], estimation[1],
                                                 validation[1]))]
    (folder / "dataBenchmark.csv").write_text(
        "\n".join(['"uEst","uVal","yEst","yVal","Ts",', *rows, ""]))
    first, second = tanks(rng, 2390), tanks(rng, 2390)
    (folder / "cylinders.csv").write_text("t,r0,r1,y0,y1\n" + "".join(
        f"{0.1 * k:.1f},{a},{b},{c + 0.5 * d},{d}\n"
        for k, (a, b, c, d) in enumerate(zip(first[0], second[0], first[1], second[1]))))
    (folder / "SNLS80mV.csv").write_text("V1,V2\n0.1,0.2\n")


def main():
    with tempfile.TemporaryDirectory(prefix="reident-field-check-") as name:
        write_files(Path(name))
        done = subprocess.run([sys.executable, Path(__file__).with_name("field.py"), sys.argv[1],
                               name], stdout=subprocess.PIPE, text=True, check=True)
    found = json.loads(done.stdout.splitlines()[-1])
    assert set(found["left_out"]) == {"Silverbox", "Wiener-Hammerstein 2009", "F-16 vibration"}
    assert "109650" in found["left_out"]["Silverbox"], found["left_out"]
    expected = {"cascaded tanks": [NOISE], "cylinders": [NOISE * math.sqrt(1.25), NOISE]}
    for data_set, noises in expected.items():
        result = found["sets"][data_set]
        assert result["order"] == 2 * len(noises), result
        for error, noise in zip(result["rmse"], noises, strict=True):
            assert 0.9 * noise < error < 1.1 * noise, (data_set, error, noise)


if __name__ == "__main__":
    main()
