#!/usr/bin/env bash
# Compiles, without output, every source that can see an annotated mutex with clang's analysis; those
# of a folder together.
#   check_thread_safety.sh CLANG++ SOURCES
set -euo pipefail
compile=("$1" -std=c++20 -fsyntax-only -Wno-everything -Wthread-safety -Werror=thread-safety
         -isystem /usr/include/eigen3 -I "$2")
cd "$2"
# reader_impl.hpp needs types that the build generates.
headers=$(grep -rl 'support/mutex[.]hpp' --include='*.hpp' service | grep -v dds/reader_impl |
          xargs -n 1 basename | paste -sd'|')
users=$(grep -rlE "support/mutex[.]hpp|/($headers)\"" --include='*.cpp' service)
units=$(mktemp -d)
trap 'rm -r "$units"' EXIT
for user in $users; do
  folder=$(dirname "$user")
  echo "#include \"$user\"" >> "$units/${folder//\//.}.cpp"
done
printf '%s\n' "$units"/*.cpp | xargs -P "$(nproc)" -n 1 "${compile[@]}"
echo "$(wc -w <<<"$users") sources hold their locks"
