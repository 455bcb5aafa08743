#!/usr/bin/env python3
# SPDX-FileCopyrightText: 2026 The Vernier authors
# SPDX-License-Identifier: Apache-2.0
"""vernier stereo as a user calls it: on a pair made here, boxes before a wall, and on real raw ones.

    stereo_test.py PROGRAM [unittest's options]
"""
import csv
import json
import math
import pathlib
import re
import shutil
import struct
import sys
import tempfile
import unittest

sys.dont_write_bytecode = True
import cli_test
from cli_test import IMAGES, CalibratedCase, Case
from evaluate_test import HEIGHT, WIDTH, pair, write_pgm

F_PX, BASELINE_M = 200, 0.1


def rows_of(file):
    with open(file, newline='') as text:
        return list(csv.DictReader(text))


def pinholes(covariance=True, offset=0):
    """The rig of the pair made here."""
    core = {'f_px': F_PX, 'ax': 1, 'ay': 1, 'ox_px': 99.5, 'oy_px': 59.5}
    rig = {'format': 'vernier/rig', 'version': 1, 'cameras': [
        {'name': 'left', 'model': 'pinhole', 'size_px': [WIDTH, HEIGHT], 'parameters': core},
        {'name': 'right', 'model': 'pinhole', 'size_px': [WIDTH, HEIGHT],
         'parameters': dict(core, ox_px=99.5 + offset),
         'from_first': {'rotation_rad': [0, 0, 0], 'translation_m': [-BASELINE_M, 0, 0]}}]}
    if covariance:
        names = [f'{side}.{name}' for side in ('left', 'right')
                 for name in ('f_px', 'ax', 'ox_px', 'oy_px')]
        names += ['right.wx_rad', 'right.wy_rad', 'right.wz_rad', 'right.tx_m', 'right.ty_m',
                  'right.tz_m']
        rig['parameter_names'] = names
        rig['parameters'] = [F_PX, 1, 99.5, 59.5, F_PX, 1, 99.5 + offset, 59.5, 0, 0, 0,
                             -BASELINE_M, 0, 0]
        variance = [0.0] * 14
        variance[names.index('right.tx_m')] = (0.02 * BASELINE_M)**2  # 2 % of the baseline
        rig['covariance'] = {'kind': 'prior', 'matrix': [
            [variance[i] if i == j else 0 for j in range(14)] for i in range(14)]}
    return rig


def plane(points):
    """a, b, c of d = a u + b v + c by least squares over (u, v, d)."""
    rows = [(u, v, 1) for u, v, _ in points]
    A = [[sum(r[i] * r[j] for r in rows) for j in range(3)] +
         [sum(r[i] * p[2] for r, p in zip(rows, points))] for i in range(3)]
    for i in range(3):
        A[i] = [x / A[i][i] for x in A[i]]
        for k in range(3):
            if k != i:
                A[k] = [x - A[k][i] * y for x, y in zip(A[k], A[i])]
    return [row[3] for row in A]


class Made(Case):
    @classmethod
    def setUpClass(cls):
        cls.shared = tempfile.TemporaryDirectory()
        cls.images = pathlib.Path(cls.shared.name)
        for name, rows in zip(('left', 'right'), pair()):
            write_pgm(cls.images / f'{name}.pgm', rows)
        write_pgm(cls.images / 'blank.pgm', [[100] * WIDTH for _ in range(HEIGHT)])
        write_pgm(cls.images / 'small.pgm', [[100] * 50 for _ in range(40)])
        (cls.images / 'rig.json').write_text(json.dumps(pinholes()))

    @classmethod
    def tearDownClass(cls):
        cls.shared.cleanup()

    def arguments(self, left='left', right='right', most=24, rectified=True):
        return ('stereo', '--left', self.images / f'{left}.pgm', '--right',
                self.images / f'{right}.pgm', '--max-disparity', most, '-o', self.folder / 'seen',
                *(('--rectified',) if rectified else ()))

    def values(self):
        return ('--f-px', F_PX, '--baseline-m', BASELINE_M, '--centre-px', '99.5,59.5')

    def test_disparities_without_cameras(self):
        done = self.works(*self.arguments(), '--json', '--picture', self.folder / 'edges.png')
        said = json.loads(done.stdout)
        self.assertIsNone(said['depth'])
        self.assertGreater(said['density'], 0.8)
        self.assertEqual(sorted(p.name for p in (self.folder / 'seen').iterdir()),
                         ['edges.csv', 'segments.csv', 'segments.json'])
        self.assertEqual((self.folder / 'edges.png').read_bytes()[:4], b'\x89PNG')
        edges = rows_of(self.folder / 'seen/edges.csv')
        self.assertEqual(len(edges), said['edges'])
        right = wrong = 0
        for edge in edges:
            if not edge['disparity_px']:
                continue
            self.assertGreater(float(edge['sigma_px']), 0)
            self.assertEqual((edge['depth_m'], edge['calibration_sigma_px']), ('', ''))
            near = min(abs(float(edge['disparity_px']) - d) for d in (6, 14)) < 0.7
            right, wrong = right + near, wrong + (not near)
        self.assertGreater(right, 30 * wrong)
        self.assertIn('no cameras given', self.works(*self.arguments()).stdout)

    def test_depths_with_values(self):
        said = json.loads(self.works(*self.arguments(), *self.values(), '--json').stdout)
        self.assertGreater(said['segments']['placed'], 20)
        self.assertIsNone(said['depth']['calibration_sigma_m'])
        wall, box = F_PX * BASELINE_M / 6, F_PX * BASELINE_M / 14
        for s in rows_of(self.folder / 'seen/segments.csv'):
            for end in '12':
                z = float(s[f'z{end}_m'])
                d = F_PX * BASELINE_M / z
                self.assertAlmostEqual(d, float(s[f'disparity{end}_px']), 4)
                near = min(abs(d - 6), abs(d - 14))
                self.assertLess(near, 5 * float(s[f'disparity{end}_sigma_px']) + 0.1)
                x = (float(s[f'u{end}_px']) - 99.5) * z / F_PX
                self.assertAlmostEqual(x, float(s[f'x{end}_m']), 4)
        self.assertLess(said['depth']['median_m'], 1.2 * wall)
        self.assertGreater(said['depth']['median_m'], 0.8 * box)
        ply = (self.folder / 'seen/segments.ply').read_text().splitlines()
        self.assertEqual(ply[0], 'ply')
        vertices = int(next(l for l in ply if l.startswith('element vertex')).split()[2])
        edges = int(next(l for l in ply if l.startswith('element edge')).split()[2])
        self.assertEqual((vertices, len(ply) - ply.index('end_header') - 1),
                         (2 * edges, vertices + edges))

    def test_an_offset_is_added_to_disparities(self):
        self.works(*self.arguments(), *self.values(), '--offset-px', 4, '-q')
        s = rows_of(self.folder / 'seen/segments.csv')[0]
        self.assertAlmostEqual(float(s['z1_m']), F_PX * BASELINE_M / (float(s['disparity1_px']) + 4),
                               4)
        (self.folder / 'rig.json').write_text(json.dumps(pinholes(offset=4)))
        first = (self.folder / 'seen/segments.csv').read_text()
        self.works(*self.arguments(), '--rig', self.folder / 'rig.json', '-q')
        again = rows_of(self.folder / 'seen/segments.csv')[0]
        self.assertAlmostEqual(float(again['z1_m']), float(s['z1_m']), 6)
        self.assertIn(s['z1_m'], first)

    def test_both_parts_of_the_covariance(self):
        done = self.works(*self.arguments(), '--rig', self.images / 'rig.json', '--json')
        said = json.loads(done.stdout)
        # 2 % of the baseline is 2 % of every depth.
        self.assertAlmostEqual(said['depth']['calibration_sigma_m'] / said['depth']['median_m'],
                               0.02, 2)
        file = json.loads((self.folder / 'seen/segments.json').read_text())
        self.assertEqual((file['format'], file['version'], file['frame']),
                         ('vernier/segments', 1, 'left camera'))
        names = file['parameter_names']
        self.assertEqual(len(file['segments']), said['segments']['placed'])
        self.assertEqual(len(file['segments']) + len(file['refused']),
                         sum(n for k, n in said['segments'].items() if k != 'found'))
        k = names.index('right.tx_m')
        for s in file['segments']:
            by_baseline = [row[k] for row in s['by_rig']]
            for i, x in enumerate(s['a_m'] + s['b_m']):
                self.assertAlmostEqual(by_baseline[i] * -BASELINE_M, x, 9)  # all scales with it
                self.assertAlmostEqual(s['calibration_m2'][i][i], (0.02 * x)**2, 9)
                self.assertGreaterEqual(s['independent_m2'][i][i], 0)
        edge = next(e for e in rows_of(self.folder / 'seen/edges.csv') if e['disparity_px'])
        self.assertAlmostEqual(float(edge['calibration_sigma_px']), 0)  # a baseline moves no pixel

    def test_other_matchers(self):
        for matcher in ('stretch', 'bm', 'sgbm'):
            said = json.loads(self.works(*self.arguments(), '--matcher', matcher, '--json').stdout)
            self.assertEqual(said['matcher'], matcher)
            self.assertGreater(said['matched'], 0)

    def test_any_run_gives_the_same_files(self):
        read = lambda: [(self.folder / 'seen' / f).read_bytes()
                        for f in ('edges.csv', 'segments.csv', 'segments.json', 'segments.ply')]
        self.works(*self.arguments(), *self.values(), '-q')
        first = read()
        self.works(*self.arguments(), *self.values(), '-q', '--threads', 3)
        self.assertEqual(first, read())

    def test_a_range_that_the_scene_is_not_in_is_doubted(self):
        of_range = lambda least, most: (*self.arguments(most=most), '--min-disparity', least)
        for least, most, of in ((0, 6, '--max-disparity'),  # the wall is at 6, the box at 14
                                (10, 24, '--min-disparity')):
            done = cli_test.vernier(*of_range(least, most), '--json')
            self.assertEqual(done.returncode, 3, done.stderr)
            (doubt,) = json.loads(done.stdout)['doubts']
            self.assertRegex(doubt, r'^[0-9]+ % of the edges match (below 10|above 6) px, outside the range')
            wider = int(re.search(of + r' (-?[0-9]+)', doubt).group(1))
            again = of_range(least, wider) if of == '--max-disparity' else of_range(wider, most)
            self.assertNotIn('outside the range', self.works(*again).stderr)

    def test_far_scenes_are_doubted(self):
        done = cli_test.vernier(*self.arguments(), *self.values(), '--offset-px', -5.5, '--json')
        self.assertEqual(done.returncode, 3, done.stderr)
        self.assertIn('uncertain by more than 10 %', json.loads(done.stdout)['doubts'][-1])
        self.assertTrue((self.folder / 'seen/segments.json').exists())

    def test_a_scene_beyond_the_greatest_depth_is_doubted(self):
        done = cli_test.vernier(*self.arguments(), *self.values(), '--max-depth-m', 0.01, '--json')
        self.assertEqual(done.returncode, 3, done.stderr)
        self.assertRegex(json.loads(done.stdout)['doubts'][-1], '^no segment lies nearer than 0.01 m, .*--max-depth-m$')

    def test_vertical_disparity_is_doubted_in_silence_too(self):
        for down in (1, 3):
            rows = pair()[1]
            write_pgm(self.images / 'lower.pgm', rows[:1] * down + rows[:HEIGHT - down])
            done = cli_test.vernier(*self.arguments(right='lower'), '-q', '--json')
            self.assertEqual(done.returncode, 3, done.stderr)
            self.assertIn(f'misaligned by {down}.0', done.stderr)
            self.assertTrue((self.folder / 'seen/edges.csv').exists())
            said = json.loads(done.stdout)
            self.assertTrue(said['vertical_field']['misaligned'])
            self.assertEqual(len(said['doubts']), 1)  # one line for one cause
            self.works(*self.arguments(right='lower'), '-q', '--repair')

    def test_an_offset_says_that_disparities_are_negative(self):
        """The right principal point is 16 px further right: the wall's 6 px become -10."""
        write_pgm(self.images / 'shifted.pgm', [row[:1] * 16 + row[:-16] for row in pair()[1]])
        words = self.arguments(right='shifted', most=8)
        done = self.works(*words, *self.values(), '--offset-px', 16, '--json')
        said = json.loads(done.stdout)
        self.assertEqual((said['min_disparity_px'], said['max_disparity_px']), (-16, 8))
        self.assertGreater(said['density'], 0.8)
        self.assertIn('disparities from -16 px are searched', done.stderr)
        self.assertAlmostEqual(said['depth']['median_m'], F_PX * BASELINE_M / 6, 0)
        (self.folder / 'rig.json').write_text(json.dumps(pinholes(offset=16)))
        said = json.loads(self.works(*words, '--rig', self.folder / 'rig.json', '--json').stdout)
        self.assertEqual(said['min_disparity_px'], -16)
        said = json.loads(cli_test.vernier(*words, *self.values(), '--offset-px', 16,
                                           '--min-disparity', -12, '--json').stdout)
        self.assertEqual(said['min_disparity_px'], -12)
        self.complains(*self.arguments(right='shifted', most=12), '-q',
                       of='give a smaller --min-disparity')
        self.complains(*self.arguments(), *self.values(), '-q', '--offset-px', 5000,
                       of='--offset-px: the principal points are 5000 px apart')

    def program(self, scale):
        """A matcher that writes the true map, its values times `scale`."""
        truth = pair()[2]
        with open(self.folder / 'map.pfm', 'wb') as out:
            out.write(b'Pf\n%d %d\n-1\n' % (WIDTH, HEIGHT))
            for row in reversed(truth):
                out.write(struct.pack(f'<{WIDTH}f', *(scale * value / 4 for value in row)))
        return f"sh -c 'cp \"$0\" \"$1\"' {self.folder}/map.pfm {{output}} {{left}} {{right}}"

    def test_a_programs_map_of_another_scale_is_doubted(self):
        words = (*self.arguments(), *self.values(), '--json', '-q', '--command')
        self.assertGreater(json.loads(self.works(*words, self.program(1)).stdout)['density'], 0.95)
        for scale in (4, 256):
            done = cli_test.vernier(*words, self.program(scale))
            self.assertEqual(done.returncode, 3, done.stderr)
            self.assertIn('the scale of its map may be wrong', done.stderr)
            self.assertEqual(len(json.loads(done.stdout)['doubts']), 1)

    def test_programs_take_no_matchers_name(self):
        for name in ('edge', 'stretch', 'bm', 'sgbm'):
            self.complains(*self.arguments(), '-q', '--command', name + '=x {left} {right} {output}',
                           of=f'"{name}" is a built-in matcher; give the program another name',
                           leaves=[self.folder / 'seen'])
        self.complains(*self.arguments(), '-q', '--min-disparity', -4, '--command',
                       'x {left} {right} {output.png}', of='a PNG cannot hold',
                       leaves=[self.folder / 'seen'])

    def opencv_rig(self, baseline_m=BASELINE_M):
        rig = pinholes(covariance=False)
        rig['cameras'][1]['from_first']['translation_m'][0] = -baseline_m
        (self.folder / 'rig.json').write_text(json.dumps(rig))
        file = self.folder / 'rig.yml'
        self.works('convert', self.folder / 'rig.json', '--to', 'opencv', '-o', file, '-q')
        return file

    def test_images_tell_the_size_that_an_opencv_file_lacks(self):
        file = self.opencv_rig()
        lines = file.read_text().splitlines()
        file.write_text('\n'.join(line for line in lines if not line.startswith('image_')))
        words = self.arguments(rectified=False)
        said = json.loads(self.works(*words, '--rig', file, '--json', '-q').stdout)
        self.assertGreater(said['segments']['placed'], 20)
        rectified = self.works('rectify', '--rig', file, *words[1:5], '-o', self.folder / 'r', '--json')
        self.assertEqual(json.loads(rectified.stdout)['size_px'], [WIDTH, HEIGHT])
        self.complains('convert', file, '-o', self.folder / 'x.json', '-q', of="convert's option --size",
                       leaves=[self.folder / 'x.json'])

    def test_a_baseline_in_millimetres_is_told(self):
        words = self.arguments(rectified=False)
        done = self.works(*words, '--rig', self.opencv_rig())
        self.assertNotIn('millimetres', done.stderr)
        done = cli_test.vernier(*words, '--rig', self.opencv_rig(1000 * BASELINE_M))
        self.assertEqual(done.returncode, 3, done.stderr)
        self.assertIn('is 100 m from the first; if the file is in millimetres, convert it',
                      done.stderr)
        self.assertIn('no segment lies nearer than 30 m', done.stderr)

    def test_rows_that_cannot_be_checked_are_told(self):
        for name, rows in zip(('left', 'right'), pair()):
            write_pgm(self.images / f'{name}_strip.pgm', rows[40:80])
        done = cli_test.vernier(*self.arguments(left='left_strip', right='right_strip'))
        self.assertIn('warning: row alignment could not be checked: too few corners', done.stderr)

    def test_a_principal_point_outside_is_told(self):
        done = self.works(*self.arguments(), *self.values()[:4], '--centre-px', '9999,5')
        self.assertIn('--centre-px 9999,5: outside the image of 200x120 px', done.stderr)

    def test_12_bits_in_16_are_told(self):
        for name, rows in zip(('left', 'right'), pair()):
            with open(self.images / f'{name}12.pgm', 'wb') as out:
                out.write(b'P5\n%d %d\n65535\n' % (WIDTH, HEIGHT))
                for row in rows:
                    out.write(struct.pack(f'>{WIDTH}H', *(4 * value for value in row)))
        self.complains(*self.arguments(left='left12', right='right12'), '-q',
                       of='those of 12 bits in a 16-bit file by 16', leaves=[self.folder / 'seen'])

    def test_complaints(self):
        out = [self.folder / 'seen']
        for files, words in ((dict(right='small'), 'small.pgm: the left image is 200x120'),
                             (dict(left='blank', right='right'), 'no edges'),
                             (dict(left='right', right='left'), 'appear to be swapped'),
                             (dict(most=400), '--max-disparity: the disparity range 0 to 400 exceeds'),
                             (dict(right='left'), 'same image'),
                             (dict(rectified=False), "no rig given")):
            self.complains(*self.arguments(**files), '-q', of=words, leaves=out)
        for options, words in ((('--f-px', 200), '--baseline-m'),
                               (('--baseline-m', 0.1), '--f-px'),
                               ((*self.values(), '--rig', self.images / 'rig.json'), 'leave them out'),
                               (('--matcher', 'edge,sgbm'), 'more than one'),
                               (('--matcher', 'best'), 'unknown matcher "best"'),
                               (('--f-px', 'nan'), '--f-px'),
                               (('--epipolar-reject-deg', 90), '--epipolar-reject-deg'),
                               (('--min-disparity', 30), 'the disparity range'),
                               (('--rig', 'nominal'), 'two parallel pinhole cameras')):
            self.complains(*self.arguments(), '-q', *options, of=words, leaves=out)

    def test_outputs_never_replace_inputs(self):
        out = self.folder / 'seen'
        out.mkdir()
        shutil.copy(self.images / 'rig.json', out / 'segments.json')
        before = (out / 'segments.json').read_bytes()
        self.complains(*self.arguments(), '--rig', out / 'segments.json', '-q', of='is an input')
        self.assertEqual((out / 'segments.json').read_bytes(), before)
        (self.folder / 'left.png').symlink_to(self.images / 'left.pgm')
        self.complains(*self.arguments(), '-q', '--picture', self.folder / 'left.png',
                       of='is an input')


@unittest.skipUnless((IMAGES / 'left01.jpg').exists(), 'opencv-doc has no images here')
class Raw(CalibratedCase):
    def arguments(self, left='left01', right='right01'):
        return ('stereo', '--rig', self.rig, '--left', IMAGES / f'{left}.jpg', '--right',
                IMAGES / f'{right}.jpg', '--max-disparity', 160, '-o', self.folder / 'seen')

    def board_corners(self):
        """(u, v, d) of the board's corners, found by vernier detect in the images that vernier
        rectify makes of the same pair."""
        self.works('rectify', *self.arguments()[1:7], '-o', self.folder / 'rectified', '-q')
        for side in ('left', 'right'):
            shutil.copy(self.folder / f'rectified/{side}.png', self.folder / f'{side}1.png')
        self.works('detect', '--left', self.folder / 'left1.png', '--right',
                   self.folder / 'right1.png', '--board', '9x6', '-o', self.folder / 'corners.vnl')
        seen = {'left1.png': [], 'right1.png': []}
        for line in (self.folder / 'corners.vnl').read_text().splitlines():
            if not line.startswith('#') and line.split()[1] != '-':
                name, x, y = line.split()[:3]
                seen[pathlib.Path(name).name].append((float(x), float(y)))
        return [(u, v, u - other) for (u, v), (other, _) in zip(*seen.values())]

    def test_a_chessboards_segments_are_on_its_plane(self):
        """The board's corners span a plane, d = a u + b v + c; segments among them lie on it within
        their matching's standard deviation (the rig's errors are the same for both)."""
        said = json.loads(self.works(*self.arguments(), '--json').stdout)
        self.assertGreater(said['segments']['placed'], 150)
        self.assertGreater(said['depth']['calibration_share'], 0)
        self.assertLess(said['depth']['calibration_share'], 1)
        file = json.loads((self.folder / 'seen/segments.json').read_text())
        self.assertEqual(len(file['segments'][0]['by_rig'][0]), len(file['parameter_names']))
        self.assertEqual(len(file['rig_covariance']), len(file['parameter_names']))
        corners = self.board_corners()
        a, b, c = plane(corners)
        self.assertLess(max(abs(d - a * u - b * v - c) for u, v, d in corners), 1)
        low, high = ([f(p[i] for p in corners) for i in (0, 1)] for f in (min, max))
        off = []
        for s in file['segments']:
            if not all(low[i] < end[i] < high[i] for end in s['left_px'] for i in (0, 1)):
                continue
            C = s['image_covariance_px2']
            J = [-a / 2, -b / 2, -a / 2, -b / 2, 0.5, 0.5]  # of the middle
            sigma = math.sqrt(sum(J[i] * C[i][j] * J[j] for i in range(6) for j in range(6)))
            u, v = ((s['left_px'][0][i] + s['left_px'][1][i]) / 2 for i in (0, 1))
            off.append((sum(s['disparity_px']) / 2 - a * u - b * v - c) / sigma)
        self.assertGreater(len(off), 15)
        within = sum(abs(z) < 2 for z in off) / len(off)
        self.assertGreater(within, 0.85)
        self.assertLess(sorted(map(abs, off))[len(off) // 2], 1.2)

    def test_exchanged_images_are_told(self):
        self.complains(*self.arguments('right01', 'left01'), '-q', of='appear to be swapped',
                       leaves=[self.folder / 'seen'])

    def test_raw_images_taken_for_rectified_are_doubted(self):
        words = [w for w in self.arguments() if w not in ('--rig', self.rig)]
        done = cli_test.vernier(*words, '--rectified')
        self.assertEqual(done.returncode, 3, done.stderr)
        self.assertIn('the rows of the two images are not aligned', done.stderr)
        self.assertIn('rectify the pair first', done.stderr)
        self.assertEqual(done.stderr.count('trustworthy: '), 1)  # one line for one cause

    def test_repair(self):
        rig = json.loads(self.rig.read_text())
        rig['cameras'][1]['parameters']['oy_px'] -= 2
        rig['parameters'][rig['parameter_names'].index('right.oy_px')] -= 2
        lowered = self.folder / 'lowered.json'
        lowered.write_text(json.dumps(rig))
        words = ['stereo', '--rig', lowered, *self.arguments()[3:], '--json']
        done = cli_test.vernier(*words, '-q')
        self.assertEqual(done.returncode, 3, done.stderr)
        self.assertRegex(done.stderr, 'misaligned by [12]')
        self.assertTrue((self.folder / 'seen/segments.json').exists())
        plain = json.loads(done.stdout)
        repaired = json.loads(self.works(*words, '--repair').stdout)
        self.assertTrue(plain['vertical_field']['significant'])
        self.assertFalse(plain['vertical_field']['repaired'])
        self.assertTrue(repaired['vertical_field']['repaired'])
        self.assertGreater(repaired['matched'], 1.05 * plain['matched'])


if __name__ == '__main__':
    cli_test.PROGRAM = sys.argv.pop(1)
    unittest.main()
