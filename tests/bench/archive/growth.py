"""What an archive costs when it has grown: appending, windows, a month in SQL and a verify of what
came in a day, compared with a small archive of the same telemetry. The large one is measured with
its telemetry in the database, and with that of 2017 in a shard.

Costs are processor time, the least of several runs: other work of the machine does not count. The
split and the verify are elapsed time.
"""

import resource
import shutil
import subprocess
import time

from sql import DAY, QUESTIONS, START

PARAMETERS = 24
SMALL_FRAMES = 41_667  # a million samples
MONTH_FRAMES = 32 * 86_400  # what a month is asked of must hold one
DAY_FRAMES = 86_400
STEP_FRAMES = 20_480
WINDOW = ("--rows", 15_000, "--series", 5, "--parameters", PARAMETERS)
WINDOWS, RUNS = 200, 3


def least_processor_s(run):
    """Processor seconds of the processes that `run` starts, the least of several runs."""
    least = float("inf")
    for _ in range(RUNS):
        before = resource.getrusage(resource.RUSAGE_CHILDREN)
        run()
        after = resource.getrusage(resource.RUSAGE_CHILDREN)
        least = min(least, after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime)
    return least


class Growth:
    def __init__(self, programs, reident, folder):
        self.programs, self.reident, self.folder = programs, reident, folder

    def make(self, name, frames):
        file = self.folder / f"{name}.db"
        self.programs.measure("append", "archive", file, "--frames", frames, "--parameters",
                              PARAMETERS, "--load")
        return file

    def cpu_s(self, *words):
        return least_processor_s(lambda: self.programs.measure(*words))

    def window_s(self, file):
        one, many = (self.cpu_s("read", "archive", file, "--windows", count, *WINDOW)
                     for count in (1, WINDOWS))
        return (many - one) / (WINDOWS - 1)

    def append_s(self, file):
        """Into a copy, so that the archive stays as it is."""
        copy = self.folder / "copy.db"
        shutil.copy(file, copy)
        if (shards := file.with_name(file.name + ".shards")).exists():
            shutil.copytree(shards, copy.with_name(copy.name + ".shards"), dirs_exist_ok=True)
        return min(self.programs.measure("append", "archive", copy, "--frames", STEP_FRAMES,
                                         "--parameters", PARAMETERS)["processor_s"]
                   for _ in range(RUNS))

    def month_s(self, file, question):
        return self.cpu_s("ask", file, QUESTIONS[question], "--extension", self.programs.extension,
                          "--values", START + DAY, START + 31 * DAY)

    def verify_day_s(self, file):
        known = self.folder / "known"
        verify = [self.reident, "verify", file, "--known", known]
        subprocess.run(verify, check=True, capture_output=True)
        self.programs.measure("append", "archive", file, "--frames", DAY_FRAMES, "--parameters",
                              PARAMETERS)
        begin = time.monotonic()
        subprocess.run(verify, check=True, capture_output=True)
        return time.monotonic() - begin


def measure(programs, reident, folder, samples):
    growth = Growth(programs, reident, folder)
    small = growth.make("small", SMALL_FRAMES)
    month = growth.make("month", MONTH_FRAMES)
    frames = max(MONTH_FRAMES, int(samples) // PARAMETERS)
    large = growth.make("large", frames)
    small_append, small_window = growth.append_s(small), growth.window_s(small)
    small_month = {name: growth.month_s(month, name) for name in ("rows", "summary")}
    figures = {"growth_samples": frames * PARAMETERS, "growth_bytes": large.stat().st_size}

    def ratios(suffix):
        months = [growth.month_s(large, name) / least for name, least in small_month.items()]
        return {f"billion_append{suffix}": round(growth.append_s(large) / small_append, 3),
                f"billion_window{suffix}": round(growth.window_s(large) / small_window, 3),
                f"billion_month{suffix}": round(max(months), 3)}

    figures |= ratios("")
    begin = time.monotonic()
    subprocess.run([reident, "archive", "split", large, "--before", "2018"], check=True,
                   capture_output=True)
    figures["split_s"] = round(time.monotonic() - begin, 2)
    figures |= ratios("_of_shards")
    figures["verify_day_s"] = round(growth.verify_day_s(large), 2)
    return figures
