# Sourced by tools/demo and tools/check: packages, and installing those that are missing.

# libsundials-dev is large (about 310 packages and 240 MB with what it needs): it integrates the
# equations of the drives, as a reference or where a scenario asks for it.
BUILD_PACKAGES=(g++ cmake ninja-build libeigen3-dev libfmt-dev libhdf5-dev libdeflate-dev
  libboost-dev libboost-program-options-dev libtomlplusplus-dev libsundials-dev libxsimd-dev)
FIGURE_PACKAGES=(python3 python3-numpy python3-h5py python3-matplotlib python3-pil python3-xarray
  python3-h5netcdf)
TEST_PACKAGES=(git libgtest-dev libbenchmark-dev clang-format clang-tidy hdf5-tools)
# One-machine Slurm (tools/slurm/local_cluster) and GNU parallel; only the tests with label cluster need them.
CLUSTER_PACKAGES=(slurmctld slurmd slurm-client munge)
PARALLEL_PACKAGES=(parallel)

say() { printf '\n== %s\n' "$*"; }

install_packages() {
  local missing=() package
  for package in "$@"; do
    dpkg-query -W -f='${Status}' "$package" 2>/dev/null | grep -q 'ok installed' || missing+=("$package")
  done
  [ ${#missing[@]} -eq 0 ] && return
  say "Installing: ${missing[*]}"
  local sudo=
  [ "$(id -u)" -eq 0 ] || sudo=sudo
  $sudo apt-get update -q
  $sudo env DEBIAN_FRONTEND=noninteractive apt-get install -y -q --no-install-recommends "${missing[@]}"
}
