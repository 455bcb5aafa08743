#!/usr/bin/env python3
# SPDX-FileCopyrightText: 2026 The Vernier authors
# SPDX-License-Identifier: Apache-2.0
"""The program from outside: outputs, exit codes, one-line complaints, nothing half-written.

    cli_test.py PROGRAM [unittest's options]
"""
import json
import math
import os
import pathlib
import random
import re
import shutil
import subprocess
import sys
import tempfile
import unittest

PROGRAM = None
ROOT = pathlib.Path(__file__).resolve().parents[2]
IMAGES = pathlib.Path('/usr/share/doc/opencv-doc/examples/data')
if not (IMAGES / 'left01.jpg').exists():
    IMAGES = ROOT / 'build/opencv-doc' / IMAGES.relative_to('/')


def vernier(*words, **more):
    return subprocess.run([PROGRAM, *map(str, words)], capture_output=True, text=True, **more)


class Case(unittest.TestCase):
    def setUp(self):
        self.temporary = tempfile.TemporaryDirectory()
        self.folder = pathlib.Path(self.temporary.name)

    def tearDown(self):
        self.temporary.cleanup()

    def works(self, *words, **more):
        done = vernier(*words, **more)
        self.assertEqual(done.returncode, 0, done.stderr)
        return done

    def complains(self, *words, of, leaves=()):
        """Exit code 2, one line on standard error that holds `of`, nothing on standard output."""
        done = vernier(*words)
        self.assertEqual(done.returncode, 2, done.stdout + done.stderr)
        self.assertEqual(done.stdout, '')
        lines = done.stderr.strip().splitlines()
        self.assertEqual(len(lines), 1, done.stderr)
        self.assertTrue(lines[0].startswith('vernier: '), lines[0])
        self.assertIn(of, lines[0])
        for path in leaves:
            self.assertFalse(path.exists(), f'{path} was left behind')
        self.assertEqual(list(self.folder.glob('*.tmp')), [])


class CalibratedCase(Case):
    """With the rig of Debian's thirteen real pairs in cls.rig."""

    @classmethod
    def setUpClass(cls):
        cls.shared = tempfile.TemporaryDirectory()
        cls.rig = pathlib.Path(cls.shared.name) / 'rig.json'
        done = vernier(
            'calibrate', '--left', IMAGES / 'left[0-9]*.jpg', '--right', IMAGES / 'right[0-9]*.jpg',
            '--board', '9x6', '--square-m', 0.025, '--model', 'opencv5', '--no-model-check',
            '--no-evidence', '-o', cls.rig)
        assert done.returncode == 0, done.stderr

    @classmethod
    def tearDownClass(cls):
        cls.shared.cleanup()


class Help(Case):
    def test_every_verb_has_help_with_an_example(self):
        text = self.works('--help').stdout
        self.assertIn('Example:', text)
        listed = text.split('Subcommands:')[1].split('Example:')[0]
        verbs = re.findall(r'^  (\w+) ', listed, re.M)
        self.assertGreaterEqual(len(verbs), 8)
        for verb in verbs:
            self.assertIn('Example:', self.works(verb, '--help').stdout, verb)
        for verb in ('make', 'info'):
            self.assertIn('Example:', self.works('world', verb, '--help').stdout)

    def test_help_is_given_whatever_else_is_wrong_on_the_line(self):
        asked = self.works('world', 'info', '--help').stdout
        for words in (['--poses', '-3'], ['--plan', 'missing/x.svg'], ['--nonsense'], ['a', 'b']):
            self.assertEqual(self.works('world', 'info', *words, '--help').stdout, asked)
            self.assertEqual(self.works('world', 'info', '-h', *words).stdout, asked)
            self.assertEqual(self.works('world', '--nonsense', 'info', *words, '-h').stdout, asked)

    def test_version(self):
        self.assertRegex(self.works('--version').stdout, r'^vernier \d+\.\d+\.\d+\n$')

    def test_bad_usage(self):
        self.complains('frobnicate', of='frobnicate')
        self.complains(of='no verb')
        self.complains('calibrate', of='--output')
        self.complains('sample', 'nominal', '-n', '0', '-o', 'x.csv', of='count')

    def test_doctor(self):
        found = json.loads(self.works('doctor', '--json').stdout)['findings']
        self.assertIn('Ceres', [f['what'] for f in found])

    def test_doctor_says_where_the_real_pairs_are(self):
        unpacked = self.folder / 'build/opencv-doc/usr/share/doc/opencv-doc/examples/data'
        unpacked.mkdir(parents=True)
        (unpacked / 'left01.jpg').touch()
        installed = pathlib.Path('/usr/share/doc/opencv-doc/examples/data')
        there = (installed / 'left01.jpg').exists()
        expected = installed if there else unpacked.relative_to(self.folder)
        done = self.works('doctor', '--json', cwd=self.folder)
        pairs = next(f for f in json.loads(done.stdout)['findings']
                     if f['what'] == 'real chessboard pairs')
        self.assertEqual((pairs['value'], pairs['found']), (f'found in {expected}', True))


@unittest.skipUnless((IMAGES / 'left01.jpg').exists(), 'opencv-doc has no images here')
class RealPairs(Case):
    def calibrate(self, *more):
        return self.works('calibrate', '--left', IMAGES / 'left[0-9]*.jpg', '--right',
                          IMAGES / 'right[0-9]*.jpg', '--board', '9x6', '--square-m', '0.025',
                          '-o', self.folder / 'rig.json', '--json', *more)

    def test_bounds_of_the_real_set(self):
        radial = json.loads(self.calibrate().stdout)
        self.assertEqual(radial['views'], 13)
        self.assertLessEqual(radial['rms_px'], 0.20)
        self.assertLessEqual(json.loads(self.calibrate('--model', 'opencv5').stdout)['rms_px'], 0.16)

    def test_board_shape_and_motion(self):
        usual = json.loads(self.calibrate('--no-model-check', '--no-effects').stdout)
        found = json.loads(self.calibrate('--no-model-check', '--model', 'opencv4').stdout)
        for effect in ('shape', 'motion'):  # a board held by hand
            self.assertLess(found['effects_test'][effect]['p_value'], 0.01)
        rig = json.loads((self.folder / 'rig.json').read_text())
        self.assertEqual(len(rig['evidence']['observations']), 26)
        effects = rig['calibration']['effects']
        self.assertEqual(len(effects['shape_m']), 3 * 54)
        self.assertGreater(effects['shape_height_m'], 2e-5)
        self.assertLess(effects['shape_height_m'], 5e-4)
        self.works('sample', self.folder / 'rig.json', '-n', '2', '-o', self.folder / 's.csv')
        checked = self.works('check', self.folder / 'rig.json', '--trials', '60', '--no-mrcal', '--json')
        self.assertIn("the board's shape and motion are estimated; checked without, from the same "
                      'corners: mrcal and Monte Carlo', checked.stderr)
        self.assertTrue(all(gate['ok'] for gate in json.loads(checked.stdout)['file'].values()
                            if isinstance(gate, dict) and 'ok' in gate))
        combined = self.works('combine', self.folder / 'rig.json', '-o', self.folder / 'prior.json')
        self.assertIn('its corners are combined without', combined.stderr)
        self.assertIn('13 views, rms', combined.stdout)
        self.assertNotIn('board warp', combined.stdout)
        advised = self.works('advise', self.folder / 'rig.json', '--reduce', 'depth', '--at-m', '5')
        self.assertIn("without the board's shape and motion", advised.stderr)
        self.assertIn("(without the board's shape and motion)", self.works(
            'plan', self.folder / 'rig.json', '--depth-error', '0.01@2').stdout)
        forced = json.loads(self.calibrate('--no-model-check', '--board-shape', '--motion').stdout)
        self.assertNotIn('effects_test', forced)
        rig = json.loads((self.folder / 'rig.json').read_text())
        for key in ('pixel_sigma_px', 'rms_px', 'chi2', 'dof'):
            self.assertEqual(rig['calibration'][key], usual['calibration'][key]
                             if 'calibration' in usual else usual[key])
        self.assertIn('(without random effects)', self.works(
            'calibrate', '--left', IMAGES / 'left[0-9]*.jpg', '--right', IMAGES / 'right[0-9]*.jpg',
            '--board', '9x6', '--square-m', '0.025', '--no-model-check', '--motion', '-o',
            self.folder / 'motion.json').stdout)
        self.complains('calibrate', '--left', IMAGES / 'left[0-9]*.jpg', '--right',
                       IMAGES / 'right[0-9]*.jpg', '--board', '9x6', '--square-m', '0.025',
                       '-o', self.folder / 'no.json', '--no-effects', '--motion', of='--motion')
        for option, of in ((('--warp',), '--warp: is not estimated beside --board-shape, '
                            '--motion or --board-aspect; leave it out; --board-shape contains it'),
                           (('--pixel-sigma', '0.2'), '--pixel-sigma: is estimated with '
                            '--board-shape, --motion and --board-aspect; leave it out')):
            self.complains('calibrate', '--left', IMAGES / 'left[0-9]*.jpg', '--right',
                           IMAGES / 'right[0-9]*.jpg', '--board', '9x6', '--square-m', '0.025',
                           '-o', self.folder / 'no.json', '--motion', *option, of=of)
            self.assertFalse((self.folder / 'no.json').exists())

    def test_detect_then_calibrate_is_the_same(self):
        direct = json.loads(self.calibrate().stdout)
        self.works('detect', '--left', IMAGES / 'left[0-9]*.jpg', '--right',
                   IMAGES / 'right[0-9]*.jpg', '--board', '9x6', '-o', self.folder / 'corners.vnl')
        again = self.works('calibrate', '--corners', self.folder / 'corners.vnl', '--board', '9x6',
                           '--square-m', '0.025', '--size', '640x480', '-o',
                           self.folder / 'again.json', '--json')
        self.assertEqual(json.loads(again.stdout)['parameters'], direct['parameters'])

    def test_rig_file_and_samples(self):
        self.calibrate()
        rig = json.loads((self.folder / 'rig.json').read_text())
        self.assertEqual((rig['format'], rig['version']), ('vernier/rig', 1))
        self.assertEqual(rig['parameter_names'][:5],
                         ['left.f_px', 'left.ax', 'left.ox_px', 'left.oy_px', 'left.k1'])
        self.assertEqual(len(rig['covariance']['matrix']), 16)
        done = self.works('sample', self.folder / 'rig.json', '--psi-c', '1', '-n', '100', '--seed',
                          '1', '-o', self.folder / 'samples.csv')
        self.assertIn('of this direction is the', done.stdout)
        lines = (self.folder / 'samples.csv').read_text().splitlines()
        self.assertEqual(lines[0].split(','), rig['parameter_names'])
        self.assertEqual(len(lines), 101)
        twice = self.folder / 'twice.csv'
        self.works('sample', self.folder / 'rig.json', '--psi-c', '2', '-n', '100', '--seed', '1',
                   '-o', twice)
        for one, two in zip(lines[1:], twice.read_text().splitlines()[1:]):
            one, two = float(one.split(',')[0]), float(two.split(',')[0])
            # exactly twice in stable parameters, nearly so in the file's
            self.assertAlmostEqual(two - rig['parameters'][0], 2 * (one - rig['parameters'][0]), delta=0.05)

    def page_data(self, *inputs):
        """What the page of these inputs carries, and what was said on the way."""
        page = self.folder / 'report.html'
        done = self.works('report', *inputs, '-o', page)
        text = page.read_text()
        self.assertFalse('<!--VERNIER' in text, 'a mark of the template is left')
        data = re.search(r'<script type="application/json" id="data">(.*?)</script>', text, re.S)
        return json.loads(data[1]), done.stderr

    def test_report_of_a_rig_file_shows_its_calibration(self):
        self.calibrate()
        data, _ = self.page_data(self.folder / 'rig.json')
        self.assertNotIn('study', data)
        rig, = data['rigs']
        self.assertEqual(rig['calibration']['corners_used'], 13 * 2 * 54)
        for camera in rig['corners']:
            self.assertEqual(len(camera['points']), 13 * 54)
            self.assertEqual(sum(camera['structure']['counts']), 13 * 54)
        for camera in rig['projection']['cameras']:
            self.assertEqual([m['distance_m'] for m in camera['maps']], [1, 5, None])
            for row in camera['figures']:
                self.assertGreater(row['centre_px'], row['centre_bound_px'])
        self.assertEqual(len(rig['view_influence']), 13)
        self.assertAlmostEqual(sum(v['leverage'] for v in rig['view_influence']), 16, places=2)
        models = rig['proof']['models']['rows']
        self.assertEqual([m['model'] for m in models][:2], ['radial1', 'opencv4'])
        self.assertLess(models[1]['held_out_rms_px'], models[0]['held_out_rms_px'])
        for row in rig['proof']['left_out']['rows']:
            self.assertGreater(row['coverage_honest'], row['coverage_mvb'])
        again, _ = self.page_data(self.folder / 'rig.json')
        self.assertEqual(again, data)

    def test_report_says_what_a_rig_file_does_not_hold(self):
        self.calibrate('--no-evidence')
        data, _ = self.page_data(self.folder / 'rig.json', 'nominal', '--no-proof')
        bare, nominal = data['rigs']
        self.assertIn('does not contain its calibration data', bare['missing'])
        self.assertEqual(len(bare['correlation']), 16)
        for key in ('corners', 'projection', 'view_influence', 'proof'):
            self.assertNotIn(key, bare)
        self.assertNotIn('missing', nominal)
        self.assertNotIn('proof', nominal)

    def test_report_of_held_parameters_and_a_prior(self):
        self.calibrate('--hold', 'left.ax=1', '--know', 'left.f_px=533,2')
        rig, = self.page_data(self.folder / 'rig.json')[0]['rigs']
        self.assertNotIn('left.ax', rig['correlation_names'])
        self.assertEqual(len(rig['correlation']), 15)
        self.assertLess(sum(v['leverage'] for v in rig['view_influence']), 15)
        self.assertIn('also used a prior or matched pairs', rig['proof']['notes'][0])

    def test_report_of_held_parameters_and_other_names(self):
        self.calibrate('--hold', 'left.ax=1')
        self.works('convert', self.folder / 'rig.json', '--names', 'port,starboard', '-o',
                   self.folder / 'named.json')
        first, named = (self.page_data(self.folder / name)[0]['rigs'][0]
                        for name in ('rig.json', 'named.json'))
        self.assertEqual(named['proof']['notes'], [])
        self.assertEqual(named['proof']['left_out'], first['proof']['left_out'])
        for a, b in zip(first['proof']['models']['rows'], named['proof']['models']['rows']):
            self.assertAlmostEqual(a['held_out_rms_px'], b['held_out_rms_px'], places=9)

    def test_wrong_board_size(self):
        self.complains('calibrate', '--left', IMAGES / 'left0[12].jpg', '--right',
                       IMAGES / 'right0[12].jpg', '--board', '11x8', '--square-m', '0.025', '-o',
                       self.folder / 'rig.json', of='no 11x8 board in any image',
                       leaves=[self.folder / 'rig.json'])


    def test_smaller_board_than_there_is(self):
        for size in ('8x6', '9x5'):
            self.complains('detect', '--left', IMAGES / 'left0[1-4].jpg', '--board', size, '-o',
                           self.folder / 'c.vnl', of='more inner corners than the ' + size,
                           leaves=[self.folder / 'c.vnl'])

    def test_one_camera_and_cameras_by_name(self):
        done = self.works('detect', '--left', IMAGES / 'left0[1-4].jpg', '--board', '9x6', '-o',
                          self.folder / 'c.vnl', '--json')
        found = json.loads(done.stdout)
        self.assertEqual((found['boards'], found['frames'], found['refused']), (4, 4, []))
        self.assertEqual([(u['camera'], u['corners']) for u in found['used']], [(0, 54)] * 4)
        pair = self.works('detect', '--left', IMAGES / 'left0[1-4].jpg', '--right',
                          IMAGES / 'right0[1-4].jpg', '--board', '9x6', '-o', self.folder / 'a.vnl')
        self.assertIn('8 boards detected in 4 frames', pair.stdout)
        self.works('detect', '--camera', IMAGES / 'left0[1-4].jpg', '--camera',
                   IMAGES / 'right0[1-4].jpg', '--board', '9x6', '-o', self.folder / 'b.vnl')
        self.assertEqual((self.folder / 'a.vnl').read_text(), (self.folder / 'b.vnl').read_text())
        done = self.works('calibrate', '--left', IMAGES / 'left[0-9]*.jpg', '--board', '9x6',
                          '--square-m', '0.025', '-o', self.folder / 'one.json', '--json')
        self.assertEqual(len(json.loads(done.stdout)['parameters']), 5)

    def test_a_truncated_image(self):
        for name in ('left01.jpg', 'left02.jpg'):
            data = (IMAGES / name).read_bytes()
            (self.folder / name).write_bytes(data if name == 'left01.jpg' else data[:9000])
        detect = ('detect', '--left', self.folder / 'left*.jpg', '--board', '9x6', '-o',
                  self.folder / 'c.vnl')
        done = self.works(*detect)
        self.assertIn('1 boards detected in 1 frames', done.stdout)
        self.assertIn('left02.jpg: is cut off', done.stdout)
        (self.folder / 'c.vnl').unlink()
        for name in ('left01.jpg', 'left02.jpg'):
            (self.folder / name).write_bytes((IMAGES / name).read_bytes()[:9000])
        self.complains(*detect, of='left01.jpg: is cut off', leaves=[self.folder / 'c.vnl'])

    def test_kalibrs_checkerboard_file(self):
        target = self.folder / 'target.yaml'
        target.write_text("target_type: 'checkerboard'\ntargetCols: 9   # inner corners\n"
                          'targetRows: 6\nrowSpacingMeters: 0.025\ncolSpacingMeters: 0.025\n')
        self.works('detect', '--left', IMAGES / 'left0[12].jpg', '--target', target, '-o',
                   self.folder / 'c.vnl')
        target.write_text('target_type: circlegrid\n')
        self.complains('detect', '--left', IMAGES / 'left0[12].jpg', '--target', target, '-o',
                       self.folder / 'd.vnl',
                       of='target.yaml:1: circlegrid targets are not supported')

    def test_levels_of_a_corners_file(self):
        self.works('detect', '--left', IMAGES / 'left[0-9]*.jpg', '--board', '9x6', '-o',
                   self.folder / 'c.vnl')
        lines = (self.folder / 'c.vnl').read_text().splitlines()
        lines[1] = lines[1][:-1] + '1'
        lines[2] = lines[2][:-1] + '-'
        (self.folder / 'c.vnl').write_text('\n'.join(lines))
        done = self.works('calibrate', '--corners', self.folder / 'c.vnl', '--board', '9x6',
                          '--square-m', '0.025', '--size', '640x480', '-o', self.folder / 'r.json')
        self.assertIn('1 corners have a level above 0', done.stderr)
        view = json.loads((self.folder / 'r.json').read_text())['evidence']['observations'][0]
        self.assertEqual(view['ids'], [0] + list(range(2, 54)))


def board_lines(frames=12, tilts=True, cameras=2):
    """observations.csv of pinhole cameras and a 9x6 board, with noise of 0.2 px, as lines."""
    chance = random.Random(5)
    lines = ['frame,camera,row,col,X,Y,Z,qx,qy']
    for frame in range(frames):
        a, b = (0.5 * math.sin(2.1 * frame), 0.5 * math.cos(1.7 * frame)) if tilts else (0, 0)
        at = 0.12 * math.sin(frame), 0.08 * math.cos(3 * frame), 0.6 + 0.02 * frame
        for camera in range(cameras):
            for row in range(6):
                for col in range(9):
                    X, Y = 0.025 * col, 0.025 * row
                    x, y = X - 0.1, Y - 0.0625
                    y, z = y * math.cos(a), y * math.sin(a)
                    x, z = x * math.cos(b) + z * math.sin(b), z * math.cos(b) - x * math.sin(b)
                    x, y, z = x + at[0] + 0.03 - 0.06 * camera, y + at[1], z + at[2]
                    u = 320 + 500 * x / z + chance.gauss(0, 0.2)
                    v = 240 + 500 * y / z + chance.gauss(0, 0.2)
                    lines.append(f'{frame},{camera},{row},{col},{X},{Y},0,{u},{v}')
    return lines


class BadBoards(Case):
    """What calibrate says of corners that cannot be right, and how it ends."""

    def changed(self, change, **more):
        """The arguments of calibrate for lines changed field by field: None leaves a line out."""
        header, *lines = board_lines(**more)
        fields = [change(*[int(f) for f in line.split(',')[:4]], line.split(',')[4:])
                  for line in lines]
        text = '\n'.join([header] + [','.join(map(str, f)) for f in fields if f])
        (self.folder / 'o.csv').write_text(text)
        return ('calibrate', '--observations', self.folder / 'o.csv', '--size', '640x480', '-o',
                self.folder / 'rig.json')

    def refuses(self, change, of, **more):
        self.complains(*self.changed(change, **more), of=of, leaves=[self.folder / 'rig.json'])

    def test_lengths_of_more_than_two_cameras(self):
        (self.folder / 'o.csv').write_text('\n'.join(board_lines(cameras=3)))
        done = self.works('check', '--observations', self.folder / 'o.csv', '--size', '640x480',
                          '--no-mrcal', '--trials', '60', '--inject', '1')
        self.assertIn('are measured by the first two of 3 cameras, left and right', done.stderr)

    def test_good_corners_are_taken(self):
        done = self.works(*self.changed(lambda f, c, r, k, rest: [f, c, r, k, *rest]))
        self.assertNotIn('not trustworthy', done.stderr)

    def test_a_bad_line_37_is_named(self):
        def decimal_comma(f, c, r, k, rest):
            bad = (f, c, r, k) == (0, 0, 3, 8)
            return [f, c, r, k, *(['X' + rest[0], *rest[1:]] if bad else rest)]
        self.refuses(decimal_comma, of='o.csv:37: X, Y, Z is "X0.2", not a number')

    def test_turned_view(self):
        at = {}
        for line in board_lines()[1:]:
            f, c, r, k, *rest = line.split(',')
            at[tuple(map(int, (f, c, r, k)))] = rest
        self.refuses(lambda f, c, r, k, rest:
                     [f, c, r, k, *rest[:3], *at[(f, c, 5 - r, 8 - k)][3:]]
                     if (f, c) == (4, 1) else [f, c, r, k, *rest],
                     of='frame 4, camera 1: its corners are numbered half a turn (180 degrees)')

    def test_mirrored_view(self):
        self.refuses(lambda f, c, r, k, rest: [f, c, r, k, *rest[:3], *(
            [639 - float(rest[3]), rest[4]] if (f, c) == (2, 0) else rest[3:])],
            of='frame 2, camera 0: the board is mirrored against the other 23 views')

    def test_swapped_view(self):
        self.refuses(lambda f, c, r, k, rest: [f, 1 - c if f == 7 else c, r, k, *rest],
                     of='left and right are swapped against the other frames')

    def test_parallel_boards(self):
        self.refuses(lambda f, c, r, k, rest: [f, c, r, k, *rest], tilts=False,
                     of='every board is parallel to the image')

    def test_exchanged_cameras_end_in_doubt(self):
        done = vernier(*self.changed(lambda f, c, r, k, rest: [f, 1 - c, r, k, *rest]))
        self.assertEqual(done.returncode, 3, done.stderr)
        self.assertIn('m to the left of camera 0', done.stderr)
        self.assertTrue((self.folder / 'rig.json').exists())

    def test_unpaired_frames_are_counted(self):
        done = self.works(*self.changed(
            lambda f, c, r, k, rest: None if c == 1 and f < 2 else [f, c, r, k, *rest]))
        self.assertIn('warning: 2 of 12 frames show the board in camera 0 alone (0 and 1)',
                      done.stderr)


class IdleOptions(Case):
    """Options that nothing would come of are refused, not passed over."""

    def images(self):
        for name in ('left1.png', 'right1.png'):
            (self.folder / name).touch()
        return ('calibrate', '--left', self.folder / 'l*.png', '--right', self.folder / 'r*.png',
                '-o', self.folder / 'rig.json')

    def test_beside_a_rig_file(self):
        for option, *value in (
                ['--left', 'l*'], ['--right', 'r*'], ['--camera', 'c*'], ['--board', '9x6'],
                ['--target', 't'], ['--square-m', '1'], ['--marker-m', '1'],
                ['--dictionary', '4x4_50'], ['--legacy'], ['--tag-m', '1'], ['--tag-spacing', '1'],
                ['--family', '36h11'], ['--border-bits', '1'], ['--top-row-first'],
                ['--corners', 'c'], ['--observations', 'o'], ['--size', '640x480']):
            self.complains('check', 'nominal', option, *value,
                           of=option + ': the rig file contains the corners; leave it out, or give')
        for option, *value in (
                ['--model', 'radial1'], ['--pixel-sigma', '1'], ['--hold', 'left.ax'],
                ['--know', 'left.ax=1,1'], ['--prior', 'p'], ['--warp'], ['--keep-outliers']):
            self.complains('check', 'nominal', option, *value,
                           of=option + ': the rig file contains the solver settings; leave it out')

    def test_of_the_holdout(self):
        self.complains('check', 'nominal', '--training-frames', '9',
                       of='--training-frames: only valid with --holdout; add --holdout or leave it '
                          'out')
        self.complains('check', 'nominal', '--boards', 'still',
                       of='--boards: only valid with --holdout; add --holdout or leave it out')
        self.complains('check', 'nominal', '--splits', '9',
                       of='--splits: only valid with --holdout or --halves; add one of them or '
                          'leave it out')

    def test_beside_images(self):
        self.complains(*self.images(), '--board', '9x6', '--square-m', '1', '--size', '640x480',
                       of='--size: the size is read from the images; leave it out')

    def test_beside_observations(self):
        (self.folder / 'o.csv').write_text('\n'.join(board_lines()))
        for option, *value in (['--board', '9x6'], ['--square-m', '1'], ['--target', 't'],
                               ['--legacy'], ['--tag-spacing', '0.3'], ['--family', '36h11']):
            self.complains('calibrate', '--observations', self.folder / 'o.csv', '--size',
                           '640x480', '-o', self.folder / 'rig.json', option, *value,
                           of=option + ": the --observations file contains the board's points")

    def test_of_another_board(self):
        chess, tags = ('--board', '9x6'), ('--board', 'apriltag:6x6', '--tag-m', '1')
        charuco = ('--board', 'charuco:8x6', '--square-m', '3', '--marker-m', '2')
        for board, option, *value in (
                [chess, '--marker-m', '1'], [chess, '--dictionary', '4x4_50'], [chess, '--legacy'],
                [tags, '--marker-m', '1'], [tags, '--legacy']):
            self.complains(*self.images(), *board, option, *value,
                           of=option + ': only valid for a charuco board; leave it out')
        for board, option, *value in (
                [chess, '--tag-m', '1'], [chess, '--tag-spacing', '1'], [chess, '--family', '16h5'],
                [charuco, '--border-bits', '1'], [charuco, '--top-row-first']):
            self.complains(*self.images(), *board, option, *value,
                           of=option + ': only valid for an AprilTag grid; leave it out')
        self.complains(*self.images(), *tags, '--square-m', '1',
                       of='--square-m: an AprilTag grid has no squares; use --tag-m')

    def test_beside_a_target_file(self):
        target = self.folder / 'target.yaml'
        target.write_text('target_type: aprilgrid\ntagCols: 6\ntagRows: 6\ntagSize: 0.088\n'
                          'tagSpacing: 0.3\ncodeOffset: 0\n')
        for option in ('--square-m', '--tag-m', '--tag-spacing'):
            self.complains(*self.images(), '--target', target, option, '1',
                           of=option + ': already given by the --target file; leave it out')
        self.complains(*self.images(), '--target', target, '--legacy',
                       of='--legacy: the --target file is not a charuco board')
        target.write_text('target_type: checkerboard\ntargetCols: 9\ntargetRows: 6\n'
                          'rowSpacingMeters: 0.025\ncolSpacingMeters: 0.025\n')
        self.complains(*self.images(), '--target', target, '--family', '36h11',
                       of='--family: the --target file is a chessboard and has no tags')


class SparedInputs(Case):
    """No verb replaces what it reads."""

    def spares(self, *words, file):
        before = file.read_bytes()
        self.complains(*words, of='is an input and would be overwritten; name another')
        self.assertEqual(file.read_bytes(), before)

    def test_rig_files(self):
        rig = self.folder / 'rig.json'
        rig.write_bytes((ROOT / 'datasets/rigs/nominal.rig.json').read_bytes())
        self.spares('sample', rig, '-n', '2', '-o', rig, file=rig)
        self.spares('report', rig, '-o', self.folder / '.' / 'rig.json', file=rig)
        (self.folder / 'link').symlink_to(rig)
        self.spares('sample', rig, '-n', '2', '-o', self.folder / 'link', file=rig)
        os.link(rig, self.folder / 'uncertainty.json')
        self.spares('uncertainty', rig, '--grid', '4x3', '-o', self.folder, file=rig)
        (self.folder / 'o.csv').write_text('\n'.join(board_lines()))
        self.spares('calibrate', '--observations', self.folder / 'o.csv', '--size', '640x480',
                    '--prior', rig, '-o', rig, file=rig)

    def test_corners_and_images(self):
        file = self.folder / 'o.csv'
        file.write_text('\n'.join(board_lines()))
        self.spares('calibrate', '--observations', file, '--size', '640x480', '-o', file, file=file)
        self.spares('calibrate', '--corners', file, '--size', '640x480', '-o', file, file=file)
        image = self.folder / 'left1.png'
        image.write_bytes(b'kept')
        self.spares('detect', '--left', self.folder / 'left*.png', '--board', '9x6', '-o', image,
                    file=image)


class BadInput(Case):
    def test_boards_that_are_not_given(self):
        for board, of in (('', '--board: is empty'), ('hexagons:3x3', 'unknown kind of board'),
                          ('charuco:8x6', '--square-m is missing'), ('9by6', 'two whole numbers')):
            self.complains('detect', '--left', 'left*.png', '--board', board, '-o', 'c.vnl', of=of)
        self.complains('detect', '--left', 'left*.png', '--board', 'charuco:8x6', '--square-m',
                       '0.03', '--marker-m', '0.02', '--dictionary', '4x5', '-o', 'c.vnl',
                       of='"4x5" is unknown; supported: 4x4_50')
        self.complains('detect', '--right', 'right*.png', '--board', '9x6', '-o', 'c.vnl',
                       of='--left is missing')
        self.complains('detect', '--left', 'a*.png', '--camera', 'b*.png', '--board', '9x6', '-o',
                       'c.vnl', of='--camera cannot be combined with')

    def test_missing_images(self):
        self.complains('calibrate', '--left', self.folder / 'l*.png', '--right',
                       self.folder / 'r*.png', '--board', '9x6', '--square-m', '0.025', '-o',
                       self.folder / 'rig.json', of='no file matches',
                       leaves=[self.folder / 'rig.json'])

    def test_an_image_that_is_none(self):
        for name in ('left1.png', 'right1.png'):
            (self.folder / name).write_bytes(b'\x89PNG\r\n but cut off')
        self.complains('calibrate', '--left', self.folder / 'left*.png', '--right',
                       self.folder / 'right*.png', '--board', '9x6', '--square-m', '0.025', '-o',
                       self.folder / 'rig.json', of='not an image')

    def test_observations_with_a_bad_line(self):
        rows = ['frame,camera,row,col,X,Y,Z,qx,qy']
        rows += [f'0,0,0,{i},{i},0,0,10,10' for i in range(35)] + ['0,0,1,0,0,1,0,nan,10']
        (self.folder / 'o.csv').write_text('\n'.join(rows))
        self.complains('calibrate', '--observations', self.folder / 'o.csv', '--size', '640x480',
                       '-o', self.folder / 'rig.json', of='o.csv:37:')

    def test_two_kinds_of_input(self):
        self.complains('calibrate', '--corners', 'a', '--observations', 'b', '-o', 'c',
                       of='exactly one kind')

    def test_toml_typo(self):
        (self.folder / 's.toml').write_text('[study]\ntrials = 10\nprotocoll = "path"\n')
        self.complains('study', self.folder / 's.toml', '-o', self.folder / 'out',
                       of="s.toml:3: unknown key 'protocoll' in [study]; did you mean 'protocol'?",
                       leaves=[self.folder / 'out'])

    def test_zero_length_segment(self):
        (self.folder / 'w.world.toml').write_text(
            'format = "vernier/world"\nversion = 1\n[loose]\nsegments = [\n'
            '  [0,0,0, 1,0,0],\n  [2,0,0, 2,0,0],\n]\n')
        self.complains('world', 'info', self.folder / 'w.world.toml', of='w.world.toml:6:')

    def test_rig_without_covariance(self):
        rig = json.loads((ROOT / 'datasets/rigs/nominal.rig.json').read_text())
        for key in ('covariance', 'covariance_mvb'):
            del rig[key]
        (self.folder / 'bare.json').write_text(json.dumps(rig))
        self.complains('sample', self.folder / 'bare.json', '-n', '5', '-o',
                       self.folder / 's.csv', of='the rig has no covariance',
                       leaves=[self.folder / 's.csv'])
        (self.folder / 's.toml').write_text('[study]\ntrials = 5\n[rig]\nfile = "bare.json"\n')
        self.complains('study', self.folder / 's.toml', '-o', self.folder / 'out',
                       of='s.toml:4: bare.json has no covariance')

    def test_unknown_names(self):
        self.complains('world', 'info', 'atlantis', of='shipped: workshop')
        self.complains('sample', 'ideal', '-o', 'x.csv', of='shipped: nominal')
        self.complains('simulate', '--pose', '1,2', of='is not 3 numbers')
        self.complains('simulate', '--pose', '1,2,3', '--source', 'edge_los=1', of='edge_loss')
        self.complains('report', self.folder, '-o', self.folder / 'r.html',
                       of='is neither a study folder')
        self.complains('report', 'no.rig.json', '-o', self.folder / 'r.html', of='no such file')
        (self.folder / 'other.json').write_text('{"format": "other"}')
        self.complains('report', 'nominal', self.folder / 'other.json', '-o',
                       self.folder / 'r.html', of='other.json: is not a rig file',
                       leaves=[self.folder / 'r.html'])
        for name in ('one', 'two'):
            (self.folder / name).mkdir()
            (self.folder / name / 'study.toml').touch()
        self.complains('report', self.folder / 'one', self.folder / 'two', '-o',
                       self.folder / 'r.html', of="the file has no 'study'")

    def test_numbers_that_are_none(self):
        for psi_c in ('nan', 'inf'):
            self.complains('sample', 'nominal', '--psi-c', psi_c, '-o', self.folder / 's.csv',
                           of='not a finite number')
        self.complains('sample', 'nominal', '--seed', '-1', '-o', self.folder / 's.csv',
                       of='whole number')
        self.complains('simulate', '--pose', '1,2,3,', of='is not 3 numbers')

    def test_numbers_that_are_not_finite(self):
        (self.folder / 'o.csv').write_text('\n'.join(board_lines()))
        calibrate = ('calibrate', '--observations', self.folder / 'o.csv', '--size', '640x480',
                     '-o', self.folder / 'rig.json')
        for words in ((*calibrate, '--pixel-sigma'), (*calibrate, '--square-m'),
                      (*calibrate, '--tag-spacing'), ('advise', 'nominal', '--pixel-sigma'),
                      ('advise', 'nominal', '--square-m'), ('advise', 'nominal', '--at-m'),
                      ('convert', 'nominal', '-o', self.folder / 'r.json', '--unit-m'),
                      ('diff', 'nominal', 'nominal', '--focus')):
            for number in ('nan', 'inf', '-1', '0'):
                self.complains(*words, number,
                               of=f'{words[-1]}: "{number}" is not a finite number above 0',
                               leaves=[self.folder / 'rig.json', self.folder / 'r.json'])
        for number in ('nan', 'inf', '-1', '0'):
            above = '' if number in ('nan', 'inf') else ' above 0'
            self.complains('simulate', '--pose', '1,2,3', '--height-m', number,
                           of=f'--height-m: "{number}" is not a finite number{above}')
        self.complains('simulate', '--pose', '1,2,3', '--pitch-deg', 'nan',
                       of='--pitch-deg: "nan" is not a finite number')
        self.complains(*calibrate, '--hold', 'left.ax=nan', of='"nan" is not a finite number')
        self.complains(*calibrate, '--know', 'left.ax=1,inf', of='"inf" is not a finite number')

    def test_seeds_that_would_wrap(self):
        for words in (('check', 'nominal', '--seed'),
                      ('world', 'make', '-o', self.folder / 'w.toml', '--seed'),
                      ('simulate', '--pose', '1,2,3', '--seed'),
                      ('simulate', '--pose', '1,2,3', '--trial')):
            self.complains(*words, '-1', of=words[-1] + ': "-1" is not a whole number of 0 or more')

    def test_sizes_that_are_slips_of_the_pen(self):
        for words in (('uncertainty', 'nominal', '--grid'),
                      ('diff', 'nominal', 'nominal', '--grid'),
                      ('detect', '--left', 'l*.png', '-o', self.folder / 'c.vnl', '--board'),
                      ('advise', 'nominal', '--square-m', '0.1', '--board')):
            for size in ('100000x100000', '3x1001', '1001x3'):
                self.complains(*words, size,
                               of=f'{words[-1]}: "{size}" has a side above 1000; give a')

    def test_markers_larger_than_their_squares(self):
        (self.folder / 'c.vnl').write_text('# filename x y level\nleft1.png - - -\n')
        self.complains('calibrate', '--corners', self.folder / 'c.vnl', '--board', 'charuco:8x6',
                       '--square-m', '0.022', '--marker-m', '0.03', '--size', '640x480', '-o',
                       self.folder / 'rig.json', of='its markers are not smaller than its squares')

    def test_what_is_wrong_with_corners_begins_with_their_file(self):
        lines = board_lines()
        o = self.folder / 'o.csv'
        words = ('calibrate', '--observations', o, '--size', '640x480', '-o',
                 self.folder / 'r.json')
        o.write_text('\n'.join(lines[:3] + [lines[3].rsplit(',', 2)[0] + ',700,3'] + lines[4:]))
        self.complains(*words, of='o.csv:4: frame 0, camera 0, corner (row 0, col 2): its pixel '
                                  '(700, 3) lies outside the image of 640x480')
        o.write_text('\n'.join(lines + [f'99,{line[2:]}' for line in lines[1:109]]))
        self.complains(*words, of='o.csv: frame 99, camera 0: it is the same view as frame 0')

    def test_a_file_where_a_folder_is_wanted(self):
        (self.folder / 'file').write_text('kept')
        (self.folder / 's.toml').write_text('[study]\ntrials = 5\n')
        self.complains('study', self.folder / 's.toml', '-o', self.folder / 'file', of='file')
        self.assertEqual((self.folder / 'file').read_text(), 'kept')

    def test_links_are_followed_and_pipes_refused(self):
        os.mkfifo(self.folder / 'pipe')
        self.complains('world', 'make', '-o', self.folder / 'pipe', of='not a regular file')
        (self.folder / 'link').symlink_to(self.folder / 'target')
        self.works('world', 'make', '-o', self.folder / 'link')
        self.assertTrue((self.folder / 'link').is_symlink())
        self.assertTrue((self.folder / 'target').is_file())

    def test_output_that_cannot_be_written(self):
        self.complains('world', 'make', '-o', self.folder / 'no' / 'such' / 'w.toml',
                       of='cannot be written')


class OddNames(Case):
    def test_a_page_of_a_file_whose_name_is_not_utf8(self):
        name = os.fsdecode(b'caf\xe9.json')
        (self.folder / name).write_bytes((ROOT / 'datasets/rigs/nominal.rig.json').read_bytes())
        self.works('report', self.folder / name, '--no-proof', '-o', self.folder / 'page.html',
                   errors='replace')
        self.assertIn('caf\ufffd.json', (self.folder / 'page.html').read_text())


class WrongRigs(Case):
    def test_a_rig_too_wrong_to_use_fails_trials_and_not_the_study(self):
        (self.folder / 's.toml').write_text('[study]\ntrials = 10\n[map]\nspacing_m = 4\n'
                                            '[sources]\ncalibration = 300\n')
        done = self.works('study', self.folder / 's.toml', '-o', self.folder / 'out', '--json')
        self.assertLess(json.loads(done.stdout)['cells'][0]['success'], 0.5)


class Doubt(Case):
    def test_large_residuals_exit_3_and_say_why(self):
        """A board whose corners are 3 px off: a result, with exit code 3 and the reason."""
        rig = json.loads((ROOT / 'datasets/rigs/nominal.rig.json').read_text())
        rows = ['frame,camera,row,col,X,Y,Z,qx,qy']
        points = rig['evidence']['board']['points_m']
        for view in rig['evidence']['observations']:
            camera = 0 if view['camera'] == 'left' else 1
            for i, ((x, y, z), (u, v)) in enumerate(zip(points, view['pixels_px'])):
                off = 3 * (-1) ** (i + view['frame'])
                rows.append(f"{view['frame']},{camera},{i // 9},{i % 9},{x},{y},{z},{u + off},{v}")
        (self.folder / 'o.csv').write_text('\n'.join(rows))
        done = vernier('calibrate', '--observations', self.folder / 'o.csv', '--size', '640x480',
                       '-o', self.folder / 'rig.json', '--json')
        self.assertEqual(done.returncode, 3, done.stderr)
        self.assertIn('not trustworthy: residuals of', done.stderr)
        self.assertIn('doubts', json.loads(done.stdout))
        self.assertTrue((self.folder / 'rig.json').exists())


class HeldInPart(Case):
    """A component of a rotation that is held, through files and into a prior."""

    def calibrate(self, lines, output, *more):
        (self.folder / 'o.csv').write_text('\n'.join(lines))
        self.works('calibrate', '--observations', self.folder / 'o.csv', '--size', '640x480',
                   '--no-model-check', '-o', self.folder / output, *more)
        return json.loads((self.folder / output).read_text())

    def test_a_held_component_is_not_listed_and_the_file_is_a_prior(self):
        header, *lines = board_lines(frames=16)
        halves = [[header] + [line for line in lines if int(line.split(',')[0]) % 2 == half]
                  for half in range(2)]
        first = self.calibrate(halves[0], 'a.json', '--hold', 'right.wy_rad')
        self.assertEqual(len(first['parameter_names']), 15)
        self.assertNotIn('right.wy_rad', first['parameter_names'])
        self.assertEqual(len(first['covariance']['matrix']), 15)
        value = first['cameras'][1]['from_first']['rotation_rad'][1]
        both = self.calibrate(halves[1], 'b.json', '--hold', f'right.wy_rad={value}',
                              '--prior', self.folder / 'a.json')
        self.assertEqual(both['parameter_names'], first['parameter_names'])
        self.assertEqual(both['calibration']['prior_dof'], 15)
        for i in range(15):  # twice the views; their noise is estimated anew
            self.assertLess(both['covariance_mvb']['matrix'][i][i],
                            0.9 * first['covariance_mvb']['matrix'][i][i])


class ModelCheck(Case):
    def test_a_camera_without_views_among_those_compared_ends_in_a_warning(self):
        """Of 70 frames 60 are compared, and none of those that the right camera saw."""
        header, *lines = board_lines(frames=70)
        seen = [line for line in lines
                if line.split(',')[1] == '0' or line.split(',')[0] in ('6', '13', '20')]
        (self.folder / 'o.csv').write_text('\n'.join([header] + seen))
        done = self.works('calibrate', '--observations', self.folder / 'o.csv', '--size',
                          '640x480', '-o', self.folder / 'rig.json')
        words = ('lens models were not compared: with some views left out, camera 1 ("right"): it has '
                 'no view of the board')
        self.assertIn(words, done.stderr)
        rig = json.loads((self.folder / 'rig.json').read_text())
        self.assertTrue(any(w.startswith(words) for w in rig['calibration']['warnings']))

    def test_a_distortion_that_folds_the_image_is_named(self):
        done = self.works('calibrate', '--left', IMAGES / 'left0[1-5].jpg', '--right',
                          IMAGES / 'right0[1-5].jpg', '--board', '9x6', '--square-m', '0.025',
                          '--model', 'opencv5', '--no-model-check', '-o', self.folder / 'rig.json')
        words = 'the distortion of camera "left" cannot be inverted in 1.'
        self.assertIn(words, done.stderr)
        rig = json.loads((self.folder / 'rig.json').read_text())
        self.assertTrue(any(w.startswith(words) for w in rig['calibration']['warnings']))


class Check(Case):
    """The shipped rig holds its corners; mrcal may be absent, in whole or in part."""

    def share(self, script):
        """A share folder whose script is another."""
        share = self.folder / 'share'
        (share / 'python').mkdir(parents=True)
        (share / 'python/mrcal_uncertainty.py').write_text(script)
        (share / 'rigs').symlink_to(ROOT / 'datasets/rigs')
        return dict(os.environ, VERNIER_SHARE=str(share))

    def test_too_few_trials_are_refused_before_mrcal_is_asked(self):
        environment = self.share('open("asked", "w")\n')
        for n, said in (('1', '1 trial is'), ('31', '31 trials are')):
            done = vernier('check', 'nominal', '--trials', n, env=environment, cwd=self.folder)
            self.assertEqual(done.returncode, 2, done.stderr)
            self.assertEqual(done.stderr, f'vernier: Monte-Carlo check: {said} too few for 16 '
                             'parameters; ask for at least 32\n')
            self.assertFalse((self.folder / 'asked').exists())

    def test_the_statistic_outside_its_band_is_named(self):
        done = vernier('check', 'nominal', '--trials', '40', '--no-mrcal', '--seed', '72')
        self.assertEqual(done.returncode, 3, done.stderr)
        mean, low = re.search(r'covariance: the mean NEES is (\S+), outside its 99 % interval \[(\S+), ',
                              done.stderr).groups()
        self.assertLess(float(mean), float(low))
        self.assertIn('fails in up to 3 % of checks; give more --trials to tell', done.stderr)

    def test_json_holds_what_was_promised(self):
        found = json.loads(self.works('check', 'nominal', '--trials', '60', '--json').stdout)
        copies = found['monte_carlo']
        self.assertEqual(copies['trials'], 60)
        self.assertEqual(copies['nees_expected'], 16)
        low, high = copies['nees_interval_95']
        self.assertTrue(low < 16 < high)
        self.assertTrue(0.5 < copies['std_ratio_min'] < 1 < copies['std_ratio_max'] < 1.6)
        self.assertTrue(0 <= copies['ks_p'] <= 1)
        if found['mrcal'] is None:
            self.assertIn('mrcal', found['mrcal_reason'])
            self.skipTest('mrcal is not here')
        mrcal = found['mrcal']
        self.assertLessEqual(mrcal['max_parameter_diff_sigma'], 1e-6)
        self.assertLessEqual(mrcal['max_covariance_diff'], 1e-7)
        for key in ('mrcal_solve_ms', 'vernier_solve_ms', 'vernier_resolve_ms'):
            self.assertGreater(mrcal[key], 0)
        if mrcal['max_projection_covariance_diff'] is None:
            self.skipTest(mrcal['projection_reason'])
        self.assertLessEqual(mrcal['max_projection_covariance_diff'], 1e-6)
        self.assertLessEqual(mrcal['max_triangulation_covariance_diff'], 1e-6)

    def test_boards_left_out_are_counted(self):
        done = self.works('check', 'nominal', '--trials', '40', '--no-mrcal', '--holdout',
                          '--splits', '3', '--json')
        found = json.loads(done.stdout)['holdout']
        self.assertEqual(found['splits'], 3)
        self.assertGreater(found['boards'], 0)
        self.assertEqual(found['boards_left_out'], 0)
        self.assertEqual(found['corners_left_out'], 0)

    def test_components_of_the_corner_noise_are_told(self):
        words = ('check', 'nominal', '--trials', '40', '--no-mrcal', '--holdout', '--splits', '2')
        found = json.loads(self.works(*words, '--json').stdout)
        noise = found['noise']
        self.assertTrue(noise['converged'])
        self.assertEqual(len(noise['motions']), found['frames'])
        self.assertEqual(noise['moved'], [])  # simulated white noise
        self.assertGreater(noise['motion_test']['p_value'], 0.01)
        self.assertEqual(found['holdout']['boards_stand'], 'hand-held')
        for kind in ('edges', 'scale'):
            self.assertGreater(found['holdout'][kind]['sigma_components'], 0)
        still = json.loads(self.works(*words, '--boards', 'still', '--json').stdout)
        self.assertIsNone(still['noise']['motion_m'])
        self.assertEqual(still['noise']['motions'], [])
        self.assertEqual(still['holdout']['boards_stand'], 'still')
        self.assertIn('corner noise by components', self.works(*words).stdout)

    def test_halves_of_the_views(self):
        words = ('check', 'nominal', '--trials', '40', '--no-mrcal', '--halves', '--splits', '8',
                 '--json', '--threads')
        one = json.loads(self.works(*words, '1').stdout)['halves']
        self.assertEqual(one, json.loads(self.works(*words, '3').stdout)['halves'])
        self.assertEqual((one['splits'], one['failed'], one['frames']), (8, 0, 20))
        self.assertGreater(one['dof'], 10)
        for kind in ('honest', 'mvb'):  # white noise: both are right
            self.assertLess(one['dof'] / 2, one['nees_mean_' + kind])
            self.assertLess(one['nees_mean_' + kind], 2 * one['dof'])
        text = self.works('check', 'nominal', '--trials', '40', '--no-mrcal', '--halves',
                          '--splits', '2').stdout
        self.assertIn('halves of the 20 frames, calibrated apart: 2 splits, ', text)

    def test_injected_errors(self):
        words = ('check', 'nominal', '--trials', '40', '--no-mrcal', '--inject', '1,10')
        one = json.loads(self.works(*words, '--json', '--threads', '1').stdout)['injected']
        self.assertEqual(one, json.loads(
            self.works(*words, '--json', '--threads', '3').stdout)['injected'])
        self.assertEqual(one['boards'], 20)
        self.assertEqual([level['psi_c'] for level in one['levels']], [1, 10])
        for level in one['levels']:
            self.assertEqual((level['draws'], level['failed']), (40, 0))
            self.assertLess(abs(level['ratio'] - 1), 0.3)
        self.assertIn('lengths on 20 boards by wrong rigs, 40 draws', self.works(*words).stdout)
        for wrong in ('0', 'nan', '-1', '1e9', 'x', '1;3'):
            done = vernier('check', 'nominal', '--inject', wrong)
            self.assertEqual(done.returncode, 2, wrong)
            self.assertIn('--inject', done.stderr)
            self.assertEqual(done.stderr.count('\n'), 1)

    def test_noisy_copies_without_mrcal(self):
        words = ('check', 'nominal', '--trials', '40', '--no-mrcal', '--json', '--threads')
        one = json.loads(self.works(*words, '1').stdout)
        self.assertIsNone(one['mrcal'])
        self.assertEqual(one['mrcal_reason'], '--no-mrcal')
        self.assertEqual(one, json.loads(self.works(*words, '3').stdout))

    def test_python_without_mrcal_is_said(self):
        environment = self.share('import sys\nsys.exit(4)\n')
        done = self.works('check', 'nominal', '--trials', '40', '--json', env=environment)
        found = json.loads(done.stdout)
        if found['mrcal'] is None:
            self.skipTest('the build has no mrcal')
        self.assertIsNone(found['mrcal']['max_projection_covariance_diff'])
        self.assertIn('no Python has mrcal', found['mrcal']['projection_reason'])

    def check_with(self, change):
        """The check where mrcal's answer is changed on its way."""
        script = ROOT / 'python/mrcal_uncertainty.py'
        environment = self.share(
            'import json, runpy, sys\n'
            f'sys.path.insert(0, {str(script.parent)!r})\n'
            f'runpy.run_path({str(script)!r}, run_name="__main__")\n'
            'answer = json.load(open(sys.argv[2]))\n'
            f'{change}\n'
            'json.dump(answer, open(sys.argv[2], "w"))\n')
        done = vernier('check', 'nominal', '--trials', '40', '--json', env=environment)
        found = json.loads(done.stdout)
        if found['mrcal'] is None or 'projection_reason' in found['mrcal']:
            self.skipTest('mrcal is not here')
        self.assertEqual(done.returncode, 3, done.stderr)
        return found

    def test_a_figure_that_is_no_number_holds_no_gate(self):
        found = self.check_with('answer["projection"][0][0][0][0] = None')
        self.assertIsNone(found['mrcal']['max_projection_covariance_diff'])
        self.assertIn("projection covariance, normalised differ from mrcal's by nan",
                      found['doubts'][0])

    def test_a_gate_that_fails_is_exit_code_3(self):
        found = self.check_with('answer["projection"][0][0][0][0] *= 1 + 1e-4')
        self.assertAlmostEqual(found['mrcal']['max_projection_covariance_diff'], 1e-4, delta=1e-6)
        self.assertIn('projection covariance', found['doubts'][0])

    def test_a_share_folder_of_ones_own_leaves_the_rest_to_the_installed_one(self):
        share = self.folder / 'share'
        (share / 'worlds').mkdir(parents=True)
        (share / 'worlds/mine.world.toml').write_text(
            (ROOT / 'datasets/worlds/workshop.world.toml').read_text())
        environment = dict(os.environ, VERNIER_SHARE=str(share))
        for world in ('mine', 'workshop'):
            self.works('world', 'info', world, env=environment)
        here, plain = (json.loads(self.works('check', 'nominal', '--trials', '40', '--json',
                                             env=env).stdout)['mrcal']
                       for env in (environment, os.environ))
        if plain is None:
            self.skipTest('the build has no mrcal')
        self.assertEqual(here.get('projection_reason'), plain.get('projection_reason'))
        doctors = [self.works('doctor', env=env).stdout.splitlines()
                   for env in (environment, os.environ)]
        different = [b for a, b in zip(*doctors) if a != b]
        self.assertEqual(len(different), 1)
        self.assertIn('shipped data', different[0])

    def test_a_missing_script_is_said_and_none_of_the_working_directory_is_run(self):
        alone = self.folder / 'bin/vernier'  # no share folder beside it
        alone.parent.mkdir()
        shutil.copy(PROGRAM, alone)
        (self.folder / 'python').mkdir()
        (self.folder / 'python/mrcal_uncertainty.py').write_text('open("was_run", "w")\n')
        rig = ROOT / 'datasets/rigs/nominal.rig.json'
        for share in (None, '', '.'):
            environment = {k: v for k, v in os.environ.items() if k != 'VERNIER_SHARE'}
            if share is not None:
                environment['VERNIER_SHARE'] = share
            run = dict(capture_output=True, text=True, cwd=self.folder, env=environment)
            done = subprocess.run([alone, 'doctor'], **run)
            self.assertIn('missing: share/vernier/python/mrcal_uncertainty.py', done.stdout)
            done = subprocess.run([alone, 'check', rig, '--trials', '40', '--json'], **run)
            self.assertEqual(done.returncode, 0, done.stderr)
            mrcal = json.loads(done.stdout)['mrcal']
            self.assertFalse((self.folder / 'was_run').exists())
            if mrcal is None:
                self.skipTest('the build has no mrcal')
            self.assertIn('mrcal_uncertainty.py is missing', mrcal['projection_reason'])
            self.assertLessEqual(mrcal['max_parameter_diff_sigma'], 1e-6)

    def test_a_python_that_fails_leaves_the_solutions_compared(self):
        environment = self.share('import sys\nsys.exit("no such lens")\n')
        done = vernier('check', 'nominal', '--trials', '40', '--json', env=environment)
        found = json.loads(done.stdout)
        if found['mrcal'] is None:
            self.skipTest('the build has no mrcal')
        self.assertEqual(done.returncode, 3, done.stderr)
        self.assertIn('its Python failed: no such lens', found['doubts'][0])
        self.assertLessEqual(found['mrcal']['max_parameter_diff_sigma'], 1e-6)

    def test_holdout_is_refused_before_anything_is_solved(self):
        def refuses(*more, of, **changed):
            lines = board_lines(frames=changed.get('frames', 12))
            if changed.get('cameras') == 1:
                lines = lines[:1] + [line for line in lines[1:] if line.split(',')[1] == '0']
            (self.folder / 'o.csv').write_text('\n'.join(lines))
            self.complains('check', '--observations', self.folder / 'o.csv', '--size', '640x480',
                           '--trials', '100000', '--holdout', *more, of=of)
        refuses(cameras=1, of='--holdout: needs two cameras and at least six frames; got '
                              '1 camera(s) and 12 frame(s)')
        refuses(frames=5, of='got 2 camera(s) and 5 frame(s)')
        for frames in ('2', '12'):
            refuses('--training-frames', frames, of=f'--training-frames: {frames} of 12 frames')

    def test_bad_input(self):
        rig = json.loads((ROOT / 'datasets/rigs/nominal.rig.json').read_text())
        del rig['evidence']
        (self.folder / 'bare.json').write_text(json.dumps(rig))
        self.complains('check', self.folder / 'bare.json', of='no stored evidence to solve again')
        self.complains('check', of='exactly one kind of input')
        self.complains('check', 'nominal', '--trials', '0', of='trials')


class CheckedFile(Case):
    """What a rig file states against solving its evidence again."""

    def calibrate(self, *more, lines=None):
        (self.folder / 'o.csv').write_text('\n'.join(lines or board_lines()))
        self.works('calibrate', '--observations', self.folder / 'o.csv', '--size', '640x480',
                   '--no-model-check', '-o', self.folder / 'rig.json', *more)
        return json.loads((self.folder / 'rig.json').read_text())

    def check(self, code=0, name='rig.json', trials=40):
        done = vernier('check', self.folder / name, '--no-mrcal', '--trials', trials, '--json')
        self.assertEqual(done.returncode, code, done.stderr)
        return json.loads(done.stdout), done.stderr

    def holds(self, name='rig.json'):
        found = self.check(name=name)[0]['file']
        self.assertLess(found['max_parameter_diff_sigma'], 1e-4)
        self.assertLess(found['max_covariance_diff'], 1e-4)

    def test_files_of_this_program_hold(self):
        wrong = board_lines()
        for i in (100, 700, 1100):
            fields = wrong[i].split(',')
            wrong[i] = ','.join(fields[:7] + [str(float(fields[7]) + 9), fields[8]])
        for more in ((), ('--pixel-sigma', '0.3'), ('--hold', 'left.ax=1'), ('--warp',),
                     ('--hold', 'right.wx_rad', '--hold', 'right.tx_m=-0.06'),
                     ('--model', 'opencv5,radial1')):
            with self.subTest(more):
                self.calibrate(*more)
                self.holds()
        rig = self.calibrate(lines=wrong)
        self.assertEqual(len(rig['calibration']['outliers']), 3)
        self.holds()

    def test_a_changed_parameter_is_found(self):
        rig = self.calibrate()
        sigma = math.sqrt(rig['covariance_mvb']['matrix'][2][2])
        rig['cameras'][0]['parameters']['ox_px'] += 0.01 * sigma
        rig['parameters'][2] += 0.01 * sigma
        (self.folder / 'rig.json').write_text(json.dumps(rig))
        found, said = self.check(3)
        self.assertAlmostEqual(found['file']['max_parameter_diff_sigma'], 0.01, places=4)
        self.assertLess(found['file']['max_covariance_diff'], 1e-4)
        self.assertIn('parameters, in standard deviations differ from solving again by 1.0e-02 '
                      '(left.ox_px; limit 1e-04)', said)

    def test_a_changed_covariance_is_found(self):
        rig = self.calibrate()
        rig['covariance_mvb']['matrix'] = [[1.1 * x for x in row]
                                           for row in rig['covariance_mvb']['matrix']]
        (self.folder / 'rig.json').write_text(json.dumps(rig))
        found, said = self.check(3)
        self.assertAlmostEqual(found['file']['max_covariance_diff'], 0.1, places=4)
        self.assertIn('covariance_mvb, normalised differ from solving again', said)

    def test_a_freed_hold_is_found(self):
        rig = self.calibrate('--hold', 'left.ax=1')
        rig['calibration']['held'] = []
        (self.folder / 'rig.json').write_text(json.dumps(rig))
        found, _ = self.check(3)
        self.assertAlmostEqual(found['file']['max_covariance_diff'], 1, places=9)

    def test_a_hold_in_name_only_is_refused(self):
        rig = self.calibrate()
        rig['calibration']['held'] = ['left.ax']
        (self.folder / 'rig.json').write_text(json.dumps(rig))
        self.complains('check', self.folder / 'rig.json',
                       of='calibration.held[0]: "left.ax" has a variance in the covariance')

    def test_holds_go_with_the_names_of_cameras(self):
        self.calibrate('--hold', 'left.ax=1')
        self.works('convert', self.folder / 'rig.json', '--names', 'port,starboard', '-o',
                   self.folder / 'renamed.json')
        self.holds('renamed.json')
        rig = json.loads((self.folder / 'renamed.json').read_text())
        self.assertEqual(rig['calibration']['held'], ['port.ax'])
        rig['calibration']['held'] = ['left.ax']
        (self.folder / 'renamed.json').write_text(json.dumps(rig))
        self.complains('check', self.folder / 'renamed.json',
                       of='calibration.held[0]: the rig has no parameter "left.ax"')

    def test_a_prior_is_in_the_file(self):
        rig = self.calibrate('--know', 'left.f_px=500,1')
        found = self.check(trials=200)[0]['file']
        self.assertLess(found['max_parameter_diff_sigma'], 1e-4)
        self.assertLess(found['max_covariance_diff'], 1e-4)
        del rig['evidence']['priors']  # as files of another program might be
        (self.folder / 'rig.json').write_text(json.dumps(rig))
        found, said = self.check()
        self.assertIsNone(found['file'])
        self.assertIn('the file does not contain the prior of its calibration', said)
        self.assertIn('does not contain the prior', found['file_reason'])


class Simulation(Case):
    def test_simulate_is_repeatable_and_none_is_exact(self):
        words = ('simulate', '--pose', '10,7.5,0', '--seed', '4', '--json')
        one, two = self.works(*words).stdout, self.works(*words).stdout
        self.assertEqual(one, two)
        exact = json.loads(self.works(*words, '--source', 'none').stdout)
        self.assertEqual(exact['sensed']['left'], exact['true']['left'])
        self.assertEqual(exact['sensed']['right'], exact['true']['right'])
        self.assertGreater(len(exact['true']['left']), 50)

    def test_simulate_says_what_is_true_what_was_told_and_what_is_seen_in_space(self):
        words = ('simulate', '--pose', '10,7.5,0', '--seed', '4', '--trial', '2', '--json')
        view = json.loads(self.works(*words).stdout)
        true, sensed, space = view['true'], view['sensed'], view['space']
        for key in ('feature', 'segment', 'object', 'a_m', 'b_m', 'right'):
            self.assertEqual(len(true[key]), len(true['left']), key)
        self.assertEqual(len(set(true['feature'])), len(true['feature']))
        for key in ('feature', 'edge', 'segment', 'right'):
            self.assertEqual(len(sensed[key]), len(sensed['left']), key)
        for key in ('a_m', 'b_m', 'depth_sigma_m', 'reliable'):
            self.assertEqual(len(space[key]), len(sensed['left']), key)
        for feature, edge, segment in zip(sensed['feature'], sensed['edge'], sensed['segment']):
            self.assertEqual(feature // 2, true['feature'][edge])
            self.assertEqual(segment, true['segment'][edge])
        self.assertEqual(len(view['corners']['corner']), len(view['corners']['left']))
        nominal = json.loads((ROOT / 'datasets/rigs/nominal.rig.json').read_text())['cameras']
        for seen, filed in zip(view['rig']['true'], nominal, strict=True):
            self.assertEqual(seen['parameters'], filed['parameters'])
        self.assertEqual(view['rig']['told'], view['rig']['true'])
        self.assertEqual(view['calibration'], 0)

        exact = json.loads(self.works(*words, '--source', 'none').stdout)
        near = 0
        for a, b, reliable, edge in zip(exact['space']['a_m'], exact['space']['b_m'],
                                        exact['space']['reliable'], exact['sensed']['edge']):
            errors = [abs(x - y) for end, key in ((a, 'a_m'), (b, 'b_m'))
                      for x, y in zip(end, exact['true'][key][edge])]
            near += reliable and max(errors) < 1e-6
        self.assertGreater(near, 30)

        drawn = json.loads(self.works(*words, '--source', 'calibration=10').stdout)
        self.assertEqual(drawn['calibration'], 10)
        self.assertEqual(drawn['rig']['true'], view['rig']['true'])
        self.assertNotEqual(drawn['rig']['told'], view['rig']['true'])
        self.assertEqual(drawn['sensed'], sensed)  # it acts on what is told and nothing else
        self.assertNotEqual(drawn['space'], space)
        samples = self.folder / 'samples.csv'
        self.works('sample', 'nominal', '--psi-c', '10', '-n', '3', '--seed', '4', '-o', samples)
        names, *rows = [line.split(',') for line in samples.read_text().splitlines()]
        third = dict(zip(names, map(float, rows[2])))
        self.assertEqual(drawn['rig']['told'][0]['parameters']['f_px'], third['left.f_px'])

    def test_simulate_refuses_places_and_options_that_make_no_sense(self):
        for pose, why in (('-3,7.5,0', 'is outside the world'),
                          ('10,99,0', 'is outside the world'),
                          ('0.05,7.5,0', 'has a surface nearer than 0.12 m')):
            self.complains('simulate', f'--pose={pose}', of=why)
        self.complains('simulate', '--pose', '10,7.5,0', '--height-m', '3', of='at a height of 3 m')
        self.complains('simulate', '--pose', '10,7.5,0', '--height-m', '2.45',
                       of='less than 0.2 m above the camera')
        for sources, why in ((('stereo_mismatch=0', 'stereo_mismatch_px=5'), 'has no effect'),
                             (('none', 'corner_mismatch_px=5'), 'has no effect'),
                             (('edge_loss=0.1', 'none'), 'would override'),
                             (('edge_loss=0.1', 'edge_loss=0.2'), 'is given twice'),
                             (('calibration=-1',), 'out of range')):
            words = [word for source in sources for word in ('--source', source)]
            self.complains('simulate', '--pose', '10,7.5,0', *words, of=why)
        rig = json.loads((ROOT / 'datasets/rigs/nominal.rig.json').read_text())
        bare = {key: rig[key] for key in ('format', 'version', 'cameras')}
        (self.folder / 'bare.json').write_text(json.dumps(bare))
        self.works('simulate', '--rig', self.folder / 'bare.json', '--pose', '10,7.5,0', '-q')
        self.complains('simulate', '--rig', self.folder / 'bare.json', '--pose', '10,7.5,0',
                       '--source', 'calibration=1', of='covariance')

    def test_simulate_takes_a_pose_on_the_route_of_a_world_without_walls(self):
        edges = ''.join(f'[[segment]]\nsegment = [{x}, {y}, 0, {x}, {y}, 0.8]\n'
                        for x in (4, 5) for y in (-0.5, 0.5))
        world = self.folder / 'low.world.toml'
        world.write_text('format = "vernier/world"\nversion = 1\n' + edges +
                         '[[route]]\npoints_m = [[0, 0], [1, 0]]\n')
        self.works('simulate', '--world', world, '--pose', '0,0,0', '-q')
        self.complains('simulate', '--world', world, '--pose', '0,3,0', of='outside the world')

    def test_world_make_is_repeatable(self):
        for name in ('a', 'b'):
            self.works('world', 'make', '--seed', '7', '-o', self.folder / name)
        self.assertEqual((self.folder / 'a').read_bytes(), (self.folder / 'b').read_bytes())
        info = json.loads(self.works('world', 'info', 'workshop', '--json').stdout)
        self.assertGreaterEqual(info['segments'], 7000)
        self.assertGreaterEqual(info['repeated_share'], 0.4)
        self.assertEqual(info['size_m'], [20, 15, 2.5])


class Study(Case):
    def study(self, trials=24):
        """Of a small office, since a whole run is repeated several times."""
        world = self.folder / 'small.world.toml'
        if not world.exists():
            self.works('world', 'make', '--seed', '5', '--size-m', '10,8,2.5', '-o', world)
        file = self.folder / 's.toml'
        file.write_text(f'[study]\ntrials = {trials}\nprotocol = "near_path"\n'
                        f'[world]\nfile = "{world.name}"\n[map]\n'
                        'spacing_m = 2\n[sweep]\n"sources.calibration" = [0.1, 10]\n')
        return file

    @staticmethod
    def untimed(text):
        cells = json.loads(text)['cells']
        return [{k: v for k, v in c.items() if '_ms_' not in k} for c in cells]

    def test_json_contract_threads_and_merge(self):
        file = self.study()
        one = self.works('study', file, '-o', self.folder / 'one', '--threads', '1', '--json')
        two = self.works('study', file, '-o', self.folder / 'two', '--threads', '2', '--json', '-q')
        self.assertEqual(two.stderr, '')
        self.assertEqual(self.untimed(one.stdout), self.untimed(two.stdout))
        cell = json.loads(one.stdout)['cells'][1]
        for key in ('settings', 'trials', 'success', 'success_interval_95', 'coverage',
                    'success_when_answered', 'median_error_m', 'cpu_ms_mean', 'cpu_ms_median',
                    'cpu_ms_p95', 'wall_ms_mean', 'protocol', 'world_ceiling'):
            self.assertIn(key, cell)
        self.assertEqual(cell['settings']['sources.calibration'], 10)
        comparison, = json.loads(one.stdout)['comparisons']
        self.assertEqual(comparison['test'], 'paired t over maps')
        self.assertEqual(comparison['maps'], 6)
        self.assertTrue(0 <= comparison['p_value'] <= 1)
        self.assertTrue(0 <= comparison['mcnemar_p'] <= 1)
        self.assertEqual(comparison['p_value_holm'], comparison['p_value'])  # it is the only one
        counts = [comparison[key] for key in ('both', 'only_a', 'only_b', 'neither')]
        self.assertEqual(sum(counts), 24)
        for i in range(2):
            self.works('study', file, '-o', self.folder / f'part{i}', '--shard', f'{i}/2', '-q')
        merged = self.works('study', 'merge', self.folder / 'part0', self.folder / 'part1', '-o',
                            self.folder / 'merged', '--json')
        self.assertEqual(self.untimed(merged.stdout), self.untimed(one.stdout))

    def test_comparisons_are_adjusted_for_their_number(self):
        file = self.folder / 's.toml'
        file.write_text('[study]\ntrials = 18\nprotocol = "near_path"\n[map]\nspacing_m = 2\n'
                        '[sweep]\n"sources.calibration" = [0.1, 30, 100, 1000]\n')
        done = vernier('study', file, '-o', self.folder / 'out', '--json', '-q')
        self.assertEqual(done.returncode, 3, done.stderr)
        self.assertIn('told a rig that no cameras can have (psi_c = 1000)', done.stderr)
        found = json.loads(done.stdout)['comparisons']
        self.assertEqual(len(found), 3)
        least = 0
        for rank, row in enumerate(sorted(found, key=lambda row: row['p_value'])):
            least = max(least, min(1, (3 - rank) * row['p_value']))
            self.assertAlmostEqual(row['p_value_holm'], least, places=12)
        self.assertNotEqual([row['p_value'] for row in found],
                            [row['p_value_holm'] for row in found])

    def test_more_threads_than_cores_are_no_reason_to_speak(self):
        threads = max(8, (os.cpu_count() or 1) + 2)
        done = self.works('study', self.study(6), '-o', self.folder / 'many', '--threads',
                          str(threads), '-q')
        self.assertEqual(done.stderr, '')

    def test_a_report_replaces_no_file_of_its_study(self):
        (self.folder / 'measured.toml').write_text('[sources]\nedge_loss = 0.1\n')
        (self.folder / 's.toml').write_text('[study]\ntrials = 1\n[map]\nspacing_m = 4\n'
                                            '[sources]\nfile = "measured.toml"\n')
        out = self.folder / 'out'
        self.works('study', self.folder / 's.toml', '-o', out, '-q')
        files = sorted(file.name for file in out.iterdir()
                       if file.suffix in ('.toml', '.json', '.sqlite'))
        self.assertEqual(files, ['results.sqlite', 'rig.json', 'sources.toml', 'study.toml',
                                 'world.world.toml'])
        for name in files:
            before = (out / name).read_bytes()
            self.complains('report', out, '-o', out / name,
                           of='is an input and would be overwritten')
            self.assertEqual((out / name).read_bytes(), before)

    def test_a_study_names_the_covariance_that_drives_psi_c(self):
        for rig, kind in (('nominal', 'mvb'), ('renamed.json', 'jackknife')):
            if rig != 'nominal':
                data = json.loads((ROOT / 'datasets/rigs/nominal.rig.json').read_text())
                data['covariance']['kind'] = kind
                (self.folder / rig).write_text(json.dumps(data))
            file = self.folder / 'kind.toml'
            file.write_text(f'[study]\ntrials = 1\n[map]\nspacing_m = 4\n[rig]\nfile = "{rig}"\n')
            out = self.folder / f'of_{kind}'
            said = json.loads(self.works('study', file, '-o', out, '--json', '-q').stdout)
            self.assertEqual(said['rig'], {'file': rig, 'covariance_kind': kind})
            table = self.works('study', 'status', out).stdout
            self.assertIn(f'rig {rig}: covariance (scaled by psi_c) of kind {kind}\n',
                          table)

    def test_an_interval_needs_six_maps(self):
        file = self.study(5)
        done = self.works('study', file, '-o', self.folder / 'few', '--json', '-q')
        for cell in json.loads(done.stdout)['cells']:
            self.assertIsNone(cell['success_interval_95'])
            self.assertEqual(cell['success_interval_95_missing'], 'needs 6 maps, has 5')
            self.assertEqual(cell['maps'], 5)
        comparison, = json.loads(done.stdout)['comparisons']
        self.assertIsNone(comparison['p_value'])
        self.assertIsNone(comparison['p_value_holm'])
        self.assertIsNone(comparison['mcnemar_p'])
        table = self.works('study', 'status', self.folder / 'few').stdout
        self.assertIn('no interval: needs 6 maps, has 5', table)
        done = self.works('study', self.study(20), '-o', self.folder / 'more', '--json', '-q')
        for cell in json.loads(done.stdout)['cells']:
            self.assertEqual(cell['maps'], 7)
            self.assertLess(cell['success_interval_95'][0], cell['success'])
            self.assertIsNone(cell['success_interval_95_missing'])

    def test_a_merge_with_a_missing_shard_is_doubtful(self):
        folder = self.folder / 'part0'
        part = self.works('study', self.study(), '-o', folder, '--shard', '0/2', '-q')
        self.assertNotIn('nan %', part.stdout)  # of the ceiling, whose other queries are elsewhere
        cells = json.loads(self.works('study', 'status', folder, '--json', '-q').stdout)['cells']
        self.assertEqual([cell['world_ceiling'] for cell in cells], [None, None])
        done = vernier('study', 'merge', self.folder / 'part0', '-o', self.folder / 'merged')
        self.assertEqual(done.returncode, 3)
        self.assertIn('blocks are missing', done.stderr)

    def test_killed_and_resumed(self):
        file = self.study(48)
        running = subprocess.Popen([PROGRAM, 'study', file, '-o', self.folder / 'killed',
                                    '--threads', '1'], stderr=subprocess.PIPE, text=True)
        for line in running.stderr:
            if re.search(r'blocks: [1-9]', line):
                break
        running.kill()
        running.wait()
        running.stderr.close()
        resumed = self.works('study', file, '-o', self.folder / 'killed', '--json')
        self.assertRegex(resumed.stderr, r': 0 of ([1-9]|1[01]),')  # of 12; one or more were kept
        whole = self.works('study', file, '-o', self.folder / 'whole', '--json')
        self.assertEqual(self.untimed(resumed.stdout), self.untimed(whole.stdout))

    def test_report_is_one_page_without_requests(self):
        self.works('study', self.study(20), '-o', self.folder / 'out', '-q')
        page = self.folder / 'report.html'
        self.works('report', self.folder / 'out', '-o', page)
        text = page.read_text()
        self.assertFalse('<!--VERNIER' in text, 'a mark of the template is left')
        self.assertIsNone(re.search(r'<(script|link|img)[^>]+(src|href)="?(http|//|[.\w]+/)', text))


if __name__ == '__main__':
    PROGRAM = os.path.abspath(sys.argv.pop(1))
    unittest.main()
