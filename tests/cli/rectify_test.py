#!/usr/bin/env python3
# SPDX-FileCopyrightText: 2026 The Vernier authors
# SPDX-License-Identifier: Apache-2.0
"""vernier rectify as a user calls it, on the 13 real pairs.

    rectify_test.py PROGRAM [unittest's options]

That rows agree and depths are right is asked of the board's corners, found in the rectified images
by vernier detect.
"""
import json
import math
import pathlib
import shutil
import sys
import unittest

sys.dont_write_bytecode = True
import cli_test
from cli_test import IMAGES, CalibratedCase

ROWS, COLUMNS, SQUARE_M = 6, 9, 0.025


@unittest.skipUnless((IMAGES / 'left01.jpg').exists(), 'opencv-doc has no images here')
class Rectify(CalibratedCase):
    def arguments(self, number='01', rig=None, left=None, right=None):
        return ('rectify', '--rig', rig or self.rig, '--left', left or IMAGES / f'left{number}.jpg',
                '--right', right or IMAGES / f'right{number}.jpg', '-o', self.folder / 'rectified')

    def changed_rig(self, name, change):
        rig = json.loads(self.rig.read_text())
        change(rig)
        (self.folder / name).write_text(json.dumps(rig))
        return self.folder / name

    def lowered_rig(self, px):
        """The right camera's centre higher than it is: its rectified images lie lower."""
        def change(rig):
            rig['cameras'][1]['parameters']['oy_px'] -= px
            rig['parameters'][rig['parameter_names'].index('right.oy_px')] -= px
        return self.changed_rig('lowered.json', change)

    def corners(self):
        """The board's corners in both rectified images, row by row."""
        for side in ('left', 'right'):
            shutil.copy(self.folder / f'rectified/{side}.png', self.folder / f'{side}1.png')
        self.works('detect', '--left', self.folder / 'left1.png', '--right',
                   self.folder / 'right1.png', '--board', '9x6', '-o', self.folder / 'corners.vnl')
        seen = {'left': [], 'right': []}
        for line in (self.folder / 'corners.vnl').read_text().splitlines():
            if line.startswith('#') or line.split()[1] == '-':
                continue
            words = line.split()
            side = 'left' if 'left' in pathlib.Path(words[0]).name else 'right'
            seen[side].append((float(words[1]), float(words[2])))
        self.assertEqual((len(seen['left']), len(seen['right'])), (54, 54))
        return list(zip(seen['left'], seen['right']))

    def row_offset(self):
        apart = [right[1] - left[1] for left, right in self.corners()]
        mean = sum(apart) / len(apart)
        return mean, math.sqrt(sum((a - mean)**2 for a in apart) / len(apart))

    def test_rows_agree_and_depths_are_the_boards(self):
        for number in ('01', '05', '12'):
            said = json.loads(self.works(*self.arguments(number), '--json').stdout)
            mean, scatter = self.row_offset()
            self.assertLess(abs(mean), 0.25)
            self.assertLess(scatter, 0.25)
            f, (cx, cy) = said['f_px'], said['centre_px']
            points = []
            for (u, v), (other, _) in self.corners():
                z = f * said['baseline_m'] / (u - other)
                points.append(((u - cx) * z / f, (v - cy) * z / f, z))
            sides = [math.dist(points[r * COLUMNS + c], points[r * COLUMNS + c + 1])
                     for r in range(ROWS) for c in range(COLUMNS - 1)]
            self.assertLess(abs(sum(sides) / len(sides) / SQUARE_M - 1), 0.01)

    def test_what_it_says(self):
        said = json.loads(self.works(*self.arguments(), '--json').stdout)
        self.assertEqual(said['size_px'], [640, 480])
        self.assertLess(max(said['blank'].values()), 0.015)
        self.assertAlmostEqual(said['baseline_m'], 0.0834, 3)
        self.assertGreater(said['uncertainty']['rms_disparity_sd_px'], 0.05)
        self.assertGreater(said['uncertainty']['rms_vertical_sd_px'], 0.02)
        self.assertAlmostEqual(said['uncertainty']['disparity_px'], 32)
        self.assertTrue(said['vertical_field']['known'])
        self.assertFalse(said['vertical_field']['unrectified'])
        self.assertLess(abs(said['vertical_field']['coefficients_px'][0]), 0.2)
        self.assertEqual([pathlib.Path(f).name for f in said['files']],
                         ['left.png', 'right.png', 'rig.json'])
        text = self.works(*self.arguments()).stdout
        for part in ('baseline', 'blank', "rig's error", 'no significant vertical offset', '3 files'):
            self.assertIn(part, text)
        nearer = json.loads(self.works(*self.arguments(), '--json', '--at-m', '0.5').stdout)
        self.assertAlmostEqual(nearer['uncertainty']['at_m'], 0.5)

    def test_the_rectified_rig_is_two_pinholes_side_by_side(self):
        said = json.loads(self.works(*self.arguments(), '--json').stdout)
        rig = json.loads((self.folder / 'rectified/rig.json').read_text())
        left, right = rig['cameras']
        self.assertEqual((left['model'], left['name'], right['name']), ('pinhole', 'left', 'right'))
        self.assertEqual(left['parameters'], right['parameters'])
        self.assertEqual(left['parameters']['f_px'], said['f_px'])
        self.assertEqual(right['from_first'], {'rotation_rad': [0, 0, 0],
                                               'translation_m': [-said['baseline_m'], 0, 0]})
        self.assertNotIn('covariance', rig)
        # Rectified again, nothing changes any more.
        folder = self.folder / 'rectified'
        again = json.loads(self.works('rectify', '--rig', folder / 'rig.json', '--left',
                                      folder / 'left.png', '--right', folder / 'right.png', '--f-px',
                                      said['f_px'], '-o', self.folder / 'again', '--json').stdout)
        self.assertIsNone(again['uncertainty'])
        self.assertEqual((again['f_px'], again['baseline_m']), (said['f_px'], said['baseline_m']))

    def test_repair(self):
        rig = self.lowered_rig(2)
        done = cli_test.vernier(*self.arguments(rig=rig), '--json', '-q')
        self.assertEqual(done.returncode, 3, done.stderr)
        self.assertIn('the rows of the two images are misaligned by 2.', done.stderr)
        found = json.loads(done.stdout)['vertical_field']
        self.assertTrue(found['significant'] and found['misaligned'])
        self.assertFalse(found['unrectified'])
        self.assertFalse(found['repaired'])
        mean, _ = self.row_offset()
        self.assertLess(abs(mean - 1.9), 0.3)  # 2 px of the raw image
        self.assertLess(abs(found['coefficients_px'][0] - 1.9), 0.3)
        self.assertIn('px lower', found['words'])
        done = self.works(*self.arguments(rig=rig), '--repair')
        self.assertIn('; repaired', done.stdout)
        mean, scatter = self.row_offset()
        self.assertLess(abs(mean), 0.25)
        self.assertLess(scatter, 0.3)
        self.assertIn('no repair needed', self.works(*self.arguments(), '--repair').stdout)

    def test_size_focal_length_and_masks(self):
        said = json.loads(self.works(*self.arguments(), '--size', '800x500', '--f-px', '400',
                                     '--masks', '--json').stdout)
        self.assertEqual((said['size_px'], said['f_px']), ([800, 500], 400))
        self.assertGreater(said['blank']['left'], 0.2)
        for name in ('left', 'right', 'left_valid', 'right_valid'):
            head = (self.folder / f'rectified/{name}.png').read_bytes()[:24]
            self.assertEqual((int.from_bytes(head[16:20], 'big'), int.from_bytes(head[20:], 'big')),
                             (800, 500))

    def test_any_number_of_threads_gives_the_same_files(self):
        self.works(*self.arguments(), '--threads', '1')
        files = [self.folder / 'rectified' / f for f in ('left.png', 'right.png', 'rig.json')]
        one = [f.read_bytes() for f in files]
        self.works(*self.arguments(), '--threads', '3')
        self.assertEqual(one, [f.read_bytes() for f in files])

    def test_images_of_other_cameras_are_doubted(self):
        done = cli_test.vernier(*self.arguments(rig=self.lowered_rig(40)))
        self.assertEqual(done.returncode, 3, done.stderr)
        self.assertIn('rows of the rectified images are not aligned', done.stderr)
        done = cli_test.vernier(*self.arguments(left=IMAGES / 'right01.jpg',
                                                right=IMAGES / 'left01.jpg'), '--json')
        self.assertEqual(done.returncode, 3, done.stderr)
        self.assertIn('left and right appear to be swapped', json.loads(done.stdout)['doubts'][0])

    def test_cameras_that_converge_are_told(self):
        """50 degrees: where the axes meet has a disparity above the range that is searched."""
        def change(rig):
            angle = math.radians(50)
            rig['cameras'][1]['from_first'] = {
                'rotation_rad': [0, angle, 0],
                'translation_m': [-0.8 * math.cos(angle / 2), 0, 0.8 * math.sin(angle / 2)]}
            for key in ('parameters', 'parameter_names', 'covariance', 'calibration', 'evidence'):
                rig.pop(key, None)
        rig = self.changed_rig('converging.json', change)
        done = cli_test.vernier(*self.arguments(rig=rig))
        self.assertEqual(done.returncode, 3, done.stderr)
        self.assertRegex(done.stderr, r'converge by 50 degrees: .* disparity of \d+ px here, beyond '
                                      r'the 160 px that were searched; give a larger --max-disparity')

    def test_complaints(self):
        out = self.folder / 'rectified'

        def one_camera(rig):
            rig['cameras'] = rig['cameras'][:1]
            for key in ('parameter_names', 'parameters', 'covariance', 'covariance_mvb',
                        'calibration'):
                rig.pop(key, None)
        self.complains(*self.arguments(rig=self.changed_rig('one.json', one_camera)), '-q',
                       of='it needs a pair and the rig has 1 camera;', leaves=[out])

        def larger(rig):
            rig['cameras'][1]['size_px'] = [1280, 960]
        self.complains(*self.arguments(rig=self.changed_rig('larger.json', larger)), '-q',
                       of='right01.jpg: image size 640x480 differs from camera "right"',
                       leaves=[out])

        def behind(rig):
            rig['cameras'][1]['from_first'] = {'rotation_rad': [0, 0, 0], 'translation_m': [0.02, 0, -0.3]}
            for key in ('parameters', 'parameter_names', 'covariance', 'calibration', 'evidence'):
                rig.pop(key, None)
        self.complains(*self.arguments(rig=self.changed_rig('behind.json', behind)), '-q',
                       of='one camera is behind the other', leaves=[out])
        self.complains(*self.arguments(right=IMAGES / 'left01.jpg'), '-q', of='same image',
                       leaves=[out])
        self.complains(*self.arguments(left=self.folder / 'none.png'), '-q', of='none.png',
                       leaves=[out])
        self.complains(*self.arguments(rig=self.folder / 'none.json'), '-q', of='none.json',
                       leaves=[out])
        for options in (('--size', '9'), ('--f-px', '0'), ('--at-m', 'nan'), ('--band', '11'),
                        ('--max-disparity', '0')):
            self.complains(*self.arguments(), '-q', *options, of=options[0], leaves=[out])

    def test_outputs_never_replace_inputs(self):
        out = self.folder / 'rectified'
        out.mkdir()
        for name, source in (('left.png', IMAGES / 'left01.jpg'), ('rig.json', self.rig)):
            shutil.copy(source, out / name)
            before = (out / name).read_bytes()
            given = {'left': out / name} if name == 'left.png' else {'rig': out / name}
            self.complains(*self.arguments(**given), '-q', of='is an input')
            self.assertEqual((out / name).read_bytes(), before)
            (out / name).unlink()
        blocked = self.folder / 'file'
        blocked.write_text('')
        done = cli_test.vernier(*self.arguments()[:-1], blocked, '-q')
        self.assertEqual(done.returncode, 2, done.stderr)


if __name__ == '__main__':
    cli_test.PROGRAM = sys.argv.pop(1)
    unittest.main()
