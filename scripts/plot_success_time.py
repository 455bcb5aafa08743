#!/usr/bin/env python3
# SPDX-FileCopyrightText: 2026 The Vernier authors
# SPDX-License-Identifier: Apache-2.0
"""Plots localisation success against time a query, from the JSON of two studies:

    vernier study scripts/methods_study.toml -o out/methods --json > methods.json
    vernier study scripts/stages_study.toml -o out/stages --json > stages.json
    scripts/plot_success_time.py methods.json stages.json docs/images/success_vs_time.svg

Needs only the Python standard library. A dot a method, joined dots for the stages of `lines`; one
colour a query protocol, 95 % intervals.
"""
import json
import math
import sys

from success_frame import axis_words, opening, percent_grid, text

WIDTH, HEIGHT = 680, 380
LEFT, RIGHT, TOP, BOTTOM = 70, 660, 24, 320  # of the axes
COLOURS = {"near_path": "#1f77b4", "path": "#d95f02"}
STAGES = {"none": "ranking alone", "align": "+ align", "align+refine": "+ refine",
          "align+refine+compare": "+ compare", "align+refine+compare+deepen": "+ deepen"}


def points(files):
    """(protocol, label, is a stage, milliseconds, success, low, high) of every cell."""
    for name in files:
        with open(name, encoding="utf-8") as file:
            cells = json.load(file)["cells"]
        swept = {"localiser.stages" in cell["settings"] for cell in cells}
        for cell in cells:
            settings = cell["settings"]
            stages = settings.get("localiser.stages", "align+refine+compare+deepen")
            is_stage = True in swept
            label = STAGES[stages] if is_stage else settings["localiser.method"]
            low, high = cell["success_interval_95"]
            yield (cell["protocol"], label, is_stage, cell["cpu_ms_mean"], cell["success"], low,
                   high)


def frame(low_ms, high_ms, floor):
    """The axes, and the functions that place a value on them."""
    span = math.log(high_ms / low_ms)

    def x_of(ms):
        return LEFT + (RIGHT - LEFT) * math.log(ms / low_ms) / span

    def y_of(share):
        return BOTTOM - (BOTTOM - TOP) * (share - floor) / (1 - floor)

    lines = opening(WIDTH, HEIGHT, 12) + percent_grid(floor, LEFT, RIGHT, y_of)
    for power in range(math.ceil(math.log10(low_ms)), math.floor(math.log10(high_ms)) + 1):
        lines.append(text(x_of(10**power), BOTTOM + 18, f"{10**power:g}", "middle"))
    lines.append(text((LEFT + RIGHT) / 2, BOTTOM + 40, "CPU time a query, ms (logarithmic)",
                      "middle"))
    lines.append(axis_words("localised within 1 m", 18, (TOP + BOTTOM) / 2))
    return lines, x_of, y_of


def label_texts(labels):
    """Names below their dots; those of dots close to each other one below the other."""
    lines, kept = [], []
    for x, y, label in labels:
        at = y + 16
        while any(abs(x - other_x) < 120 and abs(at - other_at) < 14 for other_x, other_at in kept):
            at += 14
        kept.append((x, at))
        lines.append(text(x + 8, at, label, "start" if x < RIGHT - 120 else "end"))
    return lines


def draw(found):
    """Returns the plot as SVG."""
    labels = []
    floor = math.floor(10 * min(point[5] for point in found)) / 10
    lines, x_of, y_of = frame(min(p[3] for p in found) / 1.6, max(p[3] for p in found) * 2, floor)
    for protocol, colour in COLOURS.items():
        own = [point for point in found if point[0] == protocol]
        path = " ".join(f"{x_of(p[3]):.1f},{y_of(p[4]):.1f}" for p in own if p[2])
        lines.append(f'<polyline points="{path}" fill="none" stroke="{colour}"/>')
        for _, label, is_stage, ms, success, low, high in own:
            x, y = x_of(ms), y_of(success)
            fill = colour if is_stage else "white"
            lines.append(f'<line x1="{x:.1f}" y1="{y_of(low):.1f}" x2="{x:.1f}" '
                         f'y2="{y_of(high):.1f}" stroke="{colour}"/>')
            lines.append(f'<circle cx="{x:.1f}" cy="{y:.1f}" r="4" fill="{fill}" '
                         f'stroke="{colour}"/>')
            if protocol == "path":
                labels.append((x, y, label))
    lines += label_texts(labels)
    for row, (protocol, colour) in enumerate(COLOURS.items()):
        y = BOTTOM - 34 + 18 * row
        lines.append(f'<circle cx="{LEFT + 20}" cy="{y - 4}" r="4" fill="{colour}"/>')
        lines.append(text(LEFT + 30, y, protocol, "start"))
    return "\n".join(lines + ["</svg>"]) + "\n"


def main():
    if len(sys.argv) != 4:
        sys.exit(__doc__)
    with open(sys.argv[3], "w", encoding="utf-8") as file:
        file.write(draw(list(points(sys.argv[1:3]))))


if __name__ == "__main__":
    main()
