#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# The programs printed in docs/howto/read-a-recording.md read a recording as `slewring export` writes it:
#   recording_snippets_test.sh SOURCE_TREE BIN_FOLDER csv|scipy|matlab
#
# Prints "SKIPPED: reason" where the tool is missing. matlab stands for MATLAB's language, which Octave speaks.
set -euo pipefail

source=$1 bin=$2 kind=$3
scratch=$(mktemp -d)
trap 'rm -rf "$scratch"' EXIT
cd "$scratch"
PATH=$bin:$PATH

# block LANGUAGE TEXT: the document's block of that language in which the text occurs
block() {
  awk -v language="$1" -v text="$2" '
    $0 == "```" language { inside = 1; lines = ""; next }
    /^```/ { if (inside && index(lines, text)) { printf "%s", lines; exit } inside = 0; next }
    inside { lines = lines $0 "\n" }' "$source/docs/howto/read-a-recording.md" > program
  [ -s program ] || { echo "the document has no block of $1 with '$text'" >&2; exit 1; }
}

case $kind in
  csv)
    block python subprocess
    run=(python3 program)
    ;;
  scipy)
    for python in python3 /usr/bin/python3; do
      if "$python" -c 'import scipy.io' 2> /dev/null; then run=("$python" program crane.mat); fi
    done
    [ -n "${run:-}" ] || { echo "SKIPPED: no Python here has scipy"; exit 0; }
    block python scipy
    ;;
  matlab)
    command -v octave-cli > /dev/null || { echo "SKIPPED: octave-cli is not here"; exit 0; }
    block matlab load
    run=(octave-cli --quiet --no-init-file program)
    ;;
esac

slewring run "$source/scenes/truck_crane.yaml" --in-process --duration 0.5s --pace free --out runs > summary 2>&1 ||
  { cat summary >&2; exit 1; }
recording=$(find runs -name session.mcap)
slewring export "$recording" -o crane.mat > said
[ "$kind" = csv ] && run+=("$recording")
"${run[@]}" > printed || { cat printed >&2; exit 1; }

# name, unit, time and value of the last sample, and how many there are
last=$(slewring export "$recording" Cyl_Lift.force | tail -n 1)
count=$(($(slewring export "$recording" Cyl_Lift.force | wc -l) - 1))
python3 - "$last" "$count" << 'END'
import re, sys
time, value = map(float, sys.argv[1].split(","))
printed = open("printed").read()
found = re.search(r"Cyl_Lift\.force: (\d+) values, (\S+) N at (\S+) s", printed)
if not found or (int(found[1]), float(found[2]), float(found[3])) != (int(sys.argv[2]), value, time):
    sys.exit(f"printed '{printed}', expected {sys.argv[2]} values, {value!r} N at {time!r} s")
END
