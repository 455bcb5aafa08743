#!/usr/bin/env python3
# SPDX-FileCopyrightText: 2026 The Vernier authors
# SPDX-License-Identifier: Apache-2.0
"""How wrong images of a real set are named; the counterpart of wrong_calibrations for images.

    wrong_images.py PROGRAM LEFT RIGHT [BOARD] [MODEL]

LEFT and RIGHT are quoted patterns of a good set, BOARD is 9x6 by default. Each fault is put into
copies of the images; the exit code and the reason that the program gives are printed. Needs
Debian's python3-opencv.
"""
import glob
import pathlib
import random
import re
import subprocess
import sys
import tempfile

import cv2
import numpy

FAULTS = {}


def fault(name, words):
    def add(function):
        FAULTS[name] = words, function
        return function
    return add


def moved(image, matrix):
    height, width = image.shape[:2]
    return cv2.warpAffine(image, numpy.float64(matrix), (width, height),
                          flags=cv2.INTER_CUBIC, borderMode=cv2.BORDER_REPLICATE)


def shifted(image, x, y):
    return moved(image, [[1, 0, x], [0, 1, y]])


def zoomed(image, by):
    height, width = image.shape[:2]
    return moved(image, [[by, 0, (1 - by) * width / 2], [0, by, (1 - by) * height / 2]])


def jitter(size):
    def change(pairs):
        draw = random.Random(size)
        return [(a, shifted(b, draw.uniform(-size, size), draw.uniform(-size, size)))
                for a, b in pairs]
    return change


def from_half_on(change):
    return lambda pairs: [(a, change(b) if 2 * i >= len(pairs) else b)
                          for i, (a, b) in enumerate(pairs)]


def in_the_third(change):
    return lambda pairs: [change(p) if i == 2 else p for i, p in enumerate(pairs)]


TIME = 'not simultaneous|same pose|paired wrongly|moved relative'
CHANGE = 'changed|moved|lens'
fault('none', '^$')(lambda pairs: pairs)
for px in (1, 2, 4):
    fault(f'right images jittered by {px} px', TIME)(jitter(px))
fault('right lens zoomed by 2 % from half on', CHANGE)(from_half_on(lambda b: zoomed(b, 1.02)))
fault('right images moved by 8 px from half on', CHANGE)(from_half_on(lambda b: shifted(b, 8, 0)))
fault('right images half as large from half on', 'size')(
    from_half_on(lambda b: cv2.resize(b, None, fx=0.5, fy=0.5, interpolation=cv2.INTER_AREA)))
fault('right images paired one frame late', TIME)(
    lambda pairs: [(a, pairs[(i + 1) % len(pairs)][1]) for i, (a, _) in enumerate(pairs)])
fault('left and right swapped', 'exchanged|swapped')(lambda pairs: [(b, a) for a, b in pairs])
fault('one frame swapped', 'exchanged|swapped')(in_the_third(lambda p: (p[1], p[0])))
fault('every image mirrored', 'mirrored|exchanged')(
    lambda pairs: [(cv2.flip(a, 1), cv2.flip(b, 1)) for a, b in pairs])
fault('right images mirrored', 'mirrored')(lambda pairs: [(a, cv2.flip(b, 1)) for a, b in pairs])
fault('one image mirrored', 'mirrored|frame')(in_the_third(lambda p: (p[0], cv2.flip(p[1], 1))))
fault('one image upside down', 'half a turn|frame')(
    in_the_third(lambda p: (p[0], cv2.rotate(p[1], cv2.ROTATE_180))))
fault('one image given twice', 'same')(in_the_third(lambda p: (p[0], p[0])))


def number(path):
    return int(re.findall(r'\d+', pathlib.Path(path).stem)[-1])


def outcome(program, pairs, board, model):
    with tempfile.TemporaryDirectory() as folder:
        for i, pair in enumerate(pairs):
            for side, image in zip(('left', 'right'), pair):
                cv2.imwrite(f'{folder}/{side}{i:02d}.png', image)
        done = subprocess.run(
            [program, 'calibrate', '-q', '--left', f'{folder}/left*.png', '--right',
             f'{folder}/right*.png', '--board', board, '--square-m', '0.025', '--model', model,
             '--no-model-check', '--json', '-o', f'{folder}/rig.json'],
            capture_output=True, text=True)
        said = done.stderr.replace(folder + '/', '').replace('vernier: ', '').strip()
        return done.returncode, said


def main(program, left, right, board='9x6', model='opencv5'):
    files = zip(sorted(glob.glob(left), key=number), sorted(glob.glob(right), key=number))
    pairs = [tuple(cv2.imread(f, cv2.IMREAD_GRAYSCALE) for f in pair) for pair in files]
    for name, (words, change) in FAULTS.items():
        code, said = outcome(program, change(pairs), board, model)
        named = 'named' if re.search(words, said) else 'otherwise' if code else 'silent'
        print(f'{name:<42} {code} {"good" if name == "none" and not code else named:<9} {said[:110]}',
              flush=True)


if __name__ == '__main__':
    main(*sys.argv[1:])
