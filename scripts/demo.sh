#!/usr/bin/env bash
# SPDX-FileCopyrightText: 2026 The Vernier authors
# SPDX-License-Identifier: Apache-2.0
# The complete pipeline on real images: calibrate, sample, simulate a view, run trials, write a report.
# Prints the time of each part and writes it to out/demo/times.txt for scripts/check_demo_cost.sh.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."
out=out/demo
vernier=build/release/vernier
rm --force "$out/times.txt" # from an earlier run
. scripts/part_times.sh
step() { begin_part "run: $*"; }

begin_part "packages" # skipped if already installed
scripts/install_packages.sh --demo

begin_part "build"
# An existing build folder keeps its settings; programs that were missing, such as esbuild, which the
# page needs, are searched again.
if [[ ! -f build/release/build.ninja ]]; then
  # A unity build (several sources per unit) takes a third of the time, and Clang two thirds of GCC's.
  options=(-DVERNIER_BUILD_TESTS=OFF -DVERNIER_BUILD_BENCH=OFF -DCMAKE_UNITY_BUILD=ON)
  if command -v clang++-14 >/dev/null; then options+=(-DCMAKE_CXX_COMPILER=clang++-14); fi
  cmake --preset release "${options[@]}"
else
  cmake build/release
fi
cmake --build --preset release --parallel "$(nproc)" --target vernier_program

data=/usr/share/doc/opencv-doc/examples/data
if [[ ! -f $data/left01.jpg ]]; then data=build/opencv-doc$data; fi
images=(--left "$data/left[0-9]*.jpg" --right "$data/right[0-9]*.jpg"
  --board 9x6 --square-m 0.025)
mkdir --parents "$out"

step "show build settings and optional components"
$vernier doctor
step "calibrate 13 real stereo pairs, one distortion parameter per camera"
$vernier calibrate "${images[@]}" -o "$out/rig.json"
step "calibrate them again, five distortion parameters per camera"
$vernier calibrate "${images[@]}" --model opencv5 -o "$out/rig_opencv5.json"
step "sample 1000 rigs from the first calibration's covariance"
$vernier sample "$out/rig.json" --psi-c 1 -n 1000 --seed 1 -o "$out/samples.csv"
step "calibrate without a board, from matched corners of the scene and a datasheet"
$vernier match "${images[@]:0:4}" --prior docs/examples/datasheet.json --nearest-m 0.3 \
  -o "$out/pairs.csv"
$vernier calibrate --pairs "$out/pairs.csv" --prior docs/examples/datasheet.json \
  -o "$out/rig_scene.json"
step "show the world"
$vernier world info workshop
step "simulate a view of the nominal rig"
$vernier simulate --world workshop --rig nominal --pose 10,7.5,0 --seed 1 --json >"$out/view.json"
step "localisation trials with three levels of calibration error"
rm --recursive --force "$out/study" # otherwise a second demo would not run any trials
$vernier study scripts/demo_study.toml -o "$out/study"
step "the same at psi_c = 1, with queries farther from the recorded path"
rm --recursive --force "$out/path"
$vernier study scripts/path_study.toml -o "$out/path"
step "write the report"
$vernier report "$out/study" --calibration "$out/rig.json" \
  --calibration "$out/rig_opencv5.json" -o "$out/report.html"

end_parts
write_part_times >"$out/times.txt"
echo
print_part_times
echo "done in $((SECONDS / 60)) min $((SECONDS % 60)) s; open $PWD/$out/report.html"
