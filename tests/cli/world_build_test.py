# SPDX-FileCopyrightText: 2026 The Vernier authors
# SPDX-License-Identifier: Apache-2.0
"""vernier world build as a user calls it, and what the other verbs make of its world.

    world_build_test.py PROGRAM [unittest's options]
"""
import csv
import json
import math
import os
import pathlib
import sys
import unittest

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent))
sys.dont_write_bytecode = True
import verb_calls
from lines_test import BOXES, WALL_M, write_walk

PROGRAM = pathlib.Path(sys.argv[1]).resolve()
DATA = os.environ.get('VERNIER_DATA', '')
BUILD = ['world', 'build', '--segments', 'seen.jsonl', '--poses', 'poses.csv', '--height-m', '1']


class WorldBuild(verb_calls.ProgramCase):
    program = PROGRAM

    def setUp(self):
        super().setUp()
        write_walk(self.folder, steps=5)
        self.done('lines', '--image', 'walk*.pgm', '--depth', 'far*.png', '--rig', 'K.txt', '--poses',
                  'poses.csv', '--height-m', '1', '-o', 'walk.jsonl', '--segments', 'seen.jsonl')

    def done(self, *words, code=0):
        run = self.run_program(*words)
        self.assertEqual(run.returncode, code, run.stderr)
        return run.stdout

    def refused(self, *words, says):
        run = self.run_program(*words, '-o', 'out.toml')
        self.assertEqual(run.returncode, 2, run.stdout + run.stderr)
        self.assertEqual(run.stderr.count('\n'), 1, run.stderr)
        self.assertIn(says, run.stderr)
        self.assertFalse((self.folder / 'out.toml').exists())

    def lines(self):
        with open(self.folder / 'lines.csv', newline='') as text:
            return [{key: float(value) for key, value in row.items()} for row in csv.DictReader(text)]

    def test_edges_of_the_boxes_are_joined_and_surfaces_stand_behind_them(self):
        found = json.loads(self.done(*BUILD, '--depth', 'far*.png', '--rig', 'K.txt', '-o', 'b.toml',
                                     '--lines', 'lines.csv', '--plan', 'b.svg', '--json'))
        self.assertEqual(found['views'], 5)
        self.assertGreater(found['surfaces'], 3)
        self.assertGreater(found['joined'], found['lines'] - 1)
        self.assertLess(found['hidden_share'], 0.1)
        rows = self.lines()
        self.assertEqual(len(rows), found['lines'])
        upright = [row for row in rows if abs(row['a_z_m'] - row['b_z_m']) > 0.5]
        edges = [(ahead, side) for ahead, *sides in BOXES for side in sides]
        for row in upright:
            off = min(math.hypot(row['a_x_m'] - x, row['a_y_m'] - y) for x, y in edges)
            self.assertLess(off, 0.06, row)
        near = [e for e in edges if any(math.hypot(row['a_x_m'] - e[0], row['a_y_m'] - e[1]) < 0.06
                                        for row in upright)]
        self.assertGreaterEqual(len(near), 4)  # others are hidden, or leave the image
        for row in rows:
            self.assertGreaterEqual(row['views'], 2)
            self.assertGreaterEqual(row['ax_ax_m2'], 0.01 ** 2)  # what all sightings share
        info = json.loads(self.done('world', 'info', 'b.toml', '--poses', '0', '--json'))
        self.assertEqual(info['segments'], found['lines'])
        self.assertAlmostEqual(info['route_m'], 4 * math.hypot(0.2, 0.05), delta=0.02)
        seen = json.loads(self.done('simulate', '--world', 'b.toml', '--pose', '0.4,0.1,0', '--height-m',
                                    '1', '--source', 'none', '--json'))
        self.assertGreater(len(seen['space']['a_m']), 3)
        self.done('world', 'export', 'b.toml', '-o', 'b.ply')
        # the same again gives the same bytes
        before = (self.folder / 'b.toml').read_bytes(), (self.folder / 'lines.csv').read_bytes()
        self.done(*BUILD, '--depth', 'far*.png', '--rig', 'K.txt', '-o', 'b.toml', '--lines', 'lines.csv')
        self.assertEqual(before, ((self.folder / 'b.toml').read_bytes(),
                                  (self.folder / 'lines.csv').read_bytes()))

    def test_a_study_runs_in_it(self):
        self.done(*BUILD, '--depth', 'far*.png', '--rig', 'K.txt', '-o', 'b.toml')
        (self.folder / 'built.toml').write_text(
            '[study]\ntrials = 2\nprotocol = "near_path"\n[world]\nfile = "b.toml"\n'
            '[camera]\nheight_m = 1\n[map]\nspacing_m = 0.2\n')
        run = self.run_program('study', 'built.toml', '-o', 'studied', '--threads', '1')
        self.assertIn(run.returncode, (0, 3), run.stderr)

    def test_lines_that_are_upright_as_far_as_is_known_have_a_ceiling(self):
        rows = [json.loads(line) for line in (self.folder / 'seen.jsonl').read_text().splitlines()]
        for row in rows:  # lean by a third of a degree, to the side on which the lower end is
            for segment in row['segments']:
                low = 'a_m' if segment['a_m'][1] > segment['b_m'][1] else 'b_m'
                segment[low][0] += 0.01
        (self.folder / 'seen.jsonl').write_text(''.join(json.dumps(row) + '\n' for row in rows))
        (self.folder / 'built.toml').write_text(
            '[study]\ntrials = 60\nprotocol = "near_path"\n[world]\nfile = "b.toml"\n'
            '[camera]\nheight_m = 1\n[map]\nspacing_m = 0.2\n[sources]\ncalibration = 0\n')
        for words, uprights in ((['--upright-deg', '0'], 0), ([], 4)):
            with self.subTest(words):
                found = json.loads(self.done(*BUILD, '-o', 'b.toml', '--lines', 'lines.csv', *words,
                                             '--json'))
                self.assertEqual((found['upright'], found['lines']), (uprights, 4))
                self.assertEqual([row['upright'] for row in self.lines()], [float(uprights > 0)] * 4)
                # the table has the line as measured
                self.assertTrue(all(row['a_x_m'] != row['b_x_m'] or row['a_y_m'] != row['b_y_m']
                                    for row in self.lines()))
                run = self.run_program('study', 'built.toml', '-o', f'studied{uprights}', '--json', '-q')
                self.assertIn(run.returncode, (0, 3), run.stderr)
                ceiling = json.loads(run.stdout)['cells'][0]['world_ceiling']
                info = json.loads(self.done('world', 'info', 'b.toml', '--json'))['aliasing']
                if uprights:
                    self.assertGreater(ceiling, 0.9)
                    self.assertGreater(info['ceiling'], 0.9)
                else:
                    self.assertEqual((ceiling, info['ceiling']), (0, 0))

    def test_depth_maps_belong_to_images_by_name(self):
        build = [*BUILD, '--depth', 'far*.png', '--rig', 'K.txt', '-o', 'b.toml', '-q']
        segments = (self.folder / 'seen.jsonl').read_text().splitlines()
        (self.folder / 'seen.jsonl').write_text('\n'.join(segments[i] for i in (0, 1, 3, 4)) + '\n')
        (self.folder / 'far2.png').rename(self.folder / 'left_out.png')
        self.done(*build)
        without = (self.folder / 'b.toml').read_bytes()
        # lines leaves images out; their maps, and any more, may stay
        (self.folder / 'left_out.png').rename(self.folder / 'far2.png')
        (self.folder / 'far17.png').write_bytes((self.folder / 'far0.png').read_bytes())
        self.done(*build)
        self.assertEqual((self.folder / 'b.toml').read_bytes(), without)
        # the order of the names is none of the numbers
        for i in range(5):
            (self.folder / f'far{i}.png').rename(self.folder / f'far{i + 7}.png')
        for name in ('seen.jsonl', 'poses.csv'):
            text = (self.folder / name).read_text()
            for i in range(5):
                text = text.replace(f'walk{i}', f'walk{i + 7:02}')
            (self.folder / name).write_text(text)
        self.done(*build)
        self.assertEqual((self.folder / 'b.toml').read_bytes(), without)

    def test_views_of_lines_do_without_depth(self):
        found = json.loads(self.done('world', 'build', '--features', 'walk.jsonl', '-o', 'f.toml',
                                     '--lines', 'lines.csv', '--json'))
        self.assertEqual(found['surfaces'], 0)
        self.assertGreaterEqual(found['lines'], 4)
        few = json.loads(self.done('world', 'build', '--features', 'walk.jsonl', '--min-sightings', '5',
                                   '-o', 'f.toml', '--json'))
        self.assertLess(few['lines'], found['lines'])

    def test_what_no_view_saw_again_is_a_doubt(self):
        run = self.run_program(*BUILD, '--min-sightings', '6', '-o', 'b.toml')
        self.assertEqual(run.returncode, 3)
        self.assertIn('no line was seen by 6 views', run.stderr)

    def test_a_floor_elsewhere_is_a_doubt(self):
        self.done('lines', '--image', 'left.pgm', '--depth', 'depth.png', '--rig', 'rig.json', '-o',
                  'one.jsonl')  # the inputs of all verbs are at hand
        poses = (self.folder / 'poses.csv').read_text()
        down = poses.replace('0,0,1,', '0,-0.6,0.8,').replace('0,-1,0,0,0,0,0,1', '0,-0.8,-0.6,0,0,0,0,1')
        (self.folder / 'down.csv').write_text(down)
        rows = [[min(1.3 / max((v - 60) / 150 * 0.8 + 0.6, 1e-3), 4.9) for _ in range(160)]
                for v in range(120)]
        for i in range(5):
            (self.folder / f'floor{i}.png').write_bytes(
                verb_calls.png16([[round(1000 * z) for z in row] for row in rows]))
        run = self.run_program('world', 'build', '--segments', 'seen.jsonl', '--poses', 'down.csv',
                               '--height-m', '1', '--depth', 'floor*.png', '--rig', 'K.txt', '-o', 'b.toml')
        self.assertEqual(run.returncode, 3, run.stderr)
        self.assertIn('give --height-m 1.3', run.stderr)

    def test_depths_of_another_scale_are_doubted(self):
        poses = ['frame,' + ','.join(f't{i}{j}' for i in range(4) for j in range(4))]
        for i in range(24):
            x, y, turn = 2 + 0.15 * i, 1.5 + 0.1 * math.sin(i), 0.12 * i
            c, s = math.cos(turn), math.sin(turn)
            poses.append(f'v{i},{s},0,{c},{x},{-c},0,{s},{y},0,-1,0,1.2,0,0,0,1')
        (self.folder / 'way.csv').write_text('\n'.join(poses) + '\n')
        (self.folder / 'K.txt').write_text('525 0 320\n0 525 240\n0 0 1\n')
        self.done('convert', 'K.txt', '--size', '640x480', '-o', 'K.json')
        self.done('simulate', '--world', 'workshop', '--rig', 'K.json', '--poses', 'way.csv', '--height-m', '0',
                  '--features', 'views.jsonl', '--segments', 'right.jsonl', '--source', 'none', '--source',
                  'endpoint_sigma_px=0.3')
        for scale, doubt in ((1, ''), (1.03, '% too far: check the scale'), (0.97, '% too near: check the scale')):
            views = [json.loads(line) for line in (self.folder / 'right.jsonl').read_text().splitlines()]
            for segment in (segment for view in views for segment in view['segments']):
                for end in ('a_m', 'b_m'):
                    if segment.get(end):
                        segment[end] = [scale * x for x in segment[end]]
            (self.folder / 'scaled.jsonl').write_text(''.join(json.dumps(view) + '\n' for view in views))
            found = json.loads(self.done('world', 'build', '--segments', 'scaled.jsonl', '--poses', 'way.csv',
                                         '--height-m', '0', '-o', 'b.toml', '--json', code=3 if doubt else 0))
            self.assertEqual(found['point_scales']['joined_again'], bool(doubt))
            self.assertAlmostEqual(found['point_scales']['depth'], 1 / scale - 1, delta=0.002)
            self.assertIn(doubt, ' '.join(found['doubts']))

    def test_poses_that_cannot_be_right_are_doubted(self):
        head, *rows = (self.folder / 'poses.csv').read_text().splitlines()
        self.assertEqual(self.run_program(*BUILD, '-o', 'b.toml').returncode, 0)
        run = self.run_program(*BUILD, '--up', 'y', '-o', 'b.toml')
        self.assertEqual(run.returncode, 3, run.stderr)
        self.assertIn('the camera is tilted by 90 degrees (median): check --up', run.stderr)
        # each view at the place of another one, 3 m off
        moved = [row.split(',') for row in rows]
        for i, row in enumerate(moved):
            row[8] = str(3.0 * i)  # y
        (self.folder / 'moved.csv').write_text('\n'.join([head, *(','.join(row) for row in moved)]) + '\n')
        run = self.run_program('world', 'build', '--segments', 'seen.jsonl', '--poses', 'moved.csv', '--height-m',
                               '1', '-o', 'b.toml')
        self.assertEqual(run.returncode, 3, run.stderr)
        self.assertIn('of the lines only: check that the poses', run.stderr)
        far = [[*row[:4], '4e6', *row[5:]] for row in moved]
        (self.folder / 'far.csv').write_text('\n'.join([head, *(','.join(row) for row in far)]) + '\n')
        self.refused('world', 'build', '--segments', 'seen.jsonl', '--poses', 'far.csv', '--height-m', '1',
                     says='far.csv: its pose of walk0.pgm is farther than 10 km')

    def test_bad_input_is_refused(self):
        self.refused(*BUILD[:4], says='without --poses')
        self.refused('world', 'build', says='--segments or --features')
        self.refused(*BUILD, '--features', 'walk.jsonl', says='one of both')
        self.refused(*BUILD, '--depth', 'far*.png', says='without --rig')
        self.refused(*BUILD, '--rig', 'K.txt', says='no effect')
        self.refused(*BUILD, '--recede-m', '0.1', says='no depth maps')
        self.refused(*BUILD, '--depth', 'far[01].png', '--rig', 'K.txt',
                     says='--depth far[01].png: has no map of "walk2.pgm" and 2 more of the 5 images')
        self.refused(*BUILD, '--up', 'w', says='--up')
        self.refused('world', 'build', '--features', 'walk.jsonl', '--height-m', '2', says='its own')
        twice = (self.folder / 'seen.jsonl').read_text()
        (self.folder / 'seen.jsonl').write_text(2 * twice)
        self.refused(*BUILD, says='seen.jsonl:6: "walk0.pgm" is there a second time')
        (self.folder / 'seen.jsonl').write_text('{"image": "walk0.pgm", "segments": [{}]}\n')
        self.refused(*BUILD, says='seen.jsonl:1')
        (self.folder / 'seen.jsonl').write_text('')
        self.refused(*BUILD, says='seen.jsonl')

    @unittest.skipUnless(DATA, 'VERNIER_DATA does not name the folder of the data sets')
    def test_the_real_walk(self):
        walk = pathlib.Path(DATA) / 'sequences' / 'office_walk'
        if not walk.exists():
            self.skipTest('no sequences/office_walk')
        self.done('lines', '--image', f'{walk}/images/0000[0-9].png', '--depth',
                  f'{walk}/depth/0000[0-9].png', '--rig', walk / 'K.txt', '--poses', walk / 'poses.csv',
                  '--up', 'y', '--height-m', '1.53', '-o', 'real.jsonl', '--segments', 'real.segments')
        found = json.loads(self.done(
            'world', 'build', '--segments', 'real.segments', '--poses', walk / 'poses.csv', '--up', 'y',
            '--height-m', '1.53', '--depth', f'{walk}/depth/0000[0-9].png', '--rig', walk / 'K.txt',
            '-o', 'b.toml', '--json'))
        self.assertEqual(found['views'], 3)
        self.assertGreater(found['lines'], 150)
        self.assertGreater(found['surfaces'], 50)
        self.assertLess(found['hidden_share'], 0.1)


if __name__ == '__main__':
    unittest.main(argv=[sys.argv[0], *sys.argv[2:]])
