#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# cached_test.sh SCRIPTS CCACHE CLANG   with one ccache for two clones, what is compiled with a precompiled header in one
# of them is taken in the other, also when the first one is gone, and compiled again when the header changes. SCRIPTS: the
# folder of cached and compile_with. CCACHE, CLANG: the programs, or ...-NOTFOUND.
set -euo pipefail
scripts=$1 ccache=$2 clang=$3
case $ccache$clang in
  *-NOTFOUND*) echo "SKIPPED: needs ccache and clang++-14"; exit ;;
esac
folder=$(mktemp -d)
trap 'rm -r "$folder"' EXIT
export CCACHE_DIR=$folder/cache CCACHE_CONFIGPATH=/dev/null

# compile OPTION ...: as the tests are, in the folder $clone
compile() {
  "$clone/cmake/compile_with" "$clang" c++ "$clone/cmake/cached" "$ccache" c++ "$@"
}

# build CLONE NUMBER: compiles the clone's unit with its header, whose number it returns; found: whether it was in ccache
build() {
  local clone=$folder/$1
  mkdir -p "$clone/cmake" "$clone/build"
  cp "$scripts"/{cached,compile_with} "$clone/cmake"
  echo "inline int number() { return $2; }" > "$clone/number.h"
  echo "#include \"$clone/number.h\"" > "$clone/build/all.hxx"
  : > "$clone/build/all.hxx.cxx"
  echo 'int main() { return number(); }' > "$clone/main.cpp"
  cd "$clone/build"
  compile -x c++-header -include "$clone/build/all.hxx" -MD -MT all.gch -MF all.d \
    -o "$clone/build/all.hxx.gch" -c "$clone/build/all.hxx.cxx"
  "$ccache" --zero-stats > stats
  compile -include "$clone/build/all.hxx" -MD -MT main.o -MF main.d -o main.o -c "$clone/main.cpp"
  "$clang" -o main main.o
  local returned=0
  ./main || returned=$?
  [ "$returned" = "$2" ] || { echo "$1: the program returned $returned, its header says $2"; exit 1; }
  "$ccache" --print-stats | awk '$1 ~ /^(direct|preprocessed)_cache_hit$/ { hits += $2 } END { exit !hits }' &&
    found=hit || found=miss
}

# expect FOUND CLONE NUMBER
expect() {
  build "$2" "$3"
  [ "$found" = "$1" ] || { echo "$2 with $3: a $1 was expected in ccache, it was a $found"; exit 1; }
}

expect miss first 3
rm -r "$folder/first"
expect hit second 3
expect miss second 4
