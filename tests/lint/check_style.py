"""Rules of the house that no compiler checks. Prints each breach as file:line: message.

  - includes run one way: service -> {storage, identification, idl}
  - dds.h and the generated C types appear under service/dds alone, sqlite3.h under storage alone
  - identification does no I/O and has no clock, thread or log
  - functions fit on a screen or two, files hold one idea
  - tests wait for conditions; the top level is fixed; every header is included once
"""

import re
import subprocess
import sys
from pathlib import Path

MAX_FILE_LINES = 500
MAX_FUNCTION_LINES = 100
TOP_LEVEL = {"CMakeLists.txt", "CMakePresets.json", "README.md", "LICENSE", "CHANGELOG.md",
             "CONTRIBUTING.md", "CITATION.cff", "service", "idl", "storage", "identification", "tests",
             "deploy"}

FORBIDDEN_INCLUDES = [  # folder, pattern of what it must not include, why
    ("identification/", r"(storage|service|idl)/", "identification sees nobody"),
    ("identification/(?!examples/)", r"(i?o?f?stream|cstdio|chrono|thread|mutex|future|filesystem)$",
     "identification has no I/O, clock or thread"),
    ("storage/", r"(identification|service|idl)/|Eigen/", "storage sees nobody"),
    ("(?!service/dds/|tests/service/dds/)", r"dds/|(satcs|reident)\.h$",
     "DDS types appear under service/dds alone"),
    ("(?!storage/|tests/)", r"sqlite3\.h$", "SQLite appears under storage alone"),
    ("(?!service/support/)", r"spdlog/", "log through service/support/log.hpp"),
    # The data flow: a folder never includes one that comes after it.
    ("identification/(numerics|samples|simulation|statistics|screening|subspace|fit|correction)/",
     r"identification/search/", "what the search is made of does not know the search"),
    ("identification/(numerics|samples|simulation|statistics|screening)/",
     r"identification/(subspace|fit|correction)/", "models are fitted by what comes later"),
    ("storage/types/", r"storage/(?!types/)", "types are what others hold without a database"),
    ("storage/chunks/", r"storage/(?!types/|chunks/)", "a chunk is bytes, wherever they are kept"),
    ("storage/database/", r"storage/(archive|registry|care|chunks)/",
     "a database knows no table's content"),
    ("storage/registry/", r"storage/archive/", "models and telemetry are kept apart"),
    ("storage/archive/", r"storage/registry/", "telemetry and models are kept apart"),
    ("service/windows/", r"service/judgement/", "who makes a candidate does not judge it"),
    ("service/(config|windows|judgement|operations)/", r"service/daemon/",
     "no decision depends on threads and queues"),
    ("service/(config|windows|judgement)/", r"service/dds/", "no decision depends on the middleware"),
    ("service/review/", r"service/(operations|daemon|dds|cli)/", "it reads and decides nothing"),
    ("service/(sweep|fleet)/", r"service/(daemon|cli|web)/", "they work without a service"),
    ("service/cli/", r"service/daemon/", "the command line works without the daemon"),
    ("service/web/", r"service/(daemon|operations|cli)/", "the page writes nothing"),
    ("service/(?!web/)", r"service/web/|boost/(asio|beast)/", "HTTP appears under service/web alone"),
    ("service/(client|dds|model)/", r"storage/(?!types/)", "simulators hold no database"),
    ("(?!service/satcs/gateway/)", r"libxml/", "XML is read by the gateway alone"),
    ("service/satcs/gateway/(?!gateway_main)", r"service/dds/|service/satcs/(replay|reference|program)",
     "packets become frames without a middleware"),
    ("service/telemetry_file/", r"storage/|service/(?!support/|telemetry_file/)",
     "the reader of files knows files alone"),
]
ALLOWED = re.compile(r"service/dds/dds\.hpp$")


def tracked_files(root):
    listed = subprocess.run(["git", "ls-files", "-co", "--exclude-standard"], cwd=root,
                            capture_output=True, text=True)
    if listed.returncode == 0:
        return [line for line in listed.stdout.splitlines() if (root / line).is_file()]
    return [str(path.relative_to(root)) for path in root.rglob("*")
            if path.is_file() and "build" not in path.parts and ".git" not in path.parts]


def check_includes(name, lines):
    for number, line in enumerate(lines, 1):
        match = re.match(r'\s*#\s*include\s*[<"]([^>"]+)[>"]', line)
        if not match or ALLOWED.search(match[1]):
            continue
        for folder, pattern, why in FORBIDDEN_INCLUDES:
            if re.match(folder, name) and re.match(pattern, match[1]):
                yield number, f"includes {match[1]}: {why}"


def check_lengths(name, lines):
    if len(lines) > MAX_FILE_LINES:
        yield len(lines), f"{len(lines)} lines; a file of one idea has at most {MAX_FILE_LINES}"
    start = None  # a function's body begins at a line that ends in "{" at the left margin's level
    for number, line in enumerate(lines, 1):
        if re.match(r"[A-Za-z_].*\{$|^ {4}.*\) (const |noexcept |override )*\{$", line) and \
                not re.match(r"(namespace|struct|class|enum|union|extern)\b", line):
            start = number if start is None else start
        if line.startswith("}"):
            if start is not None and number - start > MAX_FUNCTION_LINES:
                yield start, f"a function of {number - start} lines; at most {MAX_FUNCTION_LINES}"
            start = None


def check_text(name, lines):
    for number, line in enumerate(lines, 1):
        if name.startswith("tests/") and name.endswith(".cpp") and \
                re.search(r"sleep_for|\busleep|\bsleep\(", line) and "poll" not in line:
            yield number, "sleeps; wait for a condition (a polling interval says so: // poll)"
        if re.search(r"\b(TODO|FIXME|XXX|HACK)\b", line):
            yield number, "a leftover"
    if name.endswith(".hpp") and not any(line.strip() == "#pragma once" for line in lines):
        yield 1, "no #pragma once"


def main():
    root = Path(sys.argv[1])
    breaches = []
    files = tracked_files(root)
    for name in files:
        if not name.startswith(".") and name.split("/")[0] not in TOP_LEVEL:
            breaches.append(f"{name}:1: not in the fixed top level")
        if not re.search(r"\.(cpp|hpp|c|h)$", name):
            continue
        lines = (root / name).read_text(encoding="utf-8").splitlines()
        for check in (check_includes, check_lengths, check_text):
            breaches += [f"{name}:{number}: {message}" for number, message in check(name, lines)]
    print("\n".join(breaches) if breaches else f"{len(files)} files keep the rules")
    return 1 if breaches else 0


if __name__ == "__main__":
    sys.exit(main())
