#!/usr/bin/env bash
# SPDX-FileCopyrightText: 2026 The Vernier authors
# SPDX-License-Identifier: Apache-2.0
# Installs missing packages, builds everything and runs all tests, and the unit tests with sanitizers.
# Prints the time of each part, what was skipped and why, and CTest's summary at the end.
set -euo pipefail

usage() {
  cat <<'USAGE'
usage: scripts/test.sh [--quick] [--apart] [--measure]
  --quick     skip the unit tests with address and undefined-behaviour sanitizers
  --apart     compile each source of the libraries, of the program and of the tests alone, not several
              in one unit: more than twice the time, and a missing include is an error
  --measure   measure the compile time of each unit that is one source (with --apart: of all) and
              fail if one is too slow; the build folder keeps this setting; units from the compiler cache are not measured unless
              CCACHE_RECACHE=1 is in the environment
USAGE
}

quick=no
apart=no
measure=no
while (($# > 0)); do
  case "$1" in
    --quick) quick=yes ;;
    --apart) apart=yes ;;
    --measure) measure=yes ;;
    -h | --help)
      usage
      exit 0
      ;;
    *)
      usage >&2
      exit 2
      ;;
  esac
  shift
done

cd "$(dirname "${BASH_SOURCE[0]}")/.."
. scripts/part_times.sh
jobs=$(nproc)
log=build/release/ctest.log
skips=build/release/skipped.txt
rm --force "$log" "$skips"

# Wall time of tests, run in parallel; CTest does not measure their CPU time.
print_test_times() {
  local name seconds LC_ALL=C
  printf '\n%-66s %9s\n' "release tests: by label, and the slowest tests" "test s"
  while IFS=$'\t' read -r name seconds; do
    printf '  %-64.64s %9.1f\n' "$name" "$seconds"
  done < <(sed --quiet --regexp-extended \
    's/^ *(\S+) *= *([0-9.]+) sec\*proc *\(([0-9]+ tests?)\).*/label \1, \3\t\2/p' "$log"
    sed --quiet --regexp-extended \
      's/^ *[0-9]+\/[0-9]+ +Test +#[0-9]+: (\S+) .* ([0-9.]+) sec.*/\1\t\2/p' "$log" |
      sort --field-separator=$'\t' --key=2 --numeric-sort --reverse | sed 8q)
}

# What the release tests skipped: a line with the reason of each. Programs of tests pass although some
# of their tests are skipped, so that only CTest's own log has them.
find_skips() {
  local all=build/release/Testing/Temporary/LastTest.log
  if [[ ! -f $all ]]; then return; fi
  sed --quiet --regexp-extended "s/^.* \.\.\. skipped (['\"])(.*)\1\$/\2/p" "$all"   # unittest's
  sed --quiet --regexp-extended '/^[^ ]+:[0-9]+: Skipped$/ { n; s/^$/without a reason/; p }' "$all" # gtest's
  sed --quiet --regexp-extended 's/^[a-z ]+: skipped(: |, )?(.*)$/\2/p' "$all"           # our scripts'
}

print_skips() {
  local count reason
  printf '\n%-66s %9s\n' "release tests: skipped, and why" "tests"
  sort "$skips" | uniq --count | sort --numeric-sort --reverse | while read -r count reason; do
    printf '  %-64s %9d\n' "$reason" "$count"
  done
  printf '  %-64s %9d\n' "all" "$(wc --lines < "$skips")"
}

close() {
  local code=$? failed_part=$part_open
  end_parts
  echo
  print_part_times
  if [[ -f $log ]]; then
    print_test_times
    if [[ -f $skips ]]; then print_skips; fi
    echo
    grep --max-count=1 'tests passed' "$log" || true
  fi
  if ((code != 0)); then echo "test.sh: failed in the part '$failed_part'" >&2; fi
}
trap close EXIT

begin_part "packages"
scripts/install_packages.sh --test
begin_part "format"
scripts/check_format.sh

begin_part "release: build"
options=(-DVERNIER_TEST_SHARDS=4 -DVERNIER_SANITIZED_TESTS=ON)
if [[ $quick == yes ]]; then options+=(-DVERNIER_SANITIZED_TESTS=OFF); fi
unity=ON
if [[ $apart == yes ]]; then unity=OFF; fi
# The tests are those of GCC's build; the demo leaves one of Clang's.
if grep --quiet '^CMAKE_CXX_COMPILER:.*clang' build/release/CMakeCache.txt 2>/dev/null; then
  options+=(--fresh)
fi
if [[ $measure == yes ]]; then options+=(-DVERNIER_MEASURE_BUILD=ON); fi
cmake --preset release -DVERNIER_BUILD_TESTS=ON -DVERNIER_BUILD_PROGRAM=ON \
  -DCMAKE_UNITY_BUILD=$unity "${options[@]}"
cmake --build --preset release --parallel "$jobs"
begin_part "release: every installed header compiles alone"
cmake --build --preset release --parallel "$jobs" --target all_verify_interface_header_sets
cost=0
if [[ $measure == yes ]]; then
  # Run the tests anyway; the exit code is reported at the end. Units from the compiler cache are
  # not measured; the check prints their number.
  scripts/check_build_cost.py build/release --top 5 --tolerance 40 --allow-cached || cost=$?
fi
begin_part "release: tests"
failed=0
ctest --preset release --parallel "$jobs" --no-tests=error --label-exclude sanitized |
  tee "$log" || failed=$?
find_skips > "$skips"
if ((failed != 0)); then exit "$failed"; fi

if [[ $quick == no ]]; then
  begin_part "sanitizers: build"
  cmake --build --preset release --parallel "$jobs" --target sanitized_tests
  begin_part "sanitizers: tests"
  ctest --preset release --parallel "$jobs" --no-tests=error --label-regex sanitized
fi

if ((cost != 0)); then
  begin_part "compile time check, see above"
  exit "$cost"
fi
