#!/usr/bin/env bash
# The whole scenes printed in docs/howto/write-a-scene.md and contact.md are accepted:  examples_test.sh SOURCE_TREE SLEWRING
#
# A block of YAML is a whole scene when it has bodies or volumes and a session.
set -euo pipefail

source=$1 slewring=$2
scratch=$(mktemp -d)
trap 'rm -rf "$scratch"' EXIT
awk -v folder="$scratch" '
  /^```yaml/ { ++n; file = folder "/block" n ".yaml"; next }
  /^```/ { if (file != "") close(file); file = ""; next }
  file != "" { print > file }' "$source/docs/howto/write-a-scene.md" "$source/docs/howto/contact.md"
scenes=0
for block in "$scratch"/block*.yaml; do
  grep -qE '^(bodies|volumes):' "$block" && grep -q '^session:' "$block" || continue
  scenes=$((scenes + 1))
  "$slewring" check "$block" || { cat "$block" >&2; exit 1; }
done
[ $scenes -ge 5 ] || { echo "only $scenes whole scenes were found" >&2; exit 1; }
