#!/usr/bin/env bash
# Shows the whole loop on one machine: a reference spacecraft sends telemetry faster than real
# time, reidentd archives it, identifies its equipment again and again and publishes what passes
# the gate, and a simulator swaps to each approved version while it runs.
#
#   deploy/demo.sh [FOLDER]     leaves reident.db and reident.toml in FOLDER (default: build/demo)
#
# Installs missing packages, builds, runs for about two minutes, stays on 127.0.0.1 and ends by
# itself. Safe to run again: it starts with a new database.
set -euo pipefail

root=$(cd "$(dirname "$0")/.." && pwd)
folder=${1:-$root/build/demo}
mkdir -p "$folder"
folder=$(cd "$folder" && pwd)
cd "$root"

deploy/install_packages.sh
echo "Building (the first time takes some minutes)"
cmake --preset release -DBUILD_TESTING=OFF >"$folder/build.log"
cmake --build --preset release >>"$folder/build.log" || { tail -20 "$folder/build.log"; exit 1; }
bin=$root/build/release/service

unset CYCLONEDDS_URI  # the programs then stay on the loopback interface
domain=$((1 + RANDOM % 200))
endpoint=(--domain "$domain" --partition demo)
rm -f "$folder"/reident.db "$folder"/reident.db-wal "$folder"/reident.db-shm
sed -e "s/^# domain = 0/domain = $domain/" \
    -e 's/^# partition = "operations"/partition = "demo"/' deploy/reident.toml \
    >"$folder/reident.toml"

pids=()
cleanup() {
  for pid in "${pids[@]}"; do kill "$pid" 2>/dev/null || true; done
  wait
}
trap cleanup EXIT

"$bin/daemon/reidentd" --config "$folder/reident.toml" 2>"$folder/reidentd.log" &
pids+=($!)
"$bin/client/reident-simulator" --name simulator-1 --spacecraft CBERS-4 --equipment BDR BAT1 MEA \
  --cache "$folder/cache" "${endpoint[@]}" >"$folder/simulator.log" 2>&1 &
pids+=($!)

echo "A CBERS-4-class power subsystem flies 24 orbits at 1500 times real time."
echo "What the service decides (<) and what the simulator runs (>):"
tail -n +1 -F "$folder/reidentd.log" 2>/dev/null |
  sed -un 's/.*window decided equipment=[^/]*\/\([A-Z0-9]*\) .* outcome=\([a-z_]*\) .*reason="\(.*\)"$/  < \1: \2. \3/p' &
pids+=($!)
tail -n +1 -F "$folder/simulator.log" 2>/dev/null | sed -un 's/^/  > /p' &
pids+=($!)

flight=(--spacecraft CBERS-4 --duration 2406min --speed 1500 --wait-readers 2 "${endpoint[@]}")
# What the hand-written simulator says of the same flight: the baseline of the first versions.
"$bin/satcs/satcs-reference" --simulated "${flight[@]}" 2>"$folder/simulated.log" &
pids+=($!)
"$bin/satcs/satcs-reference" "${flight[@]}" 2>"$folder/reference.log"
"$bin/cli/reident" status --wait idle --timeout 60 "${endpoint[@]}" >"$folder/status.log"
"$bin/cli/reident" simulators "${endpoint[@]}" >"$folder/simulators.log"
trap - EXIT
cleanup

echo
"$bin/cli/reident" history --config "$folder/reident.toml"
echo
echo "Who ran what at the end (reident simulators):"
cat "$folder/simulators.log"
echo
echo "Archive and registry: $folder/reident.db; configuration: $folder/reident.toml"
