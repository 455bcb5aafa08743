#!/usr/bin/env bash
# SPDX-FileCopyrightText: 2026 The Vernier authors
# SPDX-License-Identifier: Apache-2.0
# Runs the tests that use threads with the thread sanitizer: once for every release, not in CI.
set -euo pipefail

usage() {
  cat <<'USAGE'
usage: scripts/thread_sanitizer.sh [--jobs J] [--filter PATTERN]
Builds the libraries and the tests that use threads in build/threads with -fsanitize=thread, and runs
them. Exit code 1 for a race, a failed test, or if there was nothing to run.
  --jobs J          compilers at a time (default: all processors)
  --filter PATTERN  of GoogleTest; default: all tests of one and several threads
scripts/thread_sanitizer_suppressions.txt lists the libraries that the sanitizer cannot see into.
USAGE
}

cd "$(dirname "${BASH_SOURCE[0]}")/.."
jobs=$(nproc)
# Tests that run several threads and do not say so in their names are in these suites.
filter='*Thread*:StudyRuns.*:StudyRanks.*:WarpedPair*:RaceSearches.*:SuccessCurve.*:SuccessLimits.*:SplitHalves.*'
filter+=':OneAtATime.*:ToldStudies.*:Systems.*'
while (($# > 0)); do
  case "$1" in
    --jobs | --filter)
      if (($# < 2)); then
        usage >&2
        exit 2
      fi
      if [[ $1 == --jobs ]]; then jobs=$2; else filter=$2; fi
      shift
      ;;
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

cmake --preset threads >/dev/null
cmake --build --preset threads --parallel "$jobs" --target thread_tests

log=build/threads/thread_sanitizer.log
options="suppressions=$PWD/scripts/thread_sanitizer_suppressions.txt halt_on_error=0 exitcode=66"
# The sanitizer's memory must lie where it expects it: no address randomisation.
status=0
TSAN_OPTIONS="$options second_deadlock_stack=1" setarch --addr-no-randomize \
  build/threads/tests/thread_tests --gtest_filter="$filter" >"$log" 2>&1 || status=$?
ran=$(sed --quiet 's/^\[==========\] \([0-9]*\) tests\? .* ran\..*/\1/p' "$log")
races=$(grep --count '^WARNING: ThreadSanitizer' "$log" || true)
grep --extended-regexp '^(WARNING: ThreadSanitizer|SUMMARY: ThreadSanitizer|\[  FAILED)' "$log" || true
echo "thread sanitizer: ${ran:-0} tests, $races findings; all of it in $log"
if ((status != 0 || races > 0 || ${ran:-0} == 0)); then exit 1; fi
