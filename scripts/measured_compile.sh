#!/bin/sh
# SPDX-FileCopyrightText: 2026 The Vernier authors
# SPDX-License-Identifier: Apache-2.0
#
# A compiler launcher: runs a compiler's command line, then adds one line to LOG, its fields between
# tabs: CPU seconds (user and system, of all processes below), "compiled", "cached" or "failed", the
# object, the source. VERNIER_MEASURE_BUILD=ON puts it in front of ccache;
# scripts/check_build_cost.py reads LOG. It is plain sh and starts no process but the command, since
# every unit pays for it: 2 ms.
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
if [ -z "$object" ] || [ -z "$source" ]; then exec "$@"; fi # asks for a version, or preprocesses

# ccache says there what it did; without ccache the file stays empty.
statistics=$object.ccache
: >"$statistics"
CCACHE_STATSLOG=$statistics "$@"
code=$?

outcome=compiled
if [ $code -ne 0 ]; then outcome=failed; fi
while read -r word; do
  case $word in direct_cache_hit | preprocessed_cache_hit) outcome=cached ;; esac
done <"$statistics"

# Hundredths of a second: fields 14 and 15 of this process, 16 and 17 of those it waited for. Field
# 2, a name in parentheses, may hold blanks.
if [ ! -r /proc/$$/stat ]; then exit $code; fi
read -r fields </proc/$$/stat
# shellcheck disable=SC2086 # the fields one by one
set -- ${fields##*) }
ticks=$((${12} + ${13} + ${14} + ${15}))
hundredths=$((ticks % 100))
if [ $hundredths -lt 10 ]; then hundredths=0$hundredths; fi
# One short write at the end of the file: parallel compilers do not mix their lines.
printf '%s.%s\t%s\t%s\t%s\n' $((ticks / 100)) "$hundredths" $outcome "$object" "$source" >>"$log"
exit $code
