#!/usr/bin/env bash
# Compiles, without output, every source that can see an annotated mutex with clang's analysis.
#   check_thread_safety.sh CLANG++ EXPORTS SOURCES
set -euo pipefail
includes=()
for component in "$2"/*/; do includes+=(-I "$component"); done
cd "$3"
users=$(grep -rlE 'support/mutex[.]hpp|bounded_queue[.]hpp|archive_writer[.]hpp|window_feed[.]hpp|publisher[.]hpp|simulator_book[.]hpp|telemetry_watch[.]hpp' \
  --include='*.cpp' service)
printf '%s\n' $users | xargs -P "$(nproc)" -n 1 "$1" -std=c++20 -fsyntax-only -Wno-everything \
  -Wthread-safety -Werror=thread-safety -isystem /usr/include/eigen3 "${includes[@]}"
echo "$(wc -w <<<"$users") sources hold their locks"
