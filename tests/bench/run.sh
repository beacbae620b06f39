#!/usr/bin/env bash
# Benchmarks and measurements, apart from the tests. Builds the release preset first.
#   tests/bench/run.sh loop FILE.csv...   BUPT-1 telemetry through the real processes, as fast as
#                                         they take it: what was archived, tried and approved.
#                                         The last line is one JSON object
#   tests/bench/run.sh identification [DATA_FOLDER]
#                                         time, memory and free-run error compared with SLICOT,
#                                         on one thread each. With DATA_FOLDER, which holds DaISy
#                                         data sets as daisy_NAME.csv (columns u1.. y1..), also
#                                         accuracy compared with SLICOT and Octave, and SLICOT's
#                                         published figures.
#                                         The last line is one JSON object. Without SLICOT or
#                                         Octave it says what it leaves out
#   tests/bench/run.sh field FOLDER       free-run error on benchmark data of the identification
#                                         literature, compared with published figures: those of
#                                         dataBenchmark.csv (cascaded tanks), SNLS80mV.csv
#                                         (Silverbox), WienerHammerBenchmark.csv, f-16.txt and
#                                         cylinders.csv that FOLDER holds, as they are published.
#                                         The last line is one JSON object
#   tests/bench/run.sh paper [DATA_FOLDER] [--pictures FOLDER]
#                                         the paper's table: errors of the simulator's own model,
#                                         the identified one, with pole placement and with integral
#                                         feedback, on the reference spacecraft and, with
#                                         DATA_FOLDER, on BUPT-1's files (bupt1_eps_*.csv) in it;
#                                         drawn to FOLDER as SVG.
#                                         The last line is one JSON object
#   tests/bench/run.sh archive [DATA_FOLDER] [--billion | --samples N] [--folder FOLDER]
#                                         the archive compared with a plain SQLite table: bytes a
#                                         sample, appending, reading, SQL; and two publishers over
#                                         DDS into it. With DATA_FOLDER also the size of BUPT-1's
#                                         telemetry (bupt1_eps_*.csv). The large archive has
#                                         100 million samples, or N, or a billion, and is made in
#                                         FOLDER.
#                                         The last line is one JSON object
#   tests/bench/run.sh import FILE.csv [--other BUILD] [--runs N]
#                                         `reident import` of a file compared with the SQLite shell's,
#                                         and with the build of another commit.
#                                         The last line is one JSON object
#   tests/bench/run.sh screening FILE.csv --input NAME... --output NAME... [--time NAME] [--window ROWS]
#                                [--faults N] [--other PROGRAM]
#                                         what the screens for sensor faults leave out of a file's
#                                         telemetry, and how many of N faults of each kind they find
#                                         that are put into each window; compared with the same
#                                         program of another commit.
#                                         The last line is one JSON object
#   tests/bench/run.sh simulator          a version's way from the service to a step in another
#                                         process compared with ddsperf's round trip, a step
#                                         compared with the bare products, what a step allocates, a
#                                         hundred simulators that come late and go a hundred times,
#                                         the output's jump at a swap.
#                                         The last line is one JSON object
#   tests/bench/run.sh web [--days N] [--repetitions N] [--archive FILE]
#                                         the operators' page: bytes and time of its views in
#                                         Chromium, a year of telemetry, viewers, slow clients, what
#                                         ingest loses by them.
#                                         The last line is one JSON object
#   tests/bench/run.sh operations [PART...] [--quick]
#   tests/bench/run.sh operations soak [--minutes N] [--seed N]
#                                         operation in a failing and hostile world: packages under a
#                                         real systemd, networks that are cut, a pair of services whose
#                                         leader is killed or hangs, what seven kinds of intruders see
#                                         and reach, and what security costs; and a soak: telemetry
#                                         at 300 times real time (--speed N) while services, disks,
#                                         clocks and networks fail at random. Needs root; says what
#                                         it leaves out. The last line is one JSON object
#   tests/bench/run.sh fuzz [TARGET...] [--runs N] [--seconds N]
#                                         libFuzzer's targets of tests/fuzz, 10 million inputs each
#                                         or for an hour. The last line is one JSON object
#   tests/bench/run.sh scale [--services N] [--spacecraft N] [--days N] [--samples N] [--folder FOLDER]
#                                         a hundred services and simulators on this machine: until
#                                         all have found each other, what they take when idle, and
#                                         their status; a sweep of six spacecraft over 30 days on
#                                         one core, on two
#                                         and as a Slurm array on two emulated nodes, which needs
#                                         root: whether the bits are equal, and the speed-up; an
#                                         archive of a billion samples, or N, compared with a million,
#                                         also with a year in a shard, and what grows with
#                                         samples and with equipment.
#                                         The last line is one JSON object
#   tests/bench/run.sh build [--suite]    processor and wall time of a build from nothing, without
#                                         and with the tests; with --suite also of the tests.
#                                         The last line is one JSON object
#   tests/bench/run.sh record [--as NAME] WHAT ARGUMENT...
#                                         runs one of these and stores the object of its last line
#                                         in tests/bench/results/NAME.json (default: WHAT.json),
#                                         with commit, date and machine, and writes RESULTS.md.
#                                         WHAT may also be trust, month or trust_dds, which are
#                                         tests/trust/run.sh with --month or --dds for the last two
set -euo pipefail
cd "$(dirname "$0")/../.."
export PYTHONDONTWRITEBYTECODE=1
usage() {
  sed -n '2,/^set /{/^set /d;s/^# \{0,1\}//p}' "$0" >&2
  exit 2
}
what=${1:-}
[ $# -gt 0 ] && shift
targets=(all)
case $what in
  build)
    deploy/install_packages.sh --with-tests
    exec python3 tests/bench/build.py . "$@"
    ;;
  fuzz)
    deploy/install_packages.sh --with-tests
    for preset in fuzz fuzz-quick; do
      cmake --preset $preset >/dev/null
      cmake --build --preset $preset --target fuzz_targets >/dev/null
    done
    exec python3 tests/bench/fuzz.py build/fuzz build/fuzz-quick "$@"
    ;;
  record)
    [ $# -gt 0 ] || usage
    exec python3 tests/bench/record.py "$@"
    ;;
  loop)
    [ $# -gt 0 ] || usage
    arguments=(build/release/service deploy "$@")
    ;;
  identification)
    [ $# -le 1 ] || usage
    [ $# -eq 0 ] || [ -d "$1" ] || { echo "$1 is no folder of data sets" >&2; exit 2; }
    arguments=(build/release "$@")
    deploy/install_packages.sh --with-bench || echo "going on without the tools that are missing"
    ;;
  field)
    [ $# -eq 1 ] || usage
    [ -d "$1" ] || { echo "$1 is no folder of benchmark data" >&2; exit 2; }
    arguments=(build/release "$@")
    targets=(reident reident_identification_bench)
    ;;
  paper)
    [ $# -eq 0 ] || [[ $1 == --* ]] || [ -d "$1" ] ||
      { echo "$1 is no folder of telemetry" >&2; exit 2; }
    arguments=(build/release "$@")
    targets=(reident_paper_bench satcs-reference)
    ;;
  archive)
    [ $# -eq 0 ] || [[ $1 == --* ]] || [ -d "$1" ] ||
      { echo "$1 is no folder of telemetry" >&2; exit 2; }
    arguments=(build/release "$@")
    targets=(reident_archive_bench reident_bench_publisher reidentd)
    ;;
  import)
    [ $# -gt 0 ] || usage
    arguments=(build/release "$@")
    targets=(reident)
    ;;
  screening)
    [ $# -gt 0 ] || usage
    arguments=(build/release/tests/bench/screening/reident_screening_bench "$@")
    targets=(reident_screening_bench)
    ;;
  simulator)
    [ $# -eq 0 ] || usage
    arguments=(build/release)
    targets=(reident_step_bench reident_swap_bench reident_jump_bench reidentd reident
             reident-simulator satcs-replay)
    ;;
  scale)
    arguments=(build/release deploy "$@")
    targets=(reident reidentd reident-simulator satcs-reference reident_archive_bench
             reident_telemetry reident_web_archive)
    ;;
  web)
    arguments=(build/release "$@")
    targets=(reident_web_archive reidentd reident reident-web satcs-replay satcs-reference)
    ;;
  operations)
    arguments=(build/release "$@")
    targets=(reidentd reident satcs-reference reident-simulator e2e_programs forge_permissions lax_access_control
             reident_bench_publisher)
    deploy/install_packages.sh --with-packages || echo "going on without the tools that are missing"
    ;;
  *)
    usage
    ;;
esac
deploy/install_packages.sh --with-tests
cmake --preset release -DBUILD_TESTING=ON >/dev/null
if [ "$what" = identification ]; then
  targets=(reident reident_identification_bench)
  if cmake --build --preset release --target help | grep '^slicot_n4sid:' >/dev/null; then
    targets+=(slicot_n4sid)
  fi
fi
if [ "$what" = archive ] &&
  cmake --build --preset release --target help | grep '^reident_telemetry:' >/dev/null; then
  targets+=(reident_telemetry)
fi
if [ "$what" = web ]; then npm ci --prefix tests/e2e/browser --no-audit --no-fund >/dev/null; fi
cmake --build --preset release --target "${targets[@]}" >/dev/null
exec python3 "tests/bench/$what.py" "${arguments[@]}"
