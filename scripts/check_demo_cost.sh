#!/usr/bin/env bash
# SPDX-FileCopyrightText: 2026 The Vernier authors
# SPDX-License-Identifier: Apache-2.0
# Checks the time budget of the demo: seconds of wall time on two cores, in a fresh Debian without
# downloaded packages or compiler cache.
set -euo pipefail

budgets=(
  "packages 90"
  "build 240"
  "total 420"
)

usage() {
  cat <<'USAGE'
usage: scripts/check_demo_cost.sh [FILE]
Compares the times written by scripts/demo.sh to FILE (default: out/demo/times.txt) with the budget of
the demo; exit code 1 if one is exceeded. The budget is for a fresh Debian: run
scripts/fresh_root_demo.sh as root to create one and run the demo and this check in it.
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
    echo "check_demo_cost.sh: $times has no time for '$part'" >&2
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
