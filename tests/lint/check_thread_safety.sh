#!/usr/bin/env bash
# Compiles, without output, every source that can see an annotated mutex with clang's analysis.
#   check_thread_safety.sh CLANG++ EXPORTS SOURCES
set -euo pipefail
includes=()
for component in "$2"/*/; do includes+=(-I "$component"); done
cd "$3"
# reader_impl.hpp needs types that the build generates.
headers=$(grep -rl 'support/mutex[.]hpp' --include='*.hpp' service | grep -v dds/reader_impl |
          xargs -n 1 basename | paste -sd'|')
users=$(grep -rlE "support/mutex[.]hpp|/($headers)\"" --include='*.cpp' service)
printf '%s\n' $users | xargs -P "$(nproc)" -n 1 "$1" -std=c++20 -fsyntax-only -Wno-everything \
  -Wthread-safety -Werror=thread-safety -isystem /usr/include/eigen3 "${includes[@]}"
echo "$(wc -w <<<"$users") sources hold their locks"
