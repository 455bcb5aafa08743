#!/usr/bin/env python3
# SPDX-FileCopyrightText: 2026 The Vernier authors
# SPDX-License-Identifier: Apache-2.0
"""How often wrong matches of a scene are named, and good ones accused; the counterpart of
wrong_calibrations for `calibrate --pairs`.

    wrong_pairs.py PROGRAM [--good A-B] [--faulty A-B]

For every seed a rig is drawn from a prior, and with it eight pairs of images of scenes of 1.5 to 30 m,
80 matches each with a noise of 0.2 px. Each fault is put into such sets. Named: refused, or a doubt
(exit code 3), whose words are those for this fault; other way: other words; warned: accepted with a
line on standard error; silent: accepted. Good sets are accused where they are not accepted, and the
share of them whose stated covariance holds the true rig (95 %) is printed beside. Needs Debian's
python3-numpy and python3-scipy.
"""
import argparse
import collections
import json
import pathlib
import re
import subprocess
import sys
import tempfile

import numpy as np
from scipy import stats

SIZE = np.array([640, 480])
NOISE_PX = 0.2
IMAGES, MATCHES = 8, 80
CAMERA = {'f_px': (500, 5), 'ax': (1, 0.002), 'ox_px': (320, 3), 'oy_px': (240, 3)}
RIGHT = {'wx_rad': (0, 0.01), 'wy_rad': (0, 0.01), 'wz_rad': (0, 0.01),
         'tx_m': (-0.2, 0.0005), 'ty_m': (0, 0.003), 'tz_m': (0, 0.003)}
PRIOR = {**{f'left.{k}': v for k, v in CAMERA.items()}, **{f'right.{k}': v for k, v in CAMERA.items()},
         **{f'right.{k}': v for k, v in RIGHT.items()}}


def prior_file(path):
    camera = {'model': 'pinhole', 'size_px': SIZE.tolist(),
              'parameters': {**{k: v[0] for k, v in CAMERA.items()}, 'ay': 1}}
    right = {'rotation_rad': [0, 0, 0], 'translation_m': [-0.2, 0, 0]}
    path.write_text(json.dumps({
        'format': 'vernier/rig', 'version': 1,
        'cameras': [{'name': 'left', **camera}, {'name': 'right', **camera, 'from_first': right}],
        'parameter_names': list(PRIOR), 'parameters': [v[0] for v in PRIOR.values()],
        'covariance': {'kind': 'prior', 'matrix': np.diag([v[1] ** 2 for v in PRIOR.values()]).tolist()}}))


def turn(w):
    angle = np.linalg.norm(w)
    if angle == 0:
        return np.eye(3)
    x, y, z = w / angle
    K = np.array([[0, -z, y], [z, 0, -x], [-y, x, 0]])
    return np.eye(3) + np.sin(angle) * K + (1 - np.cos(angle)) * K @ K


def projected(rig, side, points):
    f, ax, ox, oy = (rig[f'{side}.{k}'] for k in CAMERA)
    if side == 'right':
        R = turn(np.array([rig[f'right.{k}'] for k in ('wx_rad', 'wy_rad', 'wz_rad')]))
        points = points @ R.T + [rig[f'right.{k}'] for k in ('tx_m', 'ty_m', 'tz_m')]
    return np.stack([ox + f * ax * points[:, 0] / points[:, 2], oy + f * points[:, 1] / points[:, 2]], 1)


def true_rig(draw):
    return {k: draw.normal(*v) for k, v in PRIOR.items()}


def seen(draw, rig_of):
    """A list of matches (u, v, u, v) an image pair; rig_of(i) is the rig of pair i."""
    pairs = []
    for i in range(IMAGES):
        rig = rig_of(i)
        z = 1 / draw.uniform(1 / 30, 1 / 1.5, 20 * MATCHES)
        points = np.stack([draw.uniform(-0.7, 0.7, z.size) * z, draw.uniform(-0.5, 0.5, z.size) * z, z], 1)
        both = np.hstack([projected(rig, side, points) for side in ('left', 'right')])
        inside = np.all((both > 1) & (both < np.tile(SIZE - 2, 2)), axis=1)
        pairs.append((both + draw.normal(0, NOISE_PX, both.shape))[inside][:MATCHES])
    return pairs


# What is said of good sets too.
USUAL = 'the result is dominated by what is known beside the pairs'
FAULTS = []


def fault(name, words, *sizes):
    def add(function):
        FAULTS.extend((name, words, size, function) for size in sizes)
        return function
    return add


SIDES = 'swapped|exchanged'
CHANGE = ('the rig changed after image pair|the rig is not the same in all image pairs|'
          'most matches of image pair')
OTHER_RIG = 'inconsistent'


def from_half_on(rig, **change):
    """rig_of with parameters multiplied (f, tx) or moved from half of the pairs on."""
    other = dict(rig)
    for name, by in change.items():
        other[name.replace('__', '.')] += by
    return lambda i: other if 2 * i >= IMAGES else rig


@fault('every pair swapped', SIDES, '')
def every_pair_swapped(draw, rig, size):
    return [p[:, [2, 3, 0, 1]] for p in seen(draw, lambda i: rig)]


@fault('some pairs swapped', SIDES, '1 of 8', '3 of 8')
def some_pairs_swapped(draw, rig, size):
    swapped = draw.permutation(IMAGES)[:int(size[0])]
    return [p[:, [2, 3, 0, 1]] if i in swapped else p for i, p in enumerate(seen(draw, lambda i: rig))]


@fault('right images jittered', CHANGE, '0.5 px', '1 px', '2 px', '4 px')
def jittered(draw, rig, size):
    most = float(size.split()[0])
    moved = [p + np.r_[0, 0, draw.uniform(-most, most, 2)] for p in seen(draw, lambda i: rig)]
    return [p[np.all((p > 0) & (p < np.tile(SIZE - 1, 2)), axis=1)] for p in moved]


@fault('rig moves between left and right', CHANGE, '0.2 mrad, 1 mm', '1 mrad, 5 mm', '5 mrad, 25 mm')
def moves(draw, rig, size):
    mrad, mm = (float(word.split()[0]) for word in size.split(', '))

    def other(i):
        moved = dict(rig)
        for k in ('wx_rad', 'wy_rad', 'wz_rad'):
            moved[f'right.{k}'] += draw.normal(0, 1e-3 * mrad)
        for k in ('tx_m', 'ty_m', 'tz_m'):
            moved[f'right.{k}'] += draw.normal(0, 1e-3 * mm)
        return moved
    return seen(draw, other)


@fault('two rigs mixed (f and baseline)', CHANGE, '0.5 %', '2 %', '10 %')
def two_rigs(draw, rig, size):
    by = 0.01 * float(size.split()[0])
    return seen(draw, from_half_on(rig, left__f_px=by * rig['left.f_px'], right__f_px=by * rig['right.f_px'],
                                   right__tx_m=by * rig['right.tx_m']))


@fault('right lens zoomed from half on', CHANGE, '0.2 %', '0.5 %', '2 %', '5 %')
def zoomed(draw, rig, size):
    return seen(draw, from_half_on(rig, right__f_px=0.01 * float(size.split()[0]) * rig['right.f_px']))


@fault('right camera turned from half on', CHANGE, '0.2 mrad', '1 mrad', '5 mrad')
def turned(draw, rig, size):
    w = draw.normal(size=3)
    w *= 1e-3 * float(size.split()[0]) / np.linalg.norm(w)
    return seen(draw, from_half_on(rig, right__wx_rad=w[0], right__wy_rad=w[1], right__wz_rad=w[2]))


@fault('right camera knocked before the last pairs', CHANGE, '1 of 8, 20 mrad', '2 of 8, 20 mrad')
def knocked(draw, rig, size):
    w = draw.normal(size=3)
    w *= 0.02 / np.linalg.norm(w)
    other = dict(rig)
    for k, by in zip(('wx_rad', 'wy_rad', 'wz_rad'), w):
        other[f'right.{k}'] += by
    return seen(draw, lambda i: other if i >= IMAGES - int(size[0]) else rig)


@fault('right images cropped by a border', OTHER_RIG + '|outside', '5 % of width', '15 % of width')
def cropped(draw, rig, size):
    by = 0.01 * float(size.split()[0]) * SIZE[0]
    return [p - [0, 0, by, by] for p in seen(draw, lambda i: rig)]


@fault('right images halved', OTHER_RIG + '|outside', '')
def halved(draw, rig, size):
    return [p * [1, 1, 0.5, 0.5] for p in seen(draw, lambda i: rig)]


@fault('right images mirrored', 'mirror|' + SIDES, '')
def mirrored(draw, rig, size):
    return [p * [1, 1, -1, 1] + [0, 0, SIZE[0] - 1, 0] for p in seen(draw, lambda i: rig)]


@fault('a rig that is not the prior\'s', OTHER_RIG, '4 sd', '8 sd', '30 sd')
def other_rig(draw, rig, size):
    by = draw.normal(size=len(PRIOR))
    by *= float(size.split()[0]) / np.abs(by).max()
    return seen(draw, lambda i: {k: v[0] + b * v[1] for (k, v), b in zip(PRIOR.items(), by)})


@fault('noise said to be smaller than it is', 'times their stated noise', '1.5 times', '3 times', '10 times')
def quiet(draw, rig, size):
    return seen(draw, lambda i: rig), NOISE_PX / float(size.split()[0])


def calibrated(program, folder, pairs, sigma=NOISE_PX):
    lines = ['pair,u_left_px,v_left_px,u_right_px,v_right_px,sigma_px']
    lines += [','.join(map(repr, [i, *map(float, match), sigma])) for i, p in enumerate(pairs) for match in p]
    (folder / 'pairs.csv').write_text('\n'.join(lines) + '\n')
    return subprocess.run([program, 'calibrate', '--pairs', folder / 'pairs.csv', '--prior', folder / 'prior.json',
                           '-o', folder / 'rig.json'], capture_output=True, text=True)


def holds_truth(path, rig):
    """Whether the stated covariance holds the true rig at 95 %."""
    found = json.loads(path.read_text())
    error = np.array(found['parameters']) - [rig[k] for k in found['parameter_names']]
    C = np.array(found['covariance']['matrix'])
    sd = np.sqrt(np.diag(C))
    free = sd > 0
    error, C = error[free] / sd[free], C[np.ix_(free, free)] / np.outer(sd[free], sd[free])
    return error @ np.linalg.solve(C, error) < stats.chi2.ppf(0.95, free.sum())


def seeds(text):
    first, last = map(int, text.split('-'))
    return range(first, last + 1)


def share(count, of):
    if of == 0:
        return 'none'
    interval = stats.binomtest(count, of).proportion_ci(0.95)
    return f'{count} of {of}, {100 * count / of:.1f} % ({100 * interval.low:.1f} to {100 * interval.high:.1f} %)'


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument('program', type=pathlib.Path)
    parser.add_argument('--good', type=seeds, default=seeds('1-200'))
    parser.add_argument('--faulty', type=seeds, default=seeds('1-30'))
    given = parser.parse_args()
    program = given.program.resolve()
    words_of = collections.Counter()
    with tempfile.TemporaryDirectory() as name:
        folder = pathlib.Path(name)
        prior_file(folder / 'prior.json')
        accused = held = 0
        for seed in given.good:
            draw = np.random.default_rng([seed, 1])
            rig = true_rig(draw)
            done = calibrated(program, folder, seen(draw, lambda i: rig))
            if done.returncode != 0:
                accused += 1
                words_of['good: ' + done.stderr.strip()[:160]] += 1
            else:
                held += holds_truth(folder / 'rig.json', rig)
        print('good sets accused:', share(accused, len(given.good)))
        print('true rig inside the stated 95 %:', share(held, len(given.good) - accused))
        print(f'{"fault":<44}{"size":>16}{"sets":>6}{"named %":>9}{"other way %":>13}{"warned %":>10}'
              f'{"silent %":>10}')
        for number, (what, words, size, change) in enumerate(FAULTS):
            counts = collections.Counter()
            for seed in given.faulty:
                draw = np.random.default_rng([seed, 2, number])
                pairs = change(draw, true_rig(draw), size)
                done = calibrated(program, folder, *(pairs if isinstance(pairs, tuple) else (pairs,)))
                if done.returncode not in (0, 2, 3):
                    sys.exit(f'{what} {size}, seed {seed}: exit code {done.returncode}: {done.stderr}')
                lines = done.stderr.replace(name, '').replace('prior.json', '').splitlines()
                said = [line for line in lines if USUAL not in line]
                if done.returncode:  # the lines that it stands for, not further warnings
                    reasons = [line for line in said if line.startswith('vernier: ')]
                    kind = 'named' if any(re.search(words, line) for line in reasons) else 'other'
                else:
                    kind = 'warned' if said else 'silent'
                counts[kind] += 1
                if kind == 'other':
                    words_of[f'{what} {size}: ' + done.stderr.strip()[:160].replace(name, '')] += 1
            print(f'{what:<44}{size:>16}{len(given.faulty):>6}' +
                  ''.join(f'{100 * counts[k] / len(given.faulty):>{w}.0f}'
                          for k, w in (('named', 9), ('other', 13), ('warned', 10), ('silent', 10))), flush=True)
    for words, count in words_of.most_common(12):
        print(f'{count:>4} {words}')


if __name__ == '__main__':
    main()
