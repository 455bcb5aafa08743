#!/usr/bin/env python3
# SPDX-FileCopyrightText: 2026 The Vernier authors
# SPDX-License-Identifier: Apache-2.0
"""Results that are wrong without a sign of it: exit code 3 and the reason, or a refusal.

    doubts_test.py PROGRAM [unittest's options]
"""
import json
import math
import random
import sys
import unittest

sys.dont_write_bytecode = True
import cli_test
import match_test
from cli_test import Case, board_lines, vernier


class Boards(Case):
    """Simulated corners of a board, changed."""

    def calibrate(self, *more, change=None, frames=12, code=0):
        header, *lines = board_lines(frames=frames)
        if change:
            changed = []
            for line in lines:
                f, c, r, k, X, Y, Z, u, v = (float(x) for x in line.split(','))
                u, v = change(int(f), int(c), u, v)
                changed.append(f'{int(f)},{int(c)},{int(r)},{int(k)},{X},{Y},{Z},{u},{v}')
            lines = changed
        (self.folder / 'o.csv').write_text('\n'.join([header, *lines]))
        done = vernier('calibrate', '--observations', self.folder / 'o.csv', '--size', '640x480',
                       '--no-model-check', '-o', self.folder / 'rig.json', *more)
        self.assertEqual(done.returncode, code, done.stderr)
        return done

    def doubts(self):
        return json.loads((self.folder / 'rig.json').read_text())['calibration']['doubts']

    def test_a_stated_noise_far_from_the_residuals(self):
        for sigma in ('1e-9', '0.05', '1', '1e3'):  # it is 0.2 px
            done = self.calibrate('--pixel-sigma', sigma, code=3)
            self.assertIn('the residuals do not have the stated noise', done.stderr)
            self.assertIn('the residuals do not have the stated noise', self.doubts()[0])
        self.calibrate('--pixel-sigma', '0.1')
        self.calibrate('--pixel-sigma', '0.5')

    def jitter(self, size, seed):
        draw = random.Random(seed)
        by = {f: (draw.uniform(-size, size), draw.uniform(-size, size)) for f in range(12)}
        return lambda f, c, u, v: (u + c * by[f][0], v + c * by[f][1])

    def test_right_images_that_are_off_from_frame_to_frame(self):
        for size in (4, 1):
            done = self.calibrate(change=self.jitter(size, 3), code=3)
            self.assertRegex(done.stderr, 'not simultaneous|did not see the board at the same pose')
            self.assertEqual(len(self.doubts()), 1)

    def test_a_lens_zoomed_during_the_session(self):
        def zoomed(f, c, u, v):
            by = 1.03 if c == 1 and f >= 6 else 1
            return 320 + by * (u - 320), 240 + by * (v - 240)
        done = self.calibrate(change=zoomed, code=3)
        self.assertIn('the rig changed after frame 5: another', done.stderr)

    def test_an_image_left_out_is_named(self):
        def other(f, c, u, v):
            return (u + 7 * math.sin(v / 30), v + 6 * math.cos(u / 40)) if (f, c) == (4, 1) else (u, v)
        done = self.calibrate(change=other)
        self.assertIn('with them the whole image of frame 4, camera 1', done.stderr)


class Samples(Case):
    def rig(self, sigma):
        names = ['left.f_px', 'left.ax', 'left.ox_px', 'left.oy_px']
        (self.folder / 'rig.json').write_text(json.dumps({
            'format': 'vernier/rig', 'version': 1,
            'cameras': [{'name': 'left', 'model': 'pinhole', 'size_px': [640, 480],
                         'parameters': {'f_px': 500, 'ax': 1, 'ay': 1, 'ox_px': 320, 'oy_px': 240}}],
            'parameter_names': names, 'parameters': [500, 1, 320, 240],
            'covariance': {'kind': 'prior',
                           'matrix': [[(sigma if i == 0 else 1e-3) ** 2 * (i == j)
                                       for j in range(4)] for i in range(4)]}}))

    def sample(self, *more):
        return vernier('sample', self.folder / 'rig.json', '-n', 2000, '-o',
                       self.folder / 's.csv', *more)

    def test_negative_focal_lengths_are_counted_and_doubted(self):
        self.rig(250)
        done = self.sample('--json')
        self.assertEqual(done.returncode, 3, done.stderr)
        self.assertRegex(done.stderr, r'of 2000 samples \(.* %\) are rigs that no cameras can have')
        rows = (self.folder / 's.csv').read_text().splitlines()[1:]
        negative = sum(float(row.split(',')[0]) <= 0 for row in rows)
        self.assertEqual(json.loads(done.stdout)['unphysical'], negative)
        self.assertAlmostEqual(negative / 2000, 0.0228, delta=0.015)

    def test_usual_samples_are_not(self):
        self.rig(5)
        done = self.sample('--json')
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertEqual(json.loads(done.stdout)['unphysical'], 0)

    def test_overflow_is_refused(self):
        self.rig(1e14)
        self.complains('sample', self.folder / 'rig.json', '-n', '10', '--psi-c', '1e300', '-o',
                       self.folder / 's.csv', of='exceed the range of numbers',
                       leaves=[self.folder / 's.csv'])


class Sides(Case):
    """Left and right exchanged, with a prior that hardly knows the rotation."""

    image, pairs, prior, arguments = (getattr(match_test.Match, name) for name in
                                      ('image', 'pairs', 'prior', 'arguments'))

    @staticmethod
    def loose(rig, sigma=0.05):
        for name in ('right.wx_rad', 'right.wy_rad', 'right.wz_rad'):
            i = rig['parameter_names'].index(name)
            rig['covariance']['matrix'][i][i] = sigma ** 2

    def pairs_file(self, nearest, farthest, exchanged, yaw=0.04):
        """Points before a rig whose right camera is turned, as a pairs file."""
        draw = random.Random(5)
        lines = ['pair,u_left_px,v_left_px,u_right_px,v_right_px,sigma_px']
        for pair in range(4):
            count = 0
            while count < 120:
                z = 1 / draw.uniform(1 / farthest, 1 / nearest)
                x, y = draw.uniform(-0.3, 0.3) * z, draw.uniform(-0.22, 0.22) * z
                xr, zr = (math.cos(yaw) * x + math.sin(yaw) * z - 0.2,
                          math.cos(yaw) * z - math.sin(yaw) * x)
                left = [160 + 500 * x / z, 120 + 500 * y / z]
                right = [160 + 500 * xr / zr, 120 + 500 * y / zr]
                place = [p + draw.gauss(0, 0.1) for p in left + right]
                if not all(1 < p < n for p, n in zip(place, (318, 238, 318, 238))):
                    continue
                if exchanged:
                    place = place[2:] + place[:2]
                lines.append(','.join(map(str, [pair, *place, 0.1])))
                count += 1
        (self.folder / 'p.csv').write_text('\n'.join(lines) + '\n')

    def calibrated(self):
        return vernier('calibrate', '--pairs', self.folder / 'p.csv', '--prior',
                       self.prior(change=self.loose), '-o', self.folder / 'out.json')

    def test_image_pairs_that_are_not_simultaneous(self):
        self.pairs_file(1.5, 30, False)
        header, *lines = (self.folder / 'p.csv').read_text().split()
        changed = []
        for line in lines:
            pair, *place, sigma = line.split(',')
            place = [float(p) for p in place]
            place[3] += (3, -3, 1, -1)[int(pair)]
            if 1 < place[3] < 238:
                changed.append(','.join(map(str, [pair, *place, sigma])))
        (self.folder / 'p.csv').write_text('\n'.join([header, *changed]) + '\n')
        done = self.calibrated()
        self.assertEqual(done.returncode, 3, done.stderr)
        self.assertIn('the rig is not the same in all image pairs', done.stderr)
        self.assertIn('not simultaneous', done.stderr)
        self.assertNotIn('their stated noise', done.stderr)  # follows from it

    def test_exchanged_pairs_of_a_deep_scene_are_refused(self):
        self.pairs_file(1.5, 30, True)
        done = self.calibrated()
        self.assertEqual(done.returncode, 2, done.stderr)
        self.assertIn('left and right are swapped', done.stderr)
        self.pairs_file(1.5, 30, False)
        done = self.calibrated()
        self.assertEqual(done.returncode, 0, done.stderr)

    def test_nothing_tells_the_sides_of_a_distant_scene(self):
        for exchanged in (False, True):
            self.pairs_file(150, 300, exchanged)
            done = self.calibrated()
            self.assertEqual(done.returncode, 3, done.stderr)
            self.assertIn('nothing tells left from right', done.stderr)

    def test_exchanged_images_are_told_by_a_calibration_from_their_matches(self):
        self.pairs()
        done = self.works(*self.arguments(change=self.loose))
        self.complains(*self.arguments(left='right*.pgm', right='left*.pgm', change=self.loose),
                       '-q', of='a calibration from the matches says that left and right are swapped')

    def test_interchangeable_images(self):
        self.pairs()

        def hardly_anything(rig):
            self.loose(rig, 0.2)
            for name in ('f_px', 'ox_px', 'oy_px'):
                for side in ('left', 'right'):
                    i = rig['parameter_names'].index(f'{side}.{name}')
                    rig['covariance']['matrix'][i][i] = 50 ** 2
        for left, right in (('left', 'right'), ('right', 'left')):
            done = vernier(*self.arguments(left=left + '*.pgm', right=right + '*.pgm',
                                           change=hardly_anything))
            self.assertEqual(done.returncode, 3, done.stderr)
            self.assertIn('nor the prior tell the cameras apart', done.stderr)
            done = vernier('calibrate', '--pairs', self.folder / 'pairs.csv', '--prior',
                           self.folder / 'prior.json', '-o', self.folder / 'out.json')
            self.assertEqual(done.returncode, 3, done.stderr)
            self.assertIn('nothing tells left from right', done.stderr)


if __name__ == '__main__':
    cli_test.PROGRAM = sys.argv.pop(1)
    unittest.main()
