# Completion of servomill for bash: the program itself knows its commands, options, keys and scenarios.
_servomill() {
  local word=${COMP_WORDS[COMP_CWORD]} line candidate
  COMPREPLY=()
  while IFS= read -r line; do
    if [ "$line" = :files ]; then
      mapfile -t -O "${#COMPREPLY[@]}" COMPREPLY < <(compgen -f -- "$word")
      compopt -o filenames 2>/dev/null
      continue
    fi
    candidate=${line%%$'\t'*}
    [[ $candidate == "$word"* ]] && COMPREPLY+=("$candidate")
  done < <("${COMP_WORDS[0]}" --complete "${COMP_WORDS[@]:1:COMP_CWORD}" 2>/dev/null)
  if [ ${#COMPREPLY[@]} -eq 1 ] && [[ ${COMPREPLY[0]} == *= ]]; then
    compopt -o nospace 2>/dev/null
  fi
}
complete -F _servomill servomill
