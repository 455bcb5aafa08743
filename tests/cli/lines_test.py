# SPDX-FileCopyrightText: 2026 The Vernier authors
# SPDX-License-Identifier: Apache-2.0
"""vernier lines as a user calls it, and what map and localise make of its views.

    lines_test.py PROGRAM [unittest's options]
"""
import json
import math
import pathlib
import sys
import unittest

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent))
sys.dont_write_bytecode = True
import verb_calls
from evaluate_test import write_pgm

PROGRAM = pathlib.Path(sys.argv[1]).resolve()
SIZE = (160, 120)
F_PX = 150
# upright boxes before a wall: distance ahead, from and to sideways, metres; camera at 1 m
BOXES = [(2.0, -0.9, -0.6), (2.5, -0.2, 0.1), (3.0, 0.5, 0.8), (2.2, 1.0, 1.2), (3.5, -1.8, -1.4)]
WALL_M = 4.0


def seen(x, y):
    """Grey levels and depths of a level camera at (x, y) that looks along x."""
    greys, depths = [], []
    for _ in range(SIZE[1]):
        grey, depth = [], []
        for u in range(SIZE[0]):
            level, z = 110.0, WALL_M - x
            for i, (ahead, low, high) in enumerate(BOXES):
                far = ahead - x
                side = y - (u - SIZE[0] / 2) / F_PX * far  # left is positive
                if far > 0.2 and far < z and low <= side <= high:
                    level, z = 30.0 + 40 * i, far
            grey.append(round(level))
            depth.append(round(1000 * z))
        greys.append(grey)
        depths.append(depth)
    return greys, depths


def write_walk(folder, steps=3):
    poses = ['frame,' + ','.join(f't{i}{j}' for i in range(4) for j in range(4))]
    for i in range(steps):
        greys, depths = seen(0.2 * i, 0.05 * i)
        write_pgm(folder / f'walk{i}.pgm', greys)
        (folder / f'far{i}.png').write_bytes(verb_calls.png16(depths))
        # camera x right, y down, z forward; world x forward, y left, z up
        poses.append(f'walk{i},0,0,1,{0.2 * i},-1,0,0,{0.05 * i},0,-1,0,0,0,0,0,1')
    (folder / 'poses.csv').write_text('\n'.join(poses) + '\n')
    (folder / 'K.txt').write_text(f'{F_PX} 0 {SIZE[0] / 2}\n0 {F_PX} {SIZE[1] / 2}\n0 0 1\n')


CALL = ['lines', '--image', 'walk*.pgm', '--depth', 'far*.png', '--rig', 'K.txt']


class Lines(verb_calls.ProgramCase):
    program = PROGRAM

    def setUp(self):
        super().setUp()
        write_walk(self.folder)

    def test_lines_stand_where_the_boxes_do(self):
        self.done(*CALL, '--poses', 'poses.csv', '--height-m', '1', '-o', 'out.jsonl', '--segments',
                  'segments.jsonl')
        corners = [(ahead, side) for ahead, low, high in BOXES for side in (low, high)]
        views = [json.loads(line) for line in (self.folder / 'out.jsonl').read_text().splitlines()]
        self.assertEqual(len(views), 3)
        found = 0
        for i, view in enumerate(views):
            x, y, heading = view['pose']
            self.assertAlmostEqual(x, 0.2 * i)
            self.assertAlmostEqual(heading, 0)
            look = view['looks'][0]
            self.assertAlmostEqual(look['mount']['height_m'], 1)
            for line in look['lines']:
                if line['kind'] != 'vertical':
                    continue
                off = min(math.hypot(line['a_m'][0] + x - a, line['a_m'][1] + y - s)
                          for a, s in corners)
                self.assertLess(off, 0.06)
                found += 1
        self.assertGreater(found, 12)
        rows = [json.loads(row) for row in (self.folder / 'segments.jsonl').read_text().splitlines()]
        self.assertEqual([row['image'] for row in rows], [f'walk{i}.pgm' for i in range(3)])
        # Poses without names belong to the images in order, which keep their names.
        matrices = (self.folder / 'poses.csv').read_text().splitlines()[1:]
        (self.folder / 'kitti.txt').write_text(''.join(' '.join(row.split(',')[1:13]) + '\n' for row in matrices))
        self.done(*CALL, '--poses', 'kitti.txt', '--height-m', '1', '-o', 'same.jsonl', '--segments', 'same.txt')
        for one, other in (('out.jsonl', 'same.jsonl'), ('segments.jsonl', 'same.txt')):
            self.assertEqual((self.folder / one).read_text(), (self.folder / other).read_text())
        for segment in rows[0]['segments']:
            C = segment['covariance_m2']
            self.assertEqual([len(row) for row in C], [6] * 6)
            self.assertTrue(all(C[i][i] > 0 for i in range(6)))
            self.assertTrue(all(abs(C[i][j] - C[j][i]) < 1e-12 for i in range(6) for j in range(6)))

    def test_a_map_of_them_tells_where_a_view_was_taken(self):
        self.done(*CALL, '--poses', 'poses.csv', '--height-m', '1', '-o', 'out.jsonl')
        self.done('map', 'make', '--features', 'out.jsonl', '-o', 'out.map')
        run = self.run_program('localise', 'out.map', '--features', 'out.jsonl', '--method', 'pgh',
                               '--json')
        self.assertIn(run.returncode, (0, 3), run.stderr)
        # the method that compares lines in the image of a pair says that there is none
        run = self.run_program('localise', 'out.map', '--features', 'out.jsonl')
        self.assertEqual(run.returncode, 2, run.stderr)
        self.assertIn('out.map: is of one camera with depths', run.stderr)
        self.assertIn('give --method pgh', run.stderr)

    def test_the_same_to_the_bit_and_without_poses(self):
        for name in ('a.jsonl', 'b.jsonl'):
            self.done(*CALL, '-o', name, '--height-m', '1', '--pitch-deg', '10', '--roll-deg', '3')
        a, b = ((self.folder / f'{x}.jsonl').read_bytes() for x in 'ab')
        self.assertEqual(a, b)
        self.assertNotIn('pose', json.loads(a.splitlines()[0]))

    def test_images_and_depths_named_by_their_times(self):
        # as TUM's are; the second depth map is 30 ms late, and numbers do not tell who belongs to whom
        for i, (image, depth) in enumerate([('10.175304', '10.160407'), ('10.207', '10.237'),
                                            ('10.243', '10.251')]):
            (self.folder / f'walk{i}.pgm').rename(self.folder / f'{image}.pgm')
            (self.folder / f'far{i}.png').rename(self.folder / f'{depth}.png')
        run = self.run_program('lines', '--image', '10.*.pgm', '--depth', '10.*.png', '--rig', 'K.txt', '-o',
                               'out.jsonl', '--segments', 'segments.jsonl')
        self.assertEqual(run.returncode, 0, run.stderr)
        self.assertIn('1 of 3 images have no depth map within 20 ms and are left out', run.stderr)
        rows = [json.loads(row) for row in (self.folder / 'segments.jsonl').read_text().splitlines()]
        self.assertEqual([row['image'] for row in rows], ['10.175304.pgm', '10.243.pgm'])
        (self.folder / '11.5.png').write_bytes((self.folder / '10.251.png').read_bytes())
        self.refused('lines', '--image', '10.*.pgm', '--depth', '11.5*.png', '--rig', 'K.txt', '-o',
                     'no.jsonl', says='no depth map is within 20 ms of an image')

    def test_what_cannot_be_right_is_doubted(self):
        for words, doubt in ((['--depth-unit-m', '0.1'], 'check the unit of the depth maps'),
                             (['--pitch-deg', '40', '--height-m', '0.5'], 'm below the floor: check --height-m, --pitch-deg and --roll-deg'),
                             (['--poses', 'poses.csv', '--up', 'y'], 'check --up')):
            run = self.run_program(*CALL, *words, '-o', 'out.jsonl')
            self.assertEqual(run.returncode, 3, run.stderr)
            self.assertIn(doubt, run.stderr)
        self.refused(*CALL, '--height-m', '0', '-o', 'no.jsonl', says='above the floor')

    def test_depth_maps_of_other_images_are_doubted(self):
        words = ['lines', '--image', 'walk*.pgm', '--rig', 'K.txt', '-o', 'out.jsonl']
        self.assertEqual(self.run_program(*words, '--depth', 'far*.png').returncode, 0)
        for i in range(3):  # of a camera that looks elsewhere
            depths = [row[13:] + row[:13] for row in seen(0.2 * i, 0.05 * i)[1]]
            (self.folder / f'turned{i}.png').write_bytes(verb_calls.png16(depths))
        run = self.run_program(*words, '--depth', 'turned*.png')
        self.assertEqual(run.returncode, 3, run.stderr)
        self.assertIn('check that the depth maps belong to these images', run.stderr)

    def test_bad_input(self):
        out = ['-o', 'out.jsonl']
        self.refused(*CALL, *out, '--poses', 'poses.csv', '--height-m', '-1', says='above the floor')
        self.refused(*CALL, *out, '--poses', 'poses.csv', '--up', 'w', says='--up')
        self.refused(*CALL, *out, '--up', 'z', says='--up')
        self.refused(*CALL, *out, '--poses', 'poses.csv', '--roll-deg', '3', says='--roll-deg')
        self.refused(*CALL, *out, '--depth-unit-m', '5', says='--depth-unit-m')
        self.refused(*CALL[:-2], '--rig', 'nominal', '-q', *out, says='has a lens with distortion')
        self.refused('lines', '--image', 'walk*.pgm', '--depth', 'walk*.pgm', '--rig', 'K.txt', *out,
                     says='is no depth map')
        (self.folder / 'poses.csv').write_text('frame,t00,\n')
        self.refused(*CALL, *out, '--poses', 'poses.csv', says='poses.csv')
        run = self.run_program(*CALL, '-o', 'K.txt')
        self.assertEqual(run.returncode, 2)
        self.assertIn('150 0', (self.folder / 'K.txt').read_text())


if __name__ == '__main__':
    unittest.main(argv=[sys.argv[0], *sys.argv[2:]])
