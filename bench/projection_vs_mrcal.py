#!/usr/bin/python3
# SPDX-FileCopyrightText: 2026 The Vernier authors
# SPDX-License-Identifier: Apache-2.0
"""Compares the CPU time of projection uncertainty over a 60x45 grid with mrcal, in one run.

    bench/projection_vs_mrcal.py [--build build/release] [--frames 40]

Corners of a 10x10 board in --frames poses in front of a pair are simulated with mrcal's projection and
calibrated by Vernier. The solution is passed to mrcal.projection_uncertainty (Debian's python3-mrcal) as
its optimisation problem. Both times include everything from the corners and the solution to the
covariances of the grid, with linearisation and factorisation. Prints the largest relative difference of the
covariances and the ratio of the CPU times.
"""
import argparse
import json
import os
import pathlib
import subprocess
import sys
import tempfile
import time

try:
    import mrcal
    import numpy as np
except ImportError:
    sys.exit('projection_vs_mrcal.py: no mrcal here; install python3-mrcal, and run it with the '
             "system's Python")

SIGMA_PX = 0.2
SPACING_M = 0.05
BOARD = 10
SIZE = (640, 480)
GRID = (60, 45)


def synthetic(frames, seed=3):
    """Pixels, frames x cameras x BOARD x BOARD x 2, of boards fully visible in both cameras."""
    rng = np.random.default_rng(seed)
    intrinsics = np.array([[600, 602, 325, 236, -.2, .08, 4e-4, -3e-4],
                           [604, 603, 314, 246, -.22, .08, 4e-4, -3e-4]])
    rt_right_left = np.array([.012, -.035, .006, -.2, .002, .004])
    grid = np.zeros((BOARD, BOARD, 3))
    grid[..., :2] = SPACING_M * np.stack(np.meshgrid(np.arange(BOARD), np.arange(BOARD)), -1)
    centre = grid.mean((0, 1))
    pixels = []
    while len(pixels) < frames:
        r = rng.uniform(-.6, .6, 3)
        R = mrcal.R_from_r(r)
        t = np.array([.1, 0, 1.1]) + rng.uniform(-.3, .3, 3)
        points = (grid - centre) @ R.T + t
        seen = [mrcal.project(p, 'LENSMODEL_OPENCV4', i) for p, i in zip(
            (points, mrcal.transform_point_rt(rt_right_left, points)), intrinsics)]
        if all(((q > 5) & (q < np.array(SIZE) - 6)).all() for q in seen):
            pixels.append(np.stack(seen))
    pixels = np.array(pixels)
    return pixels + SIGMA_PX * rng.standard_normal(pixels.shape)


def write_observations(pixels, file):
    with open(file, 'w') as out:
        out.write('frame,camera,row,col,X,Y,Z,qx,qy\n')
        for (frame, camera, row, col) in np.ndindex(pixels.shape[:-1]):
            q = pixels[frame, camera, row, col]
            out.write(f'{frame},{camera},{row},{col},{col * SPACING_M!r},{row * SPACING_M!r},0,'
                      f'{float(q[0])!r},{float(q[1])!r}\n')


def optimization_inputs(rig, pixels):
    """The solution in the rig file as an mrcal problem."""
    def intrinsics(camera):
        p = camera['parameters']
        return [p['f_px'] * p['ax'], p['f_px'], p['ox_px'], p['oy_px'],
                p['k1'], p['k2'], p['p1'], p['p2']]

    def rt(pose):
        return pose['rotation_rad'] + pose['translation_m']

    frames = len(pixels)
    indices = np.array([(f, c, c - 1) for f in range(frames) for c in (0, 1)], dtype=np.int32)
    observations = np.ones((2 * frames, BOARD, BOARD, 3))
    observations[..., :2] = pixels.reshape(2 * frames, BOARD, BOARD, 2)
    return dict(
        intrinsics=np.array([intrinsics(c) for c in rig['cameras']]),
        extrinsics_rt_fromref=np.array([rt(rig['cameras'][1]['from_first'])]),
        frames_rt_toref=np.array([rt(p) for p in rig['evidence']['view_poses']]),
        points=None, observations_board=observations,
        indices_frame_camintrinsics_camextrinsics=indices, observations_point=None,
        indices_point_camintrinsics_camextrinsics=None, lensmodel='LENSMODEL_OPENCV4',
        imagersizes=np.array([SIZE, SIZE], dtype=np.int32), calobject_warp=None,
        calibration_object_spacing=SPACING_M, do_optimize_intrinsics_core=True,
        do_optimize_intrinsics_distortions=True, do_optimize_extrinsics=True,
        do_optimize_frames=True, do_optimize_calobject_warp=False, do_apply_regularization=False,
        do_apply_outlier_rejection=False, verbose=False)


def mrcal_grid(model, q, distance_m):
    ray = mrcal.unproject(q, *model.intrinsics(), normalize=True)
    infinite = np.isinf(distance_m)
    return mrcal.projection_uncertainty(ray if infinite else ray * distance_m, model,
                                        atinfinity=infinite, what='covariance',
                                        observed_pixel_uncertainty=SIGMA_PX)


def cpu_ms(function, repeats=5):
    best = float('inf')
    for _ in range(repeats):
        start = time.process_time()
        function()
        best = min(best, time.process_time() - start)
    return 1e3 * best


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument('--build', type=pathlib.Path, default=pathlib.Path('build/release'))
    parser.add_argument('--frames', type=int, default=40)
    options = parser.parse_args()
    with tempfile.TemporaryDirectory() as name:
        folder = pathlib.Path(name)
        pixels = synthetic(options.frames)
        write_observations(pixels, folder / 'observations.csv')
        vernier = options.build / 'vernier'
        subprocess.run([vernier, 'calibrate', '--observations', folder / 'observations.csv',
                        '--size', '640x480', '--model', 'opencv4', '--pixel-sigma', str(SIGMA_PX),
                        '-o', folder / 'rig.json', '-q'], check=True, stdout=subprocess.DEVNULL)
        ours = json.loads(subprocess.run(
            [vernier, 'uncertainty', folder / 'rig.json', '--distances-m', '1,inf', '--grid',
             f'{GRID[0]}x{GRID[1]}', '--covariance', 'mvb', '--samples', '2', '--json', '-q'],
            check=True, capture_output=True, text=True).stdout)
        rig = json.loads((folder / 'rig.json').read_text())
        model = mrcal.cameramodel(optimization_inputs=optimization_inputs(rig, pixels),
                                  icam_intrinsics=1)
        bench = json.loads(subprocess.run(
            [options.build / 'bench/uncertainty_bench', '--benchmark_filter=grid_from_evidence',
             '--benchmark_format=json'], check=True, capture_output=True, text=True,
            env=dict(os.environ, VERNIER_BENCH_RIG=str(folder / 'rig.json'))).stdout)
    ours_ms = {b['name'].split(':')[-1]: b['cpu_time'] for b in bench['benchmarks']}
    for label, distance_m in (('1', 1.), ('0', np.inf)):
        report = next(p for p in ours['projection']
                      if p['camera'] == rig['cameras'][1]['name'] and p['fixed_to'] == 'boards'
                      and p['distance_m'] == ('inf' if np.isinf(distance_m) else distance_m))
        covariance = np.array(report['grid']['covariance_px2'])
        q = np.stack(np.meshgrid(report['grid']['x_px'], report['grid']['y_px']), -1)
        theirs = mrcal_grid(model, q, distance_m)
        difference = (np.abs(covariance - theirs).max((-1, -2)) /
                      np.abs(theirs).max((-1, -2))).max()
        mrcal_ms = cpu_ms(lambda: mrcal_grid(model, q, distance_m))
        print(f'distance {distance_m} m: relative difference {difference:.1e}; CPU ms '
              f'vernier {ours_ms[label]:.2f}, mrcal {mrcal_ms:.1f}, '
              f'ratio 1/{mrcal_ms / ours_ms[label]:.0f}')


if __name__ == '__main__':
    main()
