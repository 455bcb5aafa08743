#!/usr/bin/env bash
# SPDX-FileCopyrightText: 2026 The Vernier authors
# SPDX-License-Identifier: Apache-2.0
#
# Installs what is missing, builds everything and runs every test; with sanitizers, the unit tests.
set -euo pipefail

usage() {
  cat <<'USAGE'
usage: scripts/test.sh [--quick]
  --quick   without the second build, under address and undefined-behaviour sanitizers
USAGE
}

quick=no
case "${1:-}" in
  "") ;;
  --quick) quick=yes ;;
  -h | --help)
    usage
    exit 0
    ;;
  *)
    usage >&2
    exit 2
    ;;
esac

cd "$(dirname "${BASH_SOURCE[0]}")/.."
jobs=$(nproc)
log=build/release/ctest.log
step() { echo "== $* ($((SECONDS / 60)) min $((SECONDS % 60)) s)"; }

step "packages"
scripts/install_packages.sh --test
step "format"
scripts/check_format.sh

step "release: build"
cmake --preset release -DVERNIER_BUILD_TESTS=ON -DVERNIER_BUILD_PROGRAM=ON
cmake --build --preset release --parallel "$jobs"
step "release: every installed header compiles alone"
cmake --build --preset release --parallel "$jobs" --target all_verify_interface_header_sets
step "release: tests"
ctest --preset release --parallel "$jobs" --no-tests=error | tee "$log"

if [[ $quick == no ]]; then
  step "sanitizers: build the unit tests"
  cmake --preset asan -DVERNIER_BUILD_TESTS=ON
  cmake --build --preset asan --parallel "$jobs" --target unit_tests
  step "sanitizers: tests"
  ctest --preset asan --parallel "$jobs" --no-tests=error
fi

step "done"
grep --max-count=1 'tests passed' "$log"
