#!/usr/bin/env python3
# SPDX-FileCopyrightText: 2026 The Vernier authors
# SPDX-License-Identifier: Apache-2.0
"""Localisation on a real walk: nodes every so many metres of it, the other views as queries.

    walk_trial.py PROGRAM WALK [--half first|second|both] [--spacing-m 0.5,1] [--height-m 1.6]

WALK is the folder of sequences/office_walk: images, depth maps, K.txt, poses.csv (world y up). Lines
are found by `vernier lines`, roll, pitch and height taken as known, as from gravity. The walk is
one pass: queries stand between the nodes of the same pass, in the same light, which is the protocol
near_path and no relocalisation. The first half of the walk was for development. A query succeeds
within 1 m, or 0.25 m and 5 degrees, of its pose; one without an answer fails. Chance answers with a
node at random. Intervals of 95 % are by a bootstrap over blocks of 2 m of the walk: neighbouring
views fail together.
"""
import argparse
import csv
import json
import math
import pathlib
import random
import subprocess
import tempfile

BLOCK_M = 2
DRAWS = 2000
METHODS = ('pgh', 'pgh_baseline')


def along(poses):
    """Distance along the walk of every pose, metres."""
    way = [0.0]
    for a, b in zip(poses, poses[1:]):
        way.append(way[-1] + math.hypot(b[0] - a[0], b[1] - a[1]))
    return way


def turn_deg(a, b):
    return abs(math.degrees(math.remainder(a - b, 2 * math.pi)))


def interval(values, blocks, seed=1):
    """95 % of the mean, by resampling blocks of the walk."""
    groups = {}
    for value, block in zip(values, blocks):
        groups.setdefault(block, []).append(value)
    groups = list(groups.values())
    chance = random.Random(seed)
    means = []
    for _ in range(DRAWS):
        drawn = [v for _ in groups for v in chance.choice(groups)]
        means.append(sum(drawn) / len(drawn))
    means.sort()
    return means[int(0.025 * DRAWS)], means[int(0.975 * DRAWS) - 1]


def share(values, blocks):
    low, high = interval(values, blocks)
    return f'{100 * sum(values) / len(values):.0f} % [{100 * low:.0f}, {100 * high:.0f}]'


def median(values):
    values = sorted(values)
    return values[len(values) // 2] if values else math.nan


class Trial:
    def __init__(self, program, walk, folder, height_m):
        self.program, self.folder = program, folder
        self.run('lines', '--image', f'{walk}/images/*.png', '--depth', f'{walk}/depth/*.png', '--rig',
                 walk / 'K.txt', '--poses', walk / 'poses.csv', '--up', 'y', '--height-m', height_m,
                 '-o', 'walk.jsonl')
        self.views = (folder / 'walk.jsonl').read_text().splitlines()
        self.poses = [json.loads(view)['pose'] for view in self.views]
        self.way = along(self.poses)

    def run(self, *words):
        done = subprocess.run([self.program, *map(str, words), '-q'], cwd=self.folder,
                              capture_output=True, text=True)
        if done.returncode not in (0, 3):
            raise SystemExit(done.stderr)

    def nodes(self, spacing_m):
        nodes, last = [], -math.inf
        for i, s in enumerate(self.way):
            if s - last >= spacing_m:
                nodes.append(i)
                last = s
        return nodes

    def answers(self, nodes, queries, method):
        for name, chosen in (('nodes', nodes), ('queries', queries)):
            (self.folder / f'{name}.jsonl').write_text(
                ''.join(self.views[i] + '\n' for i in chosen))
        self.run('map', 'make', '--features', 'nodes.jsonl', '-o', 'walk.map')
        self.run('localise', 'walk.map', '--features', 'queries.jsonl', '--method', method, '-o',
                 'answers.csv')
        with open(self.folder / 'answers.csv', newline='') as text:
            return list(csv.DictReader(text))

    def figures(self, spacing_m, half, method):
        nodes = self.nodes(spacing_m)
        middle = self.way[-1] / 2
        queries = [i for i in range(len(self.views)) if i not in nodes and
                   (half == 'both' or (self.way[i] < middle) == (half == 'first'))]
        near, exact, errors, answered = [], [], [], 0
        chance_near, chance_exact = [], []
        for i, answer in zip(queries, self.answers(nodes, queries, method)):
            x, y, heading = self.poses[i]
            given = answer['status'] == 'answered'
            answered += given
            off = turn = math.inf
            if given:
                off = math.hypot(float(answer['x_m']) - x, float(answer['y_m']) - y)
                turn = turn_deg(math.radians(float(answer['heading_deg'])), heading)
                errors.append(off)
            near.append(off <= 1)
            exact.append(off <= 0.25 and turn <= 5)
            hits = [(math.hypot(self.poses[n][0] - x, self.poses[n][1] - y),
                     turn_deg(self.poses[n][2], heading)) for n in nodes]
            chance_near.append(sum(d <= 1 for d, _ in hits) / len(hits))
            chance_exact.append(sum(d <= 0.25 and t <= 5 for d, t in hits) / len(hits))
        blocks = [int(self.way[i] / BLOCK_M) for i in queries]
        right = sum(near)
        return (f'| {spacing_m:g} m | {len(nodes)} | {len(queries)} | {method} | {share(near, blocks)} '
                f'| {share(exact, blocks)} | {100 * answered / len(queries):.0f} % '
                f'| {100 * right / max(1, answered):.0f} % | {median(errors):.2f} m '
                f'| {100 * sum(chance_near) / len(queries):.0f} %; '
                f'{100 * sum(chance_exact) / len(queries):.1f} % |')


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument('program', type=lambda name: pathlib.Path(name).resolve())
    parser.add_argument('walk', type=lambda name: pathlib.Path(name).resolve())
    parser.add_argument('--half', choices=('first', 'second', 'both'), default='second')
    parser.add_argument('--spacing-m', default='0.5,1')
    parser.add_argument('--height-m', type=float, default=1.6)
    options = parser.parse_args()
    with tempfile.TemporaryDirectory() as folder:
        trial = Trial(options.program, options.walk, pathlib.Path(folder), options.height_m)
        print(f'{len(trial.views)} views of a walk of {trial.way[-1]:.1f} m, queries of the '
              f'{options.half} half\n')
        print('| nodes every | nodes | queries | method | within 1 m | within 0.25 m, 5 deg | answered '
              '| of these right | median error | chance: 1 m; 0.25 m, 5 deg |')
        print('| --- | --- | --- | --- | --- | --- | --- | --- | --- | --- |')
        for spacing in options.spacing_m.split(','):
            for method in METHODS:
                print(trial.figures(float(spacing), options.half, method), flush=True)


if __name__ == '__main__':
    main()
