#!/usr/bin/env python3
# SPDX-FileCopyrightText: 2026 The Vernier authors
# SPDX-License-Identifier: Apache-2.0
"""The verbs diff and advise from outside.

    compare_test.py PROGRAM [unittest's options]
"""
import json
import math
import sys
import unittest

sys.dont_write_bytecode = True
import cli_test
from cli_test import Case


class Rigs(Case):
    """The shipped rig with changes, as a file."""

    def rig(self, name='rig.json', change=lambda rig: None):
        rig = json.loads((cli_test.ROOT / 'datasets/rigs/nominal.rig.json').read_text())
        change(rig)
        (self.folder / name).write_text(json.dumps(rig))
        return self.folder / name

    @staticmethod
    def right_row(shift_px):
        def change(rig):
            rig['cameras'][1]['parameters']['oy_px'] += shift_px
            rig['parameters'][rig['parameter_names'].index('right.oy_px')] += shift_px
            del rig['evidence']
        return change


class Diff(Rigs):
    def test_a_rig_and_itself(self):
        done = self.works('diff', 'nominal', self.rig(), '--json')
        found = json.loads(done.stdout)
        self.assertLess(found['mahalanobis'], 1e-9)
        self.assertEqual((found['p_value'], found['dof']), (1, 16))
        self.assertLess(found['projection']['after']['max_px'], 1e-9)
        self.assertEqual(found['shared_views'], 40)
        self.assertIn('40 of the 40 images', done.stderr)
        self.assertEqual(found['warnings'][0], done.stderr.strip().removeprefix('warning: '))

    def test_a_moved_rig_differs_beyond_its_uncertainties_and_that_is_a_result(self):
        b = self.rig('b.json', self.right_row(4))
        done = self.works('diff', 'nominal', b, '--grid', '8x6', '--distances-m', '2,inf', '--json')
        found = json.loads(done.stdout)
        self.assertLess(found['p_value'], 1e-6)
        self.assertIn('differ beyond their uncertainties (p = ', found['verdict'])
        self.assertAlmostEqual(found['mahalanobis'] ** 2, found['mahalanobis_squared'], places=6)
        row = next(p for p in found['parameters'] if p['name'] == 'right.oy_px')
        self.assertAlmostEqual(row['difference'], 4, places=9)
        self.assertAlmostEqual(row['in_sigma'], 4 / row['sigma'], places=9)
        self.assertIn('of this direction is', found['directions'][0]['words'])
        left, right = found['projection']['cameras']
        self.assertEqual((left['name'], right['name']), ('left', 'right'))
        self.assertEqual(len(left['pixels_px']), 48)
        self.assertEqual([d['distance_m'] for d in right['distances']], [2, 'inf'])
        for vector in right['distances'][0]['before_px']:
            self.assertAlmostEqual(vector[1], 4, places=6)
        for distance in right['distances']:
            self.assertEqual(len(distance['after_px']), 48)
            self.assertEqual(len(distance['expected_px']), 48)
            self.assertLess(distance['after']['rms_px'], distance['before']['rms_px'])
            self.assertGreater(distance['in_focus']['rms_px'], distance['expected_in_focus_px'])
        self.assertEqual(len(found['alignment']['rotation_deg']), 3)
        self.assertEqual(len(found['alignment']['translation_m']), 3)
        text = self.works('diff', 'nominal', b).stdout
        self.assertIn('the rigs differ beyond their uncertainties', text)
        self.assertIn('Mahalanobis distance', text)

    def test_a_small_difference_lies_within(self):
        b = self.rig('b.json', self.right_row(0.01))
        found = json.loads(self.works('diff', 'nominal', b, '--json').stdout)
        self.assertGreater(found['p_value'], 0.99)
        self.assertIn('agree within', found['verdict'])

    def test_without_covariance_the_projections_alone(self):
        def bare(rig):
            for key in ('covariance', 'covariance_mvb', 'evidence', 'calibration'):
                del rig[key]
        done = self.works('diff', 'nominal', self.rig('bare.json', bare), '--json')
        found = json.loads(done.stdout)
        self.assertNotIn('p_value', found)
        self.assertNotIn('expected_rms_px', found['projection'])
        self.assertIn('no honest covariance: only projections are compared', done.stderr)
        self.assertIn('unknown', self.works('diff', 'nominal', self.folder / 'bare.json').stdout)

    def test_bad_input(self):
        def size(rig):
            rig['cameras'][0]['size_px'] = [1280, 960]
            del rig['evidence']

        def name(rig):
            rig['cameras'][1]['name'] = 'top'
            for key in ('parameter_names', 'parameters', 'covariance', 'covariance_mvb',
                        'evidence'):
                del rig[key]

        def single(rig):
            rig['cameras'].pop()
            for key in ('parameter_names', 'parameters', 'covariance', 'covariance_mvb',
                        'evidence'):
                del rig[key]
        self.complains('diff', 'nominal', self.rig('size.json', size),
                       of='images of 1280x960 and that of the first rig 640x480; calibrate both')
        self.complains('diff', 'nominal', self.rig('name.json', name),
                       of='is "top" and that of the first rig "right"')
        self.complains('diff', 'nominal', self.rig('single.json', single),
                       of='it has 1 camera and the first rig 2')
        self.complains('diff', 'nominal', of='b is required')
        self.complains('diff', 'nominal', self.folder / 'none.json', of='none.json')
        for text in ('1,,2', '1,', '0', '-3', 'nan', '1;2', 'far'):
            self.complains('diff', 'nominal', 'nominal', '--distances-m=' + text,
                           of='is not a list of positive distances')
        self.complains('diff', 'nominal', 'nominal', '--grid', '20', of='--grid')
        for grid in ('1x1', '1x9', '9x1'):
            self.complains('diff', 'nominal', 'nominal', '--grid', grid,
                           of=f'--grid: "{grid}" is smaller than 2x2; use a grid such as 20x15')
        self.complains('diff', 'nominal', 'nominal', '--grid', '3x3', '--focus', '0.5',
                       of='fewer than 6 pixels of the focus')
        self.complains('diff', 'nominal', 'nominal', '--focus', '0', of='--focus')
        self.complains('diff', 'nominal', 'nominal', '--covariance', 'best', of='--covariance')


class Advise(Rigs):
    def test_three_views_each_given_those_before(self):
        found = json.loads(self.works('advise', 'nominal', '--views', '3', '--json').stdout)
        self.assertEqual(len(found['views']), 3)
        self.assertEqual(found['unit'], 'm')
        sd = found['sd_now']
        for view in found['views']:
            self.assertAlmostEqual(view['sd_before'], sd, places=12)
            self.assertLess(view['sd_after'], sd)
            self.assertAlmostEqual(view['reduction'], 1 - view['sd_after'] / sd, places=9)
            sd = view['sd_after']
            self.assertRegex(view['words'], r'^hold the board \d\.\d\d m away, its centre in the ')
            self.assertEqual((len(view['rotation_rad']), len(view['translation_m'])), (3, 3))
            self.assertGreater(view['translation_m'][2], 0)
        self.assertEqual([len(found['alternatives']), len(found['sd_after_more'])], [5, 10])
        self.assertAlmostEqual(found['sd_after_more'][2], sd, places=12)
        self.assertGreater(found['least_helpful']['sd_after'], found['views'][0]['sd_after'])

    def test_words(self):
        text = self.works('advise', 'nominal').stdout
        self.assertIn('1. hold the board', text)
        self.assertIn('sd of the depth at 5 m: ', text)
        self.assertIn('sd after 10 such views, chosen greedily: ', text)
        self.assertIn('based on the covariance of kind mvb and independent corner noise', text)

    def test_what_is_reduced(self):
        for what, unit in (('projection', 'px'), ('rectification', 'px'), ('baseline', 'm'),
                           ('right.wy_rad', 'rad'), ('left.k1', '')):
            found = json.loads(self.works('advise', 'nominal', '--reduce', what, '--json').stdout)
            self.assertEqual(found['unit'], unit)
            self.assertLess(found['views'][0]['sd_after'], found['sd_now'])

    def test_an_honest_covariance_scales_the_bounds_prediction(self):
        def wider(rig):
            rig['covariance'] = {'kind': 'jackknife',
                                 'matrix': [[9 * x for x in row]
                                            for row in rig['covariance_mvb']['matrix']]}
        bound = json.loads(self.works('advise', 'nominal', '--json').stdout)
        wide = self.rig('wide.json', wider)
        for more in ((), ('--covariance', 'honest')):
            found = json.loads(self.works('advise', wide, '--json', *more).stdout)
            self.assertTrue(math.isclose(found['honest_over_bound'], 3, rel_tol=1e-9))
            for key in ('sd_before', 'sd_after'):
                self.assertTrue(math.isclose(found['views'][0][key], 3 * bound['views'][0][key],
                                             rel_tol=1e-6))
        text = self.works('advise', wide).stdout
        self.assertIn('standard deviations scaled by 3 to match kind jackknife', text)

    def test_without_evidence_the_board_is_asked_for(self):
        def bare(rig):
            del rig['evidence'], rig['calibration']
        bare = self.rig('bare.json', bare)
        self.complains('advise', bare, of='the file contains no corner noise; give --pixel-sigma')
        self.complains('advise', bare, '--pixel-sigma', '0.2', of='the board is unknown')
        board = ('--board', '9x6', '--square-m', '0.04', '--pixel-sigma', '0.2')
        found = json.loads(self.works('advise', bare, *board, '--json').stdout)
        self.assertEqual(found['board'], '9x6 corners, squares of 0.04 m')

    def test_bad_input(self):
        def bare(rig):
            for key in ('covariance', 'covariance_mvb'):
                del rig[key]
        self.complains('advise', self.rig('bare.json', bare), of='the rig has no covariance')
        self.complains('advise', 'nominal', '--reduce', 'sharpness',
                       of='supported: depth, projection, rectification, baseline or a parameter')
        self.complains('advise', 'nominal', '--board', '9x6',
                       of='--board and --square-m must be given together')
        self.complains('advise', 'nominal', '--board', '9x1', '--square-m', '0.04',
                       of='its corners are collinear')
        self.complains('advise', 'nominal', '--views', '0', of='--views')
        for at in ('0', '-1', 'nan', 'inf'):
            self.complains('advise', 'nominal', '--at-m', at, of='')
        self.complains('advise', of='rig is required')


if __name__ == '__main__':
    cli_test.PROGRAM = sys.argv.pop(1)
    unittest.main()
