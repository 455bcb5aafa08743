# SPDX-FileCopyrightText: 2026 The Vernier authors
# SPDX-License-Identifier: Apache-2.0
"""vernier servo as a user calls it: trials of visual servoing, the same on any number of threads.

    servo_test.py PROGRAM [unittest's options]
"""
import csv
import json
import pathlib
import sys
import unittest

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent))
sys.dont_write_bytecode = True
import verb_calls

PROGRAM = pathlib.Path(sys.argv[1]).resolve()


class Servo(verb_calls.ProgramCase):
    program = PROGRAM
    first_words = ('servo',)

    def trials(self, *words):
        run = self.run_program(*words, '--json', '-o', 'trials.csv')
        self.assertEqual(run.returncode, 0, run.stderr)
        rows = list(csv.DictReader((self.folder / 'trials.csv').read_text().splitlines()))
        return json.loads(run.stdout), rows

    def refused(self, *words):
        run = self.run_program(*words, '-o', 'no.csv')
        self.assertEqual(run.returncode, 2, run.stdout + run.stderr)
        self.assertEqual(run.stderr.count('\n'), 1, run.stderr)
        self.assertFalse((self.folder / 'no.csv').exists())
        return run.stderr

    def test_without_errors_it_arrives(self):
        for goal in ('taught', 'recorded', 'model'):
            told, rows = self.trials('--goal', goal, '--trials', 6, '--source', 'none', '--robot', 'exact')
            # In one of these trials furniture hides the door from the start.
            self.assertGreaterEqual(told['converged'], 5)
            near = [float(row['position_error_m']) < 0.025 for row in rows]
            self.assertGreaterEqual(sum(near), 5)
            self.assertLess(told['position_error_mm']['median'], 10)

    def test_trials_do_not_depend_on_threads_nor_on_those_before(self):
        _, one = self.trials('--trials', 4, '--threads', 1)
        _, two = self.trials('--trials', 4, '--threads', 2)
        _, last = self.trials('--trials', 2, '--trial', 2)
        self.assertEqual(one, two)
        self.assertEqual(one[2:], last)

    def test_a_wrong_rig_matters_for_the_model_and_not_for_what_was_taught(self):
        wrong = ('--trials', 12, '--source', 'none', '--source', 'calibration=10', '--robot', 'exact')
        model, _ = self.trials('--goal', 'model', *wrong)
        taught, _ = self.trials('--goal', 'taught', *wrong)
        self.assertGreaterEqual(min(model['converged'], taught['converged']), 8)
        self.assertGreater(model['position_error_mm']['median'],
                           3 * taught['position_error_mm']['median'])

    def test_counts_add_up_and_the_plan_is_drawn(self):
        told, rows = self.trials('--trials', 3, '--plan', 'plan.svg')
        self.assertEqual(told['trials'], 3)
        self.assertEqual(sum(told[s] for s in ('converged', 'timed_out', 'lost', 'failed')), 3)
        self.assertEqual([row['trial'] for row in rows], ['0', '1', '2'])
        self.assertIn('trial 2', (self.folder / 'plan.svg').read_text())

    def test_none_that_arrives_is_no_result(self):
        slow = ('--source', 'none', '--robot', 'max_speed_mps=0.001')
        self.assertEqual(self.run_program('--trials', '1', *slow).returncode, 0)
        run = self.run_program('--trials', '5', *slow)
        self.assertEqual(run.returncode, 3, run.stderr)
        self.assertIn('none of 5 robots says that it arrived', run.stderr)

    def test_bad_options_get_one_line(self):
        self.assertIn('use taught, recorded or model', self.refused('--goal', 'guessed'))
        self.assertIn('is no template', self.refused('--door', 'gate'))
        self.assertIn('has no free place', self.refused('--distance-m', '15'))
        self.assertIn('unknown error source', self.refused('--source', 'fog=1'))

    def test_a_slow_robot_arrives_too_and_files_are_checked_first(self):
        run = self.run_program('--trials', '2', '--source', 'none', '--robot', 'max_speed_mps=0.2')
        self.assertEqual(run.returncode, 0, run.stderr)
        run = self.run_program('--trials', '1000000', '-o', 'no-such-folder/x.csv')
        self.assertEqual(run.returncode, 2)
        run = self.run_program('--trial', '4294967295', '--trials', '2')
        self.assertEqual(run.returncode, 2)
        self.assertIn('--trial', run.stderr)

    def test_a_source_that_fails_is_told(self):
        run = self.run_program('--trials', 1, '--source', 'command=false', '--json')
        self.assertEqual(run.returncode, 3, run.stdout + run.stderr)
        self.assertEqual(json.loads(run.stdout)['failed'], 1)


if __name__ == '__main__':
    unittest.main(argv=['servo_test', *sys.argv[2:]])
