#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# docs/variables.md against what the program names:  variables_test.sh SOURCE_TREE SLEWRING
#
# Every variable of the scenes, which together have every type of docs/scene-format.md, needs a row with its quantity and
# unit; every quantity of a row must be a variable of one of them. Names of variables in other documents must exist.
set -euo pipefail

source=$1 slewring=$2
page=$source/docs/variables.md
here=$(cd "$(dirname "${BASH_SOURCE[0]}")" && pwd)
# without the descriptions of flexible bodies, which have a prefix
mapfile -t scenes < <(grep -L '^prefix:' "$source"/scenes/*.yaml "$source"/scenes/*/*.yaml "$here/every_type.yaml")
scratch=$(mktemp -d)
trap 'rm -rf "$scratch"' EXIT

# types that no scene has
for type in $(sed -n 's/^`type: \([a-z0-9_]*\)`.*/\1/p' "$source/docs/scene-format.md"); do
  grep -qE "type: $type\b" "${scenes[@]}" || echo "no scene here has the type $type: add it to every_type.yaml"
done > "$scratch/wrong"

# quantity and unit of all variables: El.position.x becomes El.position, El.point1.depth El.pointN.depth, a node of a
# flexible body the body but for its deflection and stresses, El.modal_velocity_2 El.modal_velocity_k; what belongs to no
# element keeps its name
for scene in "${scenes[@]}"; do "$slewring" variables "$scene" 2> /dev/null; done > "$scratch/all"
awk '$1 != "variable" {
    name = $1; $1 = ""; $NF = ""; gsub(/^ +| +$/, "")
    if (name !~ /^(mechanics|hydraulics)\./) { sub(/^[^.]*/, "El", name); sub(/\.point[1-8]\./, ".pointN.", name); sub(/\.Node[0-9]+\.deflection/, ".NodeN.deflection", name); sub(/\.Element[0-9]+\.Node[0-9]+\.Point[0-9]+\./, ".ElementE.NodeN.PointP.", name); sub(/\.(Node|Segment|Connector)[0-9]+\./, ".", name); sub(/modal_coordinate_[0-9]+/, "modal_coordinate_k", name); sub(/modal_velocity_[0-9]+/, "modal_velocity_k", name); sub(/\.[wxyz]$/, "", name); sub(/^El\.[A-Za-z0-9_]+\.inside$/, "El.watched.inside", name); sub(/^El\.[A-Za-z0-9_]+\.time$/, "El.watched.time", name) }
    print name "\t" $0 }' "$scratch/all" | sort -u > "$scratch/variables"

# quantities and the text that holds the units: the second column of a row, or the third
grep '^| .*`' "$page" | awk -F'|' '{
  text = $2 $3
  while (match(text, /`[A-Za-z_]+\.[A-Za-z0-9_.]+`/)) {
    name = substr(text, RSTART + 1, RLENGTH - 2); text = substr(text, RSTART + RLENGTH)
    sub(/\.[wxyz]$/, "", name)
    units = " ; " $3 " ; " $4 " ; "; gsub(/[;,()]/, " ; ", units); gsub(/ +/, " ", units)
    print name "\t" units }
  }' > "$scratch/rows"

awk -F'\t' -v variables="$scratch/variables" '
  { rows[$1] = rows[$1] $2 }
  END {
    while ((getline line < variables) > 0) {
      split(line, v, "\t"); is_variable[v[1]] = 1; ++count
      if (!(v[1] in rows)) print v[1] " has no row"
      else if (index(rows[v[1]], "; " v[2] " ;") == 0) print v[1] ": no row says its unit " v[2]
    }
    for (name in rows) if (!(name in is_variable) && name !~ /^(session|role)\./) print name " is no variable"
    if (count < 60) print "only " count + 0 " variables were found"
  }' "$scratch/rows" >> "$scratch/wrong"

# Element.quantity of the other documents, where Element is one of a scene: a variable, a part of one, or a key. Not:
# signals of a device, names that stand for any, named points, files, a name that is wrong on purpose
except='^(Seat|Free|Pair)\.|^Boom\.(tip|foot)$|\.(stl|obj)$|^Pump\.ls_prt$'
grep -E '^(\| |- |  )' "$source/docs/scene-format.md" | grep -o '`[a-z0-9_]*`' | tr -d '`' | sort -u > "$scratch/keys"
(cd "$source" && grep -oE '\b[A-Z][A-Za-z0-9_]*\.[a-z_][A-Za-z0-9_]*(\.[A-Za-z0-9_]+)*' README.md docs/*.md docs/howto/*.md \
  docs/tutorial/*.md docs/machines/*.md) | sort -u |
  awk -F: -v variables="$scratch/all" -v keys="$scratch/keys" -v except="$except" '
    BEGIN {
      while ((getline line < variables) > 0) {
        split(line, word, " "); count = split(word[1], part, "."); name = part[1]; is_element[name] = 1
        for (i = 2; i <= count; ++i) { name = name "." part[i]; is_known[name] = 1 }
      }
      while ((getline line < keys) > 0) is_key[line] = 1
    }
    {
      split($2, part, ".")
      if (!is_element[part[1]] || is_known[$2] || is_key[part[2]] || $2 ~ except) next
      print $1 ": " $2 " is no variable of a scene"
    }
  ' >> "$scratch/wrong"

[ ! -s "$scratch/wrong" ] && exit 0
echo "docs/variables.md and names of variables in documents:" >&2
sort "$scratch/wrong" >&2
exit 1
