#!/usr/bin/env python3
# SPDX-FileCopyrightText: 2026 The Vernier authors
# SPDX-License-Identifier: Apache-2.0
"""Studies of other systems than localisers: the examples of docs/systems.md, and what is refused.

    systems_test.py PROGRAM [unittest's options]
"""
import csv
import json
import os
import pathlib
import re
import shutil
import subprocess
import sys
import tempfile
import unittest

PROGRAM = None
ROOT = pathlib.Path(__file__).resolve().parents[2]
EXAMPLES = dict(re.findall(r'^```toml systems (\w+)\n(.*?)^```',
                           (ROOT / 'docs/systems.md').read_text(), re.M | re.S))
MPIRUN = ['mpirun', '--quiet', '--oversubscribe', '--bind-to', 'none', '-n', '2']
RANKS = dict(os.environ, OMPI_ALLOW_RUN_AS_ROOT='1', OMPI_ALLOW_RUN_AS_ROOT_CONFIRM='1')
COUNTS = {'cell', 'label', 'trials', 'blocks', 'success', 'coverage', 'failed'}


def shorter(example, trials):
    return re.sub(r'^trials = \d+', f'trials = {trials}', EXAMPLES[example], flags=re.M)


class Systems(unittest.TestCase):
    def setUp(self):
        self.temporary = tempfile.TemporaryDirectory()
        self.folder = pathlib.Path(self.temporary.name)
        shutil.copy(ROOT / 'docs/examples/own_system.py', self.folder)

    def tearDown(self):
        self.temporary.cleanup()

    def call(self, *words, before=(), env=None):
        return subprocess.run([*before, PROGRAM, *words], capture_output=True, text=True, env=env,
                              cwd=self.folder)

    def run_study(self, text, output='results', code=0, **more):
        (self.folder / 'study.toml').write_text(text)
        done = self.call('study', 'study.toml', '-o', output, '-q', **more)
        self.assertEqual(done.returncode, code, done.stderr)
        return done

    def cells(self, folder='results'):
        done = self.call('study', 'status', folder, '--json')
        self.assertIn(done.returncode, (0, 3), done.stderr)
        return json.loads(done.stdout)

    def rows(self, *options, folder='results'):
        done = self.call('export', folder, *options, '-o', 'table.csv')
        self.assertIn(done.returncode, (0, 3), done.stderr)
        with open(self.folder / 'table.csv', encoding='utf-8', newline='') as file:
            return list(csv.DictReader(file))

    def refused(self, text, *parts):
        done = self.run_study(text, code=2)
        self.assertEqual(len(done.stderr.splitlines()), 1, done.stderr)
        for part in parts:
            self.assertIn(part, done.stderr)
        self.assertFalse((self.folder / 'results').exists())

    def refused_in_place(self, text, part):
        """As `refused`, of a folder that stands."""
        done = self.run_study(text, code=2)
        self.assertEqual(len(done.stderr.splitlines()), 1, done.stderr)
        self.assertIn(part, done.stderr)

    def has_embree(self):
        doctor = json.loads(self.call('doctor', '--json').stdout)['findings']
        return {one['what']: one['found'] for one in doctor}['Embree']

    def check_example(self, name, trials, error, measured):
        done = self.run_study(shorter(name, trials))
        for line in done.stdout.splitlines():
            self.assertLessEqual(len(line), 80)
        self.assertNotIn('localis', done.stdout)
        study = self.cells()
        self.assertEqual(study['system']['error'], error)
        for cell in study['cells']:
            self.assertEqual(cell['trials'], trials)
            self.assertEqual(list(cell['measured']), measured)
            self.assertNotIn('median_error_m', cell)
            self.assertNotIn('world_ceiling', cell)
        cells, each = self.rows(), self.rows('--trials')
        self.assertLessEqual(COUNTS | {f'median_{error}', f'p95_{error}'}, set(cells[0]))
        for quantity in measured:
            self.assertLessEqual({f'{of}_{quantity}' for of in ('mean', 'rms', 'median')}, set(cells[0]))
        self.assertEqual(len(each), trials * len(cells))
        self.assertLessEqual({error, *measured, 'cpu_ms', 'status', 'success'}, set(each[0]))
        for cell in cells:  # the tables agree
            own = [row for row in each if row['cell'] == cell['cell']]
            right = sum(row['success'] == 'true' for row in own) / trials
            self.assertAlmostEqual(float(cell['success']), right)
        return study['cells']

    def test_calibrations(self):
        cells = self.check_example('calibrations', 18, 'depth_error_m', [
            'signed_depth_error_m', 'stated_depth_sd_m', 'error_over_sd'])
        self.assertGreater(cells[0]['median_error'], cells[2]['median_error'])
        self.assertNotIn('study.protocol', cells[0]['settings'])

    def test_servoing(self):
        self.check_example('servoing', 6, 'position_error_m', [
            'along_m', 'across_m', 'image_error_px', 'frames', 'contacts', 'retreats', 'time_s'])

    def test_matchers(self):
        if not self.has_embree():
            self.skipTest('built without Embree')
        text = EXAMPLES['matchers'].replace('[world]', 'samples = 1\n\n[world]', 1)
        self.addCleanup(EXAMPLES.__setitem__, 'matchers', EXAMPLES['matchers'])
        EXAMPLES['matchers'] = text
        self.check_example('matchers', 2, 'share_not_right', [
            'edges', 'density', 'bad_1', 'mismatch', 'rms_inlier_px', 'bias_inlier_px', 'z_rms',
            'depth_error', 'row_error_px'])

    def test_program(self):
        cells = self.check_example('program', 40, 'error', ['off_m'])
        # The depth error of a pair grows as the square of the range, and with the scale of its cause.
        by = {(cell['settings']['parameters.range_m'], cell['settings']['sources.calibration']):
              cell['measured']['off_m']['rms'] for cell in cells}
        self.assertAlmostEqual(by[4, 1] / by[2, 1] / 4, 1, delta=0.25)
        self.assertAlmostEqual(by[2, 3] / by[2, 1] / 3, 1, delta=0.1)

    def test_ranks_and_threads_give_the_same_results(self):
        if not shutil.which('mpirun'):
            self.skipTest('no mpirun; install openmpi-bin')
        timeless = lambda rows: [{key: value for key, value in row.items() if not key.endswith('_ms')}
                                 for row in rows]
        for example in ('calibrations', 'program'):
            with self.subTest(example):
                self.run_study(shorter(example, 12), f'{example}-one')
                self.run_study(shorter(example, 12), f'{example}-two', before=MPIRUN, env=RANKS)
                one, two = (timeless(self.rows('--trials', folder=f'{example}-{of}'))
                            for of in ('one', 'two'))
                self.assertEqual(one, two)

    def test_report(self):
        self.run_study(shorter('calibrations', 6))
        done = self.call('report', 'results', '-o', 'page.html', '--no-proof', '--figures', 'figures')
        self.assertEqual(done.returncode, 0, done.stderr)
        page = (self.folder / 'page.html').read_text()
        self.assertTrue('"title":"Study of a calibration"' in page)
        self.assertTrue('median depth error, m' in (self.folder / 'figures/median_error.svg').read_text())

    def test_a_program_that_fails(self):
        program = EXAMPLES['program'].replace('own_system.py', 'missing.py')
        self.refused(program, 'study.toml:6', 'the program "python3 missing.py" failed in the first 3 trials')
        (self.folder / 'sometimes.py').write_text(
            'import json, sys\n'
            'json.loads(sys.stdin.readline())\n'
            'print(json.dumps({"ready": True}), flush=True)\n'
            'for line in sys.stdin:\n'
            '    asked = json.loads(line)\n'
            '    error = "far" if asked["trial"] == 7 else 0\n'
            '    print(json.dumps({"question": asked["question"], "error": error}), flush=True)\n')
        text = shorter('program', 30).replace('own_system.py', 'sometimes.py')
        done = self.run_study(text, code=3)
        self.assertIn('a program failed in 1 of 30 trials', done.stderr)
        self.assertIn('first by:', done.stderr)
        for words in (('report', 'results', '--no-proof', '-o', 'report.html'),
                      ('export', 'results', '-o', 'table.csv', '--json')):
            shown = self.call(*words)
            self.assertEqual(shown.returncode, 0, shown.stderr)
            self.assertIn('warning: a program failed in 1 of 30 trials', shown.stderr)
        self.assertIn('failed in 1 of 30 trials', json.loads(shown.stdout)['warnings'][0])
        page = (self.folder / 'report.html').read_text()
        self.assertRegex(page, r'"doubts": ?\["a program failed in 1 of 30 trials')

    def test_a_matchers_program_that_fails_ends_the_study(self):
        if not self.has_embree():
            self.skipTest('built without Embree')
        (self.folder / 'fails.sh').write_text('echo asked >>asked\necho no memory >&2\nexit 3\n')
        matcher = EXAMPLES['matchers'].replace('["edge", "bm", "sgbm"]', '["program"]')
        for command, why in (('no-such-program', "program 'no-such-program' not found"),
                             ('sh fails.sh', 'exited with status 3: no memory')):
            text = matcher.replace('[world]', f'command = "{command} {{left}} {{right}} {{output}}"\n\n'
                                              '[world]')
            self.refused(text, 'study.toml:9: the program failed in the first 3 trials', why)
        self.assertEqual((self.folder / 'asked').read_text().split(), 3 * ['asked'])
        self.refused(text.replace('{output}', '{output} {most_px}'), 'study.toml:9: ',
                     'unknown placeholder "{most_px}"; use {left}')

    def test_every_program_of_a_study_is_tried(self):
        text = EXAMPLES['program'].replace('command = "python3 own_system.py"\n', '').replace(
            '[sweep]\n', '[sweep]\n"system.command" = ["python3 own_system.py", "false"]\n')
        self.refused(text.replace('measured', 'command = "python3 own_system.py"\nmeasured', 1),
                     'study.toml', '"false"')

    def test_another_limit_is_asked_of_what_is_stored(self):
        first = shorter('calibrations', 12)
        self.run_study(first)
        before = self.cells()
        strict = first.replace('success_error = 0.05', 'success_error = 0.01')
        self.run_study(strict)
        after = self.cells()
        for one, other in zip(before['cells'], after['cells']):
            self.assertEqual(one['median_error'], other['median_error'])
            self.assertEqual(other['success_error'], 0.01)
        errors = [float(row['depth_error_m']) for row in self.rows('--trials')]
        self.assertAlmostEqual(sum(cell['success'] * 12 for cell in after['cells']),
                               sum(error <= 0.01 for error in errors))
        self.assertEqual(after['blocks_done'], after['blocks_total'])
        self.run_study(first, output='other')
        done = self.call('study', 'merge', 'results', 'other', '-o', 'merged')
        self.assertEqual(done.returncode, 2)
        self.assertIn('system.success_error is', done.stderr)

    def test_how_near_a_localiser_is(self):
        near_by = shorter('localiser', 12) + '[map]\nspacing_m = 2\n'
        done = self.run_study(near_by)
        self.assertIn('success: answered, within system.success_error', done.stdout)
        cells = self.cells()['cells']
        self.assertEqual([cell['success_error'] for cell in cells], 3 * [0.05] + 3 * [0.2] + 3 * [1])
        rates = [cell['success'] for cell in cells]
        for near, far in zip(rates[:6], rates[3:]):
            self.assertLessEqual(near, far)
        rows = self.rows('--trials')
        right = sum(row['success'] == 'true' for row in rows)
        self.assertEqual(right, round(12 * sum(rates)))
        self.assertEqual(self.cells()['blocks_total'] * 3, len({(row['cell'], row['block']) for row in rows}))
        one = near_by.replace('"system.success_error" = [0.05, 0.2, 1]\n', '').replace(
            '"localiser"\n', '"localiser"\nsuccess_error = 0.2\n')
        self.assertIn('within 0.2 m', self.run_study(one, output='one').stdout)
        page = self.call('report', 'one', '-o', 'one.html')
        self.assertEqual(page.returncode, 0, page.stderr)
        self.refused_in_place(one.replace('0.2', '1.5'), 'study.toml:6: system.success_error is above 1 m')

    def test_an_edited_program_begins_anew(self):
        self.run_study(shorter('program', 6))
        with open(self.folder / 'own_system.py', 'a', encoding='utf-8') as file:
            file.write('# edited\n')
        done = self.call('study', 'status', 'results')
        self.assertIn('were others when the study ran', done.stderr)
        again = self.call('study', 'study.toml', '-o', 'results')
        self.assertEqual(again.returncode, 0, again.stderr)
        self.assertIn('of 36', again.stderr)

    def test_what_has_no_effect_is_refused(self):
        calibrations = EXAMPLES['calibrations']
        self.refused(calibrations + '[map]\nspacing_m = 1\n', '[map] has no effect on a calibration')
        self.refused(calibrations.replace('[study]', '[study]\nprotocol = "path"'),
                     'study.toml:2', 'study.protocol has no effect')
        self.refused(calibrations.replace('range_m', 'range'), "did you mean 'range_m'")
        self.refused(calibrations.replace('"calibration"', '"calibrator"'), 'unknown system')
        matchers = EXAMPLES['matchers']
        self.refused(matchers.replace('success_error = 0.2', 'success_error = 1'),
                     'study.toml:7: system.success_error is not below 1')
        self.refused(matchers.replace('success_error', 'range_m'),
                     "unknown key 'range_m' in [system]; use 'name', 'success_error', 'matcher', ")
        self.refused(EXAMPLES['program'].replace('success_error = 0.05\n', ''), 'success_error')
        self.refused(EXAMPLES['program'].replace('python3 own_system.py', 'no-such-program'),
                     'study.toml:6', 'no-such-program')
        self.refused(EXAMPLES['servoing'].replace('"model"', '"model"\ndoor = "portcullis"'),
                     'study.toml', 'portcullis')

    def test_doubted_calibrations_say_why(self):
        text = shorter('calibrations', 12).replace('[5, 10, 20]', '[3]').replace('0.2', '3')
        done = self.run_study(text, code=3)
        self.assertRegex(done.stderr, 'a calibration (is doubtful|failed) in .* the first by: ')
        self.assertTrue(any(row['reason'] for row in self.rows('--trials')))

    def test_races(self):
        tune = '[tune]\nconfirm_worlds = ["hall"]\n'
        for name, text in (('calibration', EXAMPLES['calibrations']), ('program', EXAMPLES['program'])):
            (self.folder / 'study.toml').write_text(text + tune)
            done = self.call('tune', 'study.toml', '-o', 'search', '-q')
            self.assertEqual(done.returncode, 2, done.stderr)
            self.assertIn(f'a {name} has none', done.stderr)


if __name__ == '__main__':
    PROGRAM = os.path.abspath(sys.argv.pop(1))
    unittest.main()
