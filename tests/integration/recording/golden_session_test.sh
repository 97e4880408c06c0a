#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# Recordings of sessions of every protocol version from 3 on, kept in golden/: this and every later program reads the
# same values from them as the one that wrote them did.
#   golden_session_test.sh BIN_FOLDER values|bits
#
# Each <name>.mcap.gz has its values beside it, as `slewring export` wrote them then. A pair is added with each new
# protocol version and each new layout of saved states, and none is ever changed. With `bits` those listed in
# golden/same_bits.txt are computed again too, to the same bits, if the machine has the arithmetic that the file names
# (`slewring doctor` prints it). A change of the computed values, or of the layout of saved states, removes the recordings
# with other bits from the list, and adds a recording with the new ones.
set -euo pipefail

bin=$1
what=$2
golden=$(cd "$(dirname "${BASH_SOURCE[0]}")/golden" && pwd)
scratch=$(mktemp -d)
trap 'rm -rf "$scratch"' EXIT
arithmetic=$("$bin/slewring" doctor | sed -n 's/^.*, arithmetic \([0-9a-f]*\)$/\1/p') || true
count=0
for packed in "$golden"/*.mcap.gz; do
  count=$((count + 1))
  name=$(basename "$packed" .mcap.gz)
  gzip -dc "$packed" > "$scratch/session.mcap"
  "$bin/slewring" info "$scratch/session.mcap" --verify > "$scratch/info" || { cat "$scratch/info" >&2; exit 1; }
  grep -q '^end *closed in order$' "$scratch/info" || { cat "$scratch/info" >&2; exit 1; }
  # the names in the heading, without "time [s]" and without units
  mapfile -t names < <(head -n 1 "$golden/$name.csv" | tr ',' '\n' | tail -n +2 | sed 's/ \[.*//')
  "$bin/slewring" export "$scratch/session.mcap" "${names[@]}" > "$scratch/values"
  cmp "$golden/$name.csv" "$scratch/values" || { echo "$name is read to other values" >&2; exit 1; }
  if [ "$what" = bits ] && grep -qx "$name $arithmetic" "$golden/same_bits.txt"; then
    "$bin/slewring" replay "$scratch/session.mcap" --verify > "$scratch/replay" 2>&1 ||
      { cat "$scratch/replay" >&2; echo "$name is computed again to other bits" >&2; exit 1; }
  fi
done
[ $count -ge 1 ] || { echo "no golden recording was found in $golden" >&2; exit 1; }
