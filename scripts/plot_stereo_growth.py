#!/usr/bin/env python3
# SPDX-FileCopyrightText: 2026 The Vernier authors
# SPDX-License-Identifier: Apache-2.0
"""Plots the CPU time of stereo matchers against pixels, disparities and edges:

    build/release/bench/stereo_bench --benchmark_filter=grow --benchmark_out=growth.json \\
        --benchmark_out_format=json
    scripts/plot_stereo_growth.py growth.json docs/images/stereo_growth.svg
"""
import json
import re
import sys

import matplotlib

matplotlib.use("svg")
import matplotlib.pyplot as plt

NAMES = {"grow_sgbm": "OpenCV SGBM, three-way", "grow_edge": "edge", "grow_stretch": "stretch"}
PANELS = (("width", "pixels", [20000, 100000, 500000]),
          ("disparities", "disparities searched", [16, 32, 64, 128, 256]),
          ("radius", "edges", [2000, 5000, 10000, 20000]))
BASE = {"width": 450, "disparities": 64, "radius": 6}


def points(runs, name, varied):
    """(abscissa, CPU ms) of the runs in which only `varied` differs from the base."""
    found = []
    for run in runs:
        if run["name"].split("/")[0] != name:
            continue
        at = {key: int(value) for key, value in re.findall(r"(\w+):(\d+)", run["name"])}
        if any(at[key] != BASE[key] for key in BASE if key != varied):
            continue
        x = {"width": at["width"] ** 2 * 5 / 6, "disparities": at["disparities"],
             "radius": run["edges"]}[varied]
        found.append((x, run["cpu_time"]))
    return sorted(found)


def main():
    if len(sys.argv) != 3:
        sys.exit(__doc__)
    with open(sys.argv[1], encoding="utf-8") as file:
        runs = [r for r in json.load(file)["benchmarks"] if r.get("run_type") == "iteration"]
    plt.rcParams.update({"svg.hashsalt": "vernier", "font.size": 9})
    figure, all_axes = plt.subplots(1, 3, figsize=(9, 3.4), layout="constrained", sharey=True)
    for axes, (varied, label, ticks) in zip(all_axes, PANELS):
        for name, words in NAMES.items():
            axes.loglog(*zip(*points(runs, name, varied)), "o-", label=words, markersize=3)
        axes.set_xlabel(label)
        axes.set_xticks(ticks, [f"{tick:,}" for tick in ticks])
        axes.set_xticks([], minor=True)
        axes.grid(True, which="both", linewidth=0.3)
    all_axes[0].set_ylabel("CPU time of a pair, ms")
    all_axes[0].set_yticks([2, 5, 10, 20, 50, 100], ["2", "5", "10", "20", "50", "100"])
    all_axes[0].legend()
    figure.savefig(sys.argv[2], metadata={"Date": None})


if __name__ == "__main__":
    main()
