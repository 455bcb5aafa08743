#!/usr/bin/env python3
# SPDX-FileCopyrightText: 2026 The Vernier authors
# SPDX-License-Identifier: Apache-2.0
"""Plots localisation success against calibration error, from a study's JSON:

    vernier study scripts/picture_study.toml -o out/picture --json > success.json
    scripts/plot_success.py success.json docs/images/success_vs_psi_c.svg

Needs only the Python standard library. One curve per query protocol, with 95 % intervals.
"""
import json
import math
import sys

from success_frame import axis_words, opening, percent_grid, text

WIDTH, HEIGHT = 640, 340
LEFT, RIGHT, TOP, BOTTOM = 70, 620, 22, 290  # of the axes
COLOURS = ("#1f77b4", "#d95f02", "#4d9221")
LABELS = {"near_path": "queries within 0.1 m and 5° of the map's path",
          "path": "within 0.3 m and 15°",
          "anywhere": "within 0.6 m, any heading"}


def curves(cells):
    """Protocol -> [(psi_c, success, low, high)] in ascending order of psi_c."""
    found = {}
    for cell in cells:
        low, high = cell["success_interval_95"]
        found.setdefault(cell["protocol"], []).append(
            (cell["settings"]["sources.calibration"], cell["success"], low, high))
    return {protocol: sorted(points) for protocol, points in found.items()}


def draw(found, trials):
    """Returns the plot as SVG."""
    values = sorted({point[0] for points in found.values() for point in points})
    lowest = min(point[2] for points in found.values() for point in points)
    floor = math.floor(10 * lowest) / 10
    span = math.log(values[-1] / values[0]) or 1

    def x_of(psi_c):
        return LEFT + 20 + (RIGHT - LEFT - 40) * math.log(psi_c / values[0]) / span

    def y_of(share):
        return BOTTOM - (BOTTOM - TOP) * (share - floor) / (1 - floor)

    lines = opening(WIDTH, HEIGHT, 13) + percent_grid(floor, LEFT, RIGHT, y_of)
    for value in values:
        lines.append(text(x_of(value), BOTTOM + 18, f"{value:g}"))
    lines.append(text((LEFT + RIGHT) / 2, BOTTOM + 40,
                      "ψ_c: error of the calibration, in its own standard deviations"))
    lines.append(axis_words("localised within 1 m", 18, (TOP + BOTTOM) / 2))
    for row, ((protocol, points), colour) in enumerate(zip(found.items(), COLOURS)):
        shift = 3 * (2 * row - len(found) + 1)  # so that intervals do not overlap
        path = " ".join(f"{x_of(p[0]) + shift:.1f},{y_of(p[1]):.1f}" for p in points)
        lines.append(f'<polyline points="{path}" fill="none" stroke="{colour}" stroke-width="2"/>')
        for psi_c, success, low, high in points:
            x = x_of(psi_c) + shift
            lines.append(f'<line x1="{x:.1f}" y1="{y_of(low):.1f}" x2="{x:.1f}" '
                         f'y2="{y_of(high):.1f}" stroke="{colour}"/>')
            lines.append(f'<circle cx="{x:.1f}" cy="{y_of(success):.1f}" r="3.5" fill="{colour}"/>')
        key_y = BOTTOM - 30 + 18 * row
        lines.append(f'<circle cx="{LEFT + 20}" cy="{key_y - 4}" r="3.5" fill="{colour}"/>')
        lines.append(text(LEFT + 30, key_y, LABELS[protocol], "start"))
    lines.append(text(RIGHT, TOP - 8, f"{trials} trials a point, 95 % intervals", "end"))
    return "\n".join(lines + ["</svg>"]) + "\n"


def main():
    if len(sys.argv) != 3:
        sys.exit(__doc__)
    with open(sys.argv[1], encoding="utf-8") as file:
        cells = json.load(file)["cells"]
    with open(sys.argv[2], "w", encoding="utf-8") as file:
        file.write(draw(curves(cells), cells[0]["trials"]))


if __name__ == "__main__":
    main()
