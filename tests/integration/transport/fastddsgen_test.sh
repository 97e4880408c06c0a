#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# fastddsgen_test.sh BUILD CXX   fastddsgen makes C++ of the installed slewring.idl, and CXX compiles it. BUILD: the
# build's folder. Bounds of strings must be numbers there; they are the two named ones.
set -euo pipefail
build=$1 cxx=$2
for needed in fastddsgen /usr/include/fastcdr/Cdr.h /usr/include/fastrtps/fastrtps_dll.h; do
  command -v "$needed" > /dev/null || [ -e "$needed" ] ||
    { echo "SKIPPED: $needed is not there; apt-get install fastddsgen libfastrtps-dev"; exit; }
done
folder=$(mktemp -d)
trap 'rm -r "$folder"' EXIT

cmake --install "$build" --component client --prefix "$folder/installed" > "$folder/log"
idl=$folder/installed/share/slewring/slewring.idl
bounds=$(sed -n 's/^const unsigned long kMax\(Name\|Reason\)Length = \([0-9]*\);.*/string<\2>/p' "$idl" | sort)
used=$(grep -o '^  string<[^>]*>' "$idl" | tr -d ' ' | sort -u)
[ "$bounds" = "$used" ] || { echo "strings have the bounds" $used "where" $bounds "are expected"; exit 1; }

mkdir "$folder/generated"
fastddsgen -replace -cs -d "$folder/generated" "$idl" > "$folder/log" 2>&1 || { cat "$folder/log"; exit 1; }
sources=("$folder"/generated/*.cxx)
[ ${#sources[@]} -eq 2 ] || { echo "fastddsgen made ${#sources[@]} sources where 2 are expected"; exit 1; }
for source in "${sources[@]}"; do
  "$cxx" -std=c++11 -fsyntax-only "$source"
done
