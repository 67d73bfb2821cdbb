# Sourced by the commands of this folder, from the folder above it: their help, packages, and installing those that are missing.

# libsundials-dev is large (about 310 packages and 240 MB with what it needs): it integrates the
# equations of the drives, as a reference or where a scenario asks for it.
BUILD_PACKAGES=(g++ cmake ninja-build libeigen3-dev libfmt-dev libhdf5-dev libdeflate-dev zlib1g-dev
  libboost-dev libboost-program-options-dev libtomlplusplus-dev libsundials-dev libxsimd-dev
  libnanoflann-dev libmatio-dev libpugixml-dev libceres-dev libzip-dev)
FIGURE_PACKAGES=(python3 python3-numpy python3-h5py python3-matplotlib python3-pil python3-xarray
  python3-h5netcdf)
# Other programs that open result files: tested with them.
READER_PACKAGES=(octave python3-netcdf4)
# The Python module (tools/python), and what runs its notebooks in the tests (24 MB).
PYTHON_PACKAGES=(python3-dev pybind11-dev python3-pybind11 python3-nbclient python3-ipykernel)
TEST_PACKAGES=(git libgtest-dev libbenchmark-dev clang-format clang-tidy hdf5-tools shellcheck)
# Fuzz targets with libFuzzer (tools/fuzz); clang-tidy brings most of it along.
FUZZ_PACKAGES=(clang-14 libclang-rt-14-dev)
# A Slurm cluster of one machine (tools/slurm/local_cluster) and GNU parallel (tools/parallel).
CLUSTER_PACKAGES=(slurmctld slurmd slurm-client munge)
PARALLEL_PACKAGES=(parallel)
# The page that shows result files (tools/page): a browser for its tests; node_packages prints the others.
PAGE_TEST_PACKAGES=(chromium)

# The Debian package (tools/deb): made, checked, and tried out on a Debian of its own.
DEB_PACKAGES=(dpkg-dev file lintian mmdebstrap)

# The comment at the head of the command, before it does anything.
help_if_asked() {
  case "${1:-}" in -h | --help)
    sed -n '2,/^set/{/^set/d;s/^# \{0,1\}//;p}' "tools/$(basename "$0")"
    exit 0
    ;;
  esac
}

say() { printf '\n== %s\n' "$*"; }

missing_packages() {
  local package
  for package in "$@"; do
    dpkg-query -W -f='${Status}' "$package" 2>/dev/null | grep -q 'ok installed' || echo "$package"
  done
}

# Packages of the commands that bundle the page, of those that are not installed from elsewhere.
node_packages() {
  command -v node >/dev/null || echo nodejs
  command -v npm >/dev/null || echo npm
}

install_packages() {
  local missing
  mapfile -t missing < <(missing_packages "$@")
  [ ${#missing[@]} -eq 0 ] && return
  say "Installing: ${missing[*]}"
  local sudo=
  [ "$(id -u)" -eq 0 ] || sudo=sudo
  $sudo apt-get update -q
  $sudo env DEBIAN_FRONTEND=noninteractive apt-get install -y -q --no-install-recommends "${missing[@]}"
}

# For what the suite can do without: as root installs, else and where that fails says what is missing and
# ends with 77, which CTest takes for skipped.
install_packages_or_skip() {
  local missing
  mapfile -t missing < <(missing_packages "$@")
  [ ${#missing[@]} -eq 0 ] && return
  if [ "$(id -u)" -ne 0 ]; then
    echo "SKIPPED: not installed, and only root could install: ${missing[*]}" >&2
    exit 77
  fi
  (install_packages "${missing[@]}") >&2 || {
    echo "SKIPPED: cannot be installed: ${missing[*]}" >&2
    exit 77
  }
}
