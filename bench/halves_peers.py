#!/usr/bin/python3
# SPDX-FileCopyrightText: 2026 The Vernier authors
# SPDX-License-Identifier: Apache-2.0
"""How far calibrations of two halves of the same views differ: Vernier, mrcal and OpenCV.

    bench/halves_peers.py PROGRAM RIG.json [--splits 30] [--seed 1]

RIG.json is a stereo calibration of a flat grid with lens model opencv4 and stored corners (`vernier calibrate`
without --no-evidence). Each split deals the frames that both cameras see whole into two halves. Every tool
calibrates both, all with the same model and the same corners:

  vernier            `vernier calibrate --no-effects`
  warp               `vernier calibrate --warp`
  shape and motion   `vernier calibrate --board-shape --motion`
  mrcal              mrcal.optimize with the settings of mrcal-calibrate-cameras: board warp, outlier
                     rejection, regularisation (a weak prior: centre in the middle, no distortion)
  mrcal, no prior    the same without regularisation
  opencv             calibrateCamera for each eye, then stereoCalibrate from there, everything free

Vernier and OpenCV begin from nothing, mrcal at RIG.json and its boards' poses. Halves that Vernier doubts
count, and are told.

The difference of a parameter is measured in standard deviations that RIG.json states for it. Prints the root
mean square over splits and parameters, also of intrinsics and of the other camera's pose alone, and each
divided by Vernier's. Halves say how much what is estimated scatters; an error that all views share is not
seen, nor the bias of a prior that both halves have. mrcal and OpenCV 4.6 run in this process
(python3-mrcal, python3-opencv).
"""
import argparse
import collections
import csv
import json
import pathlib
import random
import subprocess
import sys
import tempfile

try:
    import cv2
    import mrcal
    import numpy as np
except ImportError:
    sys.exit("halves_peers.py: install python3-mrcal and python3-opencv, and run it with the system's "
             'Python')

INTRINSICS = 16  # of 22: f, ax, ox, oy, k1, k2, p1, p2 of each eye


class Views:
    """Corners of frames that both cameras see whole."""

    def __init__(self, rig):
        cameras = [camera['name'] for camera in rig['cameras']]
        if len(cameras) != 2 or any(camera['model'] != 'opencv4' for camera in rig['cameras']):
            sys.exit('halves_peers.py: the rig is not a stereo pair of opencv4 cameras')
        self.size = tuple(rig['cameras'][0]['size_px'])
        self.target = np.array(rig['evidence']['board']['points_m'])
        self.columns = int(np.argmax(self.target[:, 1] > 1e-9))
        self.spacing = self.target[1, 0]
        seen = {}
        for view in rig['evidence']['observations']:
            if len(view['pixels_px']) == len(self.target):
                seen.setdefault(view['frame'], {})[cameras.index(view['camera'])] = np.array(
                    view['pixels_px'])
        self.pixels = {f: np.array([v[0], v[1]]) for f, v in seen.items() if len(v) == 2}
        self.poses = {pose['frame']: pose['rotation_rad'] + pose['translation_m']
                      for pose in rig['evidence']['view_poses']}
        self.frames = len(self.poses)
        self.start = rig['parameters']

    def write(self, file, frames):
        with open(file, 'w', newline='') as text:
            table = csv.writer(text)
            table.writerow(['frame', 'camera', 'row', 'col', 'X', 'Y', 'Z', 'qx', 'qy'])
            for frame in frames:
                for camera in (0, 1):
                    for i, (point, pixel) in enumerate(zip(self.target, self.pixels[frame][camera])):
                        table.writerow([frame, camera, i // self.columns, i % self.columns,
                                        *map(repr, map(float, point)), *map(repr, map(float, pixel))])


def from_opencv(intrinsics, rotation, translation):
    """Vernier's parameters (f = fy, ax = fx / fy) of two eyes fx, fy, cx, cy, k1, k2, p1, p2."""
    eyes = [[k[1], k[0] / k[1], *k[2:8]] for k in intrinsics]
    return np.array([*eyes[0], *eyes[1], *rotation, *translation], dtype=float)


def to_opencv(parameters):
    eyes = [[p[0] * p[1], p[0], *p[2:8]] for p in (parameters[:8], parameters[8:16])]
    return np.array(eyes), np.array(parameters[16:19]), np.array(parameters[19:22])


doubted = collections.Counter()  # halves that Vernier ends with exit code 3, by its options


def by_vernier(program, views, frames, folder, options):
    views.write(folder / 'half.csv', frames)
    done = subprocess.run([program, 'calibrate', '--observations', 'half.csv', '--size',
                           f'{views.size[0]}x{views.size[1]}', '--model', 'opencv4', '-o', 'half.json',
                           '-q', *options], cwd=folder, capture_output=True, text=True)
    if done.returncode not in (0, 3):
        raise RuntimeError(done.stderr.strip())
    doubted[' '.join(options)] += done.returncode == 3
    return np.array(json.loads((folder / 'half.json').read_text())['parameters'])


def by_mrcal(views, frames, regularise):
    intrinsics, rotation, translation = to_opencv(views.start)
    rows = len(views.target) // views.columns
    observed = np.ones((2 * len(frames), rows, views.columns, 3))
    for i, frame in enumerate(frames):
        for camera in (0, 1):
            observed[2 * i + camera, ..., :2] = views.pixels[frame][camera].reshape(
                rows, views.columns, 2)
    indices = np.array([(i, camera, camera - 1) for i in range(len(frames)) for camera in (0, 1)],
                       dtype=np.int32)
    problem = dict(
        intrinsics=intrinsics.copy(),
        extrinsics_rt_fromref=np.concatenate((rotation, translation))[None],
        frames_rt_toref=np.array([views.poses[frame] for frame in frames]), points=None,
        observations_board=observed, indices_frame_camintrinsics_camextrinsics=indices,
        observations_point=None, indices_point_camintrinsics_camextrinsics=None,
        lensmodel='LENSMODEL_OPENCV4', imagersizes=np.array([views.size] * 2, dtype=np.int32),
        calobject_warp=np.zeros(2), calibration_object_spacing=views.spacing,
        do_optimize_intrinsics_core=True, do_optimize_intrinsics_distortions=True,
        do_optimize_extrinsics=True, do_optimize_frames=True, do_optimize_calobject_warp=True,
        do_apply_regularization=regularise, do_apply_outlier_rejection=True, verbose=False)
    mrcal.optimize(**problem)
    pose = problem['extrinsics_rt_fromref'][0]
    return from_opencv(problem['intrinsics'], pose[:3], pose[3:])


def by_opencv(views, frames):
    target = [views.target.astype(np.float32)] * len(frames)
    pixels = [[views.pixels[frame][camera].astype(np.float32) for frame in frames] for camera in (0, 1)]
    criteria = (cv2.TERM_CRITERIA_COUNT + cv2.TERM_CRITERIA_EPS, 200, 1e-12)
    eyes = [cv2.calibrateCamera(target, p, views.size, None, None, flags=cv2.CALIB_FIX_K3,
                                criteria=criteria)[1:3] for p in pixels]
    done = cv2.stereoCalibrate(target, *pixels, *eyes[0], *eyes[1], views.size,
                               flags=cv2.CALIB_USE_INTRINSIC_GUESS | cv2.CALIB_FIX_K3, criteria=criteria)
    intrinsics = [[K[0, 0], K[1, 1], K[0, 2], K[1, 2], *d.ravel()[:4]]
                  for K, d in ((done[1], done[2]), (done[3], done[4]))]
    return from_opencv(intrinsics, cv2.Rodrigues(done[5])[0].ravel(), done[6].ravel())


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument('program', type=lambda name: pathlib.Path(name).resolve())
    parser.add_argument('rig', type=pathlib.Path)
    parser.add_argument('--splits', type=int, default=30)
    parser.add_argument('--seed', type=int, default=1)
    options = parser.parse_args()
    rig = json.loads(options.rig.read_text())
    views = Views(rig)
    sigma = np.sqrt(np.diag(np.array(rig['covariance']['matrix'])))
    if not sigma.all():
        sys.exit('halves_peers.py: the rig holds parameters fixed, which has no scale')
    frames = sorted(views.pixels)
    deal = random.Random(options.seed)
    with tempfile.TemporaryDirectory() as name:
        folder = pathlib.Path(name)
        tools = {
            'vernier': lambda half: by_vernier(options.program, views, half, folder,
                                               ['--no-effects']),
            'warp': lambda half: by_vernier(options.program, views, half, folder, ['--warp']),
            'shape and motion': lambda half: by_vernier(options.program, views, half, folder,
                                                        ['--board-shape', '--motion']),
            'mrcal': lambda half: by_mrcal(views, half, True),
            'mrcal, no prior': lambda half: by_mrcal(views, half, False),
            'opencv': lambda half: by_opencv(views, half)}
        z = {tool: [] for tool in tools}
        for _ in range(options.splits):
            dealt = deal.sample(frames, len(frames))
            halves = sorted(dealt[::2]), sorted(dealt[1::2])
            for tool, calibrate in tools.items():
                z[tool].append((calibrate(halves[0]) - calibrate(halves[1])) / sigma)
    rms = {tool: [np.sqrt(np.mean(np.array(values)[:, part] ** 2)) for part in
                  (slice(None), slice(INTRINSICS), slice(INTRINSICS, None))]
           for tool, values in z.items()}
    print(f'{len(frames)} of {views.frames} frames are seen whole by both eyes, {options.splits} splits')
    for words, count in doubted.items():
        if count:
            print(f'vernier {words}: {count} of {2 * options.splits} halves are doubtful, counted as all')
    print()
    print('| tool | all | lenses | pose | ÷ vernier: all | lenses | pose |')
    print('| --- | --- | --- | --- | --- | --- | --- |')
    for tool, values in rms.items():
        ratios = [v / usual for v, usual in zip(values, rms['vernier'])]
        print(f'| {tool} | ' + ' | '.join(f'{v:.2f}' for v in values + ratios) + ' |')


if __name__ == '__main__':
    main()
