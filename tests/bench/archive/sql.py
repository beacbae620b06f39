"""The average of one parameter over a month, in SQL."""

import statistics

from files import remove
from programs import spread

START = 1_498_867_200 * 10**9  # the first frame of the telemetry
DAY = 86_400 * 10**9
QUESTIONS = {
    "plain": "SELECT avg(value) FROM sample WHERE parameter = 1 AND time >= ? AND time < ?",
    "rows": "SELECT avg(value) FROM telemetry WHERE spacecraft = 'MISSION' AND parameter = 'P1' "
            "AND time >= ? AND time < ?",
    "summary": "SELECT mean FROM telemetry_summary WHERE spacecraft = 'MISSION' "
               "AND parameter = 'P1' AND begin_time = ? AND end_time = ?",
}


def month(programs, folder, scale):
    keys = {"summary": "sql_month_vs_plain", "rows": "sql_month_rows_vs_plain"}
    if not programs.extension:
        print("SQL over a month is left out: the loadable extension was not built\n")
        return dict.fromkeys(keys.values())
    files = {kind: folder / f"month-{kind}.db" for kind in ("archive", "plain")}
    for kind, file in files.items():
        programs.measure("append", kind, file, "--frames", (scale.month_days + 2) * 86_400,
                         "--parameters", scale.month_parameters, "--load")
    times, averages = {name: [] for name in QUESTIONS}, set()
    for _ in range(scale.repeats):
        for name in QUESTIONS:
            more = [] if name == "plain" else ["--extension", programs.extension]
            result = programs.measure(
                "ask", files["plain" if name == "plain" else "archive"], QUESTIONS[name],
                "--values", START + DAY, START + (1 + scale.month_days) * DAY, *more)
            times[name].append(result["ms"])
            averages.add(round(result["answer"], 9))
    for file in files.values():
        remove(file)
    if len(averages) != 1:
        raise SystemExit(f"the averages of the month differ: {averages}")
    print(f"Average of one parameter over {scale.month_days} days at 1 Hz, ms: from "
          f"telemetry_summary {spread(times['summary'])}; avg(value) of telemetry "
          f"{spread(times['rows'])}; avg(value) of the plain table {spread(times['plain'])}\n")
    median = {name: statistics.median(some) for name, some in times.items()}
    return {key: median["plain"] / median[name] for name, key in keys.items()}
