#!/usr/bin/env python3
# SPDX-FileCopyrightText: 2026 The Vernier authors
# SPDX-License-Identifier: Apache-2.0
"""The verb match from outside.

    match_test.py PROGRAM [unittest's options]
"""
import csv
import json
import random
import sys
import unittest

sys.dont_write_bytecode = True
import cli_test
from cli_test import Case

WIDTH, HEIGHT, DISPARITY = 320, 240, 25


class Match(Case):
    def image(self, name, shift, seed=1, grey=None):
        """Squares of random grey in rows of random places, as PGM, noise included."""
        draw = random.Random(seed)
        rows = []
        for _ in range(HEIGHT // 12 + 1):
            edges, x = [], draw.randrange(-9, 0)
            while x < WIDTH + 2 * DISPARITY:
                width = draw.randrange(9, 19)
                edges += [draw.randrange(30, 220)] * width
                x += width
            rows.append(edges)
        noise = random.Random(f'{name} {seed}')
        pixels = bytearray()
        for y in range(HEIGHT):
            row = rows[y // 12]
            for x in range(WIDTH):
                value = row[x + shift] if grey is None else grey
                pixels.append(max(0, min(255, round(value + noise.gauss(0, 1)))))
        (self.folder / name).write_bytes(b'P5\n%d %d\n255\n' % (WIDTH, HEIGHT) + bytes(pixels))

    def pairs(self, count=1):
        for i in range(1, count + 1):
            self.image(f'left{i}.pgm', 0, i)
            self.image(f'right{i}.pgm', DISPARITY, i)

    def prior(self, name='prior.json', change=lambda rig: None):
        cameras, names, values, sigma = [], [], [], []
        for side in ('left', 'right'):
            core = {'f_px': 500, 'ax': 1, 'ox_px': 160, 'oy_px': 120}
            cameras.append({'name': side, 'model': 'pinhole', 'size_px': [WIDTH, HEIGHT],
                            'parameters': {**core, 'ay': 1}})
            names += [f'{side}.{key}' for key in core]
            values += core.values()
            sigma += [1, 0.002, 0.5, 0.5]
        cameras[1]['from_first'] = {'rotation_rad': [0, 0, 0], 'translation_m': [-0.2, 0, 0]}
        names += ['right.' + p for p in ('wx_rad', 'wy_rad', 'wz_rad', 'tx_m', 'ty_m', 'tz_m')]
        values += [0, 0, 0, -0.2, 0, 0]
        sigma += [1e-3] * 6
        matrix = [[s * s if i == j else 0 for j in range(14)] for i, s in enumerate(sigma)]
        rig = {'format': 'vernier/rig', 'version': 1, 'cameras': cameras, 'parameter_names': names,
               'parameters': values, 'covariance': {'kind': 'prior', 'matrix': matrix}}
        change(rig)
        (self.folder / name).write_text(json.dumps(rig))
        return self.folder / name

    def arguments(self, left='left*.pgm', right='right*.pgm', **prior):
        return ('match', '--left', self.folder / left, '--right', self.folder / right, '--prior',
                self.prior(**prior), '--nearest-m', '2', '-o', self.folder / 'pairs.csv')

    def test_two_pairs(self):
        self.pairs(2)
        picture = self.folder / 'picture.png'
        done = self.works(*self.arguments(), '--json', '--picture', picture)
        found = json.loads(done.stdout)
        with open(self.folder / 'pairs.csv', newline='') as file:
            rows = list(csv.DictReader(file))
        self.assertEqual(len(rows), found['matches'])
        self.assertEqual([p['pair'] for p in found['image_pairs']], [1, 2])
        self.assertEqual(sum(p['matches'] for p in found['image_pairs']), len(rows))
        self.assertEqual({row['pair'] for row in rows}, {'1', '2'})
        for image in found['image_pairs']:
            self.assertGreater(image['matches'], 0.5 * image['corners_left'])
            self.assertLess(image['noise_left'], 2)
        right = [abs(float(row['u_left_px']) - float(row['u_right_px']) - DISPARITY) < 0.5 and
                 abs(float(row['v_left_px']) - float(row['v_right_px'])) < 0.5 for row in rows]
        self.assertGreater(sum(right), 0.99 * len(rows))
        self.assertEqual(picture.read_bytes()[:4], b'\x89PNG')

    def test_any_number_of_threads_gives_the_same_file(self):
        self.pairs(2)
        self.works(*self.arguments(), '--threads', '1')
        one = (self.folder / 'pairs.csv').read_bytes()
        self.works(*self.arguments(), '--threads', '3')
        self.assertEqual(one, (self.folder / 'pairs.csv').read_bytes())

    def test_a_table_for_a_person(self):
        self.pairs()
        lines = self.works(*self.arguments(), '-n', '100').stdout.splitlines()
        self.assertEqual(lines[0].split()[:5], ['pair', 'left', 'right', 'candidates', 'matches'])
        self.assertEqual(lines[1].split()[:3], ['0', '100', '150'])
        self.assertIn('matches of 1 image pairs written to', lines[2])

    def test_images_of_another_size_than_the_prior(self):
        self.pairs()

        def larger(rig):
            rig['cameras'][1]['size_px'] = [640, 480]
        self.complains(*self.arguments(change=larger), '-q',
                       of='right1.pgm: the size 320x240 differs from that of camera "right"')

    def test_images_without_a_partner(self):
        self.pairs(2)
        (self.folder / 'right2.pgm').unlink()
        self.complains(*self.arguments(), '-q',
                       of='left2.pgm: no right image has the number 2 (2 images here, 1 on the other side)')

    def test_blank_images(self):
        self.image('left1.pgm', 0, grey=100)
        self.image('right1.pgm', 0)
        self.complains(*self.arguments(), '-q',
                       of="left1.pgm: no corner is detected above the image noise")

    def test_one_blank_image_among_others(self):
        self.pairs(2)
        self.image('right2.pgm', 0, grey=100)
        done = self.works(*self.arguments(), '--json')
        self.assertIn("right2.pgm: no corner is detected above the image noise; pair skipped",
                      done.stderr)
        self.assertEqual(json.loads(done.stdout)['image_pairs'][1]['matches'], 0)

    def test_left_and_right_exchanged(self):
        self.pairs()
        self.complains(*self.arguments(left='right*.pgm', right='left*.pgm'), '-q',
                       of='left and right appear to be swapped: ')

    def test_images_that_do_not_belong_together(self):
        self.image('left1.pgm', 0, 1)
        self.image('right1.pgm', 0, 2)
        done = cli_test.vernier(*self.arguments())
        self.assertIn(done.returncode, (2, 3))
        self.assertIn('left corners were matched; check that the prior belongs to',
                      done.stderr + done.stdout)

    def test_a_camera_mounted_upright_is_matched_as_well(self):
        """The right camera turned by a quarter turn: its first row is the right edge of the view."""
        self.image('left1.pgm', 0)
        self.image('flat.pgm', DISPARITY)
        flat = (self.folder / 'flat.pgm').read_bytes()[-WIDTH * HEIGHT:]
        turned = bytes(flat[row * WIDTH + column] for column in range(WIDTH)
                       for row in reversed(range(HEIGHT)))
        (self.folder / 'right1.pgm').write_bytes(b'P5\n%d %d\n255\n' % (HEIGHT, WIDTH) + turned)

        def quarter_turn(rig):
            right = rig['cameras'][1]
            right['size_px'] = [HEIGHT, WIDTH]
            values = {'right.ox_px': HEIGHT - 1 - 120, 'right.oy_px': 160,
                      'right.wz_rad': 1.5707963267948966, 'right.tx_m': 0, 'right.ty_m': -0.2}
            right['parameters'].update(ox_px=values['right.ox_px'], oy_px=160)
            right['from_first'] = {'rotation_rad': [0, 0, values['right.wz_rad']],
                                   'translation_m': [0, -0.2, 0]}
            for name, value in values.items():
                rig['parameters'][rig['parameter_names'].index(name)] = value
        found = json.loads(self.works(*self.arguments(change=quarter_turn), '--json').stdout)
        image = found['image_pairs'][0]
        self.assertGreater(image['matches'], 0.5 * image['corners_left'])
        with open(self.folder / 'pairs.csv', newline='') as file:
            rows = list(csv.DictReader(file))
        right = [abs(float(row['u_left_px']) - float(row['v_right_px']) - DISPARITY) < 0.5 and
                 abs(HEIGHT - 1 - float(row['v_left_px']) - float(row['u_right_px'])) < 0.5
                 for row in rows]
        self.assertGreater(sum(right), 0.99 * len(rows))

    def test_a_prior_without_covariance(self):
        self.pairs()

        def bare(rig):
            for key in ('parameter_names', 'parameters', 'covariance'):
                del rig[key]
        self.complains(*self.arguments(change=bare), '-q',
                       of='covariance')

    def test_a_prior_of_three_cameras(self):
        self.pairs()

        def third(rig):
            rig['cameras'].append({**rig['cameras'][1], 'name': 'third'})
            values = {n: v for n, v in zip(rig['parameter_names'], rig['parameters'])}
            intrinsics = ['f_px', 'ax', 'ox_px', 'oy_px']
            poses = ['wx_rad', 'wy_rad', 'wz_rad', 'tx_m', 'ty_m', 'tz_m']
            names = ([f'{c}.{p}' for c in ('left', 'right', 'third') for p in intrinsics] +
                     [f'{c}.{p}' for c in ('right', 'third') for p in poses])
            rig['parameter_names'] = names
            rig['parameters'] = [values[n.replace('third', 'right')] for n in names]
            n = len(names)
            rig['covariance']['matrix'] = [[1e-6 * (i == j) for j in range(n)] for i in range(n)]
        self.complains(*self.arguments(change=third), '-q',
                       of='the rig has 3 cameras instead of 2')

    def test_outputs_never_replace_inputs(self):
        self.pairs()
        left = self.folder / 'left1.pgm'
        before = left.read_bytes()
        linked = self.folder / 'linked.png'
        linked.hardlink_to(left)
        self.complains(*self.arguments(), '-q', '--picture', linked, of='is an input')
        self.complains(*self.arguments(), '-q', '--picture', left, of='.png')
        self.assertEqual(left.read_bytes(), before)

    def test_options_that_make_no_sense(self):
        self.pairs()
        for option in (('-n', '0'), ('--nearest-m', '-1'), ('--nearest-m', 'nan'), ('--cells', 'x')):
            self.assertEqual(cli_test.vernier(*self.arguments(), *option).returncode, 2)


if __name__ == '__main__':
    cli_test.PROGRAM = sys.argv.pop(1)
    unittest.main()
