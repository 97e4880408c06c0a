# SPDX-License-Identifier: Apache-2.0
# What `run` and `test` share: finding out which packages are missing, and building. To be sourced by bash.

repository=$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd)

has_command() { command -v "$1" > /dev/null 2>&1; }

has_header() {
  local folder
  for folder in /usr/include /usr/local/include /usr/include/*-linux-gnu /usr/include/udunits2 \
    /usr/lib/llvm-14/lib/clang/*/include ${CPATH:+${CPATH//:/ }}; do
    [ -e "$folder/$1" ] && return 0
  done
  return 1
}

# Packages of the given lists whose command or header is not there.
missing_packages() {
  local list package kind name
  for list in "$@"; do
    while read -r package kind name; do
      case $package in '' | '#'*) continue ;; esac
      "has_$kind" "$name" || echo "$package"
    done < "$repository/launch_scripts/packages-$list.txt"
  done
}

# Installs what is missing; without root prints the command and ends with 7.
need_packages() {
  local missing
  missing=$(missing_packages "$@" | sort -u | tr '\n' ' ')
  [ -z "$missing" ] && return
  local install="apt-get install -y --no-install-recommends ${missing% }"
  if ! has_command apt-get; then
    echo "These packages of Debian 12, or what they stand for, are missing: ${missing% }" >&2
    echo "Nothing was built. Install them in this system's way, then run this again." >&2
    exit 7
  fi
  if [ "$(id -u)" -ne 0 ]; then
    echo "Some packages are missing; nothing was built. As root, run this, then try again:" >&2
    echo "  $install" >&2
    exit 7
  fi
  echo "installing ${missing% }"
  export DEBIAN_FRONTEND=noninteractive
  local log
  log=$(mktemp)
  # shellcheck disable=SC2086
  if ! $install > "$log" 2>&1 && ! { apt-get update > "$log" 2>&1 && $install > "$log" 2>&1; }; then
    tail -n 20 "$log" >&2
    echo "The packages could not be installed; nothing was built. Look at the lines above (whole log: $log)." >&2
    exit 7
  fi
  rm -f "$log"
}

# quietly LOG COMMAND...: output into the log, its end shown when the command fails.
quietly() {
  local log=$1
  shift
  mkdir -p "$(dirname "$log")"
  "$@" >> "$log" 2>&1 && return
  tail -n 40 "$log" >&2
  echo "Failed: $*" >&2
  echo "The whole log is in $log" >&2
  exit 1
}

# configure PRESET [OPTION...]
configure() {
  local preset=$1
  shift
  local log="$repository/build/$preset/launch.log"
  mkdir -p "$repository/build/$preset"
  : > "$log"
  echo "configuring $preset"
  (cd "$repository" && quietly "$log" cmake --preset "$preset" "$@") || exit 1
}

# build PRESET [TARGET...]: shows how far it is on a terminal.
build() {
  local preset=$1
  shift
  local log="$repository/build/$preset/launch.log"
  local targets=()
  [ $# -gt 0 ] && targets=(--target "$@")
  echo "building $preset"
  if [ -t 1 ]; then
    if ! (cd "$repository" && set -o pipefail &&
      cmake --build "build/$preset" "${targets[@]}" 2>&1 | tee -a "$log" |
      awk -v start="$(date +%s)" '
        match($0, /^\[[0-9]+\/[0-9]+\]/) {
          split(substr($0, 2, RLENGTH - 2), part, "/")
          left = part[1] > 20 ? (systime() - start) * (part[2] - part[1]) / part[1] : -1
          printf "\r  %d of %d%s   ", part[1], part[2], left >= 0 ? sprintf(", about %d s left", left) : ""
          fflush()
        }
        END { printf "\r%60s\r", "" }'); then
      tail -n 40 "$log" >&2
      echo "The build failed; nothing was started. The whole log is in $log" >&2
      exit 1
    fi
  else
    (cd "$repository" && quietly "$log" cmake --build "build/$preset" "${targets[@]}") || exit 1
  fi
}
