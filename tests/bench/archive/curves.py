"""What grows with the samples of an archive, and with the equipment of a registry: one row for each
size. Seconds of processor time, the least of several runs, but for verify and backup, whose time is
elapsed.
"""

import subprocess
import time

from growth import PARAMETERS, STEP_FRAMES, least_processor_s

EQUIPMENT = (1, 10, 100)


def processor_s(command):
    return round(least_processor_s(lambda: subprocess.run(command, check=False,
                                                          capture_output=True)), 4)


def elapsed_s(command):
    begin = time.monotonic()
    subprocess.run(list(map(str, command)), check=True, capture_output=True)
    return round(time.monotonic() - begin, 3)


def over_samples(growth, most):
    """From a million to `most`, ten times as many in each row."""
    rows, file, frames, samples = [], growth.folder / "curve.db", 0, 1_000_000
    while samples <= most * 1.001:
        wanted = int(samples) // PARAMETERS
        growth.programs.measure("append", "archive", file, "--frames", wanted - frames,
                                "--parameters", PARAMETERS, "--load")
        frames, backup = wanted, growth.folder / "backup.db"
        rows.append({
            "samples": frames * PARAMETERS, "bytes": file.stat().st_size,
            "append_million_s": round(growth.append_s(file) * 1e6 / (STEP_FRAMES * PARAMETERS), 4),
            "window_ms": round(1000 * growth.window_s(file), 3),
            "backup_s": elapsed_s([growth.reident, "backup", file, backup]),
            "verify_s": elapsed_s([growth.reident, "verify", file])})
        backup.unlink()
        samples *= 10
    return rows


def over_equipment(web_archive, reident, folder):
    rows = []
    for count in EQUIPMENT:
        file = folder / f"equipment-{count}.db"
        subprocess.run([web_archive, file, "1", str(count)], check=True)
        rows.append({"equipment": count,
                     "overview_s": processor_s([reident, "overview", "--db", file]),
                     "history_s": processor_s([reident, "history", "--db", file]),
                     "waiting_s": processor_s([reident, "waiting", "--db", file])})
    return rows
