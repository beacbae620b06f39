#!/usr/bin/env bash
# Installs what is missing, builds and runs the tests.
#   tests/run.sh                     all tests, warnings as errors, assertions on
#   tests/run.sh --preset asan       the same under a sanitizer (asan or tsan), lint left out
#   tests/run.sh -R Gate             any option of ctest
set -euo pipefail
cd "$(dirname "$0")/.."

preset=ci
if [ "${1:-}" = --preset ]; then
  preset=$2
  shift 2
fi
deploy/install_packages.sh --with-tests
cmake --preset "$preset" >/dev/null
cmake --build --preset "$preset"
exclude=()
[ "$preset" = ci ] || exclude=(-LE lint)
ctest --preset "$preset" -j "$(nproc)" "${exclude[@]}" "$@"
