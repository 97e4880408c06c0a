#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# manual_test.sh FOLDER SLEWRING: every manual page in the folder is shown without a warning, and every verb has one.
set -euo pipefail
folder=$1 slewring=$2
command -v man > /dev/null || { echo "SKIPPED: there is no man"; exit; }
failures=0
fail() {
  echo "$*"
  failures=$((failures + 1))
}

pages=("$folder"/*.1)
[ ${#pages[@]} -ge 30 ] || fail "only ${#pages[@]} pages in $folder"
for page in "${pages[@]}"; do
  # as `man -l` shows it, on 80 columns
  warnings=$(MANWIDTH=80 man --warnings=w -l "$page" 2>&1 > /dev/null) || fail "$page: man ends with $?"
  [ -z "$warnings" ] || fail "$page: $warnings"
  if command -v mandoc > /dev/null; then
    # the pages have no date, so that the same sources give the same page
    found=$(mandoc -T lint -W warning "$page" | grep -v 'missing date' || true)
    [ -z "$found" ] || fail "$found"
  fi
done
while read -r verb; do
  [ -f "$folder/slewring-$verb.1" ] || fail "$folder: no page for the verb $verb"
done < <("$slewring" --complete '' | tail -n +2 | cut -f1)

shown=$(MANWIDTH=100 man -l "$folder/slewring-run.1" 2> /dev/null)
for text in 'slewring-run - run a scene' '--pace PACE' 'One of: real, free' 'SLEWRING_DOMAIN' 'Default: 0'; do
  grep -qF -- "$text" <<< "$shown" || fail "slewring-run(1) does not show: $text"
done
exit $((failures > 0))
