#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# One claim about the launch scripts:  launch_scripts_test.sh CASE SOURCE_TREE SLEWRING
#
# The scripts are copied into a scratch tree whose package lists are the test's own. Folder `bin` in front of PATH holds
# stand-ins for the called programs; each writes its name and arguments into `calls`, and does nothing else by default.
set -euo pipefail

claim=$1 source=$2 slewring=$3
scratch=$(mktemp -d)
chmod 755 "$scratch"
trap 'rm -rf "$scratch"' EXIT
tree=$scratch/tree bin=$scratch/bin calls=$scratch/calls
mkdir -p "$tree" "$bin"
cp -r "$source/launch_scripts" "$tree/"
chmod -R a+rX "$tree"
: > "$calls"
chmod 666 "$calls"

fail() {
  echo "FAILED: $*" >&2
  [ ! -f "$scratch/out" ] || sed 's/^/  out: /' "$scratch/out" >&2
  [ ! -f "$scratch/err" ] || sed 's/^/  err: /' "$scratch/err" >&2
  sed 's/^/  called: /' "$calls" >&2
  exit 1
}

# stand_in NAME [LINES...]: the lines run after the call was written down
stand_in() {
  local name=$1
  shift
  printf '%s\n' '#!/bin/bash' "echo \"$name \$*\" >> '$calls'" "$@" > "$bin/$name"
  chmod 755 "$bin/$name"
}

# package_list NAME: lines from standard input
package_list() { cat > "$tree/launch_scripts/packages-$1.txt"; }

# absent_packages: one present, one missing command in `run`, one missing header in `test`
absent_packages() {
  package_list run << 'LIST'
# a comment

bash                    command bash
slewring-absent-tool    command slewring-absent-tool
LIST
  package_list test << 'LIST'
libslewring-absent-dev  header slewring_absent/absent.h
LIST
  package_list fastdds <<< 'bash command bash'
}

# state: everything in the tree with its content
state() { (cd "$tree" && find . -printf '%p %y %m %s\n' | sort && find . -type f -exec cksum {} + | sort); }

# call CODE COMMAND...: runs it with the stand-ins, output in `out` and `err`; the exit code must be CODE
call() {
  local expected=$1 code=0
  shift
  PATH="$bin:$PATH" "$@" > "$scratch/out" 2> "$scratch/err" || code=$?
  [ $code -eq "$expected" ] || fail "'$*' ended with $code, expected $expected"
}

has_line() { grep -qxF -- "$2" "$scratch/$1" || fail "no line '$2' in $1"; }
has_text() { grep -qF -- "$2" "$scratch/$1" || fail "no '$2' in $1"; }
nothing_was_called() { [ ! -s "$calls" ] || fail "something was called"; }

missing_without_root() {
  absent_packages
  stand_in apt-get
  stand_in cmake
  local unprivileged=()
  [ "$(id -u)" -ne 0 ] || unprivileged=(setpriv --reuid=65534 --regid=65534 --clear-groups)
  # the test's user may write everywhere: unchanged files are not a lack of permission
  chmod -R a+w "$tree"
  local before
  before=$(state)
  call 7 "${unprivileged[@]}" "$tree/launch_scripts/run" scenes/first_steps.yaml
  has_line err "  apt-get install -y --no-install-recommends slewring-absent-tool"
  has_text err "nothing was built"
  call 7 "${unprivileged[@]}" "$tree/launch_scripts/test"
  has_line err "  apt-get install -y --no-install-recommends libslewring-absent-dev slewring-absent-tool"
  call 7 "${unprivileged[@]}" "$tree/launch_scripts/machine_with_hydraulics" eth0 192.0.2.1
  has_line err "  apt-get install -y --no-install-recommends slewring-absent-tool"
  nothing_was_called
  [ "$(state)" = "$before" ] || fail "the tree was changed"
}

missing_elsewhere() {
  absent_packages
  local tool
  for tool in bash cat dirname env id nproc sed sort tr; do ln -s "$(command -v $tool)" "$bin/$tool"; done
  local code=0
  PATH="$bin" "$tree/launch_scripts/test" > "$scratch/out" 2> "$scratch/err" || code=$?
  [ $code -eq 7 ] || fail "ended with $code, expected 7"
  has_text err "missing: libslewring-absent-dev slewring-absent-tool"
  nothing_was_called
}

missing_as_root() {
  absent_packages
  mkdir -p "$tree/build/release/bin"
  stand_in id 'echo 0'
  stand_in cmake
  printf '%s\n' '#!/bin/bash' "echo \"slewring \$*\" >> '$calls'" > "$tree/build/release/bin/slewring"
  chmod 755 "$tree/build/release/bin/slewring"
  # the list of packages is old: the first attempt fails, the one after `apt-get update` does not
  stand_in apt-get "[ \"\$1\" != update ] || touch '$scratch/is_new'" \
    "[ -e '$scratch/is_new' ] || { echo 'E: Unable to locate package' >&2; exit 100; }"
  call 0 "$tree/launch_scripts/run" scenes/first_steps.yaml
  local install="apt-get install -y --no-install-recommends slewring-absent-tool"
  printf '%s\n' "id -u" "$install" "apt-get update" "$install" "cmake --preset release -DSLEWRING_BUILD_TESTS=OFF" \
    "cmake --build build/release --target slewring page" "slewring run scenes/first_steps.yaml" > "$scratch/expected"
  cmp -s "$scratch/expected" "$calls" || fail "expected these calls: $(cat "$scratch/expected")"
  # an installation that fails ends it, with the reason
  : > "$calls"
  stand_in apt-get "echo 'E: no space left'" 'exit 100'
  call 7 "$tree/launch_scripts/run"
  has_text err "E: no space left"
  has_text err "nothing was built"
  ! grep -q cmake "$calls" || fail "it was built"
}

package_lists() {
  local list
  for list in run test fastdds peers fuzz; do
    awk -v list="$list" '
      /^#/ || NF == 0 { next }
      NF != 3 || ($2 != "command" && $2 != "header") { print list ": " $0; wrong = 1 }
      { ++lines }
      END { exit wrong || lines == 0 }' "$tree/launch_scripts/packages-$list.txt" > "$scratch/out" ||
      fail "packages-$list.txt: expected PACKAGE command|header NAME in each line"
  done
}

unknown_options() {
  stand_in apt-get
  stand_in cmake
  stand_in ctest
  absent_packages
  call 2 "$tree/launch_scripts/test" --nigthly
  has_text err "there is no option '--nigthly'"
  call 2 "$tree/launch_scripts/test" --nightly --fast
  has_text err "there is no option"
  local script
  for script in machine_with_session machine_with_hydraulics; do
    call 2 "$tree/launch_scripts/$script"
    has_text err "$script INTERFACE"
    call 2 "$tree/launch_scripts/$script" --interface eth0
    has_text err "'--interface'"
  done
  nothing_was_called
}

run_arguments() {
  package_list run < /dev/null
  stand_in cmake
  mkdir -p "$tree/build/release/bin"
  ln -s "$slewring" "$tree/build/release/bin/slewring"
  call 2 "$tree/launch_scripts/run" "$source/scenes/first_steps.yaml" --no-such-option
  has_text err "--no-such-option"
  call 2 "$tree/launch_scripts/run" "$scratch/no_such_scene.yaml"
  has_text err "no_such_scene.yaml"
  # the scripts for two machines: what they start
  rm "$tree/build/release/bin/slewring"
  printf '%s\n' '#!/bin/bash' 'printf "<%s>" "$@"' 'echo' > "$tree/build/release/bin/slewring"
  chmod 755 "$tree/build/release/bin/slewring"
  call 0 "$tree/launch_scripts/machine_with_session" eth0 192.0.2.2 scene.yaml --set 'Bag.mass=1 t'
  has_line out "<run><scene.yaml><--remote><hydraulics><--interface><eth0><--peer><192.0.2.2><--set><Bag.mass=1 t>"
  call 0 "$tree/launch_scripts/machine_with_hydraulics" eth0 192.0.2.1 crane --rt
  has_text out "<node><hydraulics><--session><crane><--interface><eth0><--peer><192.0.2.1>"
  has_text out "<--rt>"
}

help() {
  stand_in apt-get
  stand_in cmake
  absent_packages
  local script option
  for script in run test machine_with_session machine_with_hydraulics; do
    for option in --help -h; do
      call 0 "$tree/launch_scripts/$script" $option
      has_text out "Example:"
      # the example is a command line of this script
      sed -n '/^Example:/,$p' "$scratch/out" | grep -q "^  launch_scripts/$script [a-z-]" || fail "$script: no example"
    done
  done
  nothing_was_called
}

failed_test() {
  package_list run < /dev/null
  package_list test < /dev/null
  package_list fastdds < /dev/null
  mkdir -p "$tree/tests/unit/math"
  : > "$tree/tests/unit/math/CMakeLists.txt"
  stand_in cmake
  # a test of the Debug build that fails the first time only
  stand_in ctest 'case $* in */dev/*) ;; *) exit 0 ;; esac' "[ -e '$scratch/has_failed' ] && exit 0" \
    "touch '$scratch/has_failed'" 'echo "Sum.IsOrdered failed: 3 is not 4"' 'exit 8'
  call 1 "$tree/launch_scripts/test"
  has_text out "Sum.IsOrdered failed: 3 is not 4"
  ! grep -q "all tests passed" "$scratch/out" || fail "it says that all tests passed"
  # without a failure it does
  call 0 "$tree/launch_scripts/test"
  has_line out "all tests passed"
}

"$claim"
