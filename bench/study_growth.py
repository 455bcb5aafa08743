#!/usr/bin/env python3
# SPDX-FileCopyrightText: 2026 The Vernier authors
# SPDX-License-Identifier: Apache-2.0
"""How time and memory of a study of one trial grow with the world: the shipped workshop repeated
K times side by side, each with its route, so that every place has K - 1 others that look the same.

    study_growth.py PROGRAM [K…]
"""
import os
import pathlib
import subprocess
import sys
import tempfile
import time
import tomllib

ROOT = pathlib.Path(__file__).resolve().parents[1]


def repeated(world, times):
    """The text of a world of `times` copies, in rows of ten, 25 m apart."""
    text = ['format = "vernier/world"\nversion = 1\n']
    for entry in world['template'] + [dict(world['loose'], name='loose features')]:
        text.append(f'[[template]]\nname = "{entry["name"]}"\n')
        text += [f'{key} = {entry[key]}\n' for key in ('segments', 'surfaces', 'corners')
                 if entry.get(key)]
    for k in range(times):
        x, y = 25 * (k % 10), 25 * (k // 10)
        for instance in world['instance'] + [{'template': 'loose features', 'at_m': [0, 0, 0]}]:
            at = instance['at_m']
            text.append(f'[[instance]]\ntemplate = "{instance["template"]}"\n'
                        f'at_m = [{at[0] + x}, {at[1] + y}, {at[2]}]\n'
                        f'yaw_deg = {float(instance.get("yaw_deg", 0))}\n')
    for leg in world['route']:
        text.append(f'[[route]]\npoints_m = {leg["points_m"]}\n')
    return ''.join(text)


def measured(command, folder):
    start = time.time()
    child = subprocess.Popen(command, cwd=folder, stdout=subprocess.PIPE, stderr=subprocess.STDOUT)
    said = child.stdout.read().decode()
    _, status, used = os.wait4(child.pid, 0)
    if status != 0:
        sys.exit(f'{" ".join(command)}: {said}')
    return used.ru_utime + used.ru_stime, time.time() - start, used.ru_maxrss / 1024, said


def main(program, counts):
    with open(ROOT / 'datasets/worlds/workshop.world.toml', 'rb') as file:
        world = tomllib.load(file)
    program = str(pathlib.Path(program).resolve())
    print(' copies  segments  info CPU s   MB  study CPU s  wall s   MB')
    for times in counts:
        with tempfile.TemporaryDirectory() as name:
            folder = pathlib.Path(name)
            (folder / 'large.world.toml').write_text(repeated(world, times))
            (folder / 's.toml').write_text(
                '[study]\ntrials = 1\n[world]\nfile = "large.world.toml"\n')
            info = measured([program, 'world', 'info', 'large.world.toml'], folder)
            study = measured([program, 'study', 's.toml', '-o', 'out'], folder)
            segments = int(info[3].split(' segments')[0].split()[-1])
            print(f'{times:7} {segments:9} {info[0]:11.2f} {info[2]:4.0f} {study[0]:12.2f} '
                  f'{study[1]:7.2f} {study[2]:4.0f}', flush=True)


if __name__ == '__main__':
    if len(sys.argv) < 2:
        sys.exit(__doc__)
    main(sys.argv[1], [int(k) for k in sys.argv[2:]] or [1, 3, 10, 30, 100])
