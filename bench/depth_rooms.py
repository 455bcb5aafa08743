#!/usr/bin/env python3
# SPDX-FileCopyrightText: 2026 The Vernier authors
# SPDX-License-Identifier: Apache-2.0
"""Whether `vernier lines --depth` places edges where they are: made-up rooms with depth maps.

    depth_rooms.py PROGRAM [ROOMS [FIRST_SEED]]

Each room has five to eight boxes, and eight views from 1.1 to 1.7 m, tilted and a little rolled, 640 x 480 at 525 px.
Images have a point spread and noise of 2 levels. Depths have the noise that `lines` assumes: 1 cm of each
pixel, and 0.0015 z^2 that changes over some 30 px. Segments of 15 px and more are compared, by the depth of both ends,
with the plane in the image there: the nearer one at a step, either at a fold. Needs numpy and OpenCV.
"""
import json
import pathlib
import subprocess
import sys
import tempfile

import cv2
import numpy as np

WIDTH, HEIGHT, F_PX = 640, 480, 525.0
CENTRE = np.array([319.5, 239.5])
VIEWS = 8
FINE = 3  # samples of a pixel, each way


class Room:
    """Rectangles along the axes, z up, metres: (axis, value, low, high, grey level)."""

    def __init__(self, rng):
        self.size = np.array([rng.uniform(5, 9), rng.uniform(4, 7), 2.7])
        self.rectangles, self.boxes = [], []
        self.add_box(np.zeros(3), self.size, rng)
        for _ in range(rng.integers(5, 9)):
            middle = rng.uniform([0.5, 0.5, 0], [self.size[0] - 0.5, self.size[1] - 0.5, 0])
            extent = rng.uniform([0.3, 0.3, 0.4], [1.2, 0.8, 1.8])
            low, high = middle - extent / 2, middle + extent / 2
            low[2], high[2] = 0, extent[2]
            self.boxes.append((low, high))
            self.add_box(low, high, rng)

    def add_box(self, low, high, rng):
        for axis in range(3):
            for value in (low[axis], high[axis]):
                self.rectangles.append((axis, value, low, high, rng.uniform(50, 220)))

    def hit(self, eye, rays):
        """Length of each ray to the first rectangle, and its number."""
        first = np.full(rays.shape[:-1], np.inf)
        number = np.full(rays.shape[:-1], -1)
        for i, (axis, value, low, high, _) in enumerate(self.rectangles):
            with np.errstate(all='ignore'):
                length = (value - eye[axis]) / rays[..., axis]
                at = eye + length[..., None] * rays
            inside = (length > 1e-6) & (length < first)
            for k in {0, 1, 2} - {axis}:
                inside &= (at[..., k] >= low[k] - 1e-9) & (at[..., k] <= high[k] + 1e-9)
            first, number = np.where(inside, length, first), np.where(inside, i, number)
        return first, number

    def is_free(self, eye):
        return not any((eye > low - 0.25).all() and (eye < high + 0.25).all() for low, high in self.boxes)


def rays_of(pixels, R):
    return np.concatenate([(pixels - CENTRE) / F_PX, np.ones((*pixels.shape[:-1], 1))], -1) @ R.T


def looking(rng):
    """A camera's axes (right, down, ahead) in the room."""
    yaw, pitch, roll = rng.uniform(0, 2 * np.pi), rng.uniform(-0.25, 0.05), rng.uniform(-0.05, 0.05)
    ahead = np.array([np.cos(yaw) * np.cos(pitch), np.sin(yaw) * np.cos(pitch), np.sin(pitch)])
    right = np.cross(ahead, [0, 0, 1])
    right /= np.linalg.norm(right)
    down = np.cross(ahead, right)
    return np.stack([np.cos(roll) * right + np.sin(roll) * down,
                     -np.sin(roll) * right + np.cos(roll) * down, ahead], 1)


def rendered(room, eye, R, rng):
    """Image and depth map of a view; nothing where it faces a wall."""
    u, v = ((np.arange(n * FINE) + 0.5) / FINE - 0.5 for n in (WIDTH, HEIGHT))
    rays = rays_of(np.stack(np.meshgrid(u, v), -1), R)
    depth, number = room.hit(eye, rays)
    if np.median(depth) < 1:
        return None
    at = eye + depth[..., None] * rays
    grey = np.array([r[4] for r in room.rectangles])[number]
    grey *= 1 + 0.06 * np.sin(1.1 * at[..., 0] + number) + 0.05 * np.cos(0.9 * at[..., 1])
    grey = grey.reshape(HEIGHT, FINE, WIDTH, FINE).mean((1, 3))
    image = cv2.GaussianBlur(grey, (0, 0), 0.6) + rng.normal(0, 2, (HEIGHT, WIDTH))
    depth = depth[FINE // 2::FINE, FINE // 2::FINE]
    shared = cv2.GaussianBlur(rng.normal(0, 1, (HEIGHT, WIDTH)), (0, 0), 30)
    noisy = depth + rng.normal(0, 0.01, depth.shape) + 1.5e-3 * depth ** 2 * shared / shared.std()
    return np.clip(image, 0, 255).astype(np.uint8), np.where(depth > 0.4, np.round(1000 * noisy), 0).astype(np.uint16)


def make_room(seed, folder):
    rng = np.random.default_rng(seed)
    room, views = Room(rng), []
    for name in ('images', 'depths'):
        (folder / name).mkdir()
    while len(views) < VIEWS:
        eye = rng.uniform([0.4, 0.4, 1.1], [room.size[0] - 0.4, room.size[1] - 0.4, 1.7])
        R = looking(rng)
        pictures = rendered(room, eye, R, rng) if room.is_free(eye) else None
        if pictures is None:
            continue
        for name, picture in zip(('images', 'depths'), pictures):
            cv2.imwrite(str(folder / name / f'{len(views):03d}.png'), picture)
        views.append((R, eye))
    (folder / 'K.txt').write_text(f'{F_PX} 0 {CENTRE[0]}\n0 {F_PX} {CENTRE[1]}\n0 0 1\n')
    head = 'frame,' + ','.join(f't{i}{j}' for i in range(4) for j in range(4))
    rows = []
    for i, (R, eye) in enumerate(views):
        T = np.eye(4)
        T[:3, :3], T[:3, 3] = R, eye
        rows.append(f'{i:03d},' + ','.join(f'{x:.12g}' for x in T.ravel()))
    (folder / 'poses.csv').write_text('\n'.join([head, *rows]) + '\n')
    return room, views


def errors_of(room, view, segment):
    """Kind of edge and error in standard deviations, with the error in metres, of both ends."""
    R, eye = view
    a, b = np.array(segment['image_px'][:2]), np.array(segment['image_px'][2:])
    if np.linalg.norm(b - a) < 15:
        return
    along = (b - a) / np.linalg.norm(b - a)
    across = np.array([-along[1], along[0]])
    covariance = np.array(segment['covariance_m2'])
    for end, (px, inside, found) in enumerate(((a, a + 3 * along, segment['a_m']), (b, b - 3 * along, segment['b_m']))):
        _, sides = room.hit(eye, rays_of(np.array([inside + 1.2 * across, inside - 1.2 * across]), R))
        ray = rays_of(px, R)
        depths = [(room.rectangles[i][1] - eye[room.rectangles[i][0]]) / ray[room.rectangles[i][0]] for i in sides]
        kind = ('within a face' if sides[0] == sides[1] else
                'fold' if abs(depths[0] - depths[1]) < 0.03 * min(depths) else 'step')
        if kind == 'fold' and {4, 5} & set(sides.tolist()):
            kind = 'fold at floor or ceiling'
        off = found[2] - min(depths)
        yield kind, off / np.sqrt(covariance[3 * end + 2, 3 * end + 2]), off


def main():
    program, numbers = sys.argv[1], [int(word) for word in sys.argv[2:]]
    rooms, first = (numbers + [12, 101][len(numbers):])[:2]
    found = {}
    for seed in range(first, first + rooms):
        with tempfile.TemporaryDirectory() as name:
            folder = pathlib.Path(name)
            room, views = make_room(seed, folder)
            subprocess.run([program, 'lines', '--image', 'images/*.png', '--depth', 'depths/*.png', '--rig', 'K.txt',
                            '--poses', 'poses.csv', '--up', 'z', '--height-m', '0', '-o', 'views.jsonl', '--segments',
                            'segments.jsonl', '-q'], cwd=folder, check=True, stdout=subprocess.DEVNULL)
            for line in (folder / 'segments.jsonl').read_text().splitlines():
                image = json.loads(line)
                if 'segments' not in image:
                    continue
                for segment in image['segments']:
                    for kind, z, off in errors_of(room, views[int(pathlib.Path(image['image']).stem)], segment):
                        found.setdefault(kind, []).append((z, off))
    print('| edge | ends | within 95 % | median error, sd | median error, cm | mean z^2, each at most 25 |')
    print('| --- | --- | --- | --- | --- | --- |')
    for kind, rows in sorted(found.items()):
        z, off = np.array(rows).T
        print(f'| {kind} | {len(z)} | {100 * np.mean(abs(z) < 1.96):.0f} % | {np.median(z):+.2f} | '
              f'{100 * np.median(off):+.1f} | {np.mean(np.minimum(z ** 2, 25)):.2f} |')


if __name__ == '__main__':
    main()
