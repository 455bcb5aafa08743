#!/usr/bin/env python3
# SPDX-FileCopyrightText: 2026 The Vernier authors
# SPDX-License-Identifier: Apache-2.0
"""What `calibrate` does with boards that are not what it is told: bent, or stretched by a printer.

    board_faults.py PROGRAM [--board bent|flat|stretched] [--views 4,5,6,7] [--sets 60] [--seed 1]

Corners of two pinhole cameras of 640 x 480 pixels, 9 x 6 corners of 25 mm, 0.2 px of white noise,
boards at 0.45 to 0.9 m tilted by up to 35 degrees; of a stretched board every second view is turned by
90 degrees. Prints a line a number of views: sets in which the shape or the aspect is estimated or a
doubt is raised, and how often f_x and the baseline lie inside their stated 95 % intervals. Needs only
the Python standard library.
"""
import argparse
import json
import math
import pathlib
import random
import subprocess
import sys
import tempfile

COLUMNS, ROWS, SQUARE_M = 9, 6, 0.025
F_PX, CX_PX, CY_PX, WIDTH, HEIGHT = 600.0, 319.5, 239.5, 640, 480
BASELINE_M, NOISE_PX = 0.12, 0.2
BENDS = ('paraboloid', 'along x', 'along y', 'oblique')


def bent(x, y, kind, height_m):
    """Height of the board at x, y in [-1, 1]."""
    if kind == 'paraboloid':
        return height_m * (1 - (x * x + y * y) / 2)
    turn = {'along x': 0, 'along y': math.pi / 2, 'oblique': 0.7}[kind]
    return height_m * (1 - (math.cos(turn) * x + math.sin(turn) * y) ** 2)


def board_points(board, number, height_m, stretch):
    half_x, half_y = SQUARE_M * (COLUMNS - 1) / 2, SQUARE_M * (ROWS - 1) / 2
    points = []
    for row in range(ROWS):
        for col in range(COLUMNS):
            x, y = SQUARE_M * col - half_x, SQUARE_M * row - half_y
            z = bent(x / half_x, y / half_y, BENDS[number % 4], height_m) if board == 'bent' else 0
            points.append((row, col, x * (1 + stretch if board == 'stretched' else 1), y, z))
    return points


def rotation(tilt, about, turn):
    """About the normal by `turn`, then by `tilt` about an axis of the board's plane."""
    ux, uy, c, s = math.cos(about), math.sin(about), math.cos(tilt), math.sin(tilt)
    tilted = ((c + ux * ux * (1 - c), ux * uy * (1 - c), uy * s),
              (ux * uy * (1 - c), c + uy * uy * (1 - c), -ux * s), (-uy * s, ux * s, c))
    ct, st = math.cos(turn), math.sin(turn)
    return [(r[0] * ct + r[1] * st, -r[0] * st + r[1] * ct, r[2]) for r in tilted]


def view(chance, points, turned):
    """Pixels of both cameras, drawn again until all corners are in both images."""
    while True:
        turn = (math.pi / 2 if turned else 0) + chance.uniform(-0.2, 0.2)
        R = rotation(chance.uniform(0, 0.6), chance.uniform(0, 2 * math.pi), turn)
        t = (chance.uniform(-0.15, 0.2), chance.uniform(-0.12, 0.12), chance.uniform(0.45, 0.9))
        pixels = []
        for row, col, *X in points:
            x, y, z = (sum(a * b for a, b in zip(R[i], X)) + t[i] for i in range(3))
            for camera, shift in ((0, 0.0), (1, BASELINE_M)):
                at = (F_PX * (x - shift) / z + CX_PX, F_PX * y / z + CY_PX)
                pixels.append((camera, row, col, *at))
        if all(5 < p[3] < WIDTH - 6 and 5 < p[4] < HEIGHT - 6 for p in pixels):
            return pixels


def corners(chance, number, views, options):
    points = board_points(options.board, number, options.height_mm / 1000, options.stretch / 100)
    lines = ['frame,camera,row,col,X,Y,Z,qx,qy']
    for frame in range(views):
        turned = options.board == 'stretched' and frame % 2 == 1
        for camera, row, col, qx, qy in view(chance, points, turned):
            lines.append(f'{frame},{camera},{row},{col},{SQUARE_M * col:.6f},{SQUARE_M * row:.6f},0,'
                         f'{qx + chance.gauss(0, NOISE_PX):.6f},{qy + chance.gauss(0, NOISE_PX):.6f}')
    return '\n'.join(lines) + '\n'


def standard_deviation(rig, gradient):
    matrix = rig['covariance']['matrix']
    at = {name: rig['parameter_names'].index(name) for name in gradient}
    return math.sqrt(sum(gradient[a] * gradient[b] * matrix[at[a]][at[b]]
                         for a in gradient for b in gradient))


def main():
    parser = argparse.ArgumentParser(description=__doc__.split('\n')[0])
    parser.add_argument('program')
    parser.add_argument('--board', choices=('bent', 'flat', 'stretched'), default='bent')
    parser.add_argument('--views', default='4,5,6,7')
    parser.add_argument('--sets', type=int, default=60)
    parser.add_argument('--seed', type=int, default=1)
    parser.add_argument('--height-mm', type=float, default=1.0, help='of the bend')
    parser.add_argument('--stretch', type=float, default=0.2, help='per cent along x')
    parser.add_argument('--options', default='', help='further options of calibrate')
    options = parser.parse_args()
    program = str(pathlib.Path(options.program).resolve())
    print(f'{"views":>5}{"sets":>6}{"failed":>8}{"found":>7}{"doubt":>7}{"f_x %":>8}{"baseline %":>12}')
    with tempfile.TemporaryDirectory() as name:
        folder = pathlib.Path(name)
        for views in map(int, options.views.split(',')):
            sets = failed = found = doubtful = f_inside = baseline_inside = 0
            for number in range(options.sets):
                chance = random.Random(f'{options.seed} {options.board} {views} {number}')
                (folder / 'c.csv').write_text(corners(chance, number, views, options))
                run = subprocess.run([program, 'calibrate', '--observations', 'c.csv', '--size',
                                      f'{WIDTH}x{HEIGHT}', '-o', 'rig.json', '-q', '--json',
                                      *options.options.split()], cwd=folder, capture_output=True, text=True)
                if run.returncode not in (0, 3):
                    failed += 1
                    continue
                rig = json.loads((folder / 'rig.json').read_text())
                sets += 1
                doubtful += run.returncode == 3
                calibration = rig['calibration']
                found += bool(calibration.get('effects') or calibration.get('board_aspect'))
                value = dict(zip(rig['parameter_names'], rig['parameters']))
                f = value['left.f_px'] * value['left.ax']
                sd = standard_deviation(rig, {'left.f_px': value['left.ax'], 'left.ax': value['left.f_px']})
                f_inside += abs(f - F_PX) < 1.96 * sd
                t = [value[f'right.t{axis}_m'] for axis in 'xyz']
                length = math.hypot(*t)
                sd = standard_deviation(rig, {f'right.t{axis}_m': part / length
                                               for axis, part in zip('xyz', t)})
                baseline_inside += abs(length - BASELINE_M) < 1.96 * sd
            of = max(1, sets)
            print(f'{views:>5}{sets:>6}{failed:>8}{found:>7}{doubtful:>7}{100 * f_inside / of:>8.0f}'
                  f'{100 * baseline_inside / of:>12.0f}', flush=True)


if __name__ == '__main__':
    sys.exit(main())
