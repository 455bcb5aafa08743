# SPDX-FileCopyrightText: 2026 The Vernier authors
# SPDX-License-Identifier: Apache-2.0
"""vernier odometry as a user calls it.

    odometry_test.py PROGRAM [unittest's options]
"""
import json
import math
import pathlib
import random
import sys
import unittest

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent))
sys.dont_write_bytecode = True
import verb_calls
from evaluate_test import write_pgm

PROGRAM = pathlib.Path(sys.argv[1]).resolve()
SIZE = (320, 240)
F_PX, BASELINE_M, DEPTH_M, STEP_M = 300, 0.2, 3.0, 0.05
ROBOT = ['odometry', '--world', 'workshop', '--leg', '2']


def rig():
    """Two parallel pinhole cameras."""
    def camera(name, **more):
        values = {'f_px': F_PX, 'ax': 1, 'ox_px': SIZE[0] / 2, 'oy_px': SIZE[1] / 2, 'k1': 0}
        return {'name': name, 'model': 'radial1', 'size_px': list(SIZE), 'parameters': values, **more}
    return {'format': 'vernier/rig', 'version': 1, 'cameras': [
        camera('left'),
        camera('right', from_first={'rotation_rad': [0, 0, 0], 'translation_m': [-BASELINE_M, 0, 0]})]}


def wall(seed=1):
    """Smooth random grey levels of a wall, for real coordinates in metres."""
    chance = random.Random(seed)
    waves = [(chance.uniform(-40, 40), chance.uniform(-40, 40), chance.uniform(0, 6.3))
             for _ in range(24)]

    def grey(x, y):
        return 128 + 9 * sum(math.cos(a * x + b * y + c) for a, b, c in waves)
    return grey


def image(grey, at_x_m):
    """What a camera at (at_x_m, 0, 0) sees of the wall at DEPTH_M."""
    scale = DEPTH_M / F_PX
    return [[max(0, min(255, round(grey((u - SIZE[0] / 2) * scale + at_x_m, (v - SIZE[1] / 2) * scale))))
             for u in range(SIZE[0])] for v in range(SIZE[1])]


class Odometry(verb_calls.ProgramCase):
    program = PROGRAM

    def test_images_of_a_rig_that_moves_sideways(self):
        (self.folder / 'wall.json').write_text(json.dumps(rig()))
        grey = wall()
        for i in range(3):
            write_pgm(self.folder / f'wl{i}.pgm', image(grey, i * STEP_M))
            write_pgm(self.folder / f'wr{i}.pgm', image(grey, i * STEP_M + BASELINE_M))
        (self.folder / 'true.txt').write_text(
            ''.join(f'{i / 10} {5 + i * STEP_M} 0 1 0 0 0 1\n' for i in range(3)))
        call = ['odometry', '--left', 'wl*.pgm', '--right', 'wr*.pgm', '--rig', 'wall.json']
        found = json.loads(self.done(*call, '--truth', 'true.txt', '--segment-m', STEP_M * 0.99,
                                     '--rate-hz', '10', '-o', 'path.txt', '--json'))
        self.assertEqual((found['steps'], found['found']), (2, 2))
        self.assertEqual((found['weak_steps'], found['ambiguous_steps']), (0, 0))
        few = self.run_program(*call, '--corners', '12')
        self.assertEqual(few.returncode, 3)
        self.assertIn('fewer than 10 corners', few.stderr)
        self.assertGreater(found['inliers_per_step'], 20)
        self.assertLess(found['truth']['end_error_m'], 0.005)
        self.assertLess(found['truth']['end_error_deg'], 0.1)
        rows = [line.split() for line in (self.folder / 'path.txt').read_text().splitlines()
                if line[0] != '#']
        self.assertEqual([float(row[0]) for row in rows], [0, 0.1, 0.2])
        self.assertAlmostEqual(float(rows[2][1]), 2 * STEP_M, delta=0.005)
        self.assertGreater(found['end_sd_m']['corners'], 0)
        self.assertNotIn('warnings', found)
        (self.folder / 'true.txt').write_text('0 0 0 0 0 0 0 1\n')
        self.refused(*call, '--truth', 'true.txt', says='has 1 poses for 3 images')
        (self.folder / 'true.txt').write_text('0 0 0 0 0 0 0\n')
        self.refused(*call, '--truth', 'true.txt', says='true.txt:1: has 7 fields')
        self.refused(*call, '--truth', 'true.txt', '-o', 'true.txt', says='true.txt')
        self.assertIn('0 0 0', (self.folder / 'true.txt').read_text())

    def test_what_is_stated_of_the_end_beside_steps_that_err_more_or_are_not_found(self):
        (self.folder / 'wall.json').write_text(json.dumps(rig()))
        grey = wall()
        for i in range(6):
            for side, x in (('l', i * STEP_M), ('r', i * STEP_M + BASELINE_M)):
                write_pgm(self.folder / f'e{side}{i}.pgm', image(grey, x))
        call = ['odometry', '--left', 'el*.pgm', '--right', 'er*.pgm', '--rig', 'wall.json', '--json', '-q']
        (self.folder / 'off.txt').write_text(
            ''.join(f'{i} {i * STEP_M + 0.02 * (i % 2)} 0 1 0 0 0 1\n' for i in range(6)))
        found = json.loads(self.done(*call, '--truth', 'off.txt'))
        self.assertEqual(found['truth']['nees_inside_95'], 0)
        self.assertIn('100 % of the steps lie outside', found['warnings'][0])
        for side, at in (('l', 170), ('r', 150)):
            write_pgm(self.folder / f'e{side}3.pgm', [
                [200 if abs(v - 120) < 9 and abs(u - at) < 9 else 100 for u in range(SIZE[0])]
                for v in range(SIZE[1])])
        run = self.run_program(*call)
        self.assertEqual(run.returncode, 3, run.stderr)
        found = json.loads(run.stdout)
        self.assertEqual((found['found'], found['steps']), (3, 5))
        self.assertIsNone(found['end_sd_m']['corners'])
        self.assertIn('2 of 5 steps were not found', found['doubts'][0])

    def test_half_of_the_image_that_moves_otherwise_is_told(self):
        (self.folder / 'wall.json').write_text(json.dumps(rig()))
        upper, lower, half = wall(1), wall(2), SIZE[1] // 2
        for i in range(3):
            for side, x in (('l', 0), ('r', BASELINE_M)):
                write_pgm(self.folder / f'h{side}{i}.pgm', image(upper, i * STEP_M + x)[:half] +
                          image(lower, 3 * i * STEP_M + x)[half:])
        run = self.run_program('odometry', '--left', 'hl*.pgm', '--right', 'hr*.pgm', '--rig', 'wall.json', '--json')
        self.assertEqual(run.returncode, 3, run.stderr)
        self.assertEqual(json.loads(run.stdout)['ambiguous_steps'], 2)
        self.assertIn('agree on another motion', run.stderr)

    def test_12_bits_in_a_file_of_16(self):
        (self.folder / 'wall.json').write_text(json.dumps(rig()))
        grey = wall()
        for i in range(2):
            for side, x in (('l', i * STEP_M), ('r', i * STEP_M + BASELINE_M)):
                rows = image(grey, x)
                with (self.folder / f'd{side}{i}.pgm').open('wb') as file:
                    file.write(b'P5\n%d %d\n65535\n' % SIZE)
                    for row in rows:
                        file.write(b''.join((16 * value).to_bytes(2, 'big') for value in row))
        (self.folder / 'true.txt').write_text(''.join(f'{i} {i * STEP_M} 0 1 0 0 0 1\n' for i in range(2)))
        found = json.loads(self.done('odometry', '--left', 'dl*.pgm', '--right', 'dr*.pgm', '--rig', 'wall.json',
                                     '--truth', 'true.txt', '--json'))
        self.assertGreater(found['inliers_per_step'], 20)
        self.assertLess(found['truth']['end_error_m'], 0.005)

    def test_rigs_and_poses_of_other_tools(self):
        grey = wall()
        for i in range(2):
            write_pgm(self.folder / f'kl{i}.pgm', image(grey, i * STEP_M))
            write_pgm(self.folder / f'kr{i}.pgm', image(grey, i * STEP_M + BASELINE_M))
        k = f'{F_PX} 0 {SIZE[0] / 2} %s 0 {F_PX} {SIZE[1] / 2} 0 0 0 1 0'
        (self.folder / 'calib.txt').write_text(k % 0 + ' ' + k % (-F_PX * BASELINE_M))
        (self.folder / 'poses.txt').write_text(
            ' '.join(f'1 0 0 {i * STEP_M} 0 1 0 0 0 0 1 0' for i in range(2)))
        call = ['odometry', '--left', 'kl*.pgm', '--right', 'kr*.pgm']
        found = json.loads(self.done(*call, '--rig', 'calib.txt', '--truth', 'poses.txt', '--json'))
        self.assertLess(found['truth']['end_error_m'], 0.005)
        sensor = ('%%YAML:1.0\nsensor_type: camera\nT_BS: {rows: 4, cols: 4, data: '
                  '[0, 0, 1, 0.3, -1, 0, 0, %s, 0, -1, 0, 0, 0, 0, 0, 1]}\nresolution: [%d, %d]\n'
                  'camera_model: pinhole\nintrinsics: [%d, %d, %d, %d]\ndistortion_model: none\n')
        for name, y in (('a.yaml', 0), ('b.yaml', -BASELINE_M)):
            (self.folder / name).write_text(
                sensor % (y, *SIZE, F_PX, F_PX, SIZE[0] / 2, SIZE[1] / 2))
        # the body looks along x; its camera moves to the right, so the body does to -y
        (self.folder / 'data.csv').write_text('#timestamp, x, y, z\n' + ''.join(
            f'{i + 1}000000000,7,{-i * STEP_M},0,1,0,0,0\n' for i in range(2)))
        found = json.loads(self.done(*call, '--rig', 'a.yaml,b.yaml', '--truth', 'data.csv', '--json'))
        self.assertLess(found['truth']['end_error_m'], 0.005)
        self.refused(*call, '--rig', 'calib.txt', '--truth', 'data.csv', says='poses of the body')
        self.refused(*call, '--rig', 'a.yaml', '--truth', 'data.csv', says='it needs a pair and the rig has 1 camera;')
        self.refused(*call, '--rig', 'a.yaml,calib.txt', says='is not of the format asl like a.yaml')

    def test_a_simulated_robot(self):
        plain = json.loads(self.done(*ROBOT, '--source', 'calibration=0', '--source',
                                     'corner_sigma_px=0', '--json', '-o', 'a.txt'))
        self.assertEqual(plain['found'], plain['steps'])
        again = json.loads(self.done(*ROBOT, '--source', 'calibration=5', '--drives', '4', '--json'))
        self.assertEqual(again['drives'], 4)
        self.assertGreater(again['end_sd_m']['calibration'], 0)
        self.assertGreater(again['truth']['end_error_m'], plain['truth']['end_error_m'])

    def test_the_same_to_the_bit(self):
        self.done(*ROBOT, '-o', 'a.txt')
        self.done(*ROBOT, '-o', 'b.txt')
        self.done(*ROBOT, '-o', 'c.txt', '--seed', '2')
        a, b, c = ((self.folder / f'{x}.txt').read_bytes() for x in 'abc')
        self.assertEqual(a, b)
        self.assertNotEqual(a, c)

    def test_bad_input(self):
        self.refused('odometry', says='--world')
        self.refused(*ROBOT, '--left', 'a*.png', says='images and a world')
        self.refused('odometry', '--left', 'a*.png', '--rig', 'nominal', says='--right')
        self.refused('odometry', '--left', 'a*.png', '--right', 'b*.png', says='give --rig')
        self.refused(*ROBOT, '--truth', 'a.txt', says='--truth')
        self.refused(*ROBOT[:-2], '--leg', '99', says='--leg')
        self.refused(*ROBOT, '--drives', '2', '-o', 'a.txt', says='--output')
        self.refused(*ROBOT, '--source', 'nonsense=1', says='nonsense')
        self.refused('odometry', '--left', 'left.pgm', '--right', 'right.pgm', '--rig', 'rig.json',
                     says='one pair of images')


if __name__ == '__main__':
    unittest.main(argv=[sys.argv[0], *sys.argv[2:]])
