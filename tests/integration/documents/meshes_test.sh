#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# scenes/meshes/make_meshes.py writes the committed meshes byte for byte, and no others:  meshes_test.sh SOURCE_TREE PYTHON
set -euo pipefail

source=$1 python=$2
scratch=$(mktemp -d)
trap 'rm -rf "$scratch"' EXIT
"$python" "$source/scenes/meshes/make_meshes.py" "$scratch"
diff -r --exclude=README.md --exclude=make_meshes.py --exclude=__pycache__ "$source/scenes/meshes" "$scratch"
[ "$(ls "$scratch" | wc -l)" -ge 20 ]
