# SPDX-License-Identifier: Apache-2.0
# Completion of `slewring` in bash. The program itself lists what may stand at the cursor (slewring --complete); the
# first line of its answer names the kind of files that fit too.
_slewring() {
  # readline splits words at '=' and ':'; the program does not
  local line=${COMP_LINE:0:COMP_POINT} words word
  read -ra words <<< "$line"
  [[ $line == *[[:space:]] || ${#words[@]} -eq 0 ]] && words+=('')
  local typed=${words[${#words[@]} - 1]}
  local -a answer
  mapfile -t answer < <("${words[0]}" --complete "${words[@]:1}" 2> /dev/null)
  COMPREPLY=()
  [ ${#answer[@]} -gt 0 ] || return

  # what readline takes for the begin of the word stays as it is
  local kept=${typed%"${typed##*[=:]}"}
  local candidate
  for candidate in "${answer[@]:1}"; do
    candidate=${candidate%%$'\t'*}
    COMPREPLY+=("${candidate#"$kept"}")
  done

  local kind suffix file
  read -ra kind <<< "${answer[0]}"
  [ "${kind[0]}" != none ] || return 0
  local begin=${typed##*=}
  compopt -o filenames
  while IFS= read -r file; do
    if [ -d "$file" ] || [ "${kind[0]}" = any ]; then COMPREPLY+=("$file"); continue; fi
    for suffix in "${kind[@]:1}"; do
      [[ $file == *"$suffix" ]] && COMPREPLY+=("$file")
    done
  done < <(compgen -f -- "$begin")
}

complete -F _slewring slewring
