#!/usr/bin/env python3
# SPDX-FileCopyrightText: 2026 The Vernier authors
# SPDX-License-Identifier: Apache-2.0
"""Are the standard deviations of disparities true? Two slanted planes with rectangles of random grey, drawn
(4 x 4 samples a pixel) as a verged rig of unlike cameras sees them, blurred and with white noise.

    stereo_deviations.py PROGRAM [--seeds 7031 7032 7033]

For each noise and blur: shares of points beyond 3 standard deviations, by the angle of the edge to the row, those
that keep the parabola apart, and the rms of z without the floor of 0.2 px. Points within 4 px of a depth edge are left out."""
import argparse
import csv
import json
import pathlib
import subprocess
import tempfile

import cv2
import numpy

WIDTH, HEIGHT, FINE = 640, 480, 4
# Of both planes: normal, a point, half the side in metres.
PLANES = ((numpy.array([0.25, 0.1, -1.0]), numpy.array([0, 0, 4.0]), numpy.inf),
          (numpy.array([-0.1, 0.05, -1.0]), numpy.array([0.2, 0.1, 2.4]), 0.5))
R_RIGHT = cv2.Rodrigues(numpy.array([0.02, -0.06, 0.03]))[0]
RIGHT_AT_M = numpy.array([0.2, 0.01, -0.01])
CAMERAS = (('left', 600.0, (325.0, 236.0), numpy.eye(3), numpy.zeros(3)),
           ('right', 640.0, (300.0, 250.0), R_RIGHT, RIGHT_AT_M))
FLOOR_PX = 0.2


def rectangles(random):
    """Of both planes: centre, size, turn, grey."""
    back = [(random.uniform(-5, 5), random.uniform(-5, 5), random.uniform(0.1, 1), random.uniform(0.1, 1),
             random.uniform(0, numpy.pi), random.uniform(30, 220)) for _ in range(60)]
    front = [(random.uniform(-0.5, 0.5), random.uniform(-0.5, 0.5), random.uniform(0.025, 0.25),
              random.uniform(0.025, 0.25), random.uniform(0, numpy.pi), random.uniform(30, 220)) for _ in range(14)]
    return back, front


def on_plane(plane, points):
    normal, origin, _ = PLANES[plane]
    normal = normal / numpy.linalg.norm(normal)
    across = numpy.cross([0, 1, 0], normal)
    across /= numpy.linalg.norm(across)
    return (points - origin) @ across, (points - origin) @ numpy.cross(normal, across)


def seen_along(rays, eye, texture=None):
    """Distance along each ray, and grey if there is a texture."""
    nearest = numpy.full(rays.shape[:-1], numpy.inf)
    grey = numpy.zeros(rays.shape[:-1])
    for plane, (normal, origin, half) in enumerate(PLANES):
        t = ((origin - eye) @ normal) / (rays @ normal)
        t = numpy.where(t > 0, t, numpy.inf)
        a, b = on_plane(plane, eye + rays * numpy.where(numpy.isfinite(t), t, 1)[..., None])
        hit = (t < nearest) & (abs(a) < half) & (abs(b) < half)
        nearest = numpy.where(hit, t, nearest)
        if texture is None:
            continue
        shade = numpy.full(a.shape, 120.0)
        for x, y, w, h, turn, level in texture[plane]:
            p = (a - x) * numpy.cos(turn) + (b - y) * numpy.sin(turn)
            q = (b - y) * numpy.cos(turn) - (a - x) * numpy.sin(turn)
            shade[(abs(p) < w / 2) & (abs(q) < h / 2)] = level
        grey = numpy.where(hit, shade, grey)
    return nearest, grey


def drawn(camera, texture):
    _, focal, centre, R, eye = camera
    fine = (numpy.arange(FINE) + 0.5) / FINE - 0.5
    u = (numpy.arange(WIDTH)[:, None] + fine).ravel()
    image = numpy.zeros((HEIGHT, WIDTH))
    for row in range(HEIGHT):
        x, y = numpy.meshgrid((u - centre[0]) / focal, (row + fine - centre[1]) / focal)
        _, grey = seen_along(numpy.stack([x, y, numpy.ones_like(x)], -1) @ R, eye, texture)
        image[row] = grey.reshape(FINE, WIDTH, FINE).mean((0, 2))
    return image


def write_rig(file):
    cameras = []
    for name, focal, centre, R, eye in CAMERAS:
        cameras.append({'name': name, 'model': 'pinhole', 'size_px': [WIDTH, HEIGHT],
                        'parameters': {'f_px': focal, 'ax': 1, 'ox_px': centre[0], 'oy_px': centre[1]}})
    cameras[1]['from_first'] = {'rotation_rad': list(cv2.Rodrigues(R_RIGHT)[0].ravel()),
                                'translation_m': list(-R_RIGHT @ RIGHT_AT_M)}
    file.write_text(json.dumps({'format': 'vernier/rig', 'version': 1, 'cameras': cameras}))


def points_of(folder):
    """Error, standard deviation, angle to the row and whether it is near a depth edge, of matched points."""
    geometry = json.loads((folder / 'segments.json').read_text())['rectified']
    focal, centre, R = geometry['f_px'], geometry['centre_px'], numpy.array(geometry['R_rectified_left'])

    def true_px(u, v):
        rays = numpy.stack([(u - centre[0]) / focal, (v - centre[1]) / focal, numpy.ones_like(u)], -1) @ R
        return focal * geometry['baseline_m'] / seen_along(rays, numpy.zeros(3))[0]

    rows = [row for row in csv.DictReader((folder / 'edges.csv').open()) if row['disparity_px']]
    u, v, found, sigma, across = (numpy.array([float(row[key]) for row in rows])
                                  for key in ('u_px', 'y', 'disparity_px', 'sigma_px', 'normal_x'))
    around = numpy.stack([true_px(u + i, v + j) for i in (-4, 0, 4) for j in (-3, 0, 3)])
    smooth = numpy.ptp(around, axis=0) < 1
    angle = numpy.degrees(numpy.arcsin(numpy.minimum(1, abs(across))))
    return (found - true_px(u, v))[smooth], sigma[smooth], angle[smooth]


def share(beyond):
    return f'{100 * beyond.mean():5.1f} % of {beyond.size:5d}' if beyond.size else '    -'


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument('program')
    parser.add_argument('--seeds', type=int, nargs='+', default=[7031, 7032, 7033])
    options = parser.parse_args()
    for noise, blur in ((2, 0.6), (2, 1.5), (2, 2.5), (4, 1.0), (8, 0.6)):
        found = []
        for seed in options.seeds:
            random = numpy.random.default_rng(seed)
            texture = rectangles(random)
            with tempfile.TemporaryDirectory() as name:
                folder = pathlib.Path(name)
                write_rig(folder / 'rig.json')
                for camera in CAMERAS:
                    image = cv2.GaussianBlur(drawn(camera, texture), (0, 0), blur)
                    image = numpy.clip(numpy.rint(image + random.normal(0, noise, image.shape)), 0, 255)
                    cv2.imwrite(str(folder / f'{camera[0]}.png'), image.astype(numpy.uint8))
                subprocess.run([options.program, 'stereo', '--left', folder / 'left.png', '--right', folder / 'right.png',
                                '--rig', folder / 'rig.json', '--max-disparity', '120', '-o', folder / 'seen', '-q'],
                               stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
                found.append(points_of(folder / 'seen'))
        error, sigma, angle = (numpy.concatenate(part) for part in zip(*found))
        beyond = abs(error) > 3 * sigma
        parabola = sigma == 0.5
        bare = numpy.sqrt(numpy.maximum(sigma**2 - FLOOR_PX**2, 1e-6))
        z = numpy.clip(error / bare, -10, 10)[~parabola & (abs(error) < 2)]
        by_angle = [share(beyond[(angle >= low) & (angle < high)]) for low, high in ((5, 20), (20, 45), (45, 91))]
        print(f'noise {noise}, blur {blur}: {" | ".join(by_angle)} | parabola {share(beyond[parabola])} | '
              f'z {numpy.sqrt((z**2).mean()):.2f}', flush=True)


if __name__ == '__main__':
    main()
