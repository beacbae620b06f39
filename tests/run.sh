#!/usr/bin/env bash
# Installs what is missing, builds and runs the tests, in the tree that deploy/demo.sh builds in.
#   tests/run.sh                     all tests
#   tests/run.sh --preset asan       the same under a sanitizer (asan or tsan), without lint
#   tests/run.sh --preset separate   each file compiled by itself, so that includes stay honest
#   tests/run.sh -R Gate             any option of ctest
set -euo pipefail
cd "$(dirname "$0")/.."

preset=release
if [ "${1:-}" = --preset ]; then
  preset=$2
  shift 2
fi
deploy/install_packages.sh --with-tests
[ tests/e2e/browser/node_modules/.package-lock.json -nt tests/e2e/browser/package-lock.json ] ||
  npm ci --prefix tests/e2e/browser --no-audit --no-fund
cmake --preset "$preset" -DBUILD_TESTING=ON >/dev/null
cmake --build --preset "$preset"
exclude=()
case $preset in asan | tsan) exclude=(-LE lint) ;; esac
# Tests with processes of their own mostly wait for them: three tests for each processor.
ctest --preset "$preset" -j "$((3 * $(nproc)))" "${exclude[@]}" "$@"
