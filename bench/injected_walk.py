#!/usr/bin/env python3
# SPDX-FileCopyrightText: 2026 The Vernier authors
# SPDX-License-Identifier: Apache-2.0
"""A wrong camera told to the queries of a walk: what it does to localisation, real and simulated.

    injected_walk.py PROGRAM WALK [--simulated VIEWS.jsonl] [--draws 6] [--psi-c 1,3,10,30]

The map has the right camera. Queries are told a depth unit, or a focal length, that is wrong by
1 + 0.01 psi_c z, z a standard normal deviate, the same at each psi_c. *Real*: `vernier lines` finds
the lines of the images again with the wrong camera. *Model*: the right lines, moved as the
simulator's estimator would move them (points along their rays, or across them). Of --simulated,
views of the same poses that a simulator made (as `lines` writes them, in the order of the images),
both the map and the moved queries are made from these: the prediction. Intervals are by a bootstrap
over blocks of 2 m of the walk; the slope is that of the share within 1 m on log10 psi_c.
"""
import argparse
import csv
import json
import math
import pathlib
import random
import tempfile

from walk_trial import BLOCK_M, DRAWS, Trial, interval, median, turn_deg

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
    camera['f_px'] = told


class Walk(Trial):
    """Views of one walk, real or simulated, and answers to queries told wrong."""

    def __init__(self, program, walk, folder, height_m, views=None):
        self.walk, self.height_m = walk, height_m
        if views is None:
            super().__init__(program, walk, folder, height_m)
        else:
            self.program, self.folder, self.views = program, folder, views
            self.poses = [json.loads(view)['pose'] for view in views]
            self.way = along_of(self.poses)

    def lines_told(self, kind, scale):
        """Views found again with a wrong depth unit or focal length."""
        unit, rig = 0.001, self.walk / 'K.txt'
        if kind == 'depth':
            unit *= scale
        else:
            K = [float(x) for x in rig.read_text().replace(',', ' ').split()]
            K[0], K[4] = K[0] * scale, K[4] * scale
            rig = self.folder / 'K_told.txt'
            rig.write_text('\n'.join(' '.join(map(repr, K[i:i + 3])) for i in (0, 3, 6)) + '\n')
        self.run('lines', '--image', f'{self.walk}/images/*.png', '--depth', f'{self.walk}/depth/*.png',
                 '--rig', rig, '--poses', self.walk / 'poses.csv', '--up', 'y', '--height-m',
                 self.height_m, '--depth-unit-m', unit, '-o', 'told.jsonl')
        return (self.folder / 'told.jsonl').read_text().splitlines()

    def make_map(self, nodes):
        (self.folder / 'nodes.jsonl').write_text(''.join(self.views[i] + '\n' for i in nodes))
        self.run('map', 'make', '--features', 'nodes.jsonl', '-o', 'walk.map')

    def errors(self, queries, views, method):
        """Metres and degrees of each query; infinite where there is no answer."""
        (self.folder / 'queries.jsonl').write_text(''.join(views[i] + '\n' for i in queries))
        self.run('localise', 'walk.map', '--features', 'queries.jsonl', '--method', method, '-o',
                 'answers.csv')
        errors = []
        with open(self.folder / 'answers.csv', newline='') as text:
            for i, answer in zip(queries, csv.DictReader(text)):
                x, y, heading = self.poses[i]
                if answer['status'] != 'answered':
                    errors.append((math.inf, math.inf))
                    continue
                errors.append((math.hypot(float(answer['x_m']) - x, float(answer['y_m']) - y),
                               turn_deg(math.radians(float(answer['heading_deg'])), heading)))
        return errors


def along_of(poses):
    way = [0.0]
    for a, b in zip(poses, poses[1:]):
        way.append(way[-1] + math.hypot(b[0] - a[0], b[1] - a[1]))
    return way


class Figures:
    """Errors of all draws at one psi_c: lists by query."""

    def __init__(self, draws, blocks):
        self.draws, self.blocks = draws, blocks

    def by_query(self, score):
        return [sum(score(d[q]) for d in self.draws) / len(self.draws)
                for q in range(len(self.blocks))]

    def near(self):
        return self.by_query(lambda e: e[0] <= 1)

    def exact(self):
        return self.by_query(lambda e: e[0] <= 0.25 and e[1] <= 5)

    def median(self):
        return median([e[0] for d in self.draws for e in d])


def resampled(blocks, statistic, seed=1):
    """95 % of a statistic of chosen queries, by resampling blocks."""
    groups = {}
    for q, block in enumerate(blocks):
        groups.setdefault(block, []).append(q)
    groups = list(groups.values())
    chance = random.Random(seed)
    values = sorted(statistic([q for _ in groups for q in chance.choice(groups)])
                    for _ in range(DRAWS // 4))
    return values[int(0.025 * len(values))], values[int(0.975 * len(values)) - 1]


def median_of(figures, queries):
    return median([d[q][0] for d in figures.draws for q in queries])


def ratio(real, predicted, blocks):
    every = list(range(len(blocks)))

    def of(chosen):
        below = median_of(predicted, chosen)
        return median_of(real, chosen) / below if below > 0 else math.inf

    low, high = resampled(blocks, of)
    return f'{of(every):.2f} ({low:.2f} to {high:.2f})'


def slope(levels, blocks):
    """Of the share within 1 m on log10 psi_c, least squares, and its interval."""
    psi = [math.log10(p) for p in levels]
    shares = [figures.near() for figures in levels.values()]
    mean = sum(psi) / len(psi)

    def of(chosen):
        y = [sum(s[q] for q in chosen) / len(chosen) for s in shares]
        return (sum((p - mean) * v for p, v in zip(psi, y)) / sum((p - mean) ** 2 for p in psi))

    low, high = resampled(blocks, of)
    return f'{of(list(range(len(blocks)))):.2f} ({low:.2f} to {high:.2f})'


def percent(values, blocks):
    low, high = interval(values, blocks)
    return f'{100 * sum(values) / len(values):.0f} % [{100 * low:.0f}, {100 * high:.0f}]'


def run(options, folder):
    walk = Walk(options.program, options.walk, folder / 'real', options.height_m)
    simulated = None
    if options.simulated:
        views = options.simulated.read_text().splitlines()
        if len(views) != len(walk.views):
            raise SystemExit(f'{options.simulated}: has {len(views)} views of {len(walk.views)} images')
        simulated = Walk(options.program, options.walk, folder / 'simulated', options.height_m, views)
    rotations = level_rotations(options.walk)
    nodes = walk.nodes(options.spacing_m)
    queries = [i for i in range(len(walk.views)) if i not in nodes]
    blocks = [int(walk.way[i] / BLOCK_M) for i in queries]
    walk.make_map(nodes)
    if simulated:
        simulated.make_map(nodes)

    def moved(views, kind, scale):
        return {i: moved_view(views[i], kind, scale, rotations[i]) for i in queries}

    names = ['real', 'model'] + (['simulated'] if simulated else [])
    print(f'{len(queries)} queries, {len(nodes)} nodes, method {options.method}; {options.draws} draws\n')
    print('| told wrong | psi_c | ' + ' | '.join(f'{n}: within 1 m; 0.25 m, 5 deg; median' for n in names)
          + ' | median error, real / ' + names[-1] + ' |')
    print('| --- ' * (len(names) + 3) + '|')
    for kind in options.of.split(','):
        levels = {name: {} for name in names}
        for psi_c in [0] + [float(p) for p in options.psi_c.split(',')]:
            chance = random.Random(f'{kind} {options.seed}')
            draws = {name: [] for name in names}
            for _ in range(options.draws if psi_c else 1):
                scale = 1 + SIGMA * psi_c * chance.gauss(0, 1)
                if scale < LEAST_SCALE:
                    continue
                told = walk.lines_told(kind, scale)
                draws['real'].append(walk.errors(queries, told, options.method))
                draws['model'].append(
                    walk.errors(queries, moved(walk.views, kind, scale), options.method))
                if simulated:
                    draws['simulated'].append(simulated.errors(
                        queries, moved(simulated.views, kind, scale), options.method))
            figures = {name: Figures(draws[name], blocks) for name in names}
            if psi_c:
                for name in names:
                    levels[name][psi_c] = figures[name]
            cells = [f'{percent(f.near(), blocks)}; {percent(f.exact(), blocks)}; {f.median():.3f} m'
                     for f in figures.values()]
            print(f'| {kind} | {psi_c:g} | ' + ' | '.join(cells) + ' | ' +
                  ratio(figures['real'], figures[names[-1]], blocks) + ' |', flush=True)
        print(f'\nslope of success, {kind}: ' +
              '; '.join(f'{name} {slope(levels[name], blocks)}' for name in names) + '\n', flush=True)


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument('program', type=lambda name: pathlib.Path(name).resolve())
    parser.add_argument('walk', type=lambda name: pathlib.Path(name).resolve())
    parser.add_argument('--simulated', type=pathlib.Path)
    parser.add_argument('--method', default='pgh')
    parser.add_argument('--of', default='depth,focal')
    parser.add_argument('--psi-c', default='1,3,10,30')
    parser.add_argument('--draws', type=int, default=6)
    parser.add_argument('--seed', type=int, default=1)
    parser.add_argument('--spacing-m', type=float, default=1)
    parser.add_argument('--height-m', type=float, default=1.6)
    options = parser.parse_args()
    with tempfile.TemporaryDirectory() as folder:
        for part in ('real', 'simulated'):
            (pathlib.Path(folder) / part).mkdir()
        run(options, pathlib.Path(folder))


if __name__ == '__main__':
    main()
