#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# completion_test.sh bash|zsh|fish SOURCE PROGRAMS: completion of `slewring` in that shell. SOURCE: root of the sources;
# PROGRAMS: folder with the programs.
set -euo pipefail
shell=$1 source=$2
export PATH=$3:$PATH
command -v "$shell" > /dev/null || { echo "SKIPPED: there is no $shell"; exit; }
scratch=$(mktemp -d)
trap 'rm -rf "$scratch"' EXIT
cd "$scratch"
mkdir scenes runs
touch scenes/crane.yaml scenes/notes.txt runs/old.mcap
failures=0

# expect LINE WORD...: at the end of the line these words are among those offered; !WORD is not
expect() {
  local line=$1 offered word
  shift
  offered=$(offer "$line")
  for word in "$@"; do
    case $word in
      !*) grep -qxF -- "${word#!}" <<< "$offered" || continue ;;
      *) grep -qxF -- "$word" <<< "$offered" && continue ;;
    esac
    echo "'$line': expected $word, offered: $(tr '\n' ' ' <<< "$offered")"
    failures=$((failures + 1))
  done
}

case $shell in
  bash)
    # in a shell of its own, as readline calls it
    offer() {
      bash -c 'source "$1"; COMP_LINE=$2; COMP_POINT=${#COMP_LINE}
               compopt() { :; }  # acts on a completion that readline has begun
               _slewring; printf "%s\n" "${COMPREPLY[@]}"' bash "$source/cli/completion/slewring.bash" "$1"
    }
    bash -c 'source "$1"; complete -p slewring' bash "$source/cli/completion/slewring.bash" | grep -q _slewring ||
      { echo "bash: slewring has no completion"; exit 1; }
    # readline keeps what stands before '='
    expect 'slewring run x.yaml --pace=f' free !real
    expect 'slewring run x.yaml --out=ru' runs
    ;;
  fish)
    offer() { fish --no-config -c "source $source/cli/completion/slewring.fish; complete -C '$1'" | cut -f1 | sed 's:/$::'; }
    expect 'slewring run x.yaml --pace=f' --pace=free
    ;;
  zsh)
    # without a terminal zsh completes nothing: the file is read, and defines the function
    zsh -f -n "$source/cli/completion/_slewring"
    head -1 "$source/cli/completion/_slewring" | grep -qx '#compdef slewring'
    exit
    ;;
esac

expect 'slewring ' run check help node !tradeoff-row !stress-load
expect 'slewring ch' check !run
expect 'slewring control p' pause
expect 'slewring help r' run
expect 'slewring run --pa' --pace
expect 'slewring run x.yaml --pace ' real free
expect 'slewring run x.yaml --middleware ' cyclone fastdds
expect 'slewring run x.yaml --remote io,me' io,mechanics
expect 'slewring run sc' scenes
expect 'slewring run scenes/' scenes/crane.yaml !scenes/notes.txt
expect 'slewring replay runs/' runs/old.mcap
expect 'slewring control save sc' scenes
expect 'slewring node ' mechanics io
expect 'slewring node mechanics --se' --session --session-timeout
expect 'slewring node mechanics --middleware ' fastdds
exit $((failures > 0))
