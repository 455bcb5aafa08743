#!/usr/bin/env python3
# SPDX-FileCopyrightText: 2026 The Vernier authors
# SPDX-License-Identifier: Apache-2.0
"""Whether the covariance of odometry's steps is true on rendered images, and whether wrong steps are told.

    odometry_trials.py PROGRAM rendered [--seed 441] [--worlds 3] [--steps 24]
    odometry_trials.py PROGRAM gaps DATA [--gaps 18,22,25,28] [--starts 0,3,5,8,10]

`rendered`: drives along the longest leg of made offices, rendered with exact truth, as they are and spoilt (JPEG
of quality 60 and 15, blurred by 15 px along rows, at 5 % of the brightness). Prints squared errors of
the steps in units of their covariance (6 if it is true) and the share inside the 95 % region.
`gaps`: single steps between frames of KITTI's drive (DATA/sequences/drive) that are far apart; the truth
is off by far less than a metre. Prints how many of each exit code are wrong by more than 5 m.
Needs OpenCV's Python module for `rendered`.
"""
import argparse
import json
import math
import pathlib
import subprocess
import tempfile
import tomllib


def odometry(program, folder, rig, *words):
    """(exit code, result) of the images left*, right* in a folder."""
    run = subprocess.run([program, 'odometry', '--left', f'{folder}/left*', '--right', f'{folder}/right*', '--rig', rig,
                          '--truth', f'{folder}/truth.txt', '--json', '-q', *words], capture_output=True, text=True)
    return run.returncode, json.loads(run.stdout) if run.stdout else {}


def poses_along(world, steps):
    """x, y and heading of views every 0.15 m along the longest leg, whose heading swings by a degree."""
    legs = [leg['points_m'] for leg in tomllib.loads(world.read_text())['route']]
    a, b = max((leg[:2] for leg in legs), key=lambda leg: math.dist(*leg))
    heading = math.atan2(b[1] - a[1], b[0] - a[0])
    step = min(0.15, (math.dist(a, b) - 1) / steps)
    return [(a[0] + step * i * math.cos(heading), a[1] + step * i * math.sin(heading),
             math.degrees(heading) + math.sin(0.7 * i)) for i in range(steps + 1)]


def tum(poses, height_m=1.2):
    """Of a level camera: x right, y down, z forward; world z up."""
    lines = []
    for i, (x, y, heading_deg) in enumerate(poses):
        half = math.radians(heading_deg - 90) / 2  # a camera that looks along world y, turned
        c, s, r = math.cos(half), math.sin(half), math.sqrt(0.5)
        lines.append(f'{i} {x:.9f} {y:.9f} {height_m} {-c * r:.12f} {-s * r:.12f} {s * r:.12f} {c * r:.12f}')
    return '\n'.join(lines) + '\n'


def spoilt():
    import cv2
    import numpy
    noise = numpy.random.default_rng(1)
    return {'as rendered': ('.png', [], lambda image: image),
            'JPEG 60': ('.jpg', [cv2.IMWRITE_JPEG_QUALITY, 60], lambda image: image),
            'JPEG 15': ('.jpg', [cv2.IMWRITE_JPEG_QUALITY, 15], lambda image: image),
            'blurred by 15 px': ('.png', [], lambda image: cv2.blur(image, (15, 1))),
            '5 % bright': ('.png', [], lambda image: numpy.clip(
                0.05 * image + noise.normal(0, 0.5, image.shape), 0, 255).astype(numpy.uint8))}


def rendered(options):
    import cv2
    for seed in range(options.seed, options.seed + options.worlds):
        with tempfile.TemporaryDirectory() as name:
            folder = pathlib.Path(name)
            world = folder / 'made.world.toml'
            quiet = {'check': True, 'stdout': subprocess.DEVNULL}
            subprocess.run([options.program, 'world', 'make', '--seed', str(seed), '-q', '-o', world], **quiet)
            poses = [tuple(round(v, 5) for v in pose) for pose in poses_along(world, options.steps)]
            views = [word for pose in poses for word in ('--pose', ','.join(map(str, pose)))]
            subprocess.run([options.program, 'render', '--world', world, '--samples', '2', '--threads', '2', '--seed',
                            str(seed), '-o', folder / 'views', '-q', *views], **quiet)
            for what, (ending, how, change) in spoilt().items():
                images = folder / what.replace(' ', '_').replace('%', 'percent')
                images.mkdir()
                (images / 'truth.txt').write_text(tum(poses))
                for i in range(len(poses)):
                    for side in ('left', 'right'):
                        image = cv2.imread(str(folder / 'views' / f'{i:03d}' / f'{side}.png'), cv2.IMREAD_GRAYSCALE)
                        cv2.imwrite(str(images / f'{side}{i:03d}{ending}'), change(image), how)
                code, found = odometry(options.program, images, 'nominal', '--segment-m', '1')
                truth = found.get('truth') or {}
                if 'nees_mean' in truth:
                    print(f'{seed} {what:18s} exit {code}: {found["found"]} of {found["steps"]} steps, '
                          f'{found["inliers_per_step"]:.0f} inliers, mean {truth["nees_mean"]:.1f}, median '
                          f'{truth["nees_median"]:.1f}, {100 * truth["nees_inside_95"]:.0f} % inside', flush=True)
                else:
                    print(f'{seed} {what:18s} exit {code}: no step', flush=True)


def gaps(options):
    drive = pathlib.Path(options.data) / 'sequences' / 'drive'
    true = (drive / 'poses.txt').read_text().splitlines()
    numbers = [list(map(float, line.split())) for line in (drive / 'calib.txt').read_text().splitlines()]
    left, right = numbers[0], numbers[1]

    def camera(name, **more):
        values = {'f_px': left[0], 'ax': 1, 'ox_px': left[2], 'oy_px': right[6]}
        return {'name': name, 'model': 'pinhole', 'size_px': [1226, 370], 'parameters': values, **more}

    images = {side: sorted((drive / f'image_{side[0]}').iterdir()) for side in ('left', 'right')}
    counts = {}
    with tempfile.TemporaryDirectory() as name:
        rig = pathlib.Path(name) / 'kitti.rig.json'
        rig.write_text(json.dumps({'format': 'vernier/rig', 'version': 1, 'cameras': [
            camera('left'), camera('right', from_first={'rotation_rad': [0, 0, 0],
                                                        'translation_m': [right[3] / right[0], 0, 0]})]}))
        for gap in map(int, options.gaps.split(',')):
            for start in map(int, options.starts.split(',')):
                if start + gap >= len(true):
                    continue
                folder = pathlib.Path(name) / f'{gap}_{start}'
                folder.mkdir()
                for i, frame in enumerate((start, start + gap)):
                    for side, files in images.items():
                        (folder / f'{side}{i}.png').symlink_to(files[frame].resolve())
                (folder / 'truth.txt').write_text(f'{true[start]}\n{true[start + gap]}\n')
                code, found = odometry(options.program, folder, rig)
                error_m = (found.get('truth') or {}).get('end_error_m', math.inf) if found.get('found') else math.inf
                key = (code, 'not found' if math.isinf(error_m) else 'off by 5 m' if error_m > 5 else 'right')
                counts[key] = counts.get(key, 0) + 1
                print(f'gap {gap} from {start}: exit {code}, {found.get("inliers_per_step", 0):.0f} inliers, {error_m:.2f} m',
                      flush=True)
    for (code, what), count in sorted(counts.items()):
        print(f'exit {code}, {what}: {count}')


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument('program')
    parser.add_argument('trial', choices=('rendered', 'gaps'))
    parser.add_argument('data', nargs='?')
    parser.add_argument('--seed', type=int, default=441)
    parser.add_argument('--worlds', type=int, default=3)
    parser.add_argument('--steps', type=int, default=24)
    parser.add_argument('--gaps', default='18,22,25,28')
    parser.add_argument('--starts', default='0,3,5,8,10')
    options = parser.parse_args()
    rendered(options) if options.trial == 'rendered' else gaps(options)


if __name__ == '__main__':
    main()
