# SPDX-License-Identifier: GPL-3.0-or-later
# Sourced by experiments/run and tests/run: installs what is missing, configures once, builds what changed.
# Everything goes to standard error, so that what the program prints can be piped.

packages=(g++ cmake ninja-build ccache git gnuplot-nox catch2 libbenchmark-dev libboost-dev libbullet-dev libcgal-dev
  libcli11-dev libdraco-dev libeigen3-dev libembree-dev libfcl-dev libfmt-dev libgmp-dev libhwy-dev libjs-three
  libmeshoptimizer-dev libmpfi-dev libmpfr-dev librapidcheck-dev libtbb-dev lrslib nettle-dev nlohmann-json3-dev
  python3 python3-jsonschema zlib1g-dev)
test_packages=(chromium chromium-driver clang clang-format coq doxygen furo gappa libcoq-flocq libcoq-gappa
  libzarith-ocaml-dev munge mypy ocaml-findlib ocaml-nox pybind11-dev python3-dev python3-hypothesis
  python3-matplotlib python3-myst-parser python3-numpy python3-pip python3-pybind11 python3-pytest
  python3-setuptools python3-sphinx python3-wheel pkg-config slurm-client slurmctld slurmd)
export CCACHE_BASEDIR=$source # what two build folders compile alike is compiled once
configuration=() # further arguments of CMake's, for build

# install_packages [NAME...]: those above, and these.
install_packages() {
  command -v dpkg-query >/dev/null || {
    echo "This is no Debian system; if the build fails, install the equivalents of: ${packages[*]}" >&2
    return
  }
  local missing=() name
  for name in "${packages[@]}" "$@"; do
    [ "$(dpkg-query -W -f '${db:Status-Status}' "$name" 2>/dev/null)" = installed ] || missing+=("$name")
  done
  [ ${#missing[@]} -gt 0 ] || return 0
  local as_root=()
  if [ "$(id -u)" -ne 0 ]; then
    if command -v sudo >/dev/null && { [ -t 0 ] || sudo -n true 2>/dev/null; }; then
      as_root=(sudo)
    else
      echo "Some packages are missing. As root, run:" >&2
      echo "  apt-get update && apt-get install --no-install-recommends ${missing[*]}" >&2
      exit 2
    fi
  fi
  echo "Installing ${missing[*]}" >&2
  "${as_root[@]}" apt-get update -qq >&2
  "${as_root[@]}" env DEBIAN_FRONTEND=noninteractive apt-get install -y -qq --no-install-recommends "${missing[@]}" >&2
}

# build TARGET...: configures the release preset if that was never done, or if there are arguments for it; then builds
# the targets.
build() {
  cd "$source"
  mkdir -p .build
  exec 9>.build/lock
  flock 9 # two calls at once take turns
  if [ ! -f .build/release/build.ninja ] || [ ${#configuration[@]} -gt 0 ]; then
    cmake --preset release "${configuration[@]}" >&2
  fi
  cmake --build --preset release --target "$@" | sed -u '/Reading the commit$/d' >&2
  exec 9>&-
}
