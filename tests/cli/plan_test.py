#!/usr/bin/env python3
# SPDX-FileCopyrightText: 2026 The Vernier authors
# SPDX-License-Identifier: Apache-2.0
"""The verb plan, and studies of a told rig, from outside.

    plan_test.py PROGRAM [unittest's options]
"""
import json
import pathlib
import re
import statistics
import subprocess
import sys
import tempfile
import unittest

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent))
sys.dont_write_bytecode = True
import cli_test

PROGRAM = None
ROOT = pathlib.Path(__file__).resolve().parents[2]
DATASHEET = ROOT / 'docs/examples/datasheet.json'

# A system whose error is that of the baseline's first coordinate.
ANSWERS = '''import json, sys
for line in sys.stdin:
    asked = json.loads(line)
    answer = {"ready": True}
    if "trial" in asked:
        x = [asked[of][1]["from_first"]["translation_m"][0]
             for of in ("told_cameras", "true_cameras")]
        answer = {"question": asked["question"], "error": abs(x[0] - x[1])}
    print(json.dumps(answer), flush=True)
'''


class Base(unittest.TestCase):
    def setUp(self):
        keeper = tempfile.TemporaryDirectory()
        self.addCleanup(keeper.cleanup)
        self.folder = pathlib.Path(keeper.name)

    def call(self, *words):
        return subprocess.run([PROGRAM, *map(str, words)], capture_output=True, text=True,
                              cwd=self.folder, timeout=300)

    def json(self, *words, code=0):
        """Of either exit code if `code` is None: whether so few trials suffice is not the question."""
        done = self.call(*words, '--json', '-q')
        self.assertIn(done.returncode, (0, 3) if code is None else (code,), done.stderr)
        return json.loads(done.stdout)

    def refused(self, *words, about):
        done = self.call(*words)
        self.assertEqual(done.returncode, 2, done.stdout)
        self.assertEqual(done.stderr.count('\n'), 1, done.stderr)
        self.assertIn(about, done.stderr)


class Plan(Base):
    def test_calibration_so_far(self):
        now = self.json('plan', 'nominal', '--depth-error', '0.01@5m')
        self.assertEqual(now['from'], 'calibration')
        self.assertEqual(now['views_so_far'], 20)
        self.assertTrue(now['reachable'])
        low, high = now['views_interval']
        self.assertLessEqual(low, now['views'])
        self.assertLessEqual(now['views'], high)
        self.assertLessEqual(high, 2 * low)
        self.assertGreater(now['confidence'], 0.5)
        sds = [row['sd'] for row in now['curve']]
        self.assertEqual(sds, sorted(sds, reverse=True))
        # As the old names of options; the same numbers at every call.
        self.assertEqual(now, self.json('plan', '--target-depth-sigma-m', '0.01', '--at-m', '5',
                                        '--rig', 'nominal'))

    def test_further_frames_are_seen_by_as_few_cameras(self):
        rows = [row for row in cli_test.board_lines()
                if not row[0].isdigit() or row.split(',')[1] == '0' or int(row.split(',')[0]) % 2]
        (self.folder / 'o.csv').write_text('\n'.join(rows))
        self.json('calibrate', '--observations', 'o.csv', '--size', '640x480', '--no-model-check', '-o', 'rig.json')
        words = ('--depth-error', '0.02@2m')
        self.assertIn('(6 of 12 are seen by all cameras)', self.call('plan', 'rig.json', *words).stdout)
        self.assertNotIn('seen by all', self.call('plan', 'nominal', *words).stdout)
        # sure enough or not (exit code 3): the numbers are given
        plan = json.loads(self.call('plan', 'rig.json', '--depth-error', '0.005@2m', '--json').stdout)
        low, high = plan['views_interval']
        self.assertTrue(low <= plan['views'] <= high)
        self.assertEqual((plan['views_so_far'], plan['views_so_far_by_all']), (12, 6))
        self.assertGreater(plan['views'] - 12, 1.5 * (plan['views_by_all'] - 12))
        self.json('convert', 'rig.json', '--cameras', 'right,left', '-o', 'pair.json')
        self.assertIn('its 12 views are not in this file', self.call('plan', 'pair.json', *words).stderr)

    def test_cameras_are_chosen_by_name(self):
        both = self.json('plan', 'nominal', '--depth-error', '0.005@5m')
        chosen = self.json('plan', 'nominal', '--depth-error', '0.005@5m', '--cameras', 'right,left')
        self.assertIn('for the cameras right,left', chosen['basis'])
        self.assertGreater(both['views'], 1.5 * both['views_so_far'])
        self.assertAlmostEqual(chosen['views'] / both['views'], 1, delta=0.1)
        self.assertAlmostEqual(chosen['curve'][0]['sd'] / both['curve'][0]['sd'], 1, delta=0.01)
        self.refused('plan', 'nominal', '--depth-error', '0.02', '--cameras', 'left', about='name two of them')
        self.refused('plan', 'nominal', '--depth-error', '0.02', '--cameras', 'left,rigth',
                     about='"rigth" is none of the rig\'s cameras')
        advised = self.json('advise', 'nominal', '--reduce', 'depth')
        turned = self.json('advise', 'nominal', '--reduce', 'depth', '--cameras', 'right,left')
        self.assertAlmostEqual(turned['sd_now'] / advised['sd_now'], 1, delta=0.1)
        self.refused('advise', 'nominal', '--reduce', 'baseline', '--cameras', 'right', about='name two of them')

    def test_more_is_needed_for_less(self):
        views = [self.json('plan', 'nominal', '--projection-error', f'{px}@5m')['views']
                 for px in (0.5, 0.3, 0.2)]
        self.assertEqual(views, sorted(views))
        self.assertLess(views[0], views[2])

    def test_datasheet(self):
        sheet = self.json('plan', DATASHEET, '--board', '9x6', '--depth-error', '0.1@5m')
        self.assertEqual((sheet['from'], sheet['views_so_far']), ('datasheet', 0))
        words = ['plan', DATASHEET, '--board', '9x6', '--pixel-sigma', '0.4', '--depth-error', '0.1@5m']
        noisier = self.call(*words, '--json')  # a datasheet alone may say too little: then 3
        views = json.loads(noisier.stdout)
        self.assertGreater(views['views'], sheet['views'])
        low, high = views['views_interval']
        self.assertEqual(noisier.returncode, 3 if high > 4 * low else 0)

    def test_what_calibration_does_not_limit(self):
        done = self.call('plan', 'nominal', '--depth-error', '0.02@5m', '--pair-sigma-px', '0.2')
        self.assertEqual(done.returncode, 3)
        self.assertIn('cannot be reached: pixel noise of 0.2 px alone gives', done.stdout)
        self.assertIn('not trustworthy: no number of views', done.stderr)
        # Included noise leaves less to the calibration.
        free = self.json('plan', 'nominal', '--depth-error', '0.07@5m')
        shared = self.json('plan', 'nominal', '--depth-error', '0.07@5m', '--pair-sigma-px', '0.2')
        self.assertLess(shared['sd_allowed'], free['sd_allowed'])
        far = self.json('plan', 'nominal', '--depth-error', '1e-05@5m', code=3)
        self.assertFalse(far['reachable'])
        self.assertIn('more than 2000 views', far['limit'])

    def test_success(self):
        self.call('world', 'make', '--seed', '5', '--size-m', '10,8,2.5', '-o', 'w.world.toml')
        words = ['plan', 'nominal', '--world', 'w.world.toml', '--trials', '18']
        plan = self.json(*words, '--success', '0.2')
        self.assertLessEqual({0, 0.25, 0.5, 1, 2, 4}, {row['calibration'] for row in plan['success']})
        self.assertEqual(plan['target']['quantity'], 'success')
        # Without any calibration error 60 trials exclude it.
        impossible = self.json(*words[:-1], '60', '--success', '0.9999', '--protocol', 'path', code=3)
        self.assertLess(impossible['success'][0]['success_interval_95'][1], 0.9999)
        self.assertIs(impossible['reachable'], False)
        self.assertIsNone(impossible['views'])
        self.assertIn('without any calibration error success is', impossible['limit'])

    def test_success_within_a_distance(self):
        self.call('world', 'make', '--seed', '5', '--size-m', '10,8,2.5', '-o', 'w.world.toml')
        words = ['plan', DATASHEET, '--board', '9x6', '--success', '0.2', '--trials', '18']
        near = self.json(*words, '--world', 'w.world.toml', '--within-m', '0.03', code=None)
        far = self.json(*words, '--world', 'w.world.toml', code=None)
        self.assertEqual((near['target']['success_error'], far['target']['success_error']), (0.03, 1))
        rates = [{row['calibration']: row['success'] for row in plan['success']} for plan in (near, far)]
        for scale in rates[0].keys() & rates[1].keys():
            self.assertLessEqual(rates[0][scale], rates[1][scale])
        self.assertLess(rates[0][4], rates[0][0])  # the calibration's error now matters
        # A study says the same, and more: of its own seed, sources and localiser.
        (self.folder / 's.toml').write_text(
            '[study]\ntrials = 18\nprotocol = "path"\n[world]\nfile = "w.world.toml"\n'
            '[system]\nname = "localiser"\nsuccess_error = 0.03\n')
        same = self.json(*words[:-2], '--study', 's.toml', code=None)
        self.assertEqual(near, same)

    def test_success_of_any_system(self):
        (self.folder / 'answer.py').write_text(ANSWERS)
        study = ('[study]\ntrials = 3000\n[system]\nname = "program"\nsuccess_error = 3e-4\n'
                 'command = "python3 answer.py"\n')
        (self.folder / 's.toml').write_text(study)
        words = ('plan', DATASHEET, '--board', '9x6', '--success', '0.9', '--study', 's.toml')
        plan = self.json(*words, code=None)
        rates = [row['success'] for row in plan['success']]
        self.assertEqual(rates[0], 1)
        # The draws are normal: 90 % are within 3e-4 m if the standard deviation is 3e-4 / 1.645.
        once = next(row for row in plan['success'] if row['calibration'] == 1)
        sd = 3e-4 / statistics.NormalDist().inv_cdf((1 + once['success']) / 2)
        scale = 3e-4 / statistics.NormalDist().inv_cdf(0.95) / sd
        printed = self.call(*words).stdout
        reference = float(re.search(r'1 times: .* of ([\d.e-]+) m', printed)[1])
        self.assertAlmostEqual(plan['sd_allowed'] / reference, scale, delta=0.06 * scale)
        self.assertIn('success 90.0 %: error at most 0.0003', self.call(*words).stdout)
        # A rig beside it takes the place of the study's, which need not be there.
        (self.folder / 's.toml').write_text(study + '[rig]\nfile = "gone.json"\n')
        self.assertEqual(self.json(*words, code=None)['success'], plan['success'])
        self.refused('plan', '--success', '0.9', '--study', 's.toml', about='gone.json')
        fewer = self.json(*words, '--trials', '60', code=None)
        self.assertNotEqual(fewer['success'], plan['success'])
        # It says how many are enough, give or take what so few tell.
        wanted = int(re.search(r'give more --trials, of the order of (\d+)', self.call(*words, '--trials', '60').stderr)[1])
        self.assertGreater(wanted, 60)
        self.assertNotIn('give more --trials', self.call(*words, '--trials', str(3 * wanted)).stderr)

    def test_more_views_than_are_tried(self):
        (self.folder / 'answer.py').write_text(ANSWERS)
        (self.folder / 's.toml').write_text(
            '[study]\ntrials = 300\n[system]\nname = "program"\nsuccess_error = 1e-5\n'
            'command = "python3 answer.py"\n')
        plan = self.json('plan', 'nominal', '--success', '0.99', '--study', 's.toml', code=3)
        self.assertFalse(plan['reachable'] and plan['views_interval'][1] is not None, plan)

    def test_trials_without_a_result_are_told(self):
        (self.folder / 'answer.py').write_text(ANSWERS.replace(
            'if "trial" in asked:', 'if asked.get("trial") == 7:\n        sys.exit(1)\n    if "trial" in asked:'))
        (self.folder / 's.toml').write_text(
            '[study]\ntrials = 36\n[system]\nname = "program"\nsuccess_error = 1\n'
            'command = "python3 answer.py"\n')
        done = self.call('plan', 'nominal', '--success', '0.5', '--study', 's.toml')
        self.assertRegex(done.stderr, r'plan: \d+ of \d+ trials gave no result, and count as failures')

    def test_studies_that_cannot_be_planned(self):
        for text, about in (
                ('[sweep]\n"sources.calibration" = [1, 2]\n', 's.toml:4: the study has 2 cells'),
                ('[calibration]\nviews = 5\n', 's.toml:3: [calibration] calibrates anew'),
                ('[rig]\ntruth = "nominal"\nfile = "nominal"\n', 's.toml:4: rig.truth tells'),
                ('[system]\nname = "calibration"\n', 's.toml:4: the error of a rig'),
                ('[map]\nspacings_m = 1\n', 's.toml:4: unknown key')):
            (self.folder / 's.toml').write_text('[study]\ntrials = 18\n' + text)
            self.refused('plan', 'nominal', '--success', '0.9', '--study', 's.toml', about=about)
        (self.folder / 's.toml').write_text('[study]\ntrials = 18\n')
        self.refused('plan', 'nominal', '--success', '0.9', '--study', 's.toml', '--within-m', '0.1',
                     about='--within-m: the study says it')
        self.refused('plan', 'nominal', '--depth-error', '1', '--study', 's.toml',
                     about='--study: only valid with --success')
        self.refused('plan', 'nominal', '--success', '0.9', '--study', 'none.toml', about='none.toml')
        self.refused('plan', 'nominal', '--success', '0.9', '--within-m', '2', about='"2" is above 1')
        self.refused('plan', 'nominal', '--success', '90', about='such as 0.95 for 95 %')

    def test_too_few_trials_to_tell(self):
        # At every scale at most 12 of 12 succeed, and the limits hold 0.97: nothing is known.
        self.call('world', 'make', '--seed', '5', '--size-m', '10,8,2.5', '-o', 'w.world.toml')
        words = ['plan', 'nominal', '--world', 'w.world.toml', '--trials', '12']
        successes = [row['success'] for row in self.json(*words, '--success', '0.2')['success']]
        self.assertLess(successes[0], 0.98)
        plan = self.json(*words, '--success', '0.98', code=3)
        if plan['success'][0]['success_interval_95'][1] >= 0.98:
            self.assertIsNone(plan['reachable'])
            self.assertIsNone(plan['views'])
            self.assertIn('not known: ', self.call(*words, '--success', '0.98').stdout)
        self.assertIsNone(plan['pixel_noise_sd_m'])

    def test_at_least_three_views(self):
        plan = self.json('plan', DATASHEET, '--board', '9x6', '--depth-error', '1000@5m')
        self.assertEqual((plan['views'], plan['views_interval']), (3, [3, 3]))

    def test_far_points(self):
        # The depth error grows with the distance squared, however small the disparity.
        sds = []
        for at_m in (5e3, 5e4, 5e5):
            done = self.call('plan', 'nominal', '--board', '9x6', '--depth-error', '1', '--at-m',
                             at_m, '--json', '-q')
            sds.append([row['sd'] for row in json.loads(done.stdout)['curve']
                        if row['views'] == 20][0])
        self.assertAlmostEqual(sds[1] / sds[0], 100, delta=2)
        self.assertAlmostEqual(sds[2] / sds[1], 100, delta=2)

    def test_bad_input(self):
        self.refused('plan', 'nominal', about='no target given')
        self.refused('plan', 'nominal', '--depth-error', '1', '--success', '0.9',
                     about='more than one target')
        self.refused('plan', 'nominal', '--depth-error', '0.02@x', about='--depth-error')
        self.refused('plan', 'nominal', '--depth-error', '0', about='"0" is not such as 0.02')
        self.refused('plan', 'nominal', '--depth-error', '0.05@5km', about='"0.05@5km" is not such')
        self.refused('plan', 'nominal', '--depth-error', 'nan', about='"nan" is not such')
        self.refused('plan', 'nominal', '--depth-error', '1@7m', '--at-m', '3', about='--at-m')
        self.refused('plan', 'nominal', '--depth-error', '1', '--at-m', '1e300', about='1e6 m')
        self.refused('plan', 'nominal', '--depth-error', '1', '--world', 'workshop',
                     about='--world: only valid with --success')
        self.refused('plan', 'nominal', '--depth-error', '1', '--pixel-sigma', '1',
                     about='--pixel-sigma: the calibration')
        self.refused('plan', 'nominal', '--projection-error', '1', '--pair-sigma-px', '1',
                     about='--pair-sigma-px: only valid with --depth-error')
        self.refused('plan', 'none.json', '--depth-error', '1', about='none.json')
        self.refused('plan', DATASHEET, '--board', '9by6', '--depth-error', '1', about='--board')
        self.refused('plan', 'nominal', '--success', '0.5', '--world', 'nowhere', about='nowhere')
        self.refused('plan', 'nominal', '--success', '0.5', '--protocol', 'far', about='far')


STUDY = '''[study]
trials = 12
protocol = "near_path"
[world]
file = "w.world.toml"
[map]
spacing_m = 3
'''


class ToldRigs(Base):
    def setUp(self):
        super().setUp()
        self.call('world', 'make', '--seed', '5', '--size-m', '8,8,2.5', '-o', 'w.world.toml')
        rig = json.loads((ROOT / 'datasets/rigs/nominal.rig.json').read_text())
        del rig['evidence']
        (self.folder / 'told.json').write_text(json.dumps(rig))
        for key in ('covariance', 'covariance_mvb', 'parameters', 'parameter_names', 'calibration'):
            rig.pop(key, None)
        (self.folder / 'bare.json').write_text(json.dumps(rig))

    def study(self, text, code=0, name='out'):
        (self.folder / 's.toml').write_text(STUDY + text)
        return self.json('study', 's.toml', '-o', name, code=code)

    @staticmethod
    def untimed(result):
        return [{k: v for k, v in cell.items() if '_ms_' not in k} for cell in result['cells']]

    def test_folder_holds_all_inputs_and_can_be_moved(self):
        text = '[rig]\ntruth = "nominal"\n[sweep]\n"rig.file" = ["told.json", "nominal"]\n'
        ran = self.study(text)
        self.assertEqual(len(ran['cells']), 2)
        self.assertEqual([rig['file'] for rig in ran['rig']['told']], ['told.json', 'nominal'])
        self.assertLessEqual({'rig.json', 'told.json', 'told-2.json', 'study.toml'},
                             {path.name for path in (self.folder / 'out').iterdir()})
        for name in ('told.json', 'w.world.toml', 's.toml'):
            (self.folder / name).unlink()
        (self.folder / 'out').rename(self.folder / 'moved')
        again = self.json('study', 'status', 'moved')
        self.assertEqual(self.untimed(ran), self.untimed(again))

    def test_swept_worlds(self):
        self.call('world', 'make', '--seed', '6', '--size-m', '8,8,2.5', '-o', 'v.world.toml')
        ran = self.study('[sweep]\n"world.file" = ["w.world.toml", "v.world.toml"]\n')
        self.assertEqual([cell['settings']['world.file'] for cell in ran['cells']],
                         ['w.world.toml', 'v.world.toml'])
        self.assertEqual(ran['comparisons'], [])  # other queries
        self.assertTrue((self.folder / 'out/world-2.world.toml').is_file())

    def test_real_views_by_subsets(self):
        nominal = json.loads((ROOT / 'datasets/rigs/nominal.rig.json').read_text())
        (self.folder / 'all.json').write_text(json.dumps(nominal))
        ran = self.study('[rig]\nfile = "all.json"\n[calibration]\nobservations = "all.json"\n'
                         '[sweep]\n"calibration.views" = [4, 20]\n', code=3)
        self.assertIn('calibrations from 20 of the same 20 frames share most of them: their error',
                      ran['doubts'][0])
        self.assertIn('about 0.00 times that of fresh views', ran['doubts'][0])
        few, whole = (cell['calibration'] for cell in ran['cells'])
        self.assertEqual(whole['calibrations'], 100)
        self.assertGreater(few['depth_error_m'], 10 * whole['depth_error_m'])  # all views: the truth
        self.assertTrue((self.folder / 'out/corners.json').is_file())

    def test_bad_input(self):
        def refused(text, about):
            (self.folder / 's.toml').write_text(STUDY + text)
            self.refused('study', 's.toml', '-o', 'bad', '-q', about=about)
            self.assertFalse((self.folder / 'bad').exists())
        refused('[sweep]\n"rig.file" = ["nominal", "told.json"]\n', 'name the true rig as rig.truth')
        refused('[rig]\ntruth = "nominal"\nfile = "none.json"\n', 'none.json')
        refused('[rig]\ntruth = "nominal"\nfile = "bare.json"\n', 'bare.json')
        refused('[sweep]\n"calibration.views" = [2, 5]\n', 'calibration.views = 2 is out of range')
        refused('[calibration]\nobservations = "none.json"\n', 'none.json')
        refused('[calibration]\nobservations = "told.json"\n', 'has no board views')
        refused('[calibration]\nobservations = "bare.json"\n', 'has no board views')
        refused('[sweep]\n"world.file" = ["w.world.toml", "none.world.toml"]\n', 'none.world.toml')


if __name__ == '__main__':
    PROGRAM = str(pathlib.Path(sys.argv.pop(1)).resolve())
    unittest.main()
