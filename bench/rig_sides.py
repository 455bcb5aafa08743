#!/usr/bin/env python3
# SPDX-FileCopyrightText: 2026 The Vernier authors
# SPDX-License-Identifier: Apache-2.0
"""How often robots are localised by rigs that are not two like cameras side by side.

    rig_sides.py PROGRAM [--seed 431] [--worlds 4] [--trials 200] [--method lines] [--threads 2]

Offices of consecutive seeds, and their mirror images. A mirrored rig in a mirrored building sees mirrored images, so
it must succeed as often as the rig in the building: a method that takes the right camera to be on the right does not.
The other rigs have a right camera of equal value in another place or position. All sources of error act but that
of the calibration, since the rigs are made up. Prints success in % and its 95 % interval, which
resamples worlds and their trials.
"""
import argparse
import csv
import json
import math
import pathlib
import random
import subprocess
import tempfile
import tomllib


def camera(name, size=(480, 480), f_px=420.0, roll_deg=0.0, yaw_deg=0.0, centre_m=None):
    """A pinhole camera at `centre_m` in the left one's frame, first turned about y, then about its axis."""
    one = {'name': name, 'model': 'pinhole', 'size_px': list(size),
           'parameters': {'f_px': f_px, 'ax': 1.0, 'ox_px': (size[0] - 1) / 2, 'oy_px': (size[1] - 1) / 2}}
    if centre_m is not None:
        # R = roll(-a) yaw(-b): a point of the left frame to this camera's frame
        a, b = math.radians(roll_deg) / 2, math.radians(yaw_deg) / 2
        w, x, y, z = math.cos(a) * math.cos(b), -math.sin(a) * math.sin(b), -math.cos(a) * math.sin(b), \
            -math.sin(a) * math.cos(b)
        length = math.sqrt(x * x + y * y + z * z)
        angle = 2 * math.atan2(length, w)
        axis = (x / length, y / length, z / length) if length > 0 else (0, 0, 0)
        turned = rotated(axis, angle, centre_m)
        one['from_first'] = {'rotation_rad': [angle * c for c in axis], 'translation_m': [-c for c in turned]}
    return one


def rotated(axis, angle, v):
    """Rodrigues' formula."""
    dot = sum(k * c for k, c in zip(axis, v))
    cross = (axis[1] * v[2] - axis[2] * v[1], axis[2] * v[0] - axis[0] * v[2], axis[0] * v[1] - axis[1] * v[0])
    return [c * math.cos(angle) + s * math.sin(angle) + k * dot * (1 - math.cos(angle))
            for c, s, k in zip(v, cross, axis)]


def rigs():
    """(name, is it in the mirrored building, cameras)"""
    left = camera('left')
    return [('side by side', False, [left, camera('right', centre_m=(0.2, 0, 0))]),
            ('its mirror image, in the mirrored building', True, [left, camera('right', centre_m=(-0.2, 0, 0))]),
            ('right camera below', False, [left, camera('right', centre_m=(0, 0.2, 0))]),
            ('right camera above', False, [left, camera('right', centre_m=(0, -0.2, 0))]),
            ('baseline tilted by 45 deg', False, [left, camera('right', centre_m=(0.1414, 0.1414, 0))]),
            ('right camera rolled by 90 deg', False, [left, camera('right', roll_deg=90, centre_m=(0.2, 0, 0))]),
            ('right camera upside down', False, [left, camera('right', roll_deg=180, centre_m=(0.2, 0, 0))]),
            ('verged by 10 deg', False, [left, camera('right', yaw_deg=-10, centre_m=(0.2, 0, 0))]),
            ('right camera of twice the pixels', False,
             [left, camera('right', size=(960, 960), f_px=840.0, centre_m=(0.2, 0, 0))])]


def mirrored(world):
    """The text of a world file with y negated."""
    def point(p):
        return [p[0], -p[1], *p[2:]]

    def segment(s):
        return point(s[:3]) + point(s[3:])

    def shape(table):
        lines = [f'name = {json.dumps(table["name"])}'] if 'name' in table else []
        for key, change in (('segments', segment), ('corners', point)):
            if key in table:
                lines.append(f'{key} = {json.dumps([change(one) for one in table[key]])}')
        if 'surfaces' in table:
            lines.append(f'surfaces = {json.dumps([[point(p) for p in s] for s in table["surfaces"]])}')
        return lines

    lines = ['format = "vernier/world"', 'version = 1', f'name = {json.dumps(world["name"] + "-mirrored")}']
    for template in world.get('template', []):
        lines += ['[[template]]', *shape(template)]
    for instance in world.get('instance', []):
        lines += ['[[instance]]', f'template = {json.dumps(instance["template"])}',
                  f'at_m = {json.dumps(point(instance["at_m"]))}', f'yaw_deg = {-instance.get("yaw_deg", 0)}']
    if 'loose' in world:
        lines += ['[loose]', *shape(world['loose'])]
    for leg in world['route']:
        lines += ['[[route]]', f'points_m = {json.dumps([point(p) for p in leg["points_m"]])}']
    return '\n'.join(lines) + '\n'


def make_world(program, seed, folder):
    """Both files of a seed: the office, and its mirror image."""
    file, other = folder / f'{seed}.world.toml', folder / f'{seed}m.world.toml'
    subprocess.run([program, 'world', 'make', '--seed', str(seed), '-q', '-o', file], check=True,
                   stdout=subprocess.DEVNULL)
    other.write_text(mirrored(tomllib.loads(file.read_text())))
    return file, other


def outcomes(program, folder, world, rig, options):
    """1 for each query whose pose was right, else 0."""
    study, results = folder / 'study.toml', folder / 'results.csv'
    study.write_text(f'[study]\nseed = 5\ntrials = {options.trials}\n[world]\nfile = "{world}"\n[rig]\nfile = "{rig}"\n'
                     f'[localiser]\nmethod = "{options.method}"\n[sources]\ncalibration = 0\n')
    store = tempfile.mkdtemp(dir=folder)
    subprocess.run([program, 'study', study, '-o', store, '--threads', str(options.threads), '-q'], check=True,
                   stdout=subprocess.DEVNULL)
    subprocess.run([program, 'export', store, '--trials', '-o', results, '-q'], check=True, stdout=subprocess.DEVNULL)
    with results.open() as file:
        return [int(row['success'] == 'true') for row in csv.DictReader(file)]


def interval(by_world):
    chance, shares = random.Random(1), []
    for _ in range(2000):
        right = total = 0
        for _ in by_world:
            one = chance.choice(by_world)
            right += sum(chance.choices(one, k=len(one)))
            total += len(one)
        shares.append(100 * right / total)
    shares.sort()
    return shares[50], shares[1949]


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument('program')
    parser.add_argument('--seed', type=int, default=431)
    parser.add_argument('--worlds', type=int, default=4)
    parser.add_argument('--trials', type=int, default=200)
    parser.add_argument('--method', default='lines')
    parser.add_argument('--threads', type=int, default=2)
    options = parser.parse_args()
    with tempfile.TemporaryDirectory() as name:
        folder = pathlib.Path(name)
        seeds = range(options.seed, options.seed + options.worlds)
        worlds = [make_world(options.program, seed, folder) for seed in seeds]
        for name, is_mirrored, cameras in rigs():
            rig = folder / 'made.rig.json'
            rig.write_text(json.dumps({'format': 'vernier/rig', 'version': 1, 'cameras': cameras}))
            by_world = [outcomes(options.program, folder, pair[is_mirrored], rig, options) for pair in worlds]
            share = 100 * sum(map(sum, by_world)) / sum(map(len, by_world))
            low, high = interval(by_world)
            print(f'{name:44s} {share:5.1f} [{low:.1f}, {high:.1f}]', flush=True)


if __name__ == '__main__':
    main()
