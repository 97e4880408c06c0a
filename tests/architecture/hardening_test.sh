#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# hardening_test.sh C_COMPILER FORTIFIED BINARY...   what the build states about hardened code holds for each of our
# programs and libraries:
# position-independent, relocations resolved at the start and read-only from then on, no executable stack,
# guarded stacks; FORTIFIED yes: checked lengths too. A program without all that is refused.
set -euo pipefail
compiler=$1 is_fortified=$2
shift 2

# problems_of BINARY: one line for each
problems_of() {
  local headers dynamic symbols
  headers=$(readelf -hlW "$1")
  dynamic=$(readelf -dW "$1")
  symbols=$(nm -D --undefined-only "$1")
  grep -qE 'Type: +DYN ' <<<"$headers" || echo "$1: not position-independent"
  grep -q GNU_RELRO <<<"$headers" || echo "$1: relocations stay writable (no GNU_RELRO)"
  grep -qE 'BIND_NOW|FLAGS_1.* NOW' <<<"$dynamic" || echo "$1: relocations are resolved late (no BIND_NOW)"
  grep -qE 'GNU_STACK .* RW +0x' <<<"$headers" || echo "$1: the stack may be executed"
  grep -q __stack_chk_fail <<<"$symbols" || echo "$1: stacks are not guarded"
  if [ "$is_fortified" = yes ]; then
    grep -qE ' U __[a-z0-9_]+_chk(@|$)' <<<"$(grep -v __stack_chk_fail <<<"$symbols")" || echo "$1: lengths are not checked"
  fi
}

folder=$(mktemp -d)
trap 'rm -r "$folder"' EXIT
echo 'int main(void) { return 0; }' > "$folder/soft.c"
"$compiler" -no-pie -fno-stack-protector -Wl,-z,norelro -Wl,-z,lazy -Wl,-z,execstack -o "$folder/soft" "$folder/soft.c" 2> "$folder/said" ||
  { cat "$folder/said"; exit 1; }
expected=5
[ "$is_fortified" = yes ] && expected=6
found=$(problems_of "$folder/soft" | wc -l)
if [ "$found" != "$expected" ]; then
  echo "of a program without any of it $expected problems were expected, and $found found:"
  problems_of "$folder/soft"
  exit 1
fi

problems=$(for binary in "$@"; do problems_of "$binary"; done)
if [ -n "$problems" ]; then
  echo "$problems"
  exit 1
fi
echo "$# files are hardened"
