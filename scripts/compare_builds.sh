#!/usr/bin/env bash
# SPDX-FileCopyrightText: 2026 The Vernier authors
# SPDX-License-Identifier: Apache-2.0
# Compares the results of two builds of the program, as of two compilers, to the bit.
set -euo pipefail

usage() {
  cat <<'USAGE'
usage: scripts/compare_builds.sh VERNIER VERNIER
Runs calibrations of real and simulated corners, samples, pairs, views, maps, buildings and studies with
both programs, and compares every file that they write; times are left out. Takes half a minute.
Exit code 1 if a file differs.
USAGE
}

if [[ ${1:-} == -h || ${1:-} == --help ]]; then
  usage
  exit 0
fi
if (($# != 2)); then
  usage >&2
  exit 2
fi
root=$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd)
data=/usr/share/doc/opencv-doc/examples/data
if [[ ! -f $data/left01.jpg ]]; then data=$root/build/opencv-doc$data; fi
images=(--left "$data/left[0-9]*.jpg" --right "$data/right[0-9]*.jpg" --board 9x6 --square-m 0.025)
work=$(mktemp --directory)
trap 'rm --recursive --force "$work"' EXIT

# Exit code 3 is a result too.
run() { "$program" "$@" >>log.txt 2>&1 || (($? == 3)); }

results_of() {
  local program=$1 # seen by run
  run calibrate "${images[@]}" -o rig.json
  run calibrate "${images[@]}" --model opencv8 -o rig8.json
  run calibrate "${images[@]}" --board-shape --motion -o motion.json
  run detect "${images[@]:0:6}" -o corners.vnl
  run sample rig.json --psi-c 1 -n 1000 --seed 1 -o samples.csv
  run match "${images[@]:0:4}" --prior "$root/docs/examples/datasheet.json" --nearest-m 0.3 -o pairs.csv
  run calibrate --pairs pairs.csv --prior "$root/docs/examples/datasheet.json" -o scene.json
  for kind in office hall corridors home; do run world make --kind "$kind" --seed 5 -o "$kind.world.toml"; done
  "$program" simulate --world workshop --rig nominal --pose 10,7.5,0 --seed 1 --json >view.json
  run map make --world workshop --spacing-m 2 --source clutter=0.2 --source missed=0.1 -o w.map
  run localise w.map --world workshop -n 40 -o answers.csv
  cat >study.toml <<'STUDY'
[study]
trials = 60
[world]
file = "office.world.toml"
[rig]
truth = "nominal"
[calibration]
views = 8
[sources]
clutter = 0.1
missed_alike = 0.1
[sweep]
"sources.calibration" = [0, 1]
STUDY
  run study study.toml -o study
  run export study --trials -o trials.csv
}

number=0
for program in "$1" "$2"; do
  number=$((number + 1))
  mkdir "$work/$number"
  program=$(realpath "$program")
  (cd "$work/$number" && results_of "$program")
  # the columns of times
  python3 - "$work/$number/trials.csv" <<'PYTHON'
import csv, sys
rows = list(csv.reader(open(sys.argv[1])))
kept = [i for i, name in enumerate(rows[0]) if not name.endswith('_ms')]
csv.writer(open(sys.argv[1], 'w')).writerows([row[i] for i in kept] for row in rows)
PYTHON
  rm --recursive "$work/$number/study" "$work/$number/log.txt"
done
differing=0
for file in "$work"/1/*; do
  name=$(basename "$file")
  if cmp --silent "$file" "$work/2/$name"; then
    echo "same    $name"
  else
    echo "DIFFERS $name"
    differing=1
  fi
done
exit "$differing"
