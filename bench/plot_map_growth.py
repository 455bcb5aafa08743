#!/usr/bin/env python3
# SPDX-FileCopyrightText: 2026 The Vernier authors
# SPDX-License-Identifier: Apache-2.0
"""Plots how the time of a query and the memory of a node grow with the map, from two tables of
bench/map_growth:

    build/release/bench/map_growth nodes 8 > all_around.csv
    build/release/bench/map_growth nodes 0 > along_the_route.csv
    bench/plot_map_growth.py all_around.csv along_the_route.csv docs/images/map_growth.svg

Needs only the Python standard library.
"""
import csv
import math
import pathlib
import sys

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1] / "scripts"))
from success_frame import axis_words, opening, text  # noqa: E402

WIDTH, HEIGHT, TOP, BOTTOM = 760, 340, 40, 280
PANELS = ((70, 360), (440, 725))
MAPS = (("eight headings a place", "#1f77b4"), ("along the route", "#d95f02"))


def axis(low, high, from_px, to_px):
    """A logarithmic axis: the pixel of a value, and the powers of ten on it."""
    def at(value):
        return from_px + (to_px - from_px) * math.log(value / low) / math.log(high / low)
    ticks = range(math.ceil(math.log10(low) - 1e-9), math.floor(math.log10(high) + 1e-9) + 1)
    return at, [10.0**k for k in ticks]


def panel(lines, sides, name, low, high, curves):
    left, right = sides
    x_of, x_ticks = axis(100, 100000, left, right)
    y_of, y_ticks = axis(low, high, BOTTOM, TOP)
    for value in y_ticks:
        lines.append(f'<line x1="{left}" y1="{y_of(value):.1f}" x2="{right}" '
                     f'y2="{y_of(value):.1f}" stroke="#ddd"/>')
        lines.append(text(left - 8, y_of(value) + 4, f"{value:g}", "end"))
    for value in x_ticks:
        lines.append(text(x_of(value), BOTTOM + 18, f"{value:,.0f}"))
    lines.append(text((left + right) / 2, BOTTOM + 40, "nodes of the map"))
    lines.append(axis_words(name, left - 50, (TOP + BOTTOM) / 2))
    for colour, dashes, points in curves:
        path = " ".join(f"{x_of(x):.1f},{y_of(y):.1f}" for x, y in points)
        lines.append(f'<polyline points="{path}" fill="none" stroke="{colour}" stroke-width="1.5"'
                     f'{dashes}/>')
        for x, y in points:
            lines.append(f'<circle cx="{x_of(x):.1f}" cy="{y_of(y):.1f}" r="3" fill="{colour}"/>')


def draw(tables):
    lines = opening(WIDTH, HEIGHT, 12)
    dashed = ' stroke-dasharray="5 4"'

    def curves(solid, broken):
        for (_, colour), table in zip(MAPS, tables):
            for key, dashes in ((solid, ""), (broken, dashed)):
                yield colour, dashes, [(int(row["nodes"]), float(row[key])) for row in table]

    panel(lines, PANELS[0], "CPU time a query, ms", 5, 1000,
          list(curves("query_ms_mean", "query_ms_p95")))
    panel(lines, PANELS[1], "kB a node", 1, 100, list(curves("index_kb_node", "map_kb_node")))
    for (name, colour), x in zip(MAPS, (80, 240)):
        lines.append(f'<circle cx="{x}" cy="16" r="4" fill="{colour}"/>')
        lines.append(text(x + 10, 20, name, "start"))
    lines.append(text(WIDTH - 20, 20, "left: mean, dashed 95th percentile; "
                                      "right: index, dashed map", "end"))
    return "\n".join(lines + ["</svg>"]) + "\n"


def main():
    if len(sys.argv) != 4:
        sys.exit(__doc__)
    tables = []
    for name in sys.argv[1:3]:
        with open(name, encoding="utf-8", newline="") as file:
            tables.append(list(csv.DictReader(file)))
    pathlib.Path(sys.argv[3]).write_text(draw(tables), encoding="utf-8")


if __name__ == "__main__":
    main()
