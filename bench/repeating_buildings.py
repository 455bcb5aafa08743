#!/usr/bin/env python3
# SPDX-FileCopyrightText: 2026 The Vernier authors
# SPDX-License-Identifier: Apache-2.0
"""What `lines` states of its errors, and how often it is wrong, in buildings that repeat: a hall whose
contents are the same after half a turn, a corridor of equal doors, a hall of bays that are furnished alike, and a
long corridor whose stretches resemble each other without repeating.

    repeating_buildings.py PROGRAM [--trials 300] [--seed 1] [--protocol near_path] [--repeats P]
                           [--halls 1] [--corridors 20x40] [--bays 1x5] [--stretches SEEDS]

Prints a line for each building, kind of map and stated error: queries answered, and of these wrong.
"""
import argparse
import json
import pathlib
import random
import subprocess
import sys
import tempfile

HEIGHT_M = 2.6
STATED = (0.001, 0.01, 0.1)


class Mesh:
    """Boxes and rectangles as an OBJ file, metres, z up."""

    def __init__(self):
        self.vertices, self.faces = [], []

    def rectangle(self, *corners):
        first = len(self.vertices) + 1
        self.vertices += corners
        self.faces.append(range(first, first + 4))

    def box(self, x0, y0, z0, x1, y1, z1):
        for y in (y0, y1):
            self.rectangle((x0, y, z0), (x1, y, z0), (x1, y, z1), (x0, y, z1))
        for x in (x0, x1):
            self.rectangle((x, y0, z0), (x, y1, z0), (x, y1, z1), (x, y0, z1))
        for z in (z0, z1):
            self.rectangle((x0, y0, z), (x1, y0, z), (x1, y1, z), (x0, y1, z))

    def write(self, file):
        rows = ['v {:.6f} {:.6f} {:.6f}'.format(*v) for v in self.vertices]
        rows += ['f ' + ' '.join(map(str, face)) for face in self.faces]
        file.write_text('\n'.join(rows) + '\n')


def turned_hall(seed, length_m=16, width_m=6):
    """Furniture along one long wall, and the same along the other, half a turn about the middle."""
    chance, mesh = random.Random(seed), Mesh()
    mesh.box(0, 0, 0, length_m, width_m, HEIGHT_M)
    x = 0.2
    while x < length_m - 1.5:
        width, depth = chance.uniform(0.4, 1.1), chance.uniform(0.3, 1.2)
        height = chance.uniform(0.7, 2.2)
        mesh.box(x, 0.02, 0, x + width, 0.02 + depth, height)
        mesh.box(length_m - x - width, width_m - 0.02 - depth, 0, length_m - x, width_m - 0.02, height)
        x += width + chance.uniform(0.15, 0.8)
    return mesh


def corridor(doors=20, length_m=40, width_m=2.2):
    """Equal doors on both sides at equal distances."""
    mesh = Mesh()
    mesh.box(0, 0, 0, length_m, width_m, HEIGHT_M)
    step = length_m / doors
    for i in range(doors):
        x = (i + 0.5) * step - 0.45
        mesh.box(x, 0, 0, x + 0.9, 0.03, 2.1)
        mesh.box(x, width_m - 0.03, 0, x + 0.9, width_m, 2.1)
    return mesh


def bays(seed, count, bay_m=6, width_m=6):
    """Bays of equal furniture in a row, along both walls."""
    chance, mesh = random.Random(seed), Mesh()
    mesh.box(0, 0, 0, count * bay_m, width_m, HEIGHT_M)
    pieces = []
    for wall in (False, True):
        x = chance.uniform(0.1, 0.6)
        while x < bay_m - 1.2:
            width, depth = chance.uniform(0.4, 1.1), chance.uniform(0.3, 1.2)
            pieces.append((x, width, depth, chance.uniform(0.7, 2.2), wall))
            x += width + chance.uniform(0.3, 1.2)
    for bay in range(count):
        for x, width, depth, height, wall in pieces:
            y = width_m - 0.02 - depth if wall else 0.02
            mesh.box(bay * bay_m + x, y, 0, bay * bay_m + x + width, y + depth, height)
    return mesh


def stretches(seed, length_m=120, width_m=2):
    """Equal doors at uneven gaps, on either side of a corridor."""
    chance, mesh = random.Random(seed), Mesh()
    mesh.box(0, 0, 0, length_m, width_m, HEIGHT_M)
    for y0, y1 in ((0, 0.03), (width_m - 0.03, width_m)):
        x = chance.uniform(0.5, 3)
        while x < length_m - 1.2:
            mesh.box(x, y0, 0, x + 0.9, y1, 2.1)
            x += chance.uniform(2.2, 7)
    return mesh


def seeds(text):
    """1,4-6 as numbers."""
    ranges = [part.split('-') for part in text.split(',') if part]
    return [seed for part in ranges for seed in range(int(part[0]), int(part[-1]) + 1)]


def buildings(options):
    """Name and mesh of each."""
    for seed in seeds(options.halls):
        yield f'hall {seed}', turned_hall(seed)
    for text in filter(None, options.corridors.split(',')):
        doors, length_m = text.split('x')
        yield f'corridor {text}', corridor(int(doors), float(length_m))
    for text in filter(None, options.bays.split(',')):
        seed, count = text.split('x')
        yield f'bays {text}', bays(int(seed), int(count))
    for seed in seeds(options.stretches):
        yield f'stretches {seed}', stretches(seed)


def main():
    parser = argparse.ArgumentParser(description=__doc__.split('\n')[0])
    parser.add_argument('program')
    parser.add_argument('--trials', type=int, default=300, help='queries a building, map and rate')
    parser.add_argument('--seed', type=int, default=1, help='of the studies')
    parser.add_argument('--repeats', type=float, help="localiser.repeats (default: the program's)")
    parser.add_argument('--halls', default='1', help='seeds of halls, as 1,4-6')
    parser.add_argument('--corridors', default='20x40', help='doors a side x length in metres')
    parser.add_argument('--bays', default='1x5', help='seed x number of bays')
    parser.add_argument('--stretches', default='', help='seeds of long corridors, as 1,4-6')
    parser.add_argument('--protocol', default='near_path', help='of the queries')
    options = parser.parse_args()
    program = str(pathlib.Path(options.program).resolve())
    print(f'{"building":<16}{"headings":>10}{"stated %":>10}{"answered":>10}{"wrong":>8}{"wrong %":>9}{"best %":>9}')
    totals = {}
    prior = '' if options.repeats is None else f'[localiser]\nrepeats = {options.repeats}\n'
    with tempfile.TemporaryDirectory() as name:
        folder = pathlib.Path(name)
        for building, mesh in buildings(options):
            file = building.replace(' ', '_')
            mesh.write(folder / f'{file}.obj')
            subprocess.run([program, 'world', 'import', f'{file}.obj', '--up', 'z', '--unit', 'm', '-o',
                            f'{file}.world.toml', '-q'], cwd=folder, check=True, capture_output=True)
            (folder / 's.toml').write_text(
                f'[study]\ntrials = {options.trials}\nseed = {options.seed}\nprotocol = "{options.protocol}"\n'
                f'[world]\nfile = "{file}.world.toml"\n{prior}[sweep]\n"map.headings" = ["path", 8]\n'
                f'"localiser.max_error_rate" = {list(STATED)}\n')
            run = subprocess.run([program, 'study', 's.toml', '-o', file, '-q', '--json'], cwd=folder,
                                 check=True, capture_output=True, text=True)
            for cell in json.loads(run.stdout)['cells']:
                answered = round(cell['coverage'] * cell['trials'])
                wrong = answered - round(cell['success'] * cell['trials'])
                headings = str(cell['swept']['map.headings']).removesuffix('.0')
                stated = 100 * cell['swept']['localiser.max_error_rate']
                print(f'{building:<16}{headings:>10}{stated:>10g}{answered:>10}{wrong:>8}'
                      f'{100 * wrong / max(1, answered):>9.1f}{100 * cell["best_guess_success"]:>9.1f}', flush=True)
                sums = totals.setdefault((building.split()[0], headings, stated), [0, 0])
                sums[0] += answered
                sums[1] += wrong
    print()
    for (kind, headings, stated), (answered, wrong) in totals.items():
        print(f'{"all: " + kind:<16}{headings:>10}{stated:>10g}{answered:>10}{wrong:>8}'
              f'{100 * wrong / max(1, answered):>9.1f}')


if __name__ == '__main__':
    sys.exit(main())
