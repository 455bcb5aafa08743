#!/usr/bin/env python3
# SPDX-FileCopyrightText: 2026 The Vernier authors
# SPDX-License-Identifier: Apache-2.0
"""Whether the covariance of narrow lenses is true of products of errors, not only of each.

    narrow_lens.py PROGRAM [--lenses 525,1500,3000,6000] [--models radial1,opencv4] [--sets 6] [--seed 1]

Corners of two cameras of 640 x 480 pixels, 9 x 6 corners of 25 mm, 0.2 px of white noise, 20 boards
at f / 1500 to f / 750 metres tilted by up to 40 degrees. Prints a line a lens and model: the field
of view, sets with exit code 0 and 3, the squared distance of calibrations solved again to what their
covariance expects (`check --trials`), that of each two sets (`diff`), and rows at the image's centre, px: the true error's rms,
the linear and the sampled standard deviation. Needs only the Python standard library.
"""
import argparse
import itertools
import json
import math
import pathlib
import random
import subprocess
import sys
import tempfile

from board_faults import COLUMNS, NOISE_PX, ROWS, SQUARE_M, rotation

WIDTH, HEIGHT = 640, 480
CENTRES = ((318.0, 241.0), (322.5, 238.0))
K1, BASELINE_M = -0.1, 0.12
TURN = (0.01, -0.02, 0.005)  # of the right camera, radians: small, about x, y and z


def right_of(x):
    """Of the left camera's frame; the turn to first order, orthogonalised by three rotations."""
    for axis, angle in enumerate(TURN):
        i, j = (axis + 1) % 3, (axis + 2) % 3
        c, s = math.cos(angle), math.sin(angle)
        x = list(x)
        x[i], x[j] = c * x[i] - s * x[j], s * x[i] + c * x[j]
    return x[0] - BASELINE_M, x[1] + 0.002, x[2] + 0.003


def pixel(f_px, camera, x):
    if camera == 1:
        x = right_of(x)
    u, v = x[0] / x[2], x[1] / x[2]
    d = 1 + K1 * (u * u + v * v)
    f_px *= 1 + 0.01 * camera
    return f_px * u * d + CENTRES[camera][0], f_px * v * d + CENTRES[camera][1]


def view(chance, f_px):
    half_x, half_y = SQUARE_M * (COLUMNS - 1) / 2, SQUARE_M * (ROWS - 1) / 2
    while True:
        R = rotation(chance.uniform(0, 0.7), chance.uniform(0, 2 * math.pi), chance.uniform(-math.pi, math.pi))
        z = f_px / 1500 * 2 ** chance.uniform(0, 1)
        t = (chance.uniform(-0.35, 0.35) * WIDTH * z / f_px + BASELINE_M / 2,
             chance.uniform(-0.35, 0.35) * HEIGHT * z / f_px, z)
        pixels = []
        for camera, row, col in itertools.product((0, 1), range(ROWS), range(COLUMNS)):
            X = (SQUARE_M * col - half_x, SQUARE_M * row - half_y, 0)
            x = [sum(a * b for a, b in zip(R[i], X)) + t[i] for i in range(3)]
            pixels.append((camera, row, col, *pixel(f_px, camera, x)))
        if all(2 < p[3] < WIDTH - 3 and 2 < p[4] < HEIGHT - 3 for p in pixels):
            return pixels


def corners(chance, f_px):
    lines = ['frame,camera,row,col,X,Y,Z,qx,qy']
    for frame in range(20):
        for camera, row, col, qx, qy in view(chance, f_px):
            lines.append(f'{frame},{camera},{row},{col},{SQUARE_M * col:.6f},{SQUARE_M * row:.6f},0,'
                         f'{qx + chance.gauss(0, NOISE_PX):.6f},{qy + chance.gauss(0, NOISE_PX):.6f}')
    return '\n'.join(lines) + '\n'


def ray(parameters, at):
    """Of a pixel, (x / z, y / z), by fixed-point iteration."""
    p = dict.fromkeys(('k1', 'k2', 'p1', 'p2'), 0.0) | parameters
    u = (at[0] - p['ox_px']) / (p['f_px'] * p['ax'])
    v = (at[1] - p['oy_px']) / p['f_px']
    x, y = u, v
    for _ in range(100):
        r2 = x * x + y * y
        d = 1 + p['k1'] * r2 + p['k2'] * r2 * r2
        x = (u - 2 * p['p1'] * x * y - p['p2'] * (r2 + 2 * x * x)) / d
        y = (v - p['p1'] * (r2 + 2 * y * y) - 2 * p['p2'] * x * y) / d
    return x, y, 1.0


def rotated(w, x):
    angle = math.sqrt(sum(c * c for c in w))
    if angle == 0:
        return x
    k = [c / angle for c in w]
    cross = (k[1] * x[2] - k[2] * x[1], k[2] * x[0] - k[0] * x[2], k[0] * x[1] - k[1] * x[0])
    dot = sum(a * b for a, b in zip(k, x))
    c, s = math.cos(angle), math.sin(angle)
    return [c * a + s * b + (1 - c) * dot * e for a, b, e in zip(x, cross, k)]


def row_error_px(rig, f_px):
    """How far the true right pixel of a point before the left camera is from its epipolar line."""
    left, right = rig['cameras']
    distance = f_px / 1000
    x = [distance * (WIDTH / 2 - CENTRES[0][0]) / f_px, distance * (HEIGHT / 2 - CENTRES[0][1]) / f_px, distance]
    a = rotated(right['from_first']['rotation_rad'], ray(left['parameters'], pixel(f_px, 0, x)))
    b = ray(right['parameters'], pixel(f_px, 1, x))
    t = right['from_first']['translation_m']
    n = (t[1] * a[2] - t[2] * a[1], t[2] * a[0] - t[0] * a[2], t[0] * a[1] - t[1] * a[0])
    return f_px * sum(p * q for p, q in zip(b, n)) / math.hypot(n[0], n[1])


def rms(values):
    return math.sqrt(sum(v * v for v in values) / max(1, len(values)))


def main():
    parser = argparse.ArgumentParser(description=__doc__.split('\n')[0])
    parser.add_argument('program')
    parser.add_argument('--lenses', default='525,1500,3000,6000', help='focal lengths, px')
    parser.add_argument('--models', default='radial1,opencv4')
    parser.add_argument('--sets', type=int, default=6)
    parser.add_argument('--trials', type=int, default=100, help='calibrations solved again, a set')
    parser.add_argument('--seed', type=int, default=1)
    options = parser.parse_args()
    program = str(pathlib.Path(options.program).resolve())
    print(f'{"view":>6}{"model":>9}{"exit 0":>8}{"3":>4}{"again":>8}{"diff":>7}'
          f'{"true row":>10}{"linear":>9}{"sampled":>9}')
    with tempfile.TemporaryDirectory() as name:
        folder = pathlib.Path(name)

        def run(*arguments):
            return subprocess.run([program, *arguments], cwd=folder, capture_output=True, text=True)

        for f_px, model in itertools.product(map(float, options.lenses.split(',')), options.models.split(',')):
            codes, again, true, linear, sampled = [], [], [], [], []
            for number in range(options.sets):
                chance = random.Random(f'{options.seed} {f_px} {number}')
                (folder / 'c.csv').write_text(corners(chance, f_px))
                file = f'{number}.json'
                codes.append(run('calibrate', '--observations', 'c.csv', '--size', f'{WIDTH}x{HEIGHT}', '--model',
                                 model, '--no-model-check', '-o', file).returncode)
                if codes[-1] not in (0, 3):
                    continue
                true.append(row_error_px(json.loads((folder / file).read_text()), f_px))
                check = run('check', file, '--no-mrcal', '--trials', str(options.trials), '--json')
                if check.stdout:  # else too few could be solved again
                    found = json.loads(check.stdout)['monte_carlo']
                    again.append(found['nees_mean'] / found['nees_expected'])
                rows = json.loads(run('uncertainty', file, '--distances-m', f'{f_px / 1000}', '--json').stdout)
                centre = rows['vertical_disparity'][0]['points'][0]
                linear.append(centre['sd_linear_px'])
                sampled.append(centre['sd_sampled_px'])
            pairs = []
            for a, b in itertools.combinations([n for n, code in enumerate(codes) if code in (0, 3)], 2):
                d = json.loads(run('diff', f'{a}.json', f'{b}.json', '--json').stdout)
                pairs.append(d['mahalanobis_squared'] / d['dof'])
            view = 2 * math.degrees(math.atan(WIDTH / 2 / f_px))
            print(f'{view:>5.0f}°{model:>9}{codes.count(0):>8}{codes.count(3):>4}{sum(again) / max(1, len(again)):>8.2f}'
                  f'{sum(pairs) / max(1, len(pairs)):>7.2f}{rms(true):>10.4f}{rms(linear):>9.4f}{rms(sampled):>9.4f}',
                  flush=True)


if __name__ == '__main__':
    sys.exit(main())
