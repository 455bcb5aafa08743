#!/usr/bin/env bash
# SPDX-FileCopyrightText: 2026 The Vernier authors
# SPDX-License-Identifier: Apache-2.0
# Fuzzes every reader of files with libFuzzer, and says how far the coverage still grows.
set -euo pipefail

usage() {
  cat <<'USAGE'
usage: scripts/fuzz.sh --seconds N [--jobs J] [--keep] [--no-build] [TARGET...]
Builds the fuzz targets in build/fuzz and runs each of them for N seconds of CPU time, in two halves,
going on from the inputs of earlier runs (build/fuzz/corpus/TARGET, tests/corpus/TARGET).
  --seconds N  CPU time of each target
  --jobs J     targets at a time (default: 1); a target is one process
  --keep       afterwards reduce the inputs to those that are needed for the coverage, and copy those
               that add most to tests/corpus/TARGET, where the unit tests replay them
  --no-build   run what is built
  TARGET       default: all
Prints a line a target and appends it to build/fuzz/history. Inputs that break a target are saved in
build/fuzz/findings with the command to run them again. Exit code 1 if there are any.
USAGE
}

wrong_usage() {
  usage >&2
  exit 2
}

cd "$(dirname "${BASH_SOURCE[0]}")/.."
seconds=''
jobs=1
keep=no
build=yes
chosen=()
while (($# > 0)); do
  case "$1" in
    --seconds | --jobs)
      if (($# < 2)) || [[ ! $2 =~ ^[1-9][0-9]*$ ]]; then wrong_usage; fi
      if [[ $1 == --seconds ]]; then seconds=$2; else jobs=$2; fi
      shift
      ;;
    --keep) keep=yes ;;
    --no-build) build=no ;;
    -h | --help)
      usage
      exit 0
      ;;
    -*) wrong_usage ;;
    *) chosen+=("$1") ;;
  esac
  shift
done
if [[ -z $seconds ]]; then wrong_usage; fi

folder=build/fuzz
program=$folder/fuzz/fuzz
if [[ $build == yes ]]; then
  cmake --preset fuzz >/dev/null
  cmake --build --preset fuzz --parallel "$jobs" --target fuzz --target make_seeds
fi
declare -A max_bytes dictionary
while read -r name bytes words; do
  max_bytes[$name]=$bytes
  dictionary[$name]=$words
done < <("$program")
if ((${#chosen[@]} == 0)); then mapfile -t chosen < <(printf '%s\n' "${!max_bytes[@]}" | sort); fi
for target in "${chosen[@]}"; do
  if [[ -z ${max_bytes[$target]:-} ]]; then
    echo "fuzz.sh: no target $target; there are: $(printf '%s\n' "${!max_bytes[@]}" | sort | xargs)" >&2
    exit 2
  fi
done

# Files of the targets are in memory where there is such a file system.
scratch=$(mktemp --directory "$([[ -w /dev/shm ]] && echo /dev/shm || echo /tmp)/vernier-fuzz-XXXXXX")
trap 'rm --recursive --force "$scratch"' EXIT
mkdir --parents "$folder"/{corpus,findings,logs}
"$folder/fuzz/make_seeds" "$folder/seeds"

# libFuzzer on a target with the given options; its folders of inputs last. A reader may take 2 GB and
# 20 s (images of 2^28 pixels are read), as a program without instruments would take a tenth of it.
fuzz() {
  local target=$1
  shift
  local words=()
  if [[ -n ${dictionary[$target]} ]]; then
    words=(-dict="fuzz/dictionaries/${dictionary[$target]}.dict")
  fi
  mkdir --parents "$scratch/$target" "$folder/corpus/$target"
  env TMPDIR="$scratch/$target" VERNIER_FUZZ_TARGET="$target" "$program" "${words[@]}" \
    -max_len="${max_bytes[$target]}" -timeout=20 -rss_limit_mb=3000 -malloc_limit_mb=2500 \
    -artifact_prefix="$folder/findings/$target-" -print_final_stats=1 "$@"
}

count_files() { find "$@" -type f 2>/dev/null | wc --lines; }
findings_of() { find "$folder/findings" -type f -name "$1-*" ! -name '*.command' | sort; }

# The last number behind a word in a log.
last_of() { sed --quiet "s/.*$2: *\([0-9][0-9]*\).*/\1/p" "$1" | tail --lines=1; }

# One half of a run: libFuzzer begins again after a finding, up to five times. Prints the CPU time,
# inputs and edges.
run_half() {
  local target=$1 limit=$2 log=$3
  local spent=0 inputs=0 edges=0 begun=0 left status times run kept=() TIMEFORMAT='%U %S'
  if [[ -d tests/corpus/$target ]]; then kept=("tests/corpus/$target"); fi
  : >"$log"
  while ((begun < 6)) && left=$(awk "BEGIN { print $limit - $spent; exit !($limit - $spent > 0.5) }"); do
    begun=$((begun + 1))
    status=0
    export VERNIER_FUZZ_CPU_S=$left
    { time fuzz "$target" "$folder/corpus/$target" "$folder/seeds/$target" "${kept[@]}" \
      >"$log.part" 2>&1 || status=$?; } 2>"$log.time"
    unset VERNIER_FUZZ_CPU_S
    times=$(tail --lines=1 "$log.time")
    spent=$(awk "BEGIN { split(\"$times\", t, \" \"); print $spent + t[1] + t[2] }")
    run=$(last_of "$log.part" number_of_executed_units)
    inputs=$((inputs + ${run:-0}))
    edges=$(last_of "$log.part" cov)
    cat "$log.part" >>"$log"
    if ((status == 0)); then break; fi
  done
  rm --force "$log.part" "$log.time"
  echo "$spent $inputs ${edges:-0}"
}

run_target() {
  local target=$1 log=$folder/logs/$1 before half1 half2
  before=$(findings_of "$target" | wc --lines)
  half1=$(run_half "$target" "$(awk "BEGIN { print $seconds / 2 }")" "$log.1")
  half2=$(run_half "$target" "$(awk "BEGIN { print $seconds / 2 }")" "$log.2")
  local finding
  while read -r finding; do
    if [[ -n $finding ]]; then
      echo "VERNIER_FUZZ_TARGET=$target $program $finding" >"$finding.command"
    fi
  done < <(findings_of "$target")
  awk -v target="$target" -v files="$(count_files "$folder/corpus/$target")" \
    -v found="$(($(findings_of "$target" | wc --lines) - before))" \
    'BEGIN { split("'"$half1"'", a, " "); split("'"$half2"'", b, " ")
             growth = a[3] > 0 ? 100 * (b[3] - a[3]) / a[3] : 0
             if (growth < 0) growth = 0
             printf "%-20s %8.1f %12d %7d %7.2f %7d %9d\n", target, a[1] + b[1], a[2] + b[2], b[3],
                    growth, files, found }'
}

# The inputs that are needed, and those of them for the unit tests that add most coverage: at most 120
# and 16 kB, so that all targets together stay below 1 MB.
keep_corpus() {
  local target=$1 reduced=$scratch/reduced-$1 kept=tests/corpus/$1 log=$folder/logs/$1.merge
  local total=0 number=0 size file
  mkdir --parents "$reduced" "$kept"
  # It takes the input that adds most coverage to those before, and writes them in that order.
  fuzz "$target" -set_cover_merge=1 -verbosity=2 "$reduced" "$folder/corpus/$target" "$folder/seeds/$target" \
    "$kept" >"$log" 2>&1
  rm --recursive --force "${folder:?}/corpus/$target"
  cp --recursive "$reduced" "$folder/corpus/$target"
  # Inputs that have once broken a target stay.
  find "$kept" -type f ! -name 'finding-*' -delete
  while read -r size file && ((number < 120)); do
    if ((total + size > 16000)); then continue; fi
    total=$((total + size))
    number=$((number + 1))
    file=${file##*/}
    cp "$reduced/$file" "$kept/${file:0:16}"
  done < <(sed --quiet 's/^Written \([0-9]*\) bytes to /\1 /p' "$log")
}

tell_run() {
  local line
  line=$(run_target "$1")
  echo "$line" >>"$folder/history"
  echo "$line"
}

printf '%-20s %8s %12s %7s %7s %7s %9s\n' target 'CPU s' inputs edges '+ %' files findings
before=$(findings_of '*' | wc --lines)
pids=()
for target in "${chosen[@]}"; do
  while (($(jobs -rp | wc --lines) >= jobs)); do wait -n || true; done
  tell_run "$target" &
  pids+=($!)
done
wait "${pids[@]}" || true
if [[ $keep == yes ]]; then
  for target in "${chosen[@]}"; do keep_corpus "$target"; done
fi
if (($(findings_of '*' | wc --lines) > before)); then
  echo "findings, with the command to run each again:" >&2
  cat "$folder"/findings/*.command >&2
  exit 1
fi
