#!/usr/bin/env python3
# SPDX-FileCopyrightText: 2026 The Vernier authors
# SPDX-License-Identifier: Apache-2.0
"""How often `world import` knows which axis is up and finds the storeys, over made-up buildings.

    made_buildings.py PROGRAM [--seed 1] [--buildings 300] [--jobs 2] [--keep FOLDER]

A building has 1 to 9 storeys, a plan of one to three rectangles, walls of boxes or of single sheets, slabs or
single floors, façades by the storey, with windows or blank, or blank over all storeys, and perhaps: a higher ground
floor, a basement, a parapet, a pitched roof, columns, a stair, a plot with a fence.
Every third one is written with each axis up. Prints, by number of storeys, how often the axis was right,
asked for, or wrong without a word; with the axis given, how often the number of storeys was right, and
how often a world has a route on the lowest.
"""
import argparse
import collections
import concurrent.futures
import json
import pathlib
import random
import subprocess
import sys
import tempfile

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent))
sys.dont_write_bytecode = True
from repeating_buildings import Mesh

DOOR_HEAD_M = 2.1


class Building:
    """One made-up building; `storeys` counts what has a floor, walls and a ceiling or roof."""

    def __init__(self, seed):
        self.chance = random.Random(seed)
        one_of, within = self.chance.choice, self.chance.uniform
        self.mesh = Mesh()
        self.is_sheet = one_of((False, False, True))
        self.slab_m = one_of((0, 0.2, 0.3))
        self.wall_m = one_of((0.1, 0.2, 0.35))
        self.goes_through = one_of((False, False, True))
        self.windows = one_of((False, True))
        self.storeys = one_of((1, 1, 2, 2, 3, 4, 5, 6, 8, 9))
        storey_m = within(2.5, 3.8)
        heights = [storey_m] * self.storeys
        if self.maybe(0.3):
            heights[0] += within(0.3, 2)
        base = -storey_m if self.storeys > 1 and self.maybe(0.2) else 0
        self.floors = [base]
        for height in heights:
            self.floors.append(self.floors[-1] + height)
        self.plans = self.rectangles()
        self.core = self.maybe(0.3) and self.storeys > 1
        for plan in self.plans:
            self.wing(plan)
        self.extras(base)

    def maybe(self, share):
        return self.chance.random() < share

    def rectangles(self):
        within = self.chance.uniform
        length, depth = within(7, 45), within(5, 16)
        plans = [(0, 0, length, depth)]
        if self.maybe(0.4):
            plans.append((0, depth, within(4, 0.7 * length), depth + within(4, 12)))
        if len(plans) == 2 and self.maybe(0.4):
            plans.append((length, 0, length + within(4, 9), within(4, depth)))
        return plans

    def wall(self, x0, y0, x1, y1, low, high, gaps=()):
        """A wall along x or y from `low` to `high`; a gap is (begin, end, sill, head)."""
        length = max(x1 - x0, y1 - y0)
        along_x, half = x1 > x0, self.wall_m / 2

        def piece(a, b, z0, z1):
            if b - a < 1e-6 or z1 - z0 < 1e-6:
                return
            if self.is_sheet:
                ends = [(x0 + t, y0) if along_x else (x0, y0 + t) for t in (a, b)]
                self.mesh.rectangle((*ends[0], z0), (*ends[1], z0), (*ends[1], z1), (*ends[0], z1))
            elif along_x:
                self.mesh.box(x0 + a, y0 - half, z0, x0 + b, y0 + half, z1)
            else:
                self.mesh.box(x0 - half, y0 + a, z0, x0 + half, y0 + b, z1)

        at = 0
        for begin, end, sill, head in gaps:
            if end > length - 0.3:
                break
            piece(at, begin, low, high)
            piece(begin, end, low, low + sill)
            piece(begin, end, low + head, high)
            at = end
        piece(at, length, low, high)

    def facade_gaps(self, length, has_door):
        gaps, at = [], self.chance.uniform(0.5, 1.5)
        if has_door:
            gaps.append((at, at + 1, 0, DOOR_HEAD_M))
            at += 2
        while self.windows and at + 1.4 < length:
            gaps.append((at, at + 1.2, 0.9, DOOR_HEAD_M))
            at += self.chance.uniform(2, 4)
        return gaps

    def floor(self, plan, z):
        x0, y0, x1, y1 = plan
        hole = (x0 + 1, y0 + 1, x0 + 3, y0 + 4.2)
        parts = [plan]
        if self.core and plan is self.plans[0] and z > self.floors[0] and z < self.floors[-1]:
            parts = [(x0, y0, hole[0], y1), (hole[2], y0, x1, y1), (hole[0], y0, hole[2], hole[1]),
                     (hole[0], hole[3], hole[2], y1)]
        for a, b, c, d in parts:
            if self.slab_m:
                self.mesh.box(a, b, z - self.slab_m, c, d, z)
            else:
                self.mesh.rectangle((a, b, z), (c, b, z), (c, d, z), (a, d, z))

    def wing(self, plan):
        x0, y0, x1, y1 = plan
        sides = ((x0, y0, x1, y0), (x0, y1, x1, y1), (x0, y0, x0, y1), (x1, y0, x1, y1))
        partitions = sorted(self.chance.uniform(x0 + 2, x1 - 2) for _ in range(self.chance.randint(0, int((x1 - x0) / 4))))
        partitions = [x for i, x in enumerate(partitions) if i == 0 or x - partitions[i - 1] > 1.2]
        middle = y0 + (y1 - y0) * self.chance.uniform(0.35, 0.65) if self.maybe(0.6) else None
        same_plan = self.maybe(0.7)
        for k, (low, high) in enumerate(zip(self.floors, self.floors[1:])):
            self.floor(plan, low)
            top = high - self.slab_m
            if not self.goes_through:
                for i, side in enumerate(sides):
                    length = max(side[2] - side[0], side[3] - side[1])
                    self.wall(*side, low, top, self.facade_gaps(length, k == 0 and i == 0))
            shift = 0 if same_plan else self.chance.uniform(-0.5, 0.5)
            for x in partitions:
                gaps = [(0.8, 1.7, 0, DOOR_HEAD_M)]
                if middle is None:
                    self.wall(x + shift, y0, x + shift, y1, low, top, gaps)
                else:
                    self.wall(x + shift, y0, x + shift, middle, low, top, gaps)
            if middle is not None:
                self.wall(x0, middle, x1, middle, low, top, [(1, 1.9, 0, DOOR_HEAD_M)])
        if self.goes_through:
            for i, side in enumerate(sides):
                self.wall(*side, self.floors[0], self.floors[-1] - self.slab_m,
                          [(1, 2, 0, DOOR_HEAD_M)] if i == 0 else [])
        self.floor(plan, self.floors[-1])

    def extras(self, base):
        x0, y0, x1, y1 = self.plans[0]
        top, mesh, within = self.floors[-1], self.mesh, self.chance.uniform
        if self.maybe(0.25):
            ridge, middle = top + within(1.5, 3), (y0 + y1) / 2
            for y in (y0 - 0.4, y1 + 0.4):
                mesh.rectangle((x0, y, top), (x1, y, top), (x1, middle, ridge), (x0, middle, ridge))
        elif self.maybe(0.3):
            for side in ((x0, y0, x1, y0), (x0, y1, x1, y1), (x0, y0, x0, y1), (x1, y0, x1, y1)):
                self.wall(*side, top, top + within(0.5, 1.1))
        if self.maybe(0.25):
            for low, high in zip(self.floors, self.floors[1:]):
                for i in range(self.chance.randint(1, 4)):
                    x = x0 + (x1 - x0) * (i + 0.5) / 4
                    mesh.box(x, y0 + 1.2, low, x + 0.3, y0 + 1.5, high - self.slab_m)
        if self.core:
            steps = int((self.floors[1] - self.floors[0]) / 0.18)
            rise, run = (self.floors[1] - self.floors[0]) / steps, 3 / steps
            for i in range(steps):
                mesh.box(x0 + 1.2, y0 + 1.1 + run * i, self.floors[0], x0 + 2.2, y0 + 1.1 + run * (i + 1),
                         self.floors[0] + rise * (i + 1))
        if base == 0 and self.maybe(0.3):
            edge, far_x = within(3, 15), max(p[2] for p in self.plans)
            far_y = max(p[3] for p in self.plans)
            mesh.rectangle((-edge, -edge, -0.03), (far_x + edge, -edge, -0.03), (far_x + edge, far_y + edge, -0.03),
                           (-edge, far_y + edge, -0.03))
            if self.maybe(0.4):
                self.wall(-edge, -edge, far_x + edge, -edge, 0, 1.5)
                self.wall(-edge, far_y + edge, far_x + edge, far_y + edge, 0, 1.5)

    def write(self, file, up):
        turned = Mesh()
        turn = {'z': lambda x, y, z: (x, y, z), 'y': lambda x, y, z: (x, z, -y), 'x': lambda x, y, z: (z, y, -x)}
        turned.vertices = [turn[up](*v) for v in self.mesh.vertices]
        turned.faces = self.mesh.faces
        turned.write(file)


def judged(program, seed, folder, up):
    """What `world import` makes of one building: its number of storeys and three answers."""
    building, file = Building(seed), folder / f'{seed}_{up}.obj'
    building.write(file, up)
    out = folder / f'{seed}.world.toml'

    def called(*more):
        return subprocess.run([program, 'world', 'import', file, '-o', out, '--unit', 'm', '--json', *more],
                              capture_output=True, text=True)

    bare = called('--no-route')
    if bare.returncode in (0, 3):
        answer = 'right' if json.loads(bare.stdout)['up'] == up else 'wrong'
    else:
        answer = 'asked' if '--up' in bare.stderr else 'failed'
    given = called('--up', up)
    storeys = route = None
    if given.returncode in (0, 3):
        said = json.loads(given.stdout)
        storeys, route = len(said['storeys_m']), bool(said.get('route_m'))
    out.unlink(missing_ok=True)
    return seed, up, building.storeys, answer, storeys, route


def main():
    options = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    options.add_argument('program', type=pathlib.Path)
    options.add_argument('--seed', type=int, default=1)
    options.add_argument('--buildings', type=int, default=300)
    options.add_argument('--jobs', type=int, default=2)
    options.add_argument('--keep', type=pathlib.Path, help='folder for the files of those not right')
    options = options.parse_args()
    tally, listed = collections.defaultdict(collections.Counter), []
    with tempfile.TemporaryDirectory() as folder:
        folder = pathlib.Path(folder)
        with concurrent.futures.ThreadPoolExecutor(options.jobs) as jobs:
            results = list(jobs.map(lambda i: judged(options.program.resolve(), options.seed + i, folder, 'zyx'[i % 3]),
                                    range(options.buildings)))
        for seed, up, storeys, answer, found, route in results:
            for row in (storeys, 'all'):
                tally[row][answer] += 1
                tally[row]['all'] += 1
                tally[row]['storeys right'] += found == storeys
                tally[row]['routes'] += bool(route)
            faults = [answer] * (answer in ('wrong', 'failed')) + [f'{found} storeys'] * (found != storeys)
            faults += ['no route'] * (not route)
            if faults:
                listed.append(f'{seed}, {up} up, {storeys} storeys: {", ".join(faults)}')
                if options.keep:
                    options.keep.mkdir(parents=True, exist_ok=True)
                    Building(seed).write(options.keep / f'{seed}_{up}.obj', up)
    columns = ('all', 'right', 'asked', 'wrong', 'failed', 'storeys right', 'routes')
    print('storeys ' + ' '.join(f'{c:>13}' for c in columns))
    for row in sorted(k for k in tally if k != 'all') + ['all']:
        print(f'{row!s:>7} ' + ' '.join(f'{tally[row][c]:13}' for c in columns))
    print('\n'.join(listed))


if __name__ == '__main__':
    main()
