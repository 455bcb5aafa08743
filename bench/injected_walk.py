#!/usr/bin/env python3
# SPDX-FileCopyrightText: 2026 The Vernier authors
# SPDX-License-Identifier: Apache-2.0
"""A wrong camera told to the queries of a walk: what it does to localisation, real and simulated.

    injected_walk.py PROGRAM WALK [--simulated] [--sources FILE] [--draws 6] [--psi-c 1,3,10,30]

The map has the right camera. Queries are told a depth unit, or a focal length, that is wrong by
1 + 0.01 psi_c z, z a standard normal deviate, the same at each psi_c. *Real*: `vernier lines` finds
the lines of the images again with the wrong camera. *Model*: the right real lines, moved as the
simulator's estimator would move them (points along their rays, or across them). With --simulated a
third column is made wholly without the images of the queries: views of the same poses in the world
built from the walk (walk_trial.py), by the sources of a file as `characterise` writes it or by the
defaults, moved in the same way: the prediction. `localise` refuses queries whose focal length differs
by more than 5 % from that of the map; so that it can be asked, their views name the map's camera.
Intervals are by a bootstrap over blocks of 2 m of the walk; the slope is that of the share within
1 m on log10 psi_c, without the right camera.
"""
import argparse
import csv
import json
import math
import pathlib
import random
import tempfile

from walk_trial import BLOCK_M, Walk, interval, is_exact, is_near, mean, median, share, sources_in

SIGMA = 0.01
LEAST_SCALE = 0.1


def level_rotations(walk):
    """R_level_camera of every image, from poses of a world with y up, as `lines --up y` has it."""
    rotations = []
    with open(walk / 'poses.csv', newline='') as text:
        for row in list(csv.reader(text))[1:]:
            m = [float(x) for x in row[1:17]]
            world = [m[0:3], m[4:7], m[8:11]]
            floor = [world[2], world[0], world[1]]  # z, x, y of the world: y up becomes z up
            heading = math.atan2(floor[1][2], floor[0][2])
            c, s = math.cos(heading), math.sin(heading)
            level = [[s, -c, 0], [0, 0, -1], [c, s, 0]]
            rotations.append([[sum(level[i][k] * floor[k][j] for k in range(3)) for j in range(3)]
                              for i in range(3)])
    return rotations


def times(R, p):
    return [sum(R[i][k] * p[k] for k in range(3)) for i in range(3)]


def transposed(R):
    return [list(row) for row in zip(*R)]


class Moved:
    """What the estimator makes of a camera-frame point when depth or focal length are told wrong."""

    def __init__(self, kind, scale, R):
        self.factors = [scale] * 3 if kind == 'depth' else [1 / scale, 1 / scale, 1]
        self.R, self.back = R, transposed(R)

    def in_level(self, p):
        camera = times(self.back, p)
        return times(self.R, [f * x for f, x in zip(self.factors, camera)])


def moved_view(line, kind, scale, R):
    """A line of the file of views, as told wrong."""
    view = json.loads(line)
    move = Moved(kind, scale, R)
    look = view['looks'][0]
    height = look['mount']['height_m']
    for s in look['lines']:
        for end in ('a_m', 'b_m'):
            x, y, z = s[end]  # robot: x forward, y left, z up; level camera: x right, y down
            right, down, ahead = move.in_level([-y, height - z, x])
            s[end] = [ahead, -right, height - down]
        s['sigma_m'] *= scale if kind == 'depth' else 1
    if kind == 'focal':
        move_pixels(look, move, scale)
    return json.dumps(view)


def move_pixels(look, move, scale):
    camera = look['cameras'][0]['parameters']
    told = camera['f_px'] * scale

    def moved(u, v):
        p = move.in_level([(u - camera['ox_px']) / (camera['f_px'] * camera['ax']),
                           (v - camera['oy_px']) / camera['f_px'], 1])
        if p[2] <= 0:
            return [u, v]
        return [camera['ox_px'] + told * camera['ax'] * p[0] / p[2],
                camera['oy_px'] + told * p[1] / p[2]]

    for key in ('image_lines_px', 'monocular_lines_px'):
        look[key] = [moved(*s[:2]) + moved(*s[2:]) for s in look.get(key, [])]


def lines_told(walk, kind, scale):
    """Views found again with a wrong depth unit or focal length, under the right camera's name."""
    unit, rig = 0.001, walk.walk / 'K.txt'
    if kind == 'depth':
        unit *= scale
    else:
        K = [float(x) for x in rig.read_text().replace(',', ' ').split()]
        K[0], K[4] = K[0] * scale, K[4] * scale
        rig = walk.folder / 'K_told.txt'
        rig.write_text('\n'.join(' '.join(map(repr, K[i:i + 3])) for i in (0, 3, 6)) + '\n')
    walk.run('lines', *walk.images(), '--rig', rig, *walk.poses_at, '--depth-unit-m', unit, '-o',
             'told.jsonl')
    told = []
    for right, line in zip(walk.views, (walk.folder / 'told.jsonl').read_text().splitlines()):
        view = json.loads(line)
        view['looks'][0]['cameras'] = json.loads(right)['looks'][0]['cameras']
        told.append(json.dumps(view))
    return told


class Trial:
    """A map by the right camera, and its queries told wrong."""

    def __init__(self, walk, spacing_m, method):
        self.walk, self.method = walk, method
        self.nodes = walk.nodes(spacing_m)
        self.queries = walk.queries(self.nodes, 'both')
        self.blocks = [int(walk.way[i] / BLOCK_M) for i in self.queries]
        self.rotations = level_rotations(walk.walk)

    def answers(self, right, told):
        views = list(right)
        for i in self.queries:
            views[i] = told[i]
        return self.walk.answers(views, self.nodes, self.queries, self.method)

    def moved(self, views, kind, scale):
        return {i: moved_view(views[i], kind, scale, self.rotations[i]) for i in self.queries}


class Figures:
    """Answers of all draws at one psi_c, by query."""

    def __init__(self, draws):
        self.by_query = list(zip(*draws))

    def score(self, is_hit):
        return [mean([is_hit(a) for a in answers]) for answers in self.by_query]

    def cell(self, blocks):
        return (f'{share(self.score(is_near), blocks)}; {share(self.score(is_exact), blocks)}; '
                f'{error_of(self.by_query):.3f} m')


def error_of(queries):
    return median([a['off_m'] for answers in queries for a in answers])


def ratio(real, predicted, blocks):
    def of(rows):
        below = error_of([p for _, p in rows])
        return error_of([r for r, _ in rows]) / below if below > 0 else math.nan

    rows = list(zip(real.by_query, predicted.by_query))
    low, high = interval(rows, blocks, of)
    return f'{of(rows):.2f} [{low:.2f}, {high:.2f}]'


def slope(levels, blocks):
    """Of the share within 1 m on log10 psi_c, least squares, and its interval."""
    psi = [math.log10(p) for p in levels]
    middle = mean(psi)

    def of(rows):
        return (sum((p - middle) * mean([row[k] for row in rows]) for k, p in enumerate(psi)) /
                sum((p - middle) ** 2 for p in psi))

    rows = list(zip(*(figures.score(is_near) for figures in levels.values())))
    low, high = interval(rows, blocks, of)
    return f'{of(rows):.2f} [{low:.2f}, {high:.2f}]'


def scales(options, kind, psi_c):
    chance = random.Random(f'{kind} {options.seed}')
    drawn = [1 + SIGMA * psi_c * chance.gauss(0, 1) for _ in range(options.draws)]
    return [s for s in drawn if s >= LEAST_SCALE] if psi_c else [1]


def run(options, folder):
    walk = Walk(options.program, options.walk, folder, options.height_m)
    simulated = None
    if options.simulated:
        walk.build()
        simulated = walk.simulated(0, sources_in(options.sources) if options.sources else [])
    trial = Trial(walk, options.spacing_m, options.method)
    names = ['real', 'model'] + (['simulated'] if simulated else [])
    print(f'{len(trial.queries)} queries, {len(trial.nodes)} nodes, method {options.method}; '
          f'{options.draws} draws\n')
    print('| told wrong | psi_c | ' + ' | '.join(f'{n}: within 1 m; 0.25 m, 5 deg; median' for n in names)
          + ' | ' + ' | '.join(f'median error, real / {n}' for n in names[1:]) + ' |')
    print('| --- ' * (2 * len(names) + 1) + '|')
    for kind in options.of.split(','):
        levels = {name: {} for name in names}
        for psi_c in [0] + [float(p) for p in options.psi_c.split(',')]:
            draws = {name: [] for name in names}
            for scale in scales(options, kind, psi_c):
                draws['real'].append(trial.answers(walk.views, lines_told(walk, kind, scale)))
                draws['model'].append(
                    trial.answers(walk.views, trial.moved(walk.views, kind, scale)))
                if simulated:
                    draws['simulated'].append(
                        trial.answers(simulated, trial.moved(simulated, kind, scale)))
            figures = {name: Figures(draws[name]) for name in names}
            if psi_c:
                for name in names:
                    levels[name][psi_c] = figures[name]
            cells = [f.cell(trial.blocks) for f in figures.values()]
            cells += [ratio(figures['real'], figures[n], trial.blocks) for n in names[1:]]
            print(f'| {kind} | {psi_c:g} | ' + ' | '.join(cells) + ' |', flush=True)
        print(f'\nslope of success, {kind}: ' +
              '; '.join(f'{name} {slope(levels[name], trial.blocks)}' for name in names) + '\n',
              flush=True)


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument('program', type=lambda name: pathlib.Path(name).resolve())
    parser.add_argument('walk', type=lambda name: pathlib.Path(name).resolve())
    parser.add_argument('--simulated', action='store_true')
    parser.add_argument('--sources', type=pathlib.Path)
    parser.add_argument('--method', default='pgh')
    parser.add_argument('--of', default='depth,focal')
    parser.add_argument('--psi-c', default='1,3,10,30')
    parser.add_argument('--draws', type=int, default=6)
    parser.add_argument('--seed', type=int, default=1)
    parser.add_argument('--spacing-m', type=float, default=1)
    parser.add_argument('--height-m', type=float, default=1.6)
    options = parser.parse_args()
    with tempfile.TemporaryDirectory() as folder:
        run(options, pathlib.Path(folder))


if __name__ == '__main__':
    main()
