#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# Steps per second of the distributed truck crane in `free` pace, beside a bare Cyclone star of the same shape measured
# in the same minute, and with keys (DDS Security, everything encrypted). Prints the figures of every round.
#
#   benchmarks/distributed_crane.sh BUILD_DIRECTORY [ROUNDS=5] [SECONDS=20]
set -euo pipefail
build=${1:?usage: benchmarks/distributed_crane.sh BUILD_DIRECTORY [ROUNDS] [SECONDS]}
rounds=${2:-5}
seconds=${3:-20}
root=$(cd "$(dirname "$0")/.." && pwd)
bin=$(cd "$build" && pwd)/bin
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
cd "$work"

# wall seconds from the io node's first to its last tick are what `--json` reports as steps_per_second
crane() {
  "$bin/slewring" run "$root/scenes/truck_crane.yaml" --pace free --duration "${seconds}s" --session "bench$$" \
    --domain 97 "$@" --quiet --json 2>/dev/null | sed -n 's/.*"steps_per_second": *\([0-9]*\).*/\1/p' | head -1
}
star() { "$bin/cyclone_star" 20000 1; }

"$bin/slewring" keys create keys >/dev/null
for round in $(seq "$rounds"); do
  # by assignment, so that a program that fails ends the script
  bare=$(star | tr '\n' ' ')
  recorded=$(crane)
  unrecorded=$(crane --no-record)
  secured=$(crane --no-record --keys keys)
  echo "round $round: star: $bare"
  echo "round $round: crane with recorder: $recorded steps/s, without: $unrecorded steps/s, with keys and without" \
    "recorder: $secured steps/s"
done
echo "load: $(cat /proc/loadavg)"
