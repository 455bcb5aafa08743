#!/usr/bin/env bash
# SPDX-FileCopyrightText: 2026 The Vernier authors
# SPDX-License-Identifier: Apache-2.0
#
# Does the demo stay within its budget? Seconds of wall time on two cores, in a fresh Debian, with
# the packages still to be fetched and nothing in a compiler cache.
set -euo pipefail

budgets=(
  "packages 90"
  "build 240"
  "total 420"
)

usage() {
  cat <<'USAGE'
usage: scripts/check_demo_cost.sh [FILE]
Compares the times that scripts/demo.sh left in FILE (out/demo/times.txt) with the demo's budget;
exit code 1 where one is exceeded. The budget is meant for a fresh Debian:
scripts/fresh_root_demo.sh, as root, makes one, runs the demo there and then this check.
USAGE
}

if [[ ${1:-} == -h || ${1:-} == --help ]]; then
  usage
  exit 0
fi
if (($# > 1)) || [[ ${1:-} == -* ]]; then
  usage >&2
  exit 2
fi
times=${1:-$(dirname "${BASH_SOURCE[0]}")/../out/demo/times.txt}
if [[ ! -f $times ]]; then
  echo "check_demo_cost.sh: no $times; run scripts/demo.sh first" >&2
  exit 2
fi

LC_ALL=C
over=0
printf '%-12s %9s %9s\n' "part" "wall s" "budget s"
for line in "${budgets[@]}"; do
  read -r part budget <<<"$line"
  seconds=$(awk -F '\t' -v part="$part" '$1 == part { print $2; exit }' "$times")
  if [[ ! $seconds =~ ^[0-9]+\.[0-9][0-9]$ ]]; then
    echo "check_demo_cost.sh: $times does not say what '$part' took" >&2
    exit 2
  fi
  verdict=''
  if ((10#${seconds/./} > budget * 100)); then
    verdict='  over'
    over=1
  fi
  printf '%-12s %9.1f %9.1f%s\n' "$part" "$seconds" "$budget" "$verdict"
done
exit "$over"
