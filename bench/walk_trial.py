#!/usr/bin/env python3
# SPDX-FileCopyrightText: 2026 The Vernier authors
# SPDX-License-Identifier: Apache-2.0
"""Localisation on a real walk, and on the same walk simulated in the world built from its views.

    walk_trial.py PROGRAM WALK [--half first|second|both] [--spacing-m 0.5,1] [--height-m 1.6]
                  [--simulated N] [--min-sightings 2] [--sources FILE] [--source NAME=VALUE …] [--page page.html]
                  [--json figures.json]

WALK is the folder of sequences/office_walk: images, depth maps, K.txt, poses.csv (world y up). Nodes
every so many metres of the walk, the other views as queries. Lines are found by `vernier lines`, roll,
pitch and height taken as known, as from gravity. The walk is one pass: queries stand between the nodes
of the same pass, in the same light, which is the protocol near_path and no relocalisation. The first
half of the walk was for development. A query succeeds within 1 m, or 0.25 m and 5 degrees, of its pose;
one without an answer fails. Chance answers with a node at random.

With --simulated N the prediction stands beside: `world build` makes a world of all views, `simulate
--poses` looks from the same poses N times, with other draws, for nodes and queries alike, by the sources
that are given (--sources, as characterise writes them, --source; else the defaults). Real and predicted are paired by query: their difference is
real minus the mean of the N. Intervals of 95 % are by a bootstrap over blocks of 2 m of the walk:
neighbouring views fail together. --page writes both on one page.
"""
import argparse
import csv
import json
import math
import pathlib
import random
import re
import struct
import subprocess
import tempfile

import walk_page

BLOCK_M = 2
DRAWS = 2000
METHODS = ('pgh', 'pgh_baseline')


def along(poses):
    """Distance along the walk of every pose, metres."""
    way = [0.0]
    for a, b in zip(poses, poses[1:]):
        way.append(way[-1] + math.hypot(b[0] - a[0], b[1] - a[1]))
    return way


def sources_in(file):
    """The values of a file of sources, as words of --source."""
    return [f'{name}={value}' for name, value in
            re.findall(r'^(\w+) = ([-+.\de]+)', file.read_text(), re.MULTILINE)]


def turn_deg(a, b):
    return abs(math.degrees(math.remainder(a - b, 2 * math.pi)))


def median(values):
    values = sorted(values)
    return values[len(values) // 2] if values else math.nan


def mean(values):
    return sum(values) / len(values) if values else math.nan


def interval(rows, blocks, figure=mean, seed=1):
    """95 % of a figure of rows, by resampling blocks of the walk."""
    groups = {}
    for row, block in zip(rows, blocks):
        groups.setdefault(block, []).append(row)
    groups = list(groups.values())
    chance = random.Random(seed)
    values = []
    for _ in range(DRAWS):
        value = figure([row for _ in groups for row in chance.choice(groups)])
        if not math.isnan(value):
            values.append(value)
    values.sort()
    return (values[int(0.025 * len(values))], values[int(0.975 * len(values)) - 1]) if values else (
        math.nan, math.nan)


def share(values, blocks):
    low, high = interval(values, blocks)
    return f'{100 * mean(values):.0f} % [{100 * low:.0f}, {100 * high:.0f}]'


class Walk:
    """The real views and the simulated ones, by the same poses."""

    def __init__(self, program, walk, folder, height_m):
        self.program, self.walk, self.folder = program, walk, folder
        self.poses_at = ['--poses', walk / 'poses.csv', '--up', 'y', '--height-m', height_m]
        self.run('lines', *self.images(), '--rig', walk / 'K.txt', *self.poses_at, '-o', 'walk.jsonl',
                 '--segments', 'walk.segments')
        self.views = (folder / 'walk.jsonl').read_text().splitlines()
        self.poses = [json.loads(view)['pose'] for view in self.views]
        self.way = along(self.poses)

    def images(self):
        return ['--image', f'{self.walk}/images/*.png', '--depth', f'{self.walk}/depth/*.png']

    def run(self, *words):
        done = subprocess.run([self.program, *map(str, words), '-q'], cwd=self.folder,
                              capture_output=True, text=True)
        if done.returncode not in (0, 3):
            raise SystemExit(done.stderr)
        return done.stdout

    def build(self, min_sightings):
        """The world of all views."""
        first = sorted(self.walk.glob('images/*.png'))[0]
        width, height = struct.unpack('>2I', first.read_bytes()[16:24])
        self.run('convert', self.walk / 'K.txt', '--size', f'{width}x{height}', '-o', 'K.json')
        return json.loads(self.run('world', 'build', '--segments', 'walk.segments', *self.poses_at,
                                   '--depth', f'{self.walk}/depth/*.png', '--rig', self.walk / 'K.txt',
                                   '--min-sightings', min_sightings, '--upright-deg', '0', '-o',
                                   'walk.world.toml', '--json'))

    def simulated(self, trial, sources):
        """The views of the same poses in that world."""
        with open(self.walk / 'poses.csv', newline='') as text:
            header, *rows = text.read().splitlines()
        seen = {path.stem for path in self.walk.glob('images/*.png')}
        (self.folder / 'sim.csv').write_text('\n'.join(
            [header, *(row for row in rows if row.split(',')[0].rsplit('.', 1)[0] in seen)]) + '\n')
        self.run('simulate', '--world', 'walk.world.toml', '--rig', 'K.json', '--poses', 'sim.csv',
                 *self.poses_at[2:], '--trial', trial, '--features', 'sim.jsonl',
                 *(word for source in sources for word in ('--source', source)))
        views = (self.folder / 'sim.jsonl').read_text().splitlines()
        if len(views) != len(self.views):
            raise SystemExit(f'{len(views)} simulated views and {len(self.views)} real ones')
        return views

    def nodes(self, spacing_m):
        nodes, last = [], -math.inf
        for i, s in enumerate(self.way):
            if s - last >= spacing_m:
                nodes.append(i)
                last = s
        return nodes

    def queries(self, nodes, half):
        middle = self.way[-1] / 2
        return [i for i in range(len(self.views)) if i not in nodes and
                (half == 'both' or (self.way[i] < middle) == (half == 'first'))]

    def answers(self, views, nodes, queries, method):
        """Of each query: pose or None, error in metres and degrees."""
        for name, chosen in (('nodes', nodes), ('queries', queries)):
            (self.folder / f'{name}.jsonl').write_text(''.join(views[i] + '\n' for i in chosen))
        self.run('map', 'make', '--features', 'nodes.jsonl', '-o', 'walk.map')
        self.run('localise', 'walk.map', '--features', 'queries.jsonl', '--method', method, '-o',
                 'answers.csv')
        with open(self.folder / 'answers.csv', newline='') as text:
            return [self.judged(i, row) for i, row in zip(queries, csv.DictReader(text))]

    def judged(self, i, row):
        x, y, heading = self.poses[i]
        if row['status'] != 'answered':
            return {'at': None, 'off_m': math.inf, 'turn_deg': math.inf}
        at = float(row['x_m']), float(row['y_m'])
        return {'at': at, 'off_m': math.hypot(at[0] - x, at[1] - y),
                'turn_deg': turn_deg(math.radians(float(row['heading_deg'])), heading)}


def is_near(answer):
    return float(answer['off_m'] <= 1)


def is_exact(answer):
    return float(answer['off_m'] <= 0.25 and answer['turn_deg'] <= 5)


class Comparison:
    """Real answers of one map and method, and those of the simulated walks, query by query."""

    def __init__(self, walk, simulated, spacing_m, half, method):
        self.walk, self.spacing_m, self.method = walk, spacing_m, method
        self.nodes = walk.nodes(spacing_m)
        self.queries = walk.queries(self.nodes, half)
        self.blocks = [int(walk.way[i] / BLOCK_M) for i in self.queries]
        self.real = walk.answers(walk.views, self.nodes, self.queries, method)
        self.predicted = [walk.answers(views, self.nodes, self.queries, method)
                          for views in simulated]

    def chance(self, is_hit):
        total = 0
        for i in self.queries:
            x, y, heading = self.walk.poses[i]
            hits = [is_hit({'off_m': math.hypot(self.walk.poses[n][0] - x, self.walk.poses[n][1] - y),
                            'turn_deg': turn_deg(self.walk.poses[n][2], heading)}) for n in self.nodes]
            total += mean(hits)
        return total / len(self.queries)

    def real_row(self):
        answered = [a for a in self.real if a['at']]
        right = sum(map(is_near, self.real))
        return (f'| {self.spacing_m:g} m | {len(self.nodes)} | {len(self.queries)} | {self.method} '
                f'| {share([is_near(a) for a in self.real], self.blocks)} '
                f'| {share([is_exact(a) for a in self.real], self.blocks)} '
                f'| {100 * len(answered) / len(self.real):.0f} % '
                f'| {100 * right / max(1, len(answered)):.0f} % '
                f'| {median([a["off_m"] for a in answered]):.2f} m '
                f'| {100 * self.chance(is_near):.0f} %; {100 * self.chance(is_exact):.1f} % |')

    def success(self, is_hit):
        """Real share, predicted share, their difference with its interval."""
        real = [is_hit(a) for a in self.real]
        predicted = [mean([is_hit(run[k]) for run in self.predicted]) for k in range(len(real))]
        differences = [r - p for r, p in zip(real, predicted)]
        low, high = interval(differences, self.blocks)
        return {'real': mean(real), 'predicted': mean(predicted), 'difference': mean(differences),
                'low': low, 'high': high, 'holds_0': low <= 0 <= high}

    def error(self):
        """Median errors of the answers, and real over predicted with its interval."""
        rows = [(self.real[k], [run[k] for run in self.predicted]) for k in range(len(self.real))]

        def ratio(chosen):
            real = median([a['off_m'] for a, _ in chosen if a['at']])
            predicted = median([a['off_m'] for _, runs in chosen for a in runs if a['at']])
            return real / predicted if predicted > 0 else math.nan

        low, high = interval(rows, self.blocks, ratio)
        return {'real_m': median([a['off_m'] for a in self.real if a['at']]),
                'predicted_m': median([a['off_m'] for run in self.predicted for a in run if a['at']]),
                'ratio': ratio(rows), 'low': low, 'high': high, 'within': 0.67 <= ratio(rows) <= 1.5}

    def figures(self):
        return {'spacing_m': self.spacing_m, 'method': self.method, 'queries': len(self.queries),
                'near': self.success(is_near), 'exact': self.success(is_exact), 'error': self.error()}

    def paired_row(self):
        f = self.figures()

        def cells(s):
            return (f'{100 * s["real"]:.0f} % | {100 * s["predicted"]:.0f} % '
                    f'| {100 * s["difference"]:+.0f} [{100 * s["low"]:+.0f}, {100 * s["high"]:+.0f}]')

        e = f['error']
        return (f'| {self.spacing_m:g} m | {self.method} | {cells(f["near"])} | {cells(f["exact"])} '
                f'| {e["real_m"]:.3f} m | {e["predicted_m"]:.3f} m '
                f'| {e["ratio"]:.2f} [{e["low"]:.2f}, {e["high"]:.2f}] |')


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument('program', type=lambda name: pathlib.Path(name).resolve())
    parser.add_argument('walk', type=lambda name: pathlib.Path(name).resolve())
    parser.add_argument('--half', choices=('first', 'second', 'both'), default='second')
    parser.add_argument('--spacing-m', default='0.5,1')
    parser.add_argument('--height-m', type=float, default=1.6)
    parser.add_argument('--simulated', type=int, default=0, metavar='N')
    parser.add_argument('--min-sightings', type=int, default=2)
    parser.add_argument('--sources', type=pathlib.Path)
    parser.add_argument('--source', action='append', default=[])
    parser.add_argument('--page', type=pathlib.Path)
    parser.add_argument('--json', type=pathlib.Path)
    options = parser.parse_args()
    if options.sources:
        options.source = sources_in(options.sources) + options.source
    with tempfile.TemporaryDirectory() as folder:
        walk = Walk(options.program, options.walk, pathlib.Path(folder), options.height_m)
        print(f'{len(walk.views)} views of a walk of {walk.way[-1]:.1f} m, queries of the '
              f'{options.half} half')
        simulated = []
        if options.simulated:
            built = walk.build(options.min_sightings)
            print(f'world of {built["lines"]} lines and {built["surfaces"]} surfaces; sources: '
                  f'{", ".join(options.source) or "defaults"}; {options.simulated} draws')
            simulated = [walk.simulated(k, options.source) for k in range(options.simulated)]
        compared = [Comparison(walk, simulated, float(spacing), options.half, method)
                    for spacing in options.spacing_m.split(',') for method in METHODS]
        print('\n| nodes every | nodes | queries | method | within 1 m | within 0.25 m, 5 deg | answered '
              '| of these right | median error | chance: 1 m; 0.25 m, 5 deg |')
        print('| --- | --- | --- | --- | --- | --- | --- | --- | --- | --- |')
        for c in compared:
            print(c.real_row())
        if not simulated:
            return
        print('\n| nodes every | method | within 1 m: real | predicted | difference, points '
              '| within 0.25 m, 5 deg: real | predicted | difference, points | median error: real '
              '| predicted | ratio |')
        print('| --- | --- | --- | --- | --- | --- | --- | --- | --- | --- | --- |')
        for c in compared:
            print(c.paired_row())
        if options.json:
            options.json.write_text(json.dumps([c.figures() for c in compared], indent=1) + '\n')
        if options.page:
            options.page.write_text(walk_page.page(compared, options.half, options.source,
                                                   options.simulated, is_near))


if __name__ == '__main__':
    main()
