"""Size, appending and reading: the archive's file compared with a plain table's."""

import statistics
from dataclasses import dataclass
from pathlib import Path

from programs import spread, table

PARAMETERS = 629  # of the mission's frames
BATCH = 512  # frames of a transaction: 5 MiB, as much as the service puts into one


@dataclass
class Scale:
    reference_s: int  # telemetry of the reference spacecraft
    large_frames: int
    large_plain_frames: int
    small_frames: int  # of 24 parameters
    step_frames: int  # of an append measurement
    repeats: int
    windows: int
    rows: int  # samples of a window
    month_days: int
    month_parameters: int
    end_to_end_samples: int


MOST_PLAIN = 100_000_000  # samples: a plain table of a billion takes 27 GB and half an hour


def scale(samples):
    frames = max(16_384, int(samples) // PARAMETERS)
    return Scale(reference_s=86_400, large_frames=frames,
                 large_plain_frames=min(frames, MOST_PLAIN // PARAMETERS), small_frames=41_667,
                 step_frames=16_384, repeats=3, windows=40, rows=15_000, month_days=30,
                 month_parameters=4, end_to_end_samples=10_000_000)


QUICK = Scale(reference_s=600, large_frames=300, large_plain_frames=300, small_frames=300,
              step_frames=100, repeats=1, windows=3, rows=200, month_days=1, month_parameters=1,
              end_to_end_samples=20_000)


def sizes(programs, folder, data, scale):
    """Bytes of the pages in use, all columns and indexes counted, after compaction."""
    rows, bupt = [], None
    recorded = sorted(Path(data).glob("bupt1_eps_*.csv")) if data else []
    for file in recorded:
        rows.append(size_row(file.stem, programs.measure("size", folder, "--csv", file)))
    if recorded:
        bupt = programs.measure("size", folder, "--csv", *recorded)
        rows.append(size_row("BUPT-1, these in one file", bupt))
    else:
        print("BUPT-1 is left out: no DATA_FOLDER with bupt1_eps_*.csv was given\n")
    reference = programs.measure("size", folder, "--reference", scale.reference_s)
    rows.append(size_row(f"reference spacecraft, {scale.reference_s} s", reference))
    print("Size, bytes in use a sample\n")
    table(["telemetry", "samples", "archive", "plain table", "ratio"], rows)
    return {"samples_bupt": bupt["samples"] if bupt else None,
            "bytes_per_sample_bupt": each(bupt, "archive"),
            "bytes_per_sample_plain_bupt": each(bupt, "plain"),
            "bytes_per_sample_reference": each(reference, "archive"),
            "bytes_per_sample_plain": each(reference, "plain")}


def each(result, kind):
    return result[f"{kind}_bytes"] / result["samples"] if result else None


def size_row(name, result):
    archive, plain = each(result, "archive"), each(result, "plain")
    return name, result["samples"], f"{archive:.3f}", f"{plain:.1f}", f"{plain / archive:.0f}"


def rate(result):
    """Samples a second, with all the work that they make: compaction, folding the log in."""
    return result["samples"] / (result["append_s"] + result["settle_s"])


def effort(results):
    """Processor time of a sample: what is left of the comparison where others use the machine."""
    return statistics.median(r["processor_s"] / r["samples"] for r in results)


def remove(file):
    for name in (file, Path(f"{file}-wal"), Path(f"{file}-shm"), Path(f"{file}.lock")):
        name.unlink(missing_ok=True)


def appends_and_reads(programs, folder, scale):
    large = {kind: folder / f"large-{kind}.db" for kind in ("archive", "plain")}
    frames = {"archive": scale.large_frames, "plain": scale.large_plain_frames}
    for kind, file in large.items():
        programs.measure("append", kind, file, "--frames", frames[kind], "--load")
    if frames["plain"] < frames["archive"]:
        print(f"The large plain table has {frames['plain'] * PARAMETERS:.3g} samples only\n")
    figures = reads(programs, folder, scale, large)
    figures |= appends(programs, folder, scale, large)
    for file in large.values():
        remove(file)
    return figures


def appends(programs, folder, scale, large):
    """Interleaved, so that what else the machine does falls on all alike."""
    def into(kind, file):
        return programs.measure("append", kind, file, "--frames", scale.step_frames, "--batch",
                                BATCH)

    empty = {kind: [] for kind in large}
    full = {kind: [] for kind in large}
    for _ in range(scale.repeats):
        for kind, file in large.items():
            fresh = folder / f"fresh-{kind}.db"
            empty[kind].append(into(kind, fresh))
            remove(fresh)
            full[kind].append(into(kind, file))
    print(f"Appending {scale.step_frames} frames of {PARAMETERS} samples, {BATCH} frames a commit, "
          "synchronous = FULL, compaction and the last checkpoint included; median (least to "
          f"greatest) of {scale.repeats}\n")
    rows = []
    for kind in large:
        frames = scale.large_frames if kind == "archive" else scale.large_plain_frames
        for name, results in (("empty", empty[kind]),
                              (f"{frames * PARAMETERS:.3g} samples", full[kind])):
            rows.append([kind, name, spread([rate(r) / 1e6 for r in results]),
                         spread([r["samples"] / r["processor_s"] / 1e6 for r in results]),
                         spread([r["longest_append_ms"] for r in results], "{:.0f}"),
                         spread([r["peak_mib"] for r in results], "{:.0f}")])
    table(["file", "begins with", "million samples a second",
           "the same, of processor time", "longest append, ms",
           "writer's memory at most, MiB"], rows)
    median = {(kind, name): statistics.median(map(rate, results))
              for name, group in (("empty", empty), ("large", full))
              for kind, results in group.items()}
    return {"append_per_s": median["archive", "empty"],
            "append_plain_per_s": median["plain", "empty"],
            "append_vs_plain": median["archive", "empty"] / median["plain", "empty"],
            "append_processor_vs_plain": effort(empty["plain"]) / effort(empty["archive"]),
            "append_processor_large_over_empty": effort(empty["archive"]) / effort(full["archive"]),
            "append_large_vs_plain": median["archive", "large"] / median["plain", "large"],
            "append_large_over_empty": median["archive", "large"] / median["archive", "empty"],
            "longest_append_ms": max(r["longest_append_ms"]
                                     for group in (empty, full) for r in group["archive"]),
            "writer_peak_mib": max(r["peak_mib"] for r in full["archive"]),
            "writer_peak_small_mib": max(r["peak_mib"] for r in empty["archive"])}


def reads(programs, folder, scale, large):
    small = {kind: folder / f"small-{kind}.db" for kind in large}
    for kind, file in small.items():
        programs.measure("append", kind, file, "--frames", scale.small_frames, "--parameters", 24,
                         "--load")
    common = ["--windows", scale.windows, "--rows", scale.rows]
    alike = scale.large_frames == scale.large_plain_frames
    places = [("small", small, ["--parameters", 24], True), ("large", large, [], alike),
              ("large, nothing of the file in memory", large, ["--cold"], alike)]
    rows, median = [], {}
    for name, files, more, same in places:
        found = {kind: [] for kind in large}
        digests = {kind: set() for kind in large}
        for _ in range(scale.repeats):
            for kind in large:
                result = programs.measure("read", kind, files[kind], *common, *more)
                found[kind] += result["window_ms"]
                digests[kind].add(result["digest"])
        if same and digests["archive"] != digests["plain"]:
            raise SystemExit(f"the {name} archive and the plain table differ")
        for kind in large:
            median[kind, name] = statistics.median(found[kind])
        rows.append([name, spread(found["archive"]), spread(found["plain"]),
                     f"{median['plain', name] / median['archive', name]:.1f}"])
    tail = live_tail(programs, folder, scale, common)
    rows.append(["newest samples, the last of them not compacted", spread(tail), "", ""])
    for file in small.values():
        remove(file)
    print(f"Reading a window of {scale.rows} samples of 5 parameters into arrays, ms\n")
    table(["samples", "archive", "plain table", "ratio"], rows)
    return {"large_samples": scale.large_frames * PARAMETERS,
            "window_samples": scale.large_frames * PARAMETERS,
            "window_read_vs_plain": median["plain", "large"] / median["archive", "large"],
            "window_read_small_vs_plain": median["plain", "small"] / median["archive", "small"],
            "window_read_large_over_small": median["archive", "large"] / median["archive", "small"],
            "window_read_ms": median["archive", "large"],
            "window_read_tail_ms": statistics.median(tail)}


def live_tail(programs, folder, scale, common):
    """Windows that end with the newest sample, of an archive that is being written."""
    file = folder / "tail.db"
    programs.measure("append", "archive", file, "--frames", scale.rows + scale.rows // 3,
                     "--parameters", 24, "--batch", BATCH)
    programs.measure("append", "archive", file, "--frames", scale.rows // 5, "--parameters", 24,
                     "--batch", 16, "--leave")
    result = programs.measure("read", "archive", file, *common, "--parameters", 24, "--newest")
    remove(file)
    return result["window_ms"]
