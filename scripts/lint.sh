#!/usr/bin/env bash
# SPDX-FileCopyrightText: 2026 The Vernier authors
# SPDX-License-Identifier: Apache-2.0
# Runs clang-tidy 14 with .clang-tidy on C++ files; prints each finding once; exit code 1 if there are
# any.
set -euo pipefail

usage() {
  cat <<'USAGE'
usage: scripts/lint.sh [--since REVISION] [--build FOLDER] [--jobs N] [FILE...]
Runs clang-tidy on the given files, by default on all sources built in FOLDER and their headers.
  --since REVISION   only files that differ from REVISION in git, including uncommitted changes
  --build FOLDER     configured build folder, need not be built (default: build/release)
  --jobs N           parallel jobs (default: all processors); a source takes 10 to 30 s, and a unity
                     batch little more: with a FOLDER configured with -DCMAKE_UNITY_BUILD=ON all of the
                     libraries and the program take some minutes
USAGE
}

wrong_usage() {
  usage >&2
  exit 2
}

refuse() {
  echo "lint.sh: $*" >&2
  exit 2
}

started_in=$PWD
cd "$(dirname "${BASH_SOURCE[0]}")/.."
since=''
build=build/release
jobs=$(nproc)
files=()
while (($# > 0)); do
  case "$1" in
    -h | --help)
      usage
      exit 0
      ;;
    --since | --build | --jobs)
      if (($# < 2)); then wrong_usage; fi
      case "$1" in
        --since) since=$2 ;;
        --build) build=$(realpath --relative-base=. "$started_in/$2") ;;
        --jobs) jobs=$2 ;;
      esac
      shift
      ;;
    -*) wrong_usage ;;
    *)
      files+=("$(cd "$started_in" && realpath "$1")")
      if [[ ! -f ${files[-1]} ]]; then refuse "no such file: $1"; fi
      ;;
  esac
  shift
done
if [[ ! $jobs =~ ^[1-9][0-9]*$ ]]; then wrong_usage; fi
if [[ -n $since ]] && ((${#files[@]} > 0)); then wrong_usage; fi

tidy=$(command -v clang-tidy-14 || command -v clang-tidy || true)
if [[ -z $tidy || $("$tidy" --version) != *"version 14."* ]]; then
  refuse "clang-tidy 14 not found; as root: apt-get install clang-tidy"
fi
if ! command -v python3 >/dev/null; then refuse "python3 not found"; fi
if [[ ! -f $build/compile_commands.json ]]; then
  refuse "no $build/compile_commands.json; run cmake --preset release first"
fi
if [[ -n $since ]] && ! git rev-parse --quiet --verify "$since^{commit}" >/dev/null; then
  refuse "unknown git revision $since"
fi

results=$(mktemp --directory)
trap 'rm --recursive --force "$results"' EXIT

# The build's command lines adapted for clang: without GCC's precompiled headers, which clang cannot
# read, and without errors for GCC-only warning options. Prints the sources, except generated ones.
python3 - "$build/compile_commands.json" "$results/compile_commands.json" >"$results/sources" <<'PY'
import json, os, shlex, sys

root = os.getcwd() + "/"
entries = []
sources = set()
with open(sys.argv[1], encoding="utf-8") as file:
    for entry in json.load(file):
        name = entry["file"]
        made = name.startswith(entry["directory"] + "/") and "/Unity/unity_" not in name
        if not name.startswith(root) or made:
            continue
        words = shlex.split(entry["command"])
        kept = []
        skip = False
        for i, word in enumerate(words):
            if skip:
                skip = False
            elif word == "-include" and words[i + 1].endswith("/cmake_pch.hxx"):
                skip = True
            elif word not in ("-Winvalid-pch", "-fpch-preprocess") and "--param=ggc" not in word:
                kept.append(word)
        kept.insert(1, "-Wno-unknown-warning-option")
        entries.append({"directory": entry["directory"], "file": name, "arguments": kept})
        sources.add(name)
with open(sys.argv[2], "w", encoding="utf-8") as file:
    json.dump(entries, file)
print("\n".join(sorted(sources)))
PY

if [[ -n $since ]]; then
  while IFS= read -r -d '' file; do
    # A source that is in no target here cannot be compiled; a header takes its neighbour's flags.
    if [[ $file == *.h ]] || grep --quiet --line-regexp --fixed-strings "$PWD/$file" \
      "$results/sources"; then
      files+=("$PWD/$file")
    elif grep --quiet "/Unity/unity_" "$results/sources" && [[ $file =~ ^(calib|stereo|localise|sim|cli)/ ]]; then
      refuse "$build is a unity build, which does not compile $file alone: configure another folder" \
        "with -DCMAKE_UNITY_BUILD=OFF, and give it as --build"
    fi
  done < <(
    git diff --name-only --diff-filter=d -z "$since" -- '*.cpp' '*.h'
    git ls-files --others --exclude-standard -z -- '*.cpp' '*.h'
  )
  if ((${#files[@]} == 0)); then
    echo "lint: no C++ file differs from $since"
    exit 0
  fi
elif ((${#files[@]} == 0)); then
  mapfile -t files <"$results/sources"
fi

lint_one() {
  local found=$results/${1//\//_}.found messages=$results/${1//\//_}.messages
  local options=()
  # A unity batch includes its sources: report their findings, but not that they are included.
  if [[ $1 == */Unity/unity_* ]]; then
    options=(--checks=-bugprone-suspicious-include "--header-filter=${filter/'\.h$'/'\.(h|cpp)$'}")
  fi
  if "$tidy" --quiet -p "$results" "${options[@]}" "$1" >"$found" 2>"$messages"; then return; fi
  # It also fails if there are findings; without findings, clang-tidy itself failed.
  if ! grep --quiet --extended-regexp '(:[0-9]+:[0-9]+: (warning|error)|^error): ' "$found"; then
    echo "$1:1:1: error: $(tail --lines=1 "$messages") [clang-tidy-failed]" >"$found"
  fi
}
export -f lint_one
filter=$(sed --quiet "s/^HeaderFilterRegex: '\(.*\)'/\1/p" .clang-tidy)
export tidy results filter
# shellcheck disable=SC2016 # $1 is for the inner bash
printf '%s\0' "${files[@]}" |
  xargs --null --max-args=1 --max-procs="$jobs" bash -c 'lint_one "$1"' bash

# A finding in a header is reported for each source that includes it: keep the first, with its notes.
find "$results" -name '*.found' -print0 | sort --zero-terminated | xargs --null cat |
  awk -v root="$PWD/" '
    /^[^ ].*:[0-9]+:[0-9]+: (warning|error): / { show = !seen[$0]++ }
    show { if (index($0, root) == 1) $0 = substr($0, length(root) + 1); print }
  ' >"$results/all"
cat "$results/all"

findings=$(grep --count --extended-regexp '^[^ ].*:[0-9]+:[0-9]+: (warning|error): ' \
  "$results/all" || true)
if ((findings > 0)); then
  echo
  # by check
  sed --quiet --regexp-extended \
    's/^[^ ].*:[0-9]+:[0-9]+: (warning|error): .*\[([^],]+).*\]$/\2/p' "$results/all" |
    sort | uniq --count | sort --numeric-sort --reverse
fi
echo "lint: ${#files[@]} files, $findings findings"
((findings == 0))
