#!/usr/bin/env python3
# SPDX-FileCopyrightText: 2026 The Vernier authors
# SPDX-License-Identifier: Apache-2.0
"""vernier match, calibrate --pairs and combine as a user calls them, on the 13 real pairs.

    combine_test.py PROGRAM
"""
import csv
import json
import os
import pathlib
import subprocess
import sys
import tempfile
import unittest

ROOT = pathlib.Path(__file__).resolve().parents[2]
PRIOR = str(ROOT / 'docs/examples/datasheet.json')
IMAGES = '/usr/share/doc/opencv-doc/examples/data'
if not os.path.exists(f'{IMAGES}/left01.jpg'):
    IMAGES = f'{ROOT}/build/opencv-doc{IMAGES}'
PROGRAM = ''


def run(*arguments, folder):
    return subprocess.run([PROGRAM, *arguments], cwd=folder, capture_output=True, text=True)


@unittest.skipUnless(os.path.exists(f'{IMAGES}/left01.jpg'), 'opencv-doc has no images here')
class Combine(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.temporary = tempfile.TemporaryDirectory()
        cls.folder = pathlib.Path(cls.temporary.name)
        done = run('match', '--left', f'{IMAGES}/left[0-9]*.jpg', '--right',
                   f'{IMAGES}/right[0-9]*.jpg', '--prior', PRIOR, '--nearest-m', '0.3', '-o',
                   'pairs.csv', folder=cls.folder)
        assert done.returncode == 0, done.stderr
        with open(cls.folder / 'pairs.csv') as file:
            rows = list(csv.reader(file))
        for name, keep in (('a.csv', lambda n: n <= 6), ('b.csv', lambda n: n > 6),
                           ('one.csv', lambda n: n == 1)):
            with open(cls.folder / name, 'w') as file:
                csv.writer(file, lineterminator='\n').writerows(
                    [rows[0]] + [row for row in rows[1:] if keep(int(row[0]))])

    @classmethod
    def tearDownClass(cls):
        cls.temporary.cleanup()

    def json_of(self, *arguments, code=0):
        done = run(*arguments, '--json', folder=self.folder)
        self.assertEqual(done.returncode, code, done.stderr)
        return json.loads(done.stdout)

    def complaint(self, *arguments):
        done = run(*arguments, folder=self.folder)
        self.assertEqual(done.returncode, 2, done.stdout + done.stderr)
        self.assertEqual(done.stdout, '')
        return done.stderr.splitlines()[-1]

    def test_pairs_make_vertical_disparity_good_and_depth_hardly(self):
        said = self.json_of('calibrate', '--pairs', 'pairs.csv', '--prior', PRIOR, '-o', 'rig.json')
        seen = said['observability']
        self.assertLess(seen['vertical_disparity_px'][1], 0.5)
        self.assertGreater(seen['vertical_disparity_px'][0], 10)
        self.assertGreater(seen['depth_sigma_m'][1], 0.1)
        self.assertAlmostEqual(seen['baseline_sd_m'][1] / seen['baseline_sd_m'][0], 1, 3)
        rig = json.loads((self.folder / 'rig.json').read_text())
        self.assertEqual(rig['calibration']['source'], 'pairs')
        self.assertEqual(len(rig['evidence']['priors']), 1)
        # Downstream verbs take it.
        for verb in (['sample', 'rig.json', '-n', '3', '-o', 's.csv'], ['uncertainty', 'rig.json'],
                     ['convert', 'rig.json', '--to', 'kalibr', '-o', 'k.yaml'],
                     ['diff', 'rig.json', 'rig.json']):
            done = run(*verb, folder=self.folder)
            self.assertIn(done.returncode, (0, 3), f'{verb}: {done.stderr}')

    def test_evidence_of_pairs_alone_is_refused_where_boards_are_needed(self):
        self.json_of('calibrate', '--pairs', 'pairs.csv', '--prior', PRIOR, '-o', 'board_less.json')
        self.assertIn('board', self.complaint('check', 'board_less.json'))
        self.assertIn('board', self.complaint('advise', 'board_less.json'))

    def test_batches_and_monitor(self):
        whole = self.json_of('calibrate', '--pairs', 'pairs.csv', '--prior', PRIOR, '-o', 'w.json')
        said = self.json_of('combine', '--prior', PRIOR, 'a.csv', 'b.csv', '--monitor', '--drift',
                            'drift.csv', '-o', 'combined.json')
        self.assertEqual([i['kind'] for i in said['inputs']], ['prior', 'pairs', 'pairs'])
        self.assertTrue(all(i['used'] for i in said['inputs']))
        for ours, theirs, sigma in zip(said['parameters'], whole['parameters'], whole['sigma']):
            self.assertLess(abs(ours - theirs), 1e-4 * sigma)
        self.assertEqual(len(said['drift']), 2)
        with open(self.folder / 'drift.csv') as file:
            self.assertEqual(len(list(csv.reader(file))), 1 + 2 * 22)
        text = run('combine', '--prior', PRIOR, 'a.csv', 'b.csv', '--monitor', '-o', 'c.json',
                   folder=self.folder).stdout
        self.assertIn('largest drift', text)
        self.assertIn('first input', text)

    def test_says_which_numbers_image_pairs_have(self):
        with open(self.folder / 'b.csv') as file:
            rows = list(csv.reader(file))
        with open(self.folder / 'again.csv', 'w') as file:  # numbers of a.csv, one left out
            csv.writer(file, lineterminator='\n').writerows(
                [rows[0]] + [[int(n) - 7, *rest] for n, *rest in rows[1:] if n != '9'])
        own = sorted({int(n) - 7 for n, *_ in rows[1:] if n != '9'})
        arguments = ['combine', '--prior', PRIOR, 'a.csv', 'again.csv', '-o', 'numbered.json']
        first, a, again = [i['image_pairs'] for i in self.json_of(*arguments)['inputs']]
        self.assertEqual(first, [])
        self.assertEqual([n for n, _ in a], [n for _, n in a])
        self.assertEqual([n for n, _ in again], own)
        evidence = json.loads((self.folder / 'numbered.json').read_text())['evidence']['pairs']
        self.assertEqual([pair['pair'] for pair in evidence], [n for _, n in a + again])
        said = run(*arguments, folder=self.folder).stdout
        own, here = next((own, here) for own, here in again if own != here)
        self.assertRegex(said, rf'(?m)^image pairs? {own} (to \d+ )?of again.csv (is|are) numbered '
                               rf'{here} (to \d+ )?below$')

    def test_without_pairs(self):
        board = ['calibrate', '--left', f'{IMAGES}/left0[1-7].jpg', '--right',
                 f'{IMAGES}/right0[1-7].jpg', '--board', '9x6', '--square-m', '0.025', '--model',
                 'opencv4', '--no-model-check', '-o', 'board.json']
        done = run(*board, folder=self.folder)
        self.assertIn(done.returncode, (0, 3), done.stderr)
        for inputs in (['board.json'], [PRIOR], ['--prior', PRIOR, 'board.json']):
            said = self.json_of('combine', *inputs, '-o', 'c.json', code=0)
            self.assertNotIn('observability', said)
            done = run('combine', *inputs, '-o', 'c.json', folder=self.folder)
            self.assertEqual(done.returncode, 0, done.stderr)
            self.assertIn('first input', done.stdout)
        # A batch that is left out leaves no pairs: said, not a crash.
        with open(self.folder / 'a.csv') as file:
            rows = list(csv.reader(file))
        with open(self.folder / 'shifted.csv', 'w') as file:
            csv.writer(file, lineterminator='\n').writerows(
                [rows[0]] + [row[:4] + [str(float(row[4]) + 8)] + row[5:] for row in rows[1:]
                             if float(row[4]) + 8 < 479])
        said = self.json_of('combine', 'board.json', 'shifted.csv', '-o', 'c.json', code=3)
        self.assertFalse(said['inputs'][1]['used'])
        self.assertNotIn('observability', said)

    def test_outputs_are_spared(self):
        self.assertIn('another output',
                      self.complaint('combine', '--prior', PRIOR, 'a.csv', 'b.csv', '--monitor',
                                     '--drift', './q.json', '-o', 'q.json'))
        self.assertFalse((self.folder / 'q.json').exists())
        images = ['--left', f'{IMAGES}/left01.jpg', '--right', f'{IMAGES}/right01.jpg', '--prior',
                  PRIOR]
        self.assertIn('another output',
                      self.complaint('match', *images, '-o', 'z.png', '--picture', './z.png'))
        self.complaint('match', *images, '-o', 'z.csv', '--picture', 'nowhere/z.png')
        self.assertFalse((self.folder / 'z.csv').exists())
        self.assertIn('same image', self.complaint('match', '--left', f'{IMAGES}/left01.jpg',
                                                   '--right', f'{IMAGES}/left01.jpg', '--prior',
                                                   PRIOR, '-o', 'z.csv'))

    def test_impossible_priors_leave_no_file(self):
        prior = json.loads(pathlib.Path(PRIOR).read_text())
        prior['covariance']['matrix'][0][0] *= -1
        (self.folder / 'negative.json').write_text(json.dumps(prior))
        said = self.complaint('calibrate', '--pairs', 'pairs.csv', '--prior', 'negative.json',
                              '-o', 'none.json')
        self.assertIn('negative.json', said)
        self.assertFalse((self.folder / 'none.json').exists())

    def test_a_full_disk_is_said(self):
        with open('/dev/full', 'w') as full:
            done = subprocess.run([PROGRAM, 'calibrate', '--pairs', 'pairs.csv', '--prior', PRIOR,
                                   '-o', 'full.json', '-q', '--json'], cwd=self.folder, stdout=full,
                                  stderr=subprocess.PIPE, text=True)
        self.assertEqual(done.returncode, 2)
        self.assertIn('standard output', done.stderr)

    def test_information_filter_says_its_distance(self):
        said = self.json_of('combine', '--prior', PRIOR, 'a.csv', 'b.csv', '--mode', 'information',
                            '-o', 'filtered.json')
        self.assertGreater(said['information_filter']['worst_in_sigma'], 0)
        self.assertNotIn('evidence', json.loads((self.folder / 'filtered.json').read_text()))

    def test_a_knock_is_left_out(self):
        with open(self.folder / 'b.csv') as file:
            rows = list(csv.reader(file))
        with open(self.folder / 'knocked.csv', 'w') as file:
            for row in rows[1:]:
                row[4] = f'{float(row[4]) + 0.02 * (float(row[3]) - 320):.6f}'  # rolled by 0.02 rad
            csv.writer(file, lineterminator='\n').writerows(
                [rows[0]] + [r for r in rows[1:] if 0 < float(r[4]) < 479])
        said = self.json_of('combine', '--prior', PRIOR, 'a.csv', 'knocked.csv', '-o', 'k.json',
                            code=3)
        self.assertEqual([i['used'] for i in said['inputs']], [True, True, False])

    def test_one_image_pair_is_enough_to_go_on(self):
        self.json_of('calibrate', '--pairs', 'one.csv', '--prior', PRIOR, '-o', 'one.json')

    def test_complaints(self):
        self.assertIn('--prior', self.complaint('calibrate', '--pairs', 'pairs.csv', '-o', 'x.json'))
        self.assertIn('not used with --pairs', self.complaint(
            'calibrate', '--pairs', 'pairs.csv', '--prior', PRIOR, '--board', '9x6', '-o', 'x.json'))
        self.assertIn('give a prior', self.complaint('combine', 'a.csv', '-o', 'x.json'))
        self.assertIn('nothing.csv', self.complaint('combine', '--prior', PRIOR, 'nothing.csv', '-o',
                                                    'x.json'))
        self.assertFalse((self.folder / 'x.json').exists())


if __name__ == '__main__':
    PROGRAM = os.path.abspath(sys.argv.pop(1))
    unittest.main()
