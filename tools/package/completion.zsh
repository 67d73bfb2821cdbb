#compdef servomill
# Completion of servomill for zsh: the program itself knows its commands, options, keys and scenarios.
_servomill() {
  local line
  local -a candidates keys
  for line in ${(f)"$(${words[1]} --complete "${(@)words[2,CURRENT]}" 2>/dev/null)"}; do
    if [[ $line == :files ]]; then
      _files
    elif [[ ${line%%$'\t'*} == *= ]]; then
      keys+=("${${line%%$'\t'*}//:/\\:}:${line#*$'\t'}")
    else
      candidates+=("${${line%%$'\t'*}//:/\\:}:${line#*$'\t'}")
    fi
  done
  (( ${#keys} )) && _describe -t keys key keys -S ''
  (( ${#candidates} )) && _describe -t candidates candidate candidates
}
_servomill "$@"
