#!/usr/bin/env bash
# SPDX-FileCopyrightText: 2026 The Vernier authors
# SPDX-License-Identifier: Apache-2.0
#
# Peak memory of solving 1000 stereo views of 100 corners, each solver in its own process.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."
program=${1:-build/release/bench/mrcal_memory}
frames=${2:-1000}
echo "solver frames MiB-before MiB-more-at-peak"
for solver in vernier resolver mrcal; do "$program" "$solver" "$frames"; done
