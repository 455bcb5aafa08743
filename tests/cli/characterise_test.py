#!/usr/bin/env python3
# SPDX-FileCopyrightText: 2026 The Vernier authors
# SPDX-License-Identifier: Apache-2.0
"""vernier characterise as a user calls it, on a pair made here: boxes before a wall; and on a sequence
of views of a wall with lines.

    characterise_test.py PROGRAM
"""
import json
import os
import pathlib
import random
import subprocess
import sys
import tempfile
import tomllib
import unittest

from evaluate_test import write_pgm

PROGRAM = ''
WIDTH, HEIGHT = 360, 240


def pair():
    """A wall at disparity 6 and a box at 14, both with bright and dark boards; rows of grey values."""
    draw = random.Random(5)
    wide = WIDTH + 40

    def boards():
        grey = [[128] * wide for _ in range(HEIGHT)]
        for y in range(4, HEIGHT - 30, 34):
            for x in range(4, wide - 36, 40):
                left, top = x + draw.randrange(6), y + draw.randrange(5)
                w, h, value = draw.randrange(18, 28), draw.randrange(16, 25), draw.choice((60, 190))
                for row in grey[top:top + h]:
                    row[left:left + w] = [value] * w
        return grey
    wall, box = boards(), boards()
    left, right, truth = [], [], []
    for y in range(HEIGHT):
        inside = [70 <= y < 170 and 120 <= x < 260 for x in range(wide)]
        left.append([(box if inside[x] else wall)[y][x] for x in range(WIDTH)])
        truth.append([4 * (14 if inside[x] else 6) for x in range(WIDTH)])
        right.append([box[y][x + 14] if inside[x + 14] else wall[y][x + 6] for x in range(WIDTH)])
    return left, right, truth


def write_sequence(folder, views=20, lost=0.2):
    """A camera, 160 x 120, that steps sideways along a wall 3 m ahead with lines on it, each view
    without a fifth of them; world x right, y down, z forward."""
    draw = random.Random(3)
    f, cx, cy, z = 150, 80, 60, 3.0
    lines = [(0.55 * i - 1 + draw.uniform(-0.12, 0.12), draw.uniform(-0.9, -0.4),
              draw.uniform(0.3, 0.9)) for i in range(12)]
    covariance = [[(1e-4 if i % 3 == 2 else 4e-6) * (i == k) for k in range(6)] for i in range(6)]
    poses = ['image,' + ','.join(f't{i}{j}' for i in range(4) for j in range(4))]
    seen = []
    for v in range(views):
        at = 0.2 * v
        segments = []
        for x, top, bottom in lines:
            u = cx + f * (x - at) / z
            missed, noise = draw.random() < lost, [draw.gauss(0, 0.1) for _ in range(4)]
            if missed or not 2 < u < 157:
                continue
            px = [u + noise[0], cy + f * top / z + noise[1], u + noise[2], cy + f * bottom / z + noise[3]]
            ends = [[(px[i] - cx) / f * z, (px[i + 1] - cy) / f * z, z] for i in (0, 2)]
            segments.append({'image_px': px, 'a_m': ends[0], 'b_m': ends[1],
                             'covariance_m2': covariance, 'reliable': True})
        seen.append(json.dumps({'image': f'wall{v:02}.png', 'segments': segments}))
        poses.append(f'wall{v:02}.png,1,0,0,{at},0,1,0,0,0,0,1,0,0,0,0,1')
        import verb_calls  # which imports this module
        (folder / f'wall{v:02}.png').write_bytes(verb_calls.png16([[3000] * 160] * 120))
    (folder / 'wall.segments').write_text('\n'.join(seen) + '\n')
    (folder / 'wall.csv').write_text('\n'.join(poses) + '\n')
    (folder / 'wall_K.txt').write_text(f'{f} 0 {cx}\n0 {f} {cy}\n0 0 1\n')


SEQUENCE = ['characterise', '--sequence', 'wall.segments', '--poses', 'wall.csv', '--rig', 'wall_K.txt',
            '--depth', 'wall*.png']


class Sequence(unittest.TestCase):
    def setUp(self):
        temporary = tempfile.TemporaryDirectory()
        self.addCleanup(temporary.cleanup)
        self.folder = pathlib.Path(temporary.name)
        write_sequence(self.folder)

    def call(self, *words):
        return subprocess.run([PROGRAM, *words], cwd=self.folder, capture_output=True, text=True)

    def test_a_study_takes_what_was_measured(self):
        done = self.call(*SEQUENCE, '-o', 'sources.toml', '--json')
        self.assertEqual(done.returncode, 0, done.stderr)
        said = json.loads(done.stdout)
        self.assertEqual((said['views'], said['with_depth']), (20, True))
        figures = said['figures']
        self.assertAlmostEqual(figures['lost_whole']['value'], 0.2, delta=0.08)
        self.assertLess(figures['end_across_px']['value'], 0.2)
        self.assertAlmostEqual(figures['pieces']['value'], 1, delta=0.01)
        self.assertEqual(figures['mismatch']['value'], 0)
        self.assertGreater(said['depths_agree'], 0.95)
        self.assertEqual([band['from_m'] for band in said['lost_again']], [0, 0.25, 0.5, 1, 2, 4])
        self.assertIsNone(said['lost_again'][-1]['to_m'])
        for band in said['by_range'] + said['by_length'] + said['by_angle']:
            self.assertLessEqual(set(figures), set(band))
        written = tomllib.loads((self.folder / 'sources.toml').read_text())['sources']
        self.assertEqual(set(written) - {'missed_alike', 'missed_alike_m'}, {'missed', 'clutter', 'edge_loss', 'endpoint_sigma_px', 'stereo_mismatch'})
        for key, source in said['sources'].items():
            self.assertEqual(written.get(key), source['value'] if source['written'] else None, key)
        (self.folder / 'study.toml').write_text(
            '[study]\ntrials = 1\nprotocol = "near_path"\n[sources]\nfile = "sources.toml"\n')
        done = self.call('study', 'study.toml', '-o', 'out', '--json', '-q')
        self.assertEqual(done.returncode, 0, done.stderr)
        settings = json.loads(done.stdout)['cells'][0]['settings']
        self.assertEqual(settings['sources.edge_loss'], written['edge_loss'])

    def test_text_and_repetition(self):
        text = self.call(*SEQUENCE, '-q').stdout
        for word in ('edge_loss', 'false_edges', 'range, m', 'length, px', 'to sight, deg', 'blocks'):
            self.assertIn(word, text)
        self.assertEqual(self.call(*SEQUENCE, '-q').stdout, text)

    def test_images_left_out_may_have_depth_maps(self):
        lines = (self.folder / 'wall.segments').read_text().splitlines()
        (self.folder / 'wall.segments').write_text('\n'.join(lines[:7] + lines[8:]) + '\n')
        with_its_map = self.call(*SEQUENCE, '-q', '--json')
        self.assertEqual(with_its_map.returncode, 0, with_its_map.stderr)
        (self.folder / 'wall07.png').unlink()
        self.assertEqual(self.call(*SEQUENCE, '-q', '--json').stdout, with_its_map.stdout)

    def test_poses_of_other_images_are_noticed(self):
        lines = (self.folder / 'wall.csv').read_text().splitlines()
        (self.folder / 'wall.csv').write_text('\n'.join(  # as if it had gone the other way
            line.replace(',1,0,0,', ',1,0,0,-') for line in lines) + '\n')
        done = self.call(*SEQUENCE, '-o', 'sources.toml')
        self.assertEqual(done.returncode, 3, done.stderr)
        self.assertIn('poses', done.stderr)
        self.assertFalse((self.folder / 'sources.toml').exists())

    def test_depth_maps_of_other_images_are_noticed(self):
        import verb_calls  # which imports this module
        nearer = verb_calls.png16([[500] * 160] * 120)
        for file in self.folder.glob('wall[0-9][0-9].png'):
            file.write_bytes(nearer)
        done = self.call(*SEQUENCE, '-o', 'sources.toml')
        self.assertEqual(done.returncode, 3, done.stderr)
        self.assertIn('the depth maps agree with 0 % of the segments of their own images only', done.stderr)
        self.assertFalse((self.folder / 'sources.toml').exists())

    def test_bad_input(self):
        def complains(of, *words):
            done = self.call(*words, '-q')
            self.assertEqual(done.returncode, 2, done.stdout + done.stderr)
            self.assertEqual(done.stdout, '')
            self.assertIn(of, done.stderr.splitlines()[-1])
            self.assertEqual(len(done.stderr.splitlines()), 1)
        complains('without --poses', 'characterise', '--sequence', 'wall.segments', '--rig', 'wall_K.txt')
        complains('--matcher', *SEQUENCE, '--matcher', 'edge')
        complains('--scenes', *SEQUENCE, '--scenes', 'pairs.toml')
        complains('no --sequence', 'characterise', '--scenes', 'pairs.toml', '--poses', 'wall.csv')
        complains('no depth maps', *SEQUENCE[:-2], '--depth-unit-m', '0.01')
        complains('size', *SEQUENCE[:-2])  # of which K says nothing
        complains('wall00.png: has no map of "wall01.png" and 18 more of the 20 images', *SEQUENCE[:-1], 'wall00.png')
        complains('wall.segments', *SEQUENCE, '-o', 'wall.segments')
        complains('wall03.png', *SEQUENCE, '-o', 'wall03.png')
        (self.folder / 'wall07.png').write_bytes(b'')
        complains('wall07.png', *SEQUENCE)
        (self.folder / 'wall.segments').write_text('{"image": "wall00.png", "segments": [{}]}\n')
        complains('wall.segments:1', *SEQUENCE)


class RealSequence(unittest.TestCase):
    """The first images of a walk with a head-mounted camera; skipped without VERNIER_DATA."""

    def test_what_a_kitchen_shows(self):
        walk = pathlib.Path(os.environ.get('VERNIER_DATA', '')) / 'sequences' / 'office_walk'
        if 'VERNIER_DATA' not in os.environ or not walk.is_dir():
            self.skipTest('VERNIER_DATA does not name the folder of the data sets')
        with tempfile.TemporaryDirectory() as folder:
            def call(*words):
                done = subprocess.run([PROGRAM, *map(str, words), '-q'], cwd=folder,
                                      capture_output=True, text=True)
                self.assertEqual(done.returncode, 0, done.stderr)
                return done.stdout
            some = '000[0-4]*.png'  # 16 views
            poses = ['--poses', walk / 'poses.csv']
            call('lines', '--image', walk / 'images' / some, '--depth', walk / 'depth' / some, '--rig',
                 walk / 'K.txt', *poses, '--up', 'y', '--height-m', '1.6', '-o', 'walk.jsonl',
                 '--segments', 'walk.segments')
            said = json.loads(call('characterise', '--sequence', 'walk.segments', *poses, '--rig',
                                   walk / 'K.txt', '--depth', walk / 'depth' / some, '--json'))
        figures = {name: figure['value'] for name, figure in said['figures'].items()}
        self.assertTrue(0.05 < figures['loss'] < 0.6, figures)
        self.assertTrue(0.05 < figures['end_across_px'] < 0.4, figures)
        self.assertTrue(1 < figures['pieces'] < 2, figures)
        self.assertLess(figures['false_edges'], 0.5)
        short, long = (said['by_length'][i]['loss']['value'] for i in (0, 2))
        self.assertGreater(short, long)


class Characterise(unittest.TestCase):
    def setUp(self):
        temporary = tempfile.TemporaryDirectory()
        self.addCleanup(temporary.cleanup)
        self.folder = pathlib.Path(temporary.name)
        for name, rows in zip(('left', 'right', 'truth'), pair()):
            write_pgm(self.folder / f'{name}.pgm', rows)
        write_pgm(self.folder / 'blank.pgm', [[100] * WIDTH for _ in range(HEIGHT)])
        write_pgm(self.folder / 'small.pgm', [[100] * 50 for _ in range(40)])

    def call(self, *words):
        return subprocess.run([PROGRAM, *words], cwd=self.folder, capture_output=True, text=True)

    def run_it(self, *more, left='left', right='right', truth='truth', scale='4',
               most='24'):
        return self.call('characterise', '--left', f'{left}.pgm', '--right', f'{right}.pgm',
                         '--truth', f'{truth}.pgm', '--truth-scale', scale, '--max-disparity', most,
                         *more)

    def list_of(self, pairs):
        (self.folder / 'pairs.toml').write_text('\n'.join(
            f'[[pair]]\nname = "p{i}"\nleft = "left.pgm"\nright = "right.pgm"\n'
            'truth = "truth.pgm"\ntruth_scale = 4\nmax_disparity = 24' for i in range(pairs)))
        return 'characterise', '--scenes', 'pairs.toml'

    def test_a_study_takes_what_was_measured(self):
        done = self.run_it('-o', 'sources.toml', '--json')
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertIn('1 pair: the intervals are over image parts', done.stderr)
        said = json.loads(done.stdout)
        self.assertEqual(said['clustered_by'], 'part of an image')
        written = tomllib.loads((self.folder / 'sources.toml').read_text())['sources']
        for key, source in said['sources'].items():
            self.assertEqual(key in written, source['written'], key)
            if source['written']:
                self.assertEqual(written[key], source['value'], key)
                low, high = source['interval_95']
                if low is not None:
                    self.assertLessEqual(low, source['value'] + 1e-4, key)
                    self.assertGreaterEqual(high, source['value'] - 1e-4, key)
        self.assertIn('edge_loss', written)
        self.assertIn('stereo_mismatch', written)
        self.assertNotIn('lateral_shift_px', written)  # of which a pair sees the half at most
        (self.folder / 'study.toml').write_text(
            '[study]\ntrials = 1\nprotocol = "near_path"\n[sources]\nfile = "sources.toml"\n'
            'corner_loss = 0.25\n')
        done = self.call('study', 'study.toml', '-o', 'out', '--json', '-q')
        self.assertEqual(done.returncode, 0, done.stderr)
        settings = json.loads(done.stdout)['cells'][0]['settings']
        for key, value in written.items():
            self.assertEqual(settings[f'sources.{key}'], 0.25 if key == 'corner_loss' else value)
        (self.folder / 'sources.toml').unlink()  # the study's folder has its own
        (self.folder / 'out').rename(self.folder / 'moved')
        done = self.call('study', 'status', 'moved', '--json', '-q')
        self.assertEqual(json.loads(done.stdout)['cells'][0]['settings'], settings)

    def test_lists_and_repetition(self):
        done = self.call(*self.list_of(6), '--json', '-q', '-o', 'a.toml')
        self.assertEqual(done.returncode, 0, done.stderr)
        said = json.loads(done.stdout)
        self.assertEqual((said['clustered_by'], said['clusters']), ('pair', 6))
        self.assertEqual([scene['name'] for scene in said['scenes']], [f'p{i}' for i in range(6)])
        self.assertEqual(self.call(*self.list_of(6), '--json', '-q').stdout, done.stdout)
        text = self.call(*self.list_of(6), '-q').stdout
        for word in ('edge_loss', '95 % interval', 'default', 'bootstrap over 6 pairs'):
            self.assertIn(word, text)

    def test_what_the_eyes_differ_by_on_demand(self):
        done = self.run_it('-q', '-o', 'sources.toml', '--lateral-shift', 'independent')
        self.assertEqual(done.returncode, 0, done.stderr)
        written = tomllib.loads((self.folder / 'sources.toml').read_text())['sources']
        self.assertEqual(written['lateral_shift_mode'], 'independent')
        self.assertLess(written['lateral_shift_px'], 0.1)  # whole pixels, no noise

    def test_nothing_to_be_trusted(self):
        write_pgm(self.folder / 'nearly.pgm', [[100 + 60 * (x == 100 and 60 < y < 90)
                                                for x in range(WIDTH)] for y in range(HEIGHT)])
        for more in ({'scale': '2'}, {'left': 'nearly'}):
            done = self.run_it('-o', 'sources.toml', **more)
            self.assertEqual(done.returncode, 3, f'{more} {done.stderr}')
            self.assertIn('not trustworthy', done.stderr)
            self.assertIn('not written', done.stderr)
            self.assertFalse((self.folder / 'sources.toml').exists())

    def test_a_truth_that_is_off_everywhere(self):
        """By 3 px: edges still lie near where it has them, matched corners do not."""
        _, _, truth = pair()
        write_pgm(self.folder / 'off.pgm', [[value + 12 for value in row] for row in truth])
        done = self.run_it('-o', 'sources.toml', truth='off')
        self.assertEqual(done.returncode, 3, done.stderr)
        self.assertIn('not trustworthy', done.stderr)
        self.assertFalse((self.folder / 'sources.toml').exists())

    def test_bad_input(self):
        def complains(done, of):
            self.assertEqual(done.returncode, 2, done.stdout + done.stderr)
            self.assertEqual(done.stdout, '')
            self.assertIn(of, done.stderr.splitlines()[-1])
        complains(self.run_it('-q', right='small'), 'small.pgm')
        complains(self.run_it('-q', left='blank'), 'no edges')
        complains(self.run_it('-q', left='right', right='left'), 'swapped')
        complains(self.run_it('-q', truth='small'), 'small.pgm')
        complains(self.run_it('-q', '--matcher', 'edge,bm'), 'more than one')
        complains(self.run_it('-q', '--matcher', 'best'), 'unknown matcher')
        complains(self.run_it('-q', most='900'), 'width')
        before = (self.folder / 'truth.pgm').read_bytes()
        complains(self.run_it('-q', '-o', './truth.pgm'), 'is an input')
        self.assertEqual((self.folder / 'truth.pgm').read_bytes(), before)
        complains(self.run_it('-q', '-o', 'nowhere/s.toml'), 'nowhere')
        complains(self.call('characterise', '--left', 'left.pgm'), '--right')
        complains(self.call('characterise', '--scenes', 'none.toml', '-q'), 'none.toml')


if __name__ == '__main__':
    PROGRAM = sys.argv.pop(1)
    unittest.main()
