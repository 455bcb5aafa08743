#!/bin/sh
# SPDX-FileCopyrightText: 2026 The Vernier authors
# SPDX-License-Identifier: Apache-2.0
# A compiler launcher: runs a compiler command, then appends a line of tab-separated fields to LOG: CPU
# seconds (user plus system, including child processes), "compiled", "cached" or "failed", object,
# source. Used in front of ccache with VERNIER_MEASURE_BUILD=ON; scripts/check_build_cost.py reads LOG.
# Written in plain sh without further processes to keep the overhead per unit low: 2 ms.
if [ $# -lt 2 ]; then
  echo "usage: scripts/measured_compile.sh LOG COMMAND..." >&2
  exit 2
fi
log=$1
shift

object=''
source=''
before=''
for argument; do
  case $before in
    -o) object=$argument ;;
    -c) source=$argument ;;
  esac
  before=$argument
done
if [ -z "$object" ] || [ -z "$source" ]; then exec "$@"; fi # version query or preprocessing only

# ccache writes its result here; without ccache the file stays empty.
statistics=$object.ccache
: >"$statistics"
CCACHE_STATSLOG=$statistics "$@"
code=$?

outcome=compiled
if [ $code -ne 0 ]; then outcome=failed; fi
while read -r word; do
  case $word in direct_cache_hit | preprocessed_cache_hit) outcome=cached ;; esac
done <"$statistics"

# Hundredths of a second: fields 14 and 15 for this process, 16 and 17 for its finished children.
# Field 2, a name in parentheses, may contain blanks.
if [ ! -r /proc/$$/stat ]; then exit $code; fi
read -r fields </proc/$$/stat
# shellcheck disable=SC2086 # split into fields
set -- ${fields##*) }
ticks=$((${12} + ${13} + ${14} + ${15}))
hundredths=$((ticks % 100))
if [ $hundredths -lt 10 ]; then hundredths=0$hundredths; fi
# One short append: lines of parallel compilers are not mixed.
printf '%s.%s\t%s\t%s\t%s\n' $((ticks / 100)) "$hundredths" $outcome "$object" "$source" >>"$log"
exit $code
