#!/usr/bin/env python3
# SPDX-FileCopyrightText: 2026 The Vernier authors
# SPDX-License-Identifier: Apache-2.0
"""How far visual servoing ends from its goal, against the errors of calibration and of edges.

    servoing.py run PROGRAM FOLDER [--seeds 201-220] [--trials 10] [--threads 2]
    servoing.py table FOLDER
    servoing.py plot FOLDER FILE.svg

`run` makes the worlds (`vernier world make --seed S`) and lets `vernier servo` drive in each, for every
cell; a cell of a world that is there already is left out. Starts and doors are the same in all cells.
Intervals at 95 % resample whole worlds (percentiles of 4,000 bootstrap samples).
"""
import argparse
import csv
import math
import pathlib
import random
import subprocess

CALIBRATION = (0, 0.1, 0.3, 1, 3, 10)
SHIFT = (0, 1, 3, 6)


def cells():
    """(goal, psi_c, psi_l), the most telling ones first."""
    grid = [(c, l) for l in SHIFT for c in CALIBRATION]
    cross = [(c, l) for c, l in grid if l == 3 or c == 1]
    ends = [(c, l) for c, l in cross if c in (0, 10) or l in (0, 6) or (c, l) == (1, 3)]
    ordered = [('model', c, l) for c, l in cross] + [('taught', c, l) for c, l in ends]
    ordered += [('recorded', c, l) for c, l in grid if c == 1]
    every = [(goal, c, l) for goal in ('model', 'taught') for c, l in grid]
    return ordered + [cell for cell in every if cell not in ordered]


def file_of(folder, cell, seed):
    return folder / f'{cell[0]}_{cell[1]}_{cell[2]}_{seed}.csv'


def run(options):
    folder = pathlib.Path(options.folder)
    folder.mkdir(parents=True, exist_ok=True)
    first, last = map(int, options.seeds.split('-'))
    for seed in range(first, last + 1):
        if not (folder / f'{seed}.world.toml').exists():
            subprocess.run([options.program, 'world', 'make', '--seed', str(seed), '-q', '-o',
                            folder / f'{seed}.world.toml'], check=True, stdout=subprocess.DEVNULL)
    for cell in cells():
        goal, calibration, shift = cell
        for seed in range(first, last + 1):
            if file_of(folder, cell, seed).exists():
                continue
            subprocess.run(
                [options.program, 'servo', '--world', folder / f'{seed}.world.toml', '--seed', str(seed),
                 '--goal', goal, '--source', f'calibration={calibration}', '--source',
                 f'lateral_shift_px={shift}', '--trials', str(options.trials), '--threads',
                 str(options.threads), '-q', '-o', file_of(folder, cell, seed)],
                check=True, stdout=subprocess.DEVNULL)


def quantile(values, p):
    values = sorted(values)
    at = p * (len(values) - 1)
    low = int(at)
    return values[low] + (at - low) * (values[min(low + 1, len(values) - 1)] - values[low])


def share(trials):
    return sum(t['status'] == 'converged' for t in trials) / len(trials)


def median(name, scale):
    def statistic(trials):
        values = [scale * abs(float(t[name])) for t in trials if t['status'] == 'converged']
        return quantile(values, 0.5) if values else math.nan
    return statistic


STATISTICS = {'converged': share, 'position_mm': median('position_error_m', 1000),
              'heading_deg': median('heading_error_deg', 1)}


def with_interval(worlds, statistic):
    chance = random.Random(1)
    drawn = []
    for _ in range(4000):
        some = [t for _ in worlds for t in worlds[chance.randrange(len(worlds))]]
        drawn.append(statistic(some))
    drawn = [x for x in drawn if not math.isnan(x)]
    value = statistic([t for world in worlds for t in world])
    return value, quantile(drawn, 0.025), quantile(drawn, 0.975)


def results(folder):
    found = {}
    for cell in cells():
        files = sorted(folder.glob(f'{cell[0]}_{cell[1]}_{cell[2]}_*.csv'))
        worlds = [list(csv.DictReader(open(file, encoding='utf-8'))) for file in files]
        if worlds:
            found[cell] = dict({name: with_interval(worlds, s) for name, s in STATISTICS.items()},
                               trials=sum(map(len, worlds)), worlds=len(worlds))
    return found


def table(options):
    print('| goal | ψ_c | ψ_l | trials | converged, % | position, mm | heading, deg |\n'
          '| --- | --- | --- | --- | --- | --- | --- |')
    found = results(pathlib.Path(options.folder))
    for cell in sorted(found, key=lambda c: (c[0], c[2], c[1])):
        r = found[cell]
        number = lambda name, scale, form: '{0:{3}} ({1:{3}} to {2:{3}})'.format(
            *(scale * x for x in r[name]), form)
        print(f'| {cell[0]} | {cell[1]} | {cell[2]} | {r["trials"]} | {number("converged", 100, ".1f")} | '
              f'{number("position_mm", 1, ".1f")} | {number("heading_deg", 1, ".2f")} |')


COLOURS = {0: '#1b6ca8', 1: '#2a9d5c', 3: '#e08a00', 6: '#c22a2a'}


def plot(options):
    """Median position error against psi_c, a line for each psi_l; the model left, taught right."""
    found = results(pathlib.Path(options.folder))
    left, top, width, height, gap = 70, 40, 330, 300, 60
    low, high = 1, 1000
    x = lambda i: left + 20 + i * (width - 40) / (len(CALIBRATION) - 1)
    y = lambda mm: top + height * (1 - math.log(max(mm, low) / low) / math.log(high / low))
    svg = [f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {left + 2 * width + gap + 110} '
           f'{top + height + 60}" font-family="sans-serif" font-size="13">',
           '<rect width="100%" height="100%" fill="#fff"/>',
           f'<text x="18" y="{top + height / 2}" text-anchor="middle" transform="rotate(-90 18 '
           f'{top + height / 2})">distance from the goal, mm (median)</text>']
    for panel, goal in enumerate(('model', 'taught')):
        off = panel * (width + gap)
        svg.append(f'<g transform="translate({off} 0)"><text x="{left + width / 2}" y="24" '
                   f'text-anchor="middle">desired view: {goal}</text><rect x="{left}" y="{top}" '
                   f'width="{width}" height="{height}" fill="none" stroke="#999"/>')
        for mm in (1, 10, 100, 1000):
            svg.append(f'<path d="M{left} {y(mm):.1f}h{width}" stroke="#ddd"/><text x="{left - 6}" '
                       f'y="{y(mm) + 4:.1f}" text-anchor="end">{mm}</text>')
        for i, c in enumerate(CALIBRATION):
            svg.append(f'<text x="{x(i):.1f}" y="{top + height + 18}" text-anchor="middle">{c}</text>')
        svg.append(f'<text x="{left + width / 2}" y="{top + height + 40}" text-anchor="middle">ψ_c</text>')
        for shift in SHIFT:
            points = []
            for i, c in enumerate(CALIBRATION):
                if (goal, c, shift) not in found:
                    continue
                value, bottom, ceiling = found[goal, c, shift]['position_mm']
                at = x(i) + 4 * (SHIFT.index(shift) - 1.5)
                points.append(f'{at:.1f} {y(value):.1f}')
                svg.append(f'<path d="M{at:.1f} {y(bottom):.1f}V{y(ceiling):.1f}" '
                           f'stroke="{COLOURS[shift]}" stroke-width="1.5"/><circle cx="{at:.1f}" '
                           f'cy="{y(value):.1f}" r="3" fill="{COLOURS[shift]}"/>')
            if len(points) > 1:
                svg.append(f'<path d="M{"L".join(points)}" fill="none" stroke="{COLOURS[shift]}"/>')
        svg.append('</g>')
    for i, shift in enumerate(SHIFT):
        svg.append(f'<text x="{left + 2 * width + gap + 12}" y="{top + 14 + 20 * i}" '
                   f'fill="{COLOURS[shift]}">ψ_l = {shift} px</text>')
    pathlib.Path(options.file).write_text('\n'.join(svg + ['</svg>', '']), encoding='utf-8')


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    verbs = parser.add_subparsers(required=True)
    running = verbs.add_parser('run')
    running.add_argument('program')
    running.add_argument('folder')
    running.add_argument('--seeds', default='201-220')
    running.add_argument('--trials', type=int, default=10)
    running.add_argument('--threads', type=int, default=2)
    running.set_defaults(action=run)
    for name, action in (('table', table), ('plot', plot)):
        verb = verbs.add_parser(name)
        verb.add_argument('folder')
        if name == 'plot':
            verb.add_argument('file')
        verb.set_defaults(action=action)
    options = parser.parse_args()
    options.action(options)


if __name__ == '__main__':
    main()
