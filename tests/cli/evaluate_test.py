#!/usr/bin/env python3
# SPDX-FileCopyrightText: 2026 The Vernier authors
# SPDX-License-Identifier: Apache-2.0
"""vernier evaluate as a user calls it, on a pair made here: boxes before a wall.

    evaluate_test.py PROGRAM
"""
import json
import pathlib
import random
import shutil
import struct
import subprocess
import sys
import tempfile
import unittest

PROGRAM = ''
WIDTH, HEIGHT = 200, 120


def write_pgm(file, rows):
    with open(file, 'wb') as out:
        out.write(b'P5\n%d %d\n255\n' % (len(rows[0]), len(rows)))
        for row in rows:
            out.write(bytes(row))


def pair():
    """A wall at disparity 6 and a box at 14, each with patches of its own; rows of grey values."""
    draw = random.Random(5)
    wide = WIDTH + 40

    def patches():
        grey = [[128] * wide for _ in range(HEIGHT)]
        for _ in range(700):
            x, y, w, h = draw.randrange(wide), draw.randrange(HEIGHT), draw.randrange(3, 16), \
                draw.randrange(3, 16)
            value = draw.randrange(60, 200)
            for row in grey[y:y + h]:
                row[x:x + w] = [value] * len(row[x:x + w])
        return grey
    wall, box = patches(), patches()
    left, right, truth = [], [], []
    for y in range(HEIGHT):
        inside = [40 <= y < 90 and 80 <= x < 140 for x in range(wide)]
        left.append([(box if inside[x] else wall)[y][x] for x in range(WIDTH)])
        truth.append([4 * (14 if inside[x] else 6) for x in range(WIDTH)])
        right.append([box[y][x + 14] if inside[x + 14] else wall[y][x + 6] for x in range(WIDTH)])
    return left, right, truth


class Evaluate(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.temporary = tempfile.TemporaryDirectory()
        cls.folder = pathlib.Path(cls.temporary.name)
        for name, rows in zip(('left', 'right', 'truth'), pair()):
            write_pgm(cls.folder / f'{name}.pgm', rows)
        write_pgm(cls.folder / 'blank.pgm', [[100] * WIDTH for _ in range(HEIGHT)])
        write_pgm(cls.folder / 'small.pgm', [[100] * 50 for _ in range(40)])

    @classmethod
    def tearDownClass(cls):
        cls.temporary.cleanup()

    def run_it(self, *more, left='left', right='right', truth='truth', most=24):
        return subprocess.run(
            [PROGRAM, 'evaluate', '--left', f'{left}.pgm', '--right', f'{right}.pgm', '--truth',
             f'{truth}.pgm', '--truth-scale', '4', '--max-disparity', str(most), *more],
            cwd=self.folder, capture_output=True, text=True)

    def complains(self, *more, of, **files):
        done = self.run_it('-q', *more, **files)
        self.assertEqual(done.returncode, 2, done.stdout + done.stderr)
        self.assertEqual(done.stdout, '')
        self.assertIn(of, done.stderr.splitlines()[-1])

    def test_scores(self):
        done = self.run_it('--matcher', 'edge,bm,sgbm', '--json', '--picture', 'd.png',
                           '--error-picture', 'e.png')
        self.assertEqual(done.returncode, 0, done.stderr)
        said = json.loads(done.stdout)
        self.assertEqual(list(said['matchers']), ['edge', 'bm', 'sgbm'])
        scene, = said['scenes']
        self.assertEqual((scene['left'], scene['truth'], scene['truth_scale'], scene['most_px']),
                         ('left.pgm', 'truth.pgm', 4, 24))
        for name, score in said['matchers'].items():
            for key in ('density', 'bad_0_5', 'bad_1', 'bad_2', 'mismatch', 'rms_inlier_px',
                        'time_ms'):
                self.assertIsInstance(score[key], (int, float), f'{name} {key}')
        self.assertGreater(said['matchers']['edge']['density'], 0.9)
        self.assertLess(said['matchers']['edge']['bad_1'], 0.03)
        for picture in ('d.png', 'e.png'):
            self.assertEqual((self.folder / picture).read_bytes()[:4], b'\x89PNG')
        self.assertIn('density', self.run_it().stdout)

    def test_a_program_as_a_matcher(self):
        script = self.folder / 'mine.py'
        script.write_text('import sys, struct\n'
                          f'w, h = {WIDTH}, {HEIGHT}\n'
                          'with open(sys.argv[1], "wb") as f:\n'
                          '    f.write(b"Pf\\n%d %d\\n-1\\n" % (w, h))\n'
                          '    f.write(struct.pack("<%df" % (w * h), *[6.0] * (w * h)))\n')
        done = self.run_it('--matcher', 'none', '--command',
                           f'{sys.executable} mine.py {{output}} {{left}} {{right}}', '--json')
        self.assertEqual(done.returncode, 0, done.stderr)
        score, = json.loads(done.stdout)['matchers'].values()
        self.assertGreater(score['density'], 0.99)
        self.assertGreater(score['mismatch'], 0.1)  # the box
        self.assertLess(score['mismatch'], 0.5)

    def score_of(self, command, *more, truth=('--truth', 'truth.pgm', '--truth-scale', '4'), code=0):
        """Of a program that writes bytes of a PFM file; the standard error with it."""
        done = subprocess.run([PROGRAM, 'evaluate', '--left', 'left.pgm', '--right', 'right.pgm', *truth,
                               '--max-disparity', '24', '--matcher', 'none', '--command',
                               f'o={command} {{output}} {{left}} {{right}}', '--json', *more],
                              cwd=self.folder, capture_output=True, text=True)
        self.assertEqual(done.returncode, code, done.stderr)
        return json.loads(done.stdout)['matchers']['o'], done.stderr

    def write_pfm(self, file, values):
        (self.folder / file).write_bytes(b'Pf\n%d %d\n-1\n' % (WIDTH, HEIGHT) + b''.join(
            struct.pack(f'<{WIDTH}f', *row) for row in reversed(values)))

    def copier(self, name, values):
        """A program that writes these disparities."""
        self.write_pfm(f'{name}.pfm', values)
        (self.folder / name).write_text(f'#!/bin/sh\ncp {self.folder}/{name}.pfm "$1"\n')
        (self.folder / name).chmod(0o755)
        return f'{self.folder}/{name}'

    def test_specks_of_a_map_count_as_they_are(self):
        draw = random.Random(8)
        truth = [[d / 4 for d in row] for row in pair()[2]]
        exact, _ = self.score_of(self.copier('exact', truth))
        self.assertEqual((exact['bad_0_5'], exact['mismatch']), (0, 0))
        for share, off in ((0.3, -4), (0.02, 8), (0.1, 8)):
            specks = [[d + off if draw.random() < share else d for d in row] for row in truth]
            found, _ = self.score_of(self.copier('specks', specks))
            # 5 standard deviations of a share of 3,000 edges; at discontinuities either surface counts
            self.assertAlmostEqual(found['bad_1_smooth'], share, delta=5 * (share * (1 - share) / 3000) ** 0.5)

    def test_a_map_in_other_units_is_doubted(self):
        truth = [[d / 4 for d in row] for row in pair()[2]]
        found, said = self.score_of(self.copier('scaled', [[256 * d for d in row] for row in truth]), code=3)
        self.assertIn("100 % of the program's disparities are above the 24 px asked for", said)
        self.assertNotIn('check that the ground truth', said)
        self.assertEqual(found['density'], 0)

    def test_truth_of_separate_points(self):
        draw = random.Random(9)
        truth = [[d / 4 for d in row] for row in pair()[2]]
        points = [[d if draw.random() < 0.3 else float('inf') for d in row] for row in truth]
        self.write_pfm('points.pfm', points)
        given = ('--truth', 'points.pfm')
        exact, _ = self.score_of(self.copier('exact', truth), truth=given)
        self.assertEqual((exact['bad_0_5'], exact['mismatch'], exact['density']), (0, 0, 1))
        moved, _ = self.score_of(self.copier('moved', [[d + 0.3 for d in row] for row in truth]), truth=given)
        self.assertAlmostEqual(moved['bias_inlier_px'], 0.3, delta=1e-3)
        wrong, _ = self.score_of(self.copier('wrong', [[d + 5 for d in row] for row in truth]), truth=given,
                                 code=3)
        self.assertEqual((wrong['rms_inlier_px'], wrong['bias_inlier_px'], wrong['bad_1_smooth']), (None, None, 1))

    def test_values_of_a_truth_that_mean_unknown(self):
        truth = [[d / 4 for d in row] for row in pair()[2]]
        exact = self.copier('exact', truth)
        for value in (0, -1):
            self.write_pfm('holes.pfm', [[value if x < 40 else d for x, d in enumerate(row)] for row in truth])
            doubted, said = self.score_of(exact, truth=('--truth', 'holes.pfm'), code=3)
            self.assertIn(f'20 % of the ground truth is exactly {value}', said)
            self.assertGreater(doubted['bad_1'], 0.1)
            known, said = self.score_of(exact, truth=('--truth', 'holes.pfm', '--truth-unknown', str(value)))
            self.assertEqual((known['bad_1'], said.count('exactly')), (0, 0))
            _, said = self.score_of(exact, truth=('--truth', 'holes.pfm', '--truth-unknown', 'none'))
            self.assertNotIn('exactly', said)
        scale = [[256 * d for d in row] for row in truth]
        self.write_pfm('scaled.pfm', scale)
        _, said = self.score_of(exact, truth=('--truth', 'scaled.pfm'), code=3)
        self.assertIn('give --truth-scale 256', said)

    def test_equal_density_of_a_matcher_without_errors(self):
        truth = [[d / 4 for d in row] for row in pair()[2]]
        exact = self.copier('exact', truth)
        noisy = pair()[2]
        for row in noisy[50:80]:
            row[100:130] = [24] * 30  # the ground truth of one scene
        write_pgm(self.folder / 'noisy.pgm', noisy)
        (self.folder / 'three.toml').write_text('\n'.join(
            f'[[pair]]\nname = "{i}"\nleft = "left.pgm"\nright = "right.pgm"\ntruth = "{name}.pgm"\n'
            'truth_scale = 4\nmax_disparity = 24' for i, name in enumerate(('noisy', 'truth', 'truth'))))
        for json_too in ((), ('--json',)):
            done = subprocess.run([PROGRAM, 'evaluate', '--scenes', 'three.toml', '--matcher', 'edge', '--command',
                                   f'o={exact} {{output}} {{left}} {{right}}', '--equal-density', *json_too],
                                  cwd=self.folder, capture_output=True, text=True)
            self.assertEqual(done.returncode, 0, done.stderr)
        against = json.loads(done.stdout)['equal_density']['against']['o']
        self.assertGreater(against['ratio'], 0)
        low, high = against['ratio_interval_95']
        self.assertGreaterEqual(low, 0)
        self.assertIsNone(high)  # a resample without the scene in which it errs

    def doubts(self, *more, of, **files):
        done = self.run_it('-q', '--json', *more, **files)
        self.assertEqual(done.returncode, 3, done.stderr)
        self.assertIn(of, done.stderr)
        doubt, = json.loads(done.stdout)['doubts']  # one line for one cause
        self.assertIn(of, doubt)

    def test_what_cannot_be_is_doubted(self):
        right = [[(7 * x * y) % 251 for x in range(WIDTH)] for y in range(HEIGHT)]
        write_pgm(self.folder / 'other.pgm', right)
        write_pgm(self.folder / 'twice.pgm', [[2 * d for d in row] for row in pair()[2]])
        self.doubts(of='check that the ground truth belongs to this left image', truth='twice')
        self.doubts(of='outside the search range of 0 to 4 px; they range from 6 to', most=4)
        self.doubts(of='are not aligned', right='other')

    def test_rows_of_another_height_are_doubted(self):
        right = pair()[1]
        write_pgm(self.folder / 'lower.pgm', right[:1] * 2 + right[:HEIGHT - 2])
        self.doubts(of='left: the rows of the two images are misaligned by', right='lower')
        self.assertEqual(self.run_it('-q', '--repair', right='lower').returncode, 0)

    def test_programs_have_names_and_places(self):
        (self.folder / 'even.py').write_text(
            f'import sys, struct\nw, h = {WIDTH}, {HEIGHT}\n'
            'open(sys.argv[1], "wb").write(b"Pf\\n%d %d\\n-1\\n" % (w, h) + '
            'struct.pack("<%df" % (w * h), *[6.0] * (w * h)))\n')
        command = f'{sys.executable} even.py {{output}} {{left}} {{right}}'
        done = self.run_it('-q', '--matcher', 'mine,edge', '--command', command, '--command',
                           'mine=' + command, '--command', command, '--equal-density', '--json')
        self.assertEqual(done.returncode, 0, done.stderr)
        said = json.loads(done.stdout)
        first, second = [n for n in said['matchers'] if n not in ('mine', 'edge')]
        self.assertEqual(list(said['matchers'])[:2], ['mine', 'edge'])
        self.assertEqual(second, first + '-2')
        self.assertIn('no confidence', said['equal_density']['against'][first]['setting'])
        (self.folder / 'slow.py').write_text('import time\ntime.sleep(60)\n')
        self.complains('--matcher', 'none', '--time-limit-s', '0.3', '--command',
                       f'{sys.executable} slow.py {{output}} {{left}} {{right}}',
                       of='exceeded the time limit')

    def test_under_calibration_error(self):
        more = ('--matcher', 'edge,sgbm', '--psi-c', '1,10', '--draws', '2', '--rows-moved-px', '2',
                '--json')
        done = self.run_it('-q', *more)
        self.assertEqual(done.returncode, 0, done.stderr)
        said = json.loads(done.stdout)['calibration_error']
        self.assertEqual([(c['psi_c'], c['rows_moved_px'], c['repair']) for c in said['cells']],
                         [(p, r, repair) for p, r in ((0, 0), (1, 0), (10, 0), (0, 2))
                          for repair in (False, True)])
        given, rows = said['cells'][0], said['cells'][6:]
        plain = json.loads(self.run_it('-q', '--matcher', 'edge,sgbm', '--json').stdout)
        for name in ('edge', 'sgbm'):
            self.assertEqual(given['matchers'][name]['mismatch'],
                             plain['matchers'][name]['mismatch'])
        self.assertLess(rows[0]['matchers']['edge']['density'], 0.6)
        self.assertGreater(rows[1]['matchers']['edge']['density'], 0.85)
        self.assertEqual(rows[1]['repaired'], 1)
        self.assertGreater(said['cells'][4]['geometric_bias_rms_px'],
                           5 * said['cells'][2]['geometric_bias_rms_px'])
        again = self.run_it('-q', *more, '--threads', '1')
        self.assertEqual(json.loads(again.stdout)['calibration_error'], said)
        self.assertEqual([c['not_physical'] for c in said['cells']], [0] * 8)
        wild = self.run_it('-q', '--matcher', 'edge', '--psi-c', '1000', '--draws', '4', '--json')
        self.assertEqual(wild.returncode, 0, wild.stderr)
        cell = json.loads(wild.stdout)['calibration_error']['cells'][2]
        self.assertEqual(cell['pairs'] + cell['not_physical'], 4)
        self.assertLess(cell['matchers']['edge']['density'] or 0, 0.5)
        other = self.run_it('-q', *more, '--seed', '2')
        self.assertNotEqual(json.loads(other.stdout)['calibration_error'], said)

    def test_equal_density(self):
        done = self.run_it('-q', '--matcher', 'edge,bm', '--equal-density', '--json')
        self.assertEqual(done.returncode, 0, done.stderr)
        said = json.loads(done.stdout)
        against = said['equal_density']['against']['bm']
        self.assertLessEqual(against['density'], said['matchers']['edge']['density'] + 1e-9)
        self.assertEqual(against['ratio_interval_95'], [None, None])  # one scene
        self.assertEqual(list(said['curves']), ['edge', 'bm'])

    def test_folder_and_page(self):
        done = self.run_it('-q', '--psi-c', '1', '--draws', '1', '-o', 'out')
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertEqual(sorted(p.name for p in (self.folder / 'out').iterdir()),
                         ['01-left.disparity.png', '01-left.error.png', 'evaluation.json'])
        done = subprocess.run([PROGRAM, 'report', 'out', '-o', 'page.html'], cwd=self.folder,
                              capture_output=True, text=True)
        self.assertEqual(done.returncode, 0, done.stderr)
        page = (self.folder / 'page.html').read_text()
        self.assertIn('"calibration_error"', page)
        self.assertEqual(page.count('data:image/png;base64,'), 2)
        before = (self.folder / 'out' / 'evaluation.json').read_text()
        self.complains('-o', 'out', of='none.pgm', right='none')
        self.assertEqual((self.folder / 'out' / 'evaluation.json').read_text(), before)
        for broken in ('{"scenes": 3', '{"matchers": {}, "scenes": 3}',
                       '{"matchers": {}, "scenes": [1]}', '{"matchers": {}, "scenes": []}',
                       '{"matchers": {}, "scenes": [{"name": "a", "matchers": {}, "pictures": "x"}]}'):
            (self.folder / 'out' / 'evaluation.json').write_text(broken)
            done = subprocess.run([PROGRAM, 'report', 'out', '-o', 'page.html'], cwd=self.folder,
                                  capture_output=True, text=True)
            self.assertEqual(done.returncode, 2, broken)
            self.assertIn('evaluation.json', done.stderr)
            self.assertRegex(done.stderr, 'is not an evaluation|is not JSON: it ends too early')
        self.assertEqual((self.folder / 'page.html').read_text(), page)
        (self.folder / 'study').mkdir()
        (self.folder / 'study' / 'study.toml').write_text('')
        self.complains('-o', 'study', of='contains a study')
        self.complains('-o', 'left.pgm', of='left.pgm')
        name = '01-01_left_disparity.disparity.png'  # an input as the folder would name a picture
        (self.folder / 'inputs').mkdir()
        left = self.folder / 'inputs' / name
        shutil.copy(self.folder / 'left.pgm', left)
        (self.folder / 'pairs.toml').write_text(
            f'[[pair]]\nname = "01 left disparity"\nleft = "inputs/{name}"\n'
            'right = "right.pgm"\ntruth = "truth.pgm"\ntruth_scale = 4\nmax_disparity = 24\n')
        was = left.read_bytes()
        done = subprocess.run([PROGRAM, 'evaluate', '-q', '--scenes', 'pairs.toml', '-o', 'inputs'],
                              cwd=self.folder, capture_output=True, text=True)
        self.assertEqual(done.returncode, 2, done.stderr)
        self.assertIn('is an input', done.stderr)
        self.assertEqual(left.read_bytes(), was)

    def test_bad_input(self):
        self.complains(of='small.pgm', right='small')
        self.complains(of='no edges', left='blank')
        self.complains(of='same image', right='left')
        self.complains('--matcher', 'mine', of='unknown matcher "mine"')
        self.complains('--equal-density', '--matcher', 'edge', of='at least two matchers')
        self.complains('--psi-c', '1', '--time-limit-s', '3', of='--command')
        self.complains(of='small.pgm', truth='small')
        self.complains(of='swapped', left='right', right='left')
        self.complains(of='width', most=400)
        self.complains('--matcher', 'best', of='unknown matcher "best"')
        self.complains('--psi-c', '1,-2', of='-2 is not between')
        self.complains('--psi-c', '1e5', of='not between')
        self.complains('--rig', 'none.json', of='--psi-c')
        self.complains('--draws', '3', of='--psi-c')
        self.complains('--psi-c', '1,many', of='numbers')
        self.complains('--psi-c', '1', '--rig', 'none.json', of='none.json')
        self.complains('--picture', 'a.png', '--error-picture', './a.png', of='another output')
        done = subprocess.run([PROGRAM, 'evaluate', '--left', 'left.pgm'], cwd=self.folder,
                              capture_output=True, text=True)
        self.assertEqual(done.returncode, 2)


if __name__ == '__main__':
    PROGRAM = sys.argv.pop(1)
    unittest.main()
