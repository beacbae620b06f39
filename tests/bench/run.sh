#!/usr/bin/env bash
# Benchmarks and measurements, apart from the tests. Builds the release preset first.
#   tests/bench/run.sh loop FILE.csv...   BUPT-1 telemetry through the real processes, as fast as
#                                         they take it: what was archived, tried and approved
set -euo pipefail
cd "$(dirname "$0")/../.."
what=${1:-}
[ $# -gt 0 ] && shift
case $what in
  loop)
    [ $# -gt 0 ] || { echo "usage: tests/bench/run.sh loop FILE.csv..." >&2; exit 2; }
    ;;
  *)
    sed -n '2,5s/^# \{0,1\}//p' "$0" >&2
    exit 2
    ;;
esac
deploy/install_packages.sh --with-tests
cmake --preset release >/dev/null
cmake --build --preset release >/dev/null
exec python3 "tests/bench/$what.py" build/release/service deploy "$@"
