"""The machine and the disk that the figures were measured on."""

import os
import statistics
import time
from pathlib import Path


def describe(folder):
    device, kind = mounted(folder)
    disk = {"processors": os.cpu_count(), "processor": processor(), "file_system": kind,
            "disk": device, "rotational": rotational(folder), "fdatasync_ms": fdatasync_ms(folder)}
    says = {True: "says that it rotates", False: "says that it does not rotate",
            None: "does not say whether it rotates"}[disk["rotational"]]
    print(f"{disk['processors']} processors {disk['processor']}; files on {kind}, {device}, which "
          f"{says}; 4 KiB and fdatasync take {disk['fdatasync_ms']:.3f} ms\n", flush=True)
    return disk


def processor():
    for line in Path("/proc/cpuinfo").read_text().splitlines():
        if line.startswith("model name"):
            return line.split(":", 1)[1].strip()
    return "of unknown kind"


def mounted(folder):
    """Device and file system of the longest mount point above the folder."""
    mounts = [line.split() for line in Path("/proc/mounts").read_text().splitlines()]
    above = [m for m in mounts if Path(folder).resolve().is_relative_to(m[1])]
    best = max(above, key=lambda m: len(m[1]), default=("unknown", "", "unknown"))
    return best[0], best[2]


def rotational(folder):
    number = os.stat(folder).st_dev
    at = Path(f"/sys/dev/block/{os.major(number)}:{os.minor(number)}")
    for file in (at / "queue/rotational", at / "../queue/rotational"):
        if file.exists():
            return file.read_text().strip() == "1"
    return None


def fdatasync_ms(folder, times=100):
    file = os.open(folder / "sync", os.O_CREAT | os.O_WRONLY, 0o600)
    took = []
    for _ in range(times):
        os.write(file, bytes(4096))
        begin = time.perf_counter()
        os.fdatasync(file)
        took.append((time.perf_counter() - begin) * 1e3)
    os.close(file)
    os.unlink(folder / "sync")
    return statistics.median(took)
