# SPDX-FileCopyrightText: 2026 The Vernier authors
# SPDX-License-Identifier: Apache-2.0
"""What the plots of localisation success share: SVG text, and a frame with a grid in per cent."""
from xml.sax.saxutils import escape


def text(x, y, words, anchor="middle", more=""):
    return f'<text x="{x:.1f}" y="{y:.1f}" text-anchor="{anchor}"{more}>{escape(words)}</text>'


def opening(width, height, font_px):
    """The first elements of a picture: itself and a white ground."""
    return [f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {width} {height}" '
            f'width="{width}" height="{height}" font-family="sans-serif" font-size="{font_px}">',
            f'<rect width="{width}" height="{height}" fill="white"/>']


def percent_grid(floor, left, right, y_of):
    """Lines from `floor` to 100 % in steps of ten, with their labels."""
    lines = []
    for tick in range(round(10 * floor), 11):
        y = y_of(tick / 10)
        lines.append(f'<line x1="{left}" y1="{y:.1f}" x2="{right}" y2="{y:.1f}" stroke="#ddd"/>')
        lines.append(text(left - 8, y + 4, f"{10 * tick} %", "end"))
    return lines


def axis_words(words, x, y):
    """The name of the vertical axis."""
    return text(x, y, words, more=f' transform="rotate(-90 {x} {y})"')
