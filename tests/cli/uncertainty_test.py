#!/usr/bin/env python3
# SPDX-FileCopyrightText: 2026 The Vernier authors
# SPDX-License-Identifier: Apache-2.0
"""The verb uncertainty from outside.

    uncertainty_test.py PROGRAM [unittest's options]
"""
import csv
import json
import math
import os
import sys
import unittest
import xml.etree.ElementTree

import cli_test


class Uncertainty(cli_test.Case):
    def calibrate(self, *more):
        self.works('calibrate', '--left', cli_test.IMAGES / 'left[0-9]*.jpg', '--right',
                   cli_test.IMAGES / 'right[0-9]*.jpg', '--board', '9x6', '--square-m', '0.025',
                   '-o', self.folder / 'rig.json', '-q', *more)
        return self.folder / 'rig.json'

    def told(self, rig, *more):
        return json.loads(self.works('uncertainty', rig, '--json', '--samples', '200', *more).stdout)

    def test_contract(self):
        json_ = self.told(self.calibrate(), '--distances-m', '1,5,inf', '--grid', '60x45')
        self.assertEqual(json_['distances_m'], [1, 5, 'inf'])
        boards = [p for p in json_['projection'] if p['fixed_to'] == 'boards']
        self.assertEqual([(p['camera'], p['distance_m']) for p in boards],
                         [(c, d) for c in ('left', 'right') for d in (1, 5, 'inf')])
        for part in boards:
            grid = part['grid']
            self.assertEqual((len(grid['sd_px']), len(grid['sd_px'][0])), (45, 60))
            absent = 0
            for sds, covariances in zip(grid['sd_px'], grid['covariance_px2']):
                for sd, C in zip(sds, covariances):
                    if sd is None:
                        absent += 1
                        self.assertIsNone(C)
                        continue
                    half = (C[0][0] - C[1][1]) / 2
                    worst = (C[0][0] + C[1][1]) / 2 + math.hypot(half, C[0][1])
                    self.assertAlmostEqual(sd, math.sqrt(worst), delta=1e-9 * sd)
            self.assertEqual(absent, grid['absent'])
            self.assertLess(part['mean_sd_px'], part['worst_sd_px'])
        self.assertEqual({t['frame'] for t in json_['triangulation']}, {'rig', 'stabilised'})
        self.assertEqual({t['distance_m'] for t in json_['triangulation']}, {1, 5})
        self.assertEqual([v['distance_m'] for v in json_['vertical_disparity']], [1, 5, 'inf'])
        ranges = json_['depth'][0]['ranges']
        for shorter, longer in zip(ranges, ranges[1:]):
            self.assertLess(shorter['sd_linear_m'], longer['sd_linear_m'])

    def test_the_bound_is_smaller_and_seeds_repeat(self):
        rig = self.calibrate()
        honest = self.told(rig, '--grid', '4x3')
        bound = self.told(rig, '--grid', '4x3', '--covariance', 'mvb')
        self.assertEqual((honest['covariance_kind'], bound['covariance_kind']), ('jackknife', 'mvb'))
        for a, b in zip(honest['projection'], bound['projection']):
            self.assertGreater(a['mean_sd_px'], b['mean_sd_px'])
        self.assertEqual(honest, self.told(rig, '--grid', '4x3'))
        self.assertNotEqual(honest, self.told(rig, '--grid', '4x3', '--seed', '2'))
        self.assertAlmostEqual(
            2 * honest['projection'][0]['mean_sd_px'],
            self.told(rig, '--grid', '4x3', '--psi-c', '2')['projection'][0]['mean_sd_px'],
            places=9)

    def test_without_evidence_the_boards_form_is_missing_and_it_says_so(self):
        json_ = self.told(self.calibrate('--no-evidence'), '--grid', '4x3')
        self.assertEqual({p['fixed_to'] for p in json_['projection']}, {'camera', 'first_camera'})
        self.assertEqual({t['frame'] for t in json_['triangulation']}, {'rig'})
        self.assertTrue(any('no board poses' in note for note in json_['notes']))

    def test_files(self):
        folder = self.folder / 'out'
        done = self.works('uncertainty', self.calibrate(), '--grid', '6x5', '--samples', '50', '-o',
                          folder)
        self.assertIn('files written to', done.stdout)
        for name in ('projection_left_1m.svg', 'projection_right_inf.svg',
                     'vertical_disparity_right_5m.svg'):
            root = xml.etree.ElementTree.parse(folder / name).getroot()
            self.assertTrue(root.tag.endswith('svg'))
            self.assertNotIn('href', (folder / name).read_text())
        grid = (folder / 'projection_left_1m.csv').read_text().splitlines()
        self.assertEqual(grid[0], 'u_px,v_px,sd_px,cov_uu_px2,cov_uv_px2,cov_vv_px2')
        self.assertEqual(len(grid), 31)
        for name in ('projection', 'triangulation', 'vertical_disparity', 'depth'):
            lines = (folder / f'{name}.csv').read_text().splitlines()
            self.assertGreater(len(lines), 3)
            self.assertEqual({line.count(',') for line in lines}, {lines[0].count(',')})
        small = json.loads((folder / 'uncertainty.json').read_text())
        self.assertNotIn('covariance_px2', small['projection'][0]['grid'])

    def named(self, left, right):
        """The shipped rig with cameras of these names."""
        rig = json.loads((cli_test.ROOT / 'datasets/rigs/nominal.rig.json').read_text())
        names = {'left': left, 'right': right}
        for camera in rig['cameras']:
            camera['name'] = names[camera['name']]
        rig['parameter_names'] = [names[n.split('.')[0]] + '.' + n.split('.')[1]
                                  for n in rig['parameter_names']]
        for view in rig['evidence']['observations']:
            view['camera'] = names[view['camera']]
        (self.folder / 'rig.json').write_text(json.dumps(rig))
        return self.folder / 'rig.json'

    def test_names_that_files_cannot_have(self):
        names = 'a, "b"', 'a/ /b/'
        self.works('uncertainty', self.named(*names), '--grid', '4x3', '--samples', '50', '-o',
                   self.folder / 'out')
        for part in ('a___b_', 'a___b__2'):
            self.assertTrue((self.folder / f'out/projection_{part}_1m.csv').is_file())
            self.assertTrue((self.folder / f'out/projection_{part}_1m.svg').is_file())
        for name, cameras in (('projection', set(names)), ('triangulation', {names[1]}),
                              ('vertical_disparity', {names[1]}), ('depth', {names[1]})):
            with open(self.folder / f'out/{name}.csv', newline='') as file:
                rows = list(csv.reader(file))
            self.assertEqual({len(row) for row in rows}, {len(rows[0])})
            self.assertEqual({row[0] for row in rows[1:]}, cameras)

    def test_an_image_of_one_column(self):
        rig = json.loads((cli_test.ROOT / 'datasets/rigs/nominal.rig.json').read_text())
        del rig['evidence']
        for camera in rig['cameras']:
            camera['size_px'][0] = 1
        (self.folder / 'thin.json').write_text(json.dumps(rig))
        self.works('uncertainty', self.folder / 'thin.json', '--grid', '2x9', '--samples', '50',
                   '-o', self.folder / 'out', timeout=60)
        text = (self.folder / 'out/projection_left_any_camera.svg').read_text()
        self.assertNotIn('nan', text)
        self.assertEqual(text.count('v5"'), 1)  # one tick along u

    def test_one_camera_has_no_pair(self):
        rig = json.loads(self.calibrate('--no-evidence').read_text())
        rig['cameras'] = rig['cameras'][:1]
        rig['parameter_names'], rig['parameters'] = rig['parameter_names'][:5], rig['parameters'][:5]
        rig['covariance']['matrix'] = [row[:5] for row in rig['covariance']['matrix'][:5]]
        del rig['covariance_mvb']
        (self.folder / 'one.json').write_text(json.dumps(rig))
        json_ = self.told(self.folder / 'one.json', '--grid', '4x3')
        self.assertEqual(json_['triangulation'], [])
        self.assertTrue(any('need two cameras' in note for note in json_['notes']))
        self.complains('uncertainty', self.folder / 'one.json', '--covariance', 'mvb',
                       of='no minimum variance bound')

    def test_bad_input(self):
        for words, of in (
                (('--distances-m', '0,1'), 'not a list of positive distances'),
                (('--distances-m', '1,,2'), 'not a list of positive distances'),
                (('--distances-m', 'nan'), 'not a list of positive distances'),
                (('--grid', '0x0'), 'not two whole numbers'),
                (('--grid', '1x9'), 'smaller than 2x2'),
                (('--covariance', 'best'), '--covariance'),
                (('--samples', '1'), '--samples'),
                (('--psi-c', '-1'), '--psi-c')):
            self.complains('uncertainty', 'nominal', *words, of=of)
        rig = json.loads(self.calibrate('--no-evidence').read_text())
        del rig['covariance']
        (self.folder / 'bare.json').write_text(json.dumps(rig))
        self.complains('uncertainty', self.folder / 'bare.json', of='no covariance')


if __name__ == '__main__':
    cli_test.PROGRAM = os.path.abspath(sys.argv.pop(1))
    unittest.main()
