#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# unit_test.sh SOURCE: systemd accepts the unit of the nodes.
set -euo pipefail
command -v systemd-analyze > /dev/null || { echo "SKIPPED: there is no systemd-analyze"; exit; }
scratch=$(mktemp -d)
trap 'rm -rf "$scratch"' EXIT
sed 's:@PROGRAM_PATH@:/bin/true:' "$1/cmake/packaging/slewring@.service.in" > "$scratch/slewring@.service"
# of other units of this machine it may complain; the man page is not installed here
found=$(systemd-analyze verify --man=no "$scratch/slewring@mechanics.service" 2>&1 | grep -F slewring || true)
[ -z "$found" ] || { echo "$found"; exit 1; }
