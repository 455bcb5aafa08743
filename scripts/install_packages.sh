#!/usr/bin/env bash
# SPDX-FileCopyrightText: 2026 The Vernier authors
# SPDX-License-Identifier: Apache-2.0
# Installs the packages that Vernier needs on Debian bookworm. Does nothing if all are installed.
set -euo pipefail

usage() {
  cat <<'USAGE'
usage: scripts/install_packages.sh [--demo | --test | --fuzz]
  --demo   with Clang instead of GCC, and without the packages for tests, benchmarks, the check against
           mrcal, the import of meshes, the rendering of images, the 3-D view of worlds, figures as PDF
           and studies on several processes (MPI)
  --test   with the additional packages of the test script: clang-format, clang-tidy, git,
           Python, Chromium, mrcal, COLMAP
  --fuzz   with clang and libFuzzer, for scripts/fuzz.sh
USAGE
}

cd "$(dirname "${BASH_SOURCE[0]}")/.."

scope=standard
case "${1:-}" in
  "") ;;
  --demo) scope=demo ;;
  --test) scope="test" ;;
  --fuzz) scope=fuzz ;;
  -h | --help)
    usage
    exit 0
    ;;
  *)
    usage >&2
    exit 2
    ;;
esac

# Clang takes two thirds of GCC's time for the demo, and its program gives the same results to the bit.
compiler=g++
if [[ $scope == demo ]]; then compiler=clang-14; fi

packages=(
  "$compiler" cmake ninja-build ccache
  libceres-dev libopencv-dev libopencv-contrib-dev libeigen3-dev libtbb-dev librandom123-dev
  libsqlite3-dev libtomlplusplus-dev libcli11-dev nlohmann-json3-dev libfmt-dev libspdlog-dev
  libhwy-dev libyaml-dev libboost-dev libjpeg-dev libpng-dev esbuild
)
if [[ $scope != demo ]]; then packages+=(libassimp-dev libembree-dev libjs-three libopenmpi-dev librsvg2-bin libgtest-dev libbenchmark-dev libmrcal-dev); fi
if [[ $scope == test ]]; then
  packages+=(clang-format clang-tidy git python3 python3-pandas chromium python3-mrcal colmap locales)
fi
if [[ $scope == fuzz ]]; then packages+=(clang-14 libclang-rt-14-dev); fi

sample_images=usr/share/doc/opencv-doc/examples/data
has_sample_images() { [[ -f /$sample_images/left01.jpg || -f build/opencv-doc/$sample_images/left01.jpg ]]; }
if ! has_sample_images; then packages+=(opencv-doc); fi

# plotly.js for the plots of the report page; the Python part is not needed.
plotly=usr/share/python3-plotly/plotly.js
has_plotly() { [[ -f /$plotly || -f build/python3-plotly/$plotly ]]; }

# npm is only needed for the test of the report page; problems with it never stop the script.
has_npm() { command -v npm >/dev/null || command -v node >/dev/null; }
if [[ $scope == test ]] && ! has_npm; then packages+=(npm); fi

is_installed() {
  [[ $(dpkg-query --show --showformat='${db:Status-Status}' "$1" 2>/dev/null) == installed ]]
}

as_root() {
  if [[ $(id -u) == 0 ]]; then
    "$@"
  elif command -v sudo >/dev/null; then
    sudo --preserve-env=DEBIAN_FRONTEND "$@"
  else
    echo "install_packages.sh: not root and sudo not found; as root, run: $*" >&2
    return 1
  fi
}

apt() { as_root apt-get --quiet --option DPkg::Lock::Timeout=300 "$@"; }

is_fresh=no
update_lists() {
  if [[ $is_fresh == no ]]; then apt update >&2; fi
  is_fresh=yes
}

install_missing() {
  local missing=() package with_npm=no
  for package in "${packages[@]}"; do
    if is_installed "$package"; then continue; fi
    if [[ $package == npm ]]; then with_npm=yes; else missing+=("$package"); fi
  done
  export DEBIAN_FRONTEND=noninteractive
  if ((${#missing[@]} > 0)); then
    if ! command -v apt-get >/dev/null; then
      echo "install_packages.sh: apt-get not found; install the equivalents of: ${missing[*]}" >&2
      return 1
    fi
    echo "installing ${missing[*]}" >&2
    update_lists
    apt install --yes --no-install-recommends "${missing[@]}" >&2
  fi
  if [[ $with_npm == yes ]]; then
    update_lists || true
    apt install --yes --no-install-recommends npm >&2 || true
  fi
}

# Unpacks a package into build, without its dependencies.
unpack_beside() {
  local package=$1 folder
  echo "unpacking $package into build/$package" >&2
  folder=$(mktemp --directory)
  if ! (cd "$folder" && apt-get --quiet download "$package" >&2); then
    update_lists
    (cd "$folder" && apt-get --quiet download "$package" >&2)
  fi
  mkdir --parents "build/$package"
  dpkg-deb --extract "$folder/$package"_*.deb "build/$package"
  rm --recursive --force "$folder"
}

install_browser_driver() {
  local stamp=tests/cli/node_modules/.installed
  if [[ $scope != test || ($stamp -nt tests/cli/package-lock.json) ]]; then return; fi
  if ! command -v npm >/dev/null; then
    echo "warning: npm not found; the test of the report page will be skipped" >&2
    return
  fi
  echo "installing the browser driver for the report page test with npm" >&2
  if (cd tests/cli && npm ci --ignore-scripts --no-audit --no-fund --loglevel=error >&2); then
    touch "$stamp"
  else
    echo "warning: npm failed; the test of the report page will be skipped" >&2
  fi
}

install_missing
# Minimal images do not install /usr/share/doc.
if ! has_sample_images; then unpack_beside opencv-doc; fi
if ! has_plotly; then unpack_beside python3-plotly; fi
install_browser_driver
