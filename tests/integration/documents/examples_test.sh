#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# The whole scenes printed in docs/howto/write-a-scene.md, scene-language.md and contact.md are accepted, and the beams of flexible-model.md:
#   examples_test.sh SOURCE_TREE SLEWRING
#
# A block of YAML is a whole scene when it has bodies or volumes and a session, and a beam when it has sections.
set -euo pipefail

source=$1 slewring=$2
scratch=$(mktemp -d)
trap 'rm -rf "$scratch"' EXIT
# blocks NAME DOCUMENT...: the documents' YAML as NAME1.yaml, NAME2.yaml, ...
blocks() {
  local name=$1
  shift
  awk -v stem="$scratch/$name" '
    /^```yaml/ { ++n; file = stem n ".yaml"; next }
    /^```/ { if (file != "") close(file); file = ""; next }
    file != "" { print > file }' "$@"
}
blocks block "$source/docs/howto/write-a-scene.md" "$source/docs/howto/scene-language.md" "$source/docs/howto/contact.md"
scenes=0
for block in "$scratch"/block*.yaml; do
  grep -qE '^(bodies|volumes):' "$block" && grep -q '^session:' "$block" || continue
  scenes=$((scenes + 1))
  "$slewring" check "$block" || { cat "$block" >&2; exit 1; }
done
[ $scenes -ge 5 ] || { echo "only $scenes whole scenes were found" >&2; exit 1; }
blocks beam "$source/docs/howto/flexible-model.md"
beams=0
for block in "$scratch"/beam*.yaml; do
  grep -q '^sections:' "$block" || continue
  beams=$((beams + 1))
  "$slewring" flex report "$block" > "$scratch/report" || { cat "$block" >&2; exit 1; }
done
[ $beams -ge 2 ] || { echo "only $beams beams were found" >&2; exit 1; }
