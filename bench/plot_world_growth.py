#!/usr/bin/env python3
# SPDX-FileCopyrightText: 2026 The Vernier authors
# SPDX-License-Identifier: Apache-2.0
"""Plots how sensing and loading grow with the world, from the table of bench/world_growth:

    build/release/bench/world_growth > growth.csv
    bench/plot_world_growth.py growth.csv docs/images/world_growth.svg

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
LEAST, MOST = 1e3, 1e6


def place(value, low, high, from_px, to_px):
    return from_px + (to_px - from_px) * math.log(value / low) / math.log(high / low)


def panel(lines, sides, name, low, high, curves):
    left, right = sides
    for power in range(round(math.log10(low)), round(math.log10(high)) + 1):
        y = place(10.0**power, low, high, BOTTOM, TOP)
        lines.append(f'<line x1="{left}" y1="{y:.1f}" x2="{right}" y2="{y:.1f}" stroke="#ddd"/>')
        lines.append(text(left - 8, y + 4, f"{10.0**power:g}", "end"))
    for power in (3, 4, 5, 6):
        lines.append(text(place(10.0**power, LEAST, MOST, left, right), BOTTOM + 18,
                          f"{10**power:,}"))
    lines.append(text((left + right) / 2, BOTTOM + 40, "segments of the world"))
    lines.append(axis_words(name, left - 50, (TOP + BOTTOM) / 2))
    for (label, colour, points), row in zip(curves, range(len(curves))):
        drawn = [(place(x, LEAST, MOST, left, right), place(y, low, high, BOTTOM, TOP))
                 for x, y in points]
        path = " ".join(f"{x:.1f},{y:.1f}" for x, y in drawn)
        lines.append(f'<polyline points="{path}" fill="none" stroke="{colour}" '
                     'stroke-width="1.5"/>')
        for x, y in drawn:
            lines.append(f'<circle cx="{x:.1f}" cy="{y:.1f}" r="3" fill="{colour}"/>')
        lines.append(f'<g fill="{colour}">{text(left + 8, TOP + 14 + 16 * row, label, "start")}</g>')


def curve(table, key):
    return [(float(row["segments"]), float(row[key])) for row in table
            if not math.isnan(float(row[key]))]


def main(source, figure):
    with open(source, encoding="utf-8", newline="") as file:
        table = list(csv.DictReader(file))
    lines = opening(WIDTH, HEIGHT, 12)
    panel(lines, PANELS[0], "CPU ms", 0.01, 10,
          [("a frame: both eyes, all sources", "#1f77b4", curve(table, "frame_ms"))])
    panel(lines, PANELS[1], "CPU s", 1e-3, 10,
          [("reading, with templates", "#1f77b4", curve(table, "load_s")),
           ("reading, every feature written out", "#d95f02", curve(table, "load_flat_s")),
           ("preparing visibility", "#2a7f3f", curve(table, "prepare_s"))])
    lines.append("</svg>")
    pathlib.Path(figure).write_text("\n".join(lines) + "\n", encoding="utf-8")


if __name__ == "__main__":
    if len(sys.argv) != 3:
        sys.exit(__doc__)
    main(*sys.argv[1:])
