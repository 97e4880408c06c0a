#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# format_test.sh SOURCE CLANG_FORMAT   every source is as clang-format leaves it. SOURCE: the root. CLANG_FORMAT: the
# program, or ...-NOTFOUND.
set -euo pipefail
source=$1 clang_format=$2
case $clang_format in
  *-NOTFOUND) echo "SKIPPED: there is no clang-format"; exit ;;
esac
version=$("$clang_format" --version)
case $version in
  *"version 14."*) ;;
  *) echo "SKIPPED: other releases than 14 format otherwise; this one is $version"; exit ;;
esac
cd "$source"

sources=$(mktemp)
trap 'rm "$sources"' EXIT
find benchmarks cli examples libs tests ./*_node \
  '(' -name '*.cpp' -o -name '*.h' ')' -print0 > "$sources"
count=$(tr -cd '\0' < "$sources" | wc -c)
[ "$count" -ge 100 ] || { echo "only $count sources were found in $source"; exit 1; }
xargs --null --max-args=20 --max-procs=2 "$clang_format" --dry-run --Werror --ferror-limit=1 < "$sources" ||
  { echo "Run: git ls-files '*.cpp' '*.h' | xargs clang-format -i"; exit 1; }
