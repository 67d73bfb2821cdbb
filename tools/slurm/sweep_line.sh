# Sourced by tools/slurm/submit and tools/parallel: the line that both are called with,
#   [OPTION...] -- SHARDS SCENARIO.toml OUT.h5 [SWEEP_OPTION...]
# read into: options, shards, scenario, out, sweep_options; and SERVOMILL, the program.

read_sweep_line() {
  options=()
  while [ $# -gt 0 ] && [ "$1" != -- ]; do
    options+=("$1")
    shift
  done
  [ $# -ge 4 ] || refuse "usage: $0 [OPTION...] -- SHARDS SCENARIO.toml OUT.h5 [SWEEP_OPTION...]"
  shards=$2 scenario=$3 out=$4
  shift 4
  sweep_options=("$@")
  local option
  for option in "${sweep_options[@]}"; do
    case $option in
      -f | --force | -o* | --output* | --shard*)
        refuse "$option: is for servomill itself; a shard that is tried again must go on, not begin anew" ;;
    esac
  done
  [[ $shards =~ ^[1-9][0-9]*$ ]] || refuse "SHARDS = $shards; must be a whole number > 0"
  [[ $out == *.h5 ]] || refuse "OUT.h5 = $out; must end with .h5"
  [ ! -e "$out" ] || refuse "$out: exists; move it away or delete it"
  export SERVOMILL=${SERVOMILL:-servomill}
  "$SERVOMILL" check "$scenario"
}

refuse() {
  echo "$(basename "$0"): error: $*" >&2
  exit 2
}

# The command that joins the files of all shards.
merge_command() {
  local shard
  printf '%q merge' "$SERVOMILL"
  for ((shard = 1; shard <= shards; shard++)); do
    printf ' %q' "${out%.h5}.$shard-of-$shards.h5"
  done
  printf ' -o %q\n' "$out"
}
