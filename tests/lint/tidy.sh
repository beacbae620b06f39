#!/usr/bin/env bash
# clang-tidy over all sources (some ten minutes on two cores, so it is apart from the suite), or over
# the files that are named. Works on the preset separate,
# which it configures.
set -euo pipefail
cd "$(dirname "$0")/../.."
[ -f build/separate/compile_commands.json ] || cmake --preset separate -DBUILD_TESTING=ON >/dev/null
files=("$@")
[ ${#files[@]} -gt 0 ] ||
  mapfile -t files < <(git ls-files 'identification/*.cpp' 'storage/*.cpp' 'service/*.cpp')
printf '%s\n' "${files[@]}" | xargs -P "$(nproc)" -n 1 clang-tidy -p build/separate --quiet
