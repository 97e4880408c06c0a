#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# missing_middleware_test.sh SLEWRING   the program is not linked with Fast DDS; without the library of Fast DDS
# beside it the option is an error with the remedy, and everything else works.
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -r "$folder"' EXIT
cp "$1" "$folder/slewring"
if objdump -p "$1" | grep -q 'NEEDED.*fastrtps'; then echo "the program is linked with Fast DDS"; exit 1; fi

code=0
"$folder/slewring" sessions --middleware fastdds > "$folder/out" 2> "$folder/err" || code=$?
[ $code -eq 7 ] || { echo "it ended with $code where 7 is expected"; cat "$folder/err"; exit 1; }
for part in "libslewring_fastdds.so is not there" "nothing was started" "install libfastrtps-dev" "--middleware cyclone"; do
  grep -qF -- "$part" "$folder/err" || { echo "'$part' is missing in:"; cat "$folder/err"; exit 1; }
done
code=0
"$folder/slewring" sessions --middleware rti > "$folder/out" 2> "$folder/err" || code=$?
[ $code -eq 2 ] || { echo "an unknown middleware ended with $code where 2 is expected"; exit 1; }
"$folder/slewring" --version > "$folder/out"
