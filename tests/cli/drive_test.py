# SPDX-FileCopyrightText: 2026 The Vernier authors
# SPDX-License-Identifier: Apache-2.0
"""vernier drive as a user calls it: commands from files and programs, observations out.

    drive_test.py PROGRAM [unittest's options]
"""
import json
import math
import pathlib
import subprocess
import sys
import unittest

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent))
sys.dont_write_bytecode = True
import verb_calls
from cli_test import ROOT

PROGRAM = pathlib.Path(sys.argv[1]).resolve()
CONTROLLER = ROOT / 'docs/examples/robot_controller.py'
START = ('--pose', '10,7.5,0')

PROGRAMS = {
    'replay': '''
import json, sys
commands = [json.loads(line) for line in open('log.jsonl')]
sys.stdin.readline()
print('{"ready": true}', flush=True)
for line in sys.stdin:
    asked = json.loads(line)
    answer = commands[asked['frame']] if asked['frame'] < len(commands) else {'done': True}
    print(json.dumps({'question': asked['question'], **answer}), flush=True)
''',
    'dies': '''
import sys
sys.stdin.readline()
print('{"ready": true}', flush=True)
for i in range(2):
    sys.stdin.readline()
    print('{"question": %d, "speed_mps": 0.1, "turn_radps": 0, "duration_s": 0.2}' % (i + 1), flush=True)
sys.exit('out of ideas')
''',
    'hangs': '''
import sys, time
sys.stdin.readline()
print('{"ready": true}', flush=True)
time.sleep(60)
''',
    'raves': '''
import sys
sys.stdin.readline()
print('{"ready": true}', flush=True)
sys.stdin.readline()
print('{"question": 1, "speed_mps": 7, "turn_radps": 0, "duration_s": 0.2}', flush=True)
sys.stdin.read()
''',
    'unready': '''
import sys
open('starts', 'a').write('.')
sys.stdin.readline()
sys.exit('no licence')
''',
}


class Drive(verb_calls.ProgramCase):
    program = PROGRAM
    first_words = ('drive',)

    def setUp(self):
        super().setUp()
        for name, text in PROGRAMS.items():
            (self.folder / f'{name}.py').write_text(text)
        self.commands = [{'speed_mps': 0.3, 'turn_radps': 0.2 * (i % 3 - 1), 'duration_s': 0.3}
                         for i in range(8)]
        (self.folder / 'log.jsonl').write_text(''.join(json.dumps(c) + '\n' for c in self.commands))

    def done(self, *words):
        run = self.run_program(*START, *words, '--json')
        self.assertEqual(run.returncode, 0, run.stderr)
        return json.loads(run.stdout)

    def refused(self, *words, lines='log.jsonl'):
        run = self.run_program(*START, *words, '-o', 'no.jsonl')
        self.assertEqual(run.returncode, 2, run.stdout + run.stderr)
        self.assertEqual(run.stderr.count('\n'), 1, run.stderr)
        self.assertTrue(run.stderr.startswith('vernier: '))
        self.assertFalse((self.folder / 'no.jsonl').exists())
        return run.stderr

    def observations(self, name):
        return [json.loads(line) for line in (self.folder / name).read_text().splitlines()]

    def test_commands_become_observations_and_ways(self):
        told = self.done('--commands', 'log.jsonl', '-o', 'seen.jsonl', '--truth', 'truth.txt',
                         '--odometry', 'odometry.txt', '--plan', 'plan.svg')
        self.assertEqual((told['steps'], told['ended'], told['contacts']), (8, 'commands', 0))
        seen = self.observations('seen.jsonl')
        self.assertEqual([o['frame'] for o in seen], list(range(9)))
        self.assertAlmostEqual(seen[-1]['time_s'], 2.4)
        self.assertGreater(min(len(o['edges']) for o in seen), 20)
        text = json.dumps(seen)
        for secret in ('feature', 'segment', 'object', 'true'):
            self.assertNotIn(f'"{secret}"', text)
        for name, end in (('truth.txt', told['end']), ('odometry.txt', told['odometry_end'])):
            rows = [line.split() for line in (self.folder / name).read_text().splitlines()
                    if line[0] != '#']
            self.assertEqual(len(rows), 9)
            self.assertEqual([float(x) for x in rows[0][:4]], [0, 10, 7.5, 1.2])
            self.assertAlmostEqual(float(rows[-1][1]), end[0])
            self.assertAlmostEqual(float(rows[-1][2]), end[1])
        apart = math.dist(told['end'][:2], told['odometry_end'][:2])
        self.assertAlmostEqual(told['odometry_error_m'], apart)
        self.assertGreater(apart, 1e-4)
        self.assertIn('true way', (self.folder / 'plan.svg').read_text())

    def test_a_log_of_commands_gives_the_same_again_from_a_program_too(self):
        self.done('--commands', 'log.jsonl', '-o', 'a.jsonl')
        self.done('--commands', 'log.jsonl', '-o', 'b.jsonl')
        told = self.done('--command', 'python3 replay.py', '-o', 'c.jsonl')
        self.assertEqual(told['ended'], 'done')
        first = (self.folder / 'a.jsonl').read_bytes()
        self.assertEqual(first, (self.folder / 'b.jsonl').read_bytes())
        self.assertEqual(first, (self.folder / 'c.jsonl').read_bytes())
        self.done('--commands', 'log.jsonl', '--trial', 1, '-o', 'd.jsonl')
        self.assertNotEqual(first, (self.folder / 'd.jsonl').read_bytes())

    def test_csv_and_standard_input_are_the_same_commands(self):
        rows = ''.join(f"{c['speed_mps']},{c['turn_radps']},{c['duration_s']}\n" for c in self.commands)
        (self.folder / 'log.csv').write_text('speed_mps,turn_radps,duration_s\n# a remark\n\n' + rows)
        end = self.done('--commands', 'log.jsonl')['end']
        self.assertEqual(self.done('--commands', 'log.csv')['end'], end)
        run = subprocess.run([PROGRAM, 'drive', *START, '--commands', '-', '--json'],
                             input=(self.folder / 'log.jsonl').read_text(), capture_output=True,
                             text=True, cwd=self.folder, timeout=60)
        self.assertEqual(json.loads(run.stdout)['end'], end, run.stderr)
        blanks = 'speed_mps, turn_radps , duration_s\n' + rows.replace(',', ' ,\t')
        (self.folder / 'blanks.csv').write_text(blanks)
        self.assertEqual(self.done('--commands', 'blanks.csv')['end'], end)
        (self.folder / 'wheels.csv').write_text('left_mps,right_mps,duration_s\n0.2,0.4,1\n')
        (self.folder / 'same.jsonl').write_text(
            '{"speed_mps": 0.30000000000000004, "turn_radps": 0.5, "duration_s": 1}\n')
        for a, b in zip(self.done('--commands', 'wheels.csv')['end'],
                        self.done('--commands', 'same.jsonl')['end']):
            self.assertAlmostEqual(a, b)

    def test_without_errors_odometry_is_the_truth(self):
        told = self.done('--commands', 'log.jsonl', '--robot', 'exact')
        self.assertLess(told['odometry_error_m'], 1e-12)
        worse = self.done('--commands', 'log.jsonl', '--robot', 'exact', '--robot', 'wheel_sd=0.05')
        self.assertGreater(worse['odometry_error_m'], 1e-3)

    def test_the_controller_of_the_page_drives(self):
        told = self.done('--command', f'python3 {CONTROLLER}', '-o', 'seen.jsonl')
        self.assertEqual((told['ended'], told['steps']), ('done', 60))
        self.assertGreater(told['way_m'], 3)

    def test_a_program_that_fails_ends_the_drive_and_says_why(self):
        for name, steps, why in (('dies', 2, 'out of ideas'),
                                 ('hangs', 0, 'gives no answer within 0.5 s'),
                                 ('raves', 0, 'a wheel would run at 7 m/s'),
                                 ('unready', 0, 'no licence')):
            run = self.run_program(*START, '--command', f'python3 {name}.py', '--time-limit-s', 0.5,
                                   '-o', f'{name}.jsonl', '--json')
            self.assertEqual(run.returncode, 3, run.stdout + run.stderr)
            self.assertIn(why, run.stderr)
            told = json.loads(run.stdout)
            self.assertEqual((told['ended'], told['steps']), ('failed', steps))
            self.assertIn(why, told['failure'])
            self.assertEqual(len(self.observations(f'{name}.jsonl')), steps + 1)
        self.assertEqual((self.folder / 'starts').read_text(), '.', 'started once')
        self.assertIn('cannot be started', self.refused('--command', './no_such_program'))
        self.assertIn('--time-limit-s: there is no program',
                      self.refused('--commands', 'log.jsonl', '--time-limit-s', 3))

    def test_steps_end_a_drive(self):
        told = self.done('--commands', 'log.jsonl', '--steps', 3)
        self.assertEqual((told['steps'], told['ended']), (3, 'steps'))

    def test_bad_commands_get_one_line_with_their_place(self):
        for line, why in (('{"speed_mps": 0.1, "turn_radps": 0, "duration_s": -1}', 'the duration of -1 s'),
                          ('{"speed_mps": 5, "turn_radps": 0, "duration_s": 1}', 'max_speed_mps'),
                          ('{"speed_mps": 0.1, "turn_radps": 0}', 'duration_s'),
                          ('{"speed_mps": 0.1, "turn": 0, "duration_s": 1}', 'unknown field "turn"'),
                          ('{"speed_mps": 0.1, "left_mps": 0, "duration_s": 1}', 'unknown field'),
                          ('{"speed_mps": NaN, "turn_radps": 0, "duration_s": 1}', 'bad.jsonl:2'),
                          ('{"speed_mps": "fast", "turn_radps": 0, "duration_s": 1}', 'bad.jsonl:2'),
                          ('{', 'bad.jsonl:2')):
            (self.folder / 'bad.jsonl').write_text(json.dumps(self.commands[0]) + '\n' + line + '\n')
            said = self.refused('--commands', 'bad.jsonl')
            self.assertIn('bad.jsonl:2', said)
            self.assertIn(why, said)
        for text, why in (('speed_mps,turn_radps,duration_s\nnan,0,1\n', 'bad.csv:2'),
                          ('speed_mps,turn_radps,duration_s\n0.1,0\n', 'has not 3 fields'),
                          ('speed,turn,time\n0.1,0,1\n', 'neither with all columns of a command nor with JSON'),
                          ('0.1,0,1\n', 'neither with all columns of a command nor with JSON'), ('', 'holds no command'),
                          ('speed_mps,turn_radps,duration_s\n', 'holds no command')):
            (self.folder / 'bad.csv').write_text(text)
            self.assertIn(why, self.refused('--commands', 'bad.csv'))

    def test_files_are_checked_before_the_drive(self):
        (self.folder / 'c.csv').write_text('speed_mps,turn_radps,duration_s\n' + '0.1,0,0.2\n' * 3)
        run = self.run_program(*START, '--commands', 'c.csv', '-o', 'c.csv')
        self.assertEqual(run.returncode, 2)
        self.assertIn('would be overwritten', run.stderr)
        run = self.run_program(*START, '--commands', 'c.csv', '--steps', '2')
        self.assertEqual(run.returncode, 0, run.stderr)
        self.assertIn('holds 3 commands', run.stderr)
        run = self.run_program(*START, '--commands', 'c.csv', '--steps', '3')
        self.assertEqual(run.stderr, '')
        self.assertIn('ended by commands', run.stdout)
        (self.folder / 'spin.csv').write_text('speed_mps,turn_radps,duration_s\n0,1000,60\n')
        run = self.run_program(*START, '--robot', 'wheel_base_m=0.001', '--commands', 'spin.csv')
        self.assertEqual(run.returncode, 2)
        self.assertIn('rad/s', run.stderr)

    def test_bad_options_get_one_line(self):
        self.assertIn('no commands are given', self.refused())
        self.assertIn('commands and a program',
                      self.refused('--commands', 'log.jsonl', '--command', 'cat'))
        for setting, why in (('speed=1', 'unknown setting'), ('wheel_sd=2', 'wheel_sd is 2'),
                             ('wheel_base_m=0', 'wheel_base_m is 0'), ('wheel_sd=', 'wheel_sd=')):
            self.assertIn(why, self.refused('--commands', 'log.jsonl', '--robot', setting))
        run = self.run_program('--pose', '0.05,0.05,0', '--commands', 'log.jsonl')
        self.assertEqual(run.returncode, 2)
        self.assertIn('--pose 0.05,0.05,0', run.stderr)
        run = self.run_program(*START, '--commands', 'log.jsonl', '-o', 'log.jsonl')
        self.assertEqual(run.returncode, 2)
        self.assertIn('log.jsonl', run.stderr)


if __name__ == '__main__':
    unittest.main(argv=['drive_test', *sys.argv[2:]])
