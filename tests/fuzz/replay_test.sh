#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# Gives a fuzzer the inputs that are kept for it, and some that are changed, without libFuzzer.
#   replay_test.sh REPLAY_PROGRAM CORPUS.tar.gz CHANGED
set -euo pipefail

scratch=$(mktemp -d)
trap 'rm -rf "$scratch"' EXIT
tar -xzf "$2" -C "$scratch"
"$1" "$3" "$scratch"
