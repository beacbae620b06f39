"""The programs that measure, and what they print."""

import json
import os
import statistics
import subprocess

# The loopback configuration of the programs themselves holds.
ENVIRONMENT = {key: value for key, value in os.environ.items() if key != "CYCLONEDDS_URI"}


class Programs:
    def __init__(self, build):
        self.bench = build / "tests/bench/archive/reident_archive_bench"
        self.publisher = build / "tests/bench/archive/reident_bench_publisher"
        self.daemon = build / "service/daemon/reidentd"
        extension = build / "storage/sql/reident_telemetry.so"
        self.extension = extension if extension.exists() else None

    def measure(self, *words):
        """One measurement in a process of its own."""
        done = subprocess.run([str(self.bench), *map(str, words)], capture_output=True, text=True,
                              env=ENVIRONMENT)
        if done.returncode != 0:
            raise SystemExit(f"reident_archive_bench {' '.join(map(str, words))}\n{done.stderr}")
        return json.loads(done.stdout)


def spread(values, form="{:.3g}"):
    """The median, and the least and the greatest where there are several."""
    text = form.format(statistics.median(values))
    if len(values) == 1:
        return text
    return f"{text} ({form.format(min(values))} to {form.format(max(values))})"


def table(header, rows):
    print("| " + " | ".join(header) + " |")
    print("|" + "---|" * len(header))
    for row in rows:
        print("| " + " | ".join(str(cell) for cell in row) + " |", flush=True)
    print()
