#!/usr/bin/env python3
# SPDX-FileCopyrightText: 2026 The Vernier authors
# SPDX-License-Identifier: Apache-2.0
"""Plots the CPU time of a calibration against the number of views, from the benchmark's JSON:

    build/release/bench/resolve_bench --benchmark_out=growth.json --benchmark_out_format=json
    scripts/plot_growth.py growth.json docs/images/cost_vs_views.svg
"""
import json
import sys

import matplotlib

matplotlib.use("svg")
import matplotlib.pyplot as plt

NAMES = {
    "opencv_stereo_calibrate": "cv::stereoCalibrate",
    "mrcal": "mrcal",
    "solver_of_record": "Ceres (solver of record)",
    "resolve": "re-solver",
}
CORNERS_PER_VIEW_PAIR = 200


def main():
    if len(sys.argv) != 3:
        sys.exit(__doc__)
    with open(sys.argv[1], encoding="utf-8") as file:
        runs = [r for r in json.load(file)["benchmarks"] if r.get("run_type") == "iteration"]
    times = {name: [] for name in NAMES}
    rates = {}
    linearisations = []
    for run in runs:
        name, _, rest = run["name"].partition("/")
        if name in times and not run.get("error_occurred"):
            times[name].append((int(rest.rpartition(":")[2]), run["cpu_time"]))
        if name == "resolve":
            linearisations.append((int(rest.rpartition(":")[2]), run["linearisations"]))
        if name in ("corner_sums", "fma_peak"):
            rates[name] = run
    plt.rcParams.update({"svg.hashsalt": "vernier", "font.size": 9})
    figure, axes = plt.subplots(figsize=(6.4, 4.2), layout="constrained")
    for name, label in NAMES.items():
        if times[name]:
            axes.loglog(*zip(*sorted(times[name])), "o-", label=label, markersize=3)
    if "corner_sums" in rates and "fma_peak" in rates:
        sums = rates["corner_sums"]
        operations = sums["row_operations"] + sums["sum_operations"]
        floor = [
            (n, 1e3 * k * n * CORNERS_PER_VIEW_PAIR * operations / rates["fma_peak"]["flops"])
            for n, k in sorted(linearisations)
        ]
        axes.loglog(*zip(*floor), "k--", linewidth=0.8, label="its operations at peak")
    axes.set_xlabel("stereo views (100 corners each)")
    axes.set_ylabel("CPU time of a solve, ms")
    axes.grid(True, which="both", linewidth=0.3)
    axes.legend()
    figure.savefig(sys.argv[2], metadata={"Date": None})


if __name__ == "__main__":
    main()
