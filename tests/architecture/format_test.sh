#!/usr/bin/env bash
# format_test.sh SOURCE CLANG_FORMAT changed|all   sources are as clang-format leaves them. SOURCE: the root. CLANG_FORMAT: the
# program, or ...-NOTFOUND. changed: those that differ from the branch main, from the last commit on main itself, and
# those that git does not track; without git, or a commit to compare with, all.
set -euo pipefail
source=$1 clang_format=$2 which=$3
case $clang_format in
  *-NOTFOUND) echo "SKIPPED: there is no clang-format"; exit ;;
esac
version=$("$clang_format" --version)
case $version in
  *"version 14."*) ;;
  *) echo "SKIPPED: other releases than 14 format otherwise; this one is $version"; exit ;;
esac
cd "$source"

# all_sources, changed_sources: names, each with a NUL after it
all_sources() {
  find benchmarks cli examples flex_node hydraulics_node io_node libs mechanics_node recorder_node tests \
    '(' -name '*.cpp' -o -name '*.h' ')' -print0
}
changed_sources() {
  local base
  base=$(git merge-base HEAD main) || return
  [ "$base" != "$(git rev-parse HEAD)" ] || base=$(git rev-parse --verify HEAD~) || return
  git diff -z --name-only --diff-filter=d "$base" -- '*.cpp' '*.h'
  git ls-files -z --others --exclude-standard -- '*.cpp' '*.h'
}

folder=$(mktemp -d)
trap 'rm -r "$folder"' EXIT
all_sources > "$folder/all"
count=$(tr -cd '\0' < "$folder/all" | wc -c)
[ "$count" -ge 100 ] || { echo "only $count sources were found in $source"; exit 1; }
[ "$which" = changed ] && changed_sources > "$folder/chosen" 2> /dev/null || cp "$folder/all" "$folder/chosen"
tr -cd '\0' < "$folder/chosen" | wc -c | sed "s/$/ of $count sources/"
xargs --null --no-run-if-empty --max-args=20 --max-procs=2 "$clang_format" --dry-run --Werror --ferror-limit=1 < "$folder/chosen" ||
  { echo "Run: git ls-files '*.cpp' '*.h' | xargs clang-format -i"; exit 1; }
