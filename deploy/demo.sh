#!/usr/bin/env bash
# Shows the whole loop on one machine: a reference spacecraft sends telemetry faster than real
# time, reidentd archives it, identifies its equipment again and again and publishes what passes
# the gate, and a simulator swaps to each approved version while it runs.
#
#   deploy/demo.sh [--stay] [FOLDER]   leaves reident.db, reident.toml and a picture in FOLDER
#                                      (default: build/demo)
#
# Installs missing packages, builds, runs for about two minutes, stays on 127.0.0.1 and ends by
# itself; with --stay everything goes on until Ctrl-C, to look at on the operators' page. Safe to run
# again: it starts with a new database.
set -euo pipefail

stay=
if [ "${1:-}" = --stay ]; then
  stay=yes
  shift
fi
root=$(cd "$(dirname "$0")/.." && pwd)
folder=${1:-$root/build/demo}
mkdir -p "$folder"
folder=$(cd "$folder" && pwd)
cd "$root"

# Ninja's "[done/all] what" as one line that counts, or a line for each tenth where no terminal is.
progress() {
  local line shown=-1 tenth
  while IFS= read -r line; do
    [[ $line =~ ^\[([0-9]+)/([0-9]+)\] ]] || continue
    tenth=$((10 * BASH_REMATCH[1] / BASH_REMATCH[2]))
    if [ -t 1 ]; then
      printf '\rBuilding: step %d of %d ' "${BASH_REMATCH[1]}" "${BASH_REMATCH[2]}"
    elif [ "$tenth" -ne "$shown" ]; then
      printf 'Building: step %d of %d\n' "${BASH_REMATCH[1]}" "${BASH_REMATCH[2]}"
      shown=$tenth
    fi
  done
  if [ -t 1 ]; then printf '\n'; fi
}

deploy/install_packages.sh
echo "Building in build/release (the first time takes some minutes)"
cmake --preset release -DBUILD_TESTING=OFF >"$folder/build.log"
cmake --build --preset release 2>&1 | tee -a "$folder/build.log" | progress ||
  { tail -20 "$folder/build.log"; exit 1; }
bin=$root/build/release/service

unset CYCLONEDDS_URI  # the programs then stay on the loopback interface
domain=$((1 + RANDOM % 200))
endpoint=(--domain "$domain" --partition demo)
rm -rf "$folder"/reident.db "$folder"/reident.db-wal "$folder"/reident.db-shm "$folder"/*.log \
  "$folder/page.url" "$folder/cache"
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

"$bin/web/reident-web" --config "$folder/reident.toml" --port 0 >"$folder/page.url" \
  2>"$folder/page.log" &
pids+=($!)
until [ -s "$folder/page.url" ] || ! kill -0 "${pids[2]}" 2>/dev/null; do sleep 0.1; done
page=$(cat "$folder/page.url")
[ -n "$page" ] || { tail -5 "$folder/page.log"; exit 1; }

# Prints what the sed script makes of a log, line by line, until the process ends that writes it.
follow() {
  tail -n +1 -F --pid "$1" "$2" 2>/dev/null | sed -un "$3" | sed -u 's/^\(.\{78\}\)..\{1,\}/\1…/' &
}
echo "A CBERS-4-class power subsystem flies 24 orbits at 1500 times real time."
echo "The operators' page, while it flies: $page"
echo "What the service publishes (<) and what the simulator runs (>):"
follow "${pids[0]}" "$folder/reidentd.log" '
  s/.*version decided equipment=[^/]*\/\([A-Z0-9]*\) .*decision=approve reason="\(.*\)"$/  < \1: \2/p'
follow "${pids[1]}" "$folder/simulator.log" '/running MRSE/!s/^/  > /p'

flight=(--spacecraft CBERS-4 --duration 2406min --speed 1500 --wait-readers 2 "${endpoint[@]}")
# The telemetry of the hand-written simulator on the same flight: the baseline of first versions.
"$bin/satcs/satcs-reference" --simulated "${flight[@]}" >"$folder/simulated.log" 2>&1 &
pids+=($!)
"$bin/satcs/satcs-reference" "${flight[@]}" >"$folder/reference.log" 2>&1
"$bin/cli/reident" status --wait idle --timeout 60 "${endpoint[@]}" >"$folder/status.log"
"$bin/cli/reident" simulators "${endpoint[@]}" >"$folder/simulators.log"
reident=(env -C "$folder" "$bin/cli/reident")
"${reident[@]}" overview >"$folder/overview.log" || true  # 1: a version waits for an operator
if [ -z "$stay" ]; then
  trap - EXIT
  cleanup
fi

"${reident[@]}" history >"$folder/history.log"
"${reident[@]}" plot CBERS-4/BDR -o "$folder/bdr.svg" >/dev/null
where=${folder#"$root"/}
echo
echo "The champions: error now, when they were approved, and of the simulator's own models:"
echo
cat "$folder/overview.log"
cat <<END

Look further (the simulators at the end: $where/simulators.log):
  PATH=\$PWD/build/release/service/cli:\$PATH
  reident history --config $where/reident.toml       # all attempts, and why
  reident why CBERS-4/BDR --config $where/reident.toml
Picture of the BDR's champion: $where/bdr.svg
Archive and registry:          $where/reident.db
END
if [ -n "$stay" ]; then
  echo
  echo "Everything goes on until Ctrl-C. The operators' page: $page"
  trap exit INT TERM
  wait
fi
