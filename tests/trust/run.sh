#!/usr/bin/env bash
# The trust suite: did any simulator get a worse model, and how soon did it get a better one?
# Builds the release preset first. The last line is one JSON object.
#   tests/trust/run.sh              a few minutes: two scenarios of every sixth life
#   tests/trust/run.sh --all        first the month, then the handful over DDS, then all scenarios
#                                   of both families, of a fresh draw; three hours on two cores.
#                                   Writes build/release/trust/report.md with pictures of the worst
#                                   cases
#   tests/trust/run.sh --month      a month of the whole subsystem through the real processes: how
#                                   long it takes, and where processor time goes
#   tests/trust/run.sh --dds [--scenario N...]
#                                   scenarios through the real processes: by default a handful, every
#                                   71st of both families
#   tests/trust/run.sh OPTION...    any options of reident_trust, such as --scenario 2 --plot 2.svg
#                                   (--help lists them)
set -euo pipefail
cd "$(dirname "$0")/../.."
deploy/install_packages.sh --with-tests
cmake --preset release -DBUILD_TESTING=ON >/dev/null
cmake --build --preset release --target reident_trust satcs-reference reidentd reident \
  >/dev/null
# The databases are read and written all the time, and thrown away.
if [ -z "${TMPDIR:-}" ] && [ -w /dev/shm ]; then
  export TMPDIR=/dev/shm
fi
program=build/release/tests/trust/reident_trust
month() {  # its database is on the disk of the build
  python3 tests/trust/month.py build/release/service deploy/reference.toml
}
over_dds() {
  python3 tests/trust/over_dds.py build/release "$@"
}
case ${1:-} in
  "")
    exec "$program" --quick
    ;;
  --all)
    shift
    mkdir -p build/release/trust
    month >build/release/trust/month.json
    over_dds | tail -n 1 >build/release/trust/dds.json
    exec "$program" --report build/release/trust --month build/release/trust/month.json \
      --dds build/release/trust/dds.json "$@"
    ;;
  --month)
    month
    ;;
  --dds)
    shift
    over_dds "$@"
    ;;
  *)
    exec "$program" "$@"
    ;;
esac
