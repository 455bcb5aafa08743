#!/usr/bin/env python3
# SPDX-FileCopyrightText: 2026 The Vernier authors
# SPDX-License-Identifier: Apache-2.0
"""What a hostile trial of the program found, one test a finding.

    hostile_test.py PROGRAM [unittest's options]
"""
import json
import os
import shutil
import signal
import subprocess
import sys
import time
import unittest

sys.dont_write_bytecode = True
import cli_test
import verb_calls
from cli_test import vernier


class Hostile(cli_test.Case):
    def setUp(self):
        super().setUp()
        verb_calls.write_inputs(self.folder)
        self.before = os.getcwd()
        os.chdir(self.folder)
        self.addCleanup(os.chdir, self.before)

    def refused(self, *words, says, code=2):
        done = vernier(*words)
        self.assertEqual(done.returncode, code, done.stdout + done.stderr)
        self.assertIn(says, done.stderr)
        return done

    def calibrated(self):
        self.assertEqual(vernier('calibrate', '--observations', 'corners.csv', '--size', '640x480',
                                 '--no-model-check', '-o', 'cal.json').returncode, 0)
        return json.loads((self.folder / 'cal.json').read_text())

    def write(self, name, text):
        (self.folder / name).write_text(text if isinstance(text, str) else json.dumps(text))

    def test_boards_at_the_camera(self):
        rig = self.calibrated()
        for pose in rig['evidence']['view_poses'][:1]:
            pose['translation_m'] = [0, 0, 0]
        self.write('zero.json', rig)
        self.refused('report', 'zero.json', '-o', 'x.html', '--no-proof', says='zero.json: evidence')

    def test_every_parameter_held(self):
        rig = self.calibrated()
        rig['calibration']['held'] = rig['parameter_names']
        self.write('held.json', rig)
        self.refused('combine', 'held.json', '-o', 'q.json', says='"left.f_px" has a variance in the covariance')
        for key in 'covariance', 'covariance_mvb':
            rig[key]['matrix'] = [[0 for _ in row] for row in rig[key]['matrix']]
        self.write('held.json', rig)
        self.refused('combine', 'held.json', '-o', 'q.json', says='every parameter is fixed')

    def test_an_interrupted_study_without_the_index_of_its_log(self):
        self.write('big.toml', verb_calls.STUDY.replace('trials = 120', 'trials = 20000'))
        words = [cli_test.PROGRAM, 'study', 'big.toml', '-o', 's', '--threads', '1', '-q']
        with subprocess.Popen(words, stdout=subprocess.DEVNULL) as run:
            store = self.folder / 's/results.sqlite-wal'
            end = time.monotonic() + 60
            while not (store.exists() and store.stat().st_size > 0) and time.monotonic() < end:
                time.sleep(0.01)
            run.send_signal(signal.SIGKILL)
        (self.folder / 's/results.sqlite-shm').unlink(missing_ok=True)
        self.refused('study', 'status', 's', says='run its part of the study again')
        with subprocess.Popen(words, stdout=subprocess.DEVNULL, stderr=subprocess.PIPE) as run:
            time.sleep(2)
            run.send_signal(signal.SIGTERM)
            said = run.stderr.read().decode()
        self.assertNotIn('was interrupted while', said)
        self.assertEqual(vernier('study', 'status', 's').returncode, 0)

    def test_a_failed_start_leaves_nothing(self):
        done = subprocess.run(['sh', '-c', f'ulimit -n 6; exec "{cli_test.PROGRAM}" study study.toml -o u'],
                              capture_output=True)
        if done.returncode == 2:  # enough files are left on some machines
            self.assertFalse((self.folder / 'u').exists())
        self.assertEqual(vernier('study', 'study.toml', '-o', 'u', '-q').returncode, 0)

    def test_names_of_worlds(self):
        for name in (b'\xff', b'x' * 201, b'a\nb'):
            done = subprocess.run([cli_test.PROGRAM, 'world', 'make', '--name', name, '-o', 'w.toml'],
                                  capture_output=True)
            self.assertEqual(done.returncode, 2, done.stderr)
            self.assertFalse((self.folder / 'w.toml').exists())

    def test_draws_that_are_no_rigs(self):
        self.calibrated()
        self.refused('uncertainty', 'cal.json', '--psi-c', '10000', '--samples', '100', '--grid', '4x3',
                     says='no cameras can have', code=3)

    def test_distances(self):
        self.calibrated()
        for distances, says in ((','.join(map(str, range(1, 300))), 'more than 100'), ('5e-324', '0.001')):
            self.refused('diff', 'cal.json', 'cal.json', '--distances-m', distances, says=says)

    def test_zero_bytes_in_file_names(self):
        self.write('n.toml', '[study]\ntrials = 6\n[world]\nfile = "posts.world.toml\\u0000b"\n')
        self.refused('study', 'n.toml', '-o', 'n', says='n.toml:4: world.file holds a zero byte')

    def test_empty_values(self):
        self.refused('study', 'study.toml', '-o', 's', '--shard', '', says='--shard: is empty')
        self.refused('calibrate', '--observations', 'corners.csv', '--size', '640x480', '--prior', '',
                     '-o', 'z.json', says='--prior: is empty')
        self.refused('world', 'info', '', says='is empty')

    def test_a_byte_order_mark(self):
        text = (self.folder / 'corners.csv').read_bytes()
        (self.folder / 'bom.csv').write_bytes(b'\xef\xbb\xbf' + text)
        words = ('--size', '640x480', '--no-model-check', '--json', '-o', 'z.json')
        a = vernier('calibrate', '--observations', 'bom.csv', *words)
        b = vernier('calibrate', '--observations', 'corners.csv', *words)
        self.assertEqual(a.returncode, 0, a.stderr)
        self.assertEqual(json.loads(a.stdout)['chi2'], json.loads(b.stdout)['chi2'])

    def test_pipes_in_place_of_a_store(self):
        self.assertEqual(vernier('study', 'study.toml', '-o', 's', '-q').returncode, 0)
        shutil.copytree('s', 'journal')
        os.mkfifo('journal/results.sqlite-journal')
        self.refused('study', 'status', 'journal', says='results.sqlite-journal: is not a regular file')
        os.unlink('s/results.sqlite')
        os.mkfifo('s/results.sqlite')
        self.refused('study', 'study.toml', '-o', 's', says='results.sqlite: is not a regular file')
        self.assertTrue((self.folder / 's/results.sqlite').is_fifo())

    def test_terminal_controls_in_names(self):
        self.write('w.world.toml', verb_calls.WORLD.replace('"posts"', '"\\u001b[31mred"'))
        done = vernier('world', 'info', 'w.world.toml')
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertNotIn('\x1b', done.stdout)

    def test_a_value_swept_twice(self):
        self.write('d.toml', '[study]\n[sweep]\n"sources.calibration" = [1, 1]\n')
        self.refused('study', 'd.toml', '-o', 'd', says='d.toml:3: the sweep of sources.calibration lists 1')

    def test_numbers_too_large(self):
        text = (self.folder / 'corners.csv').read_text().splitlines()
        text[1] = '2147483648' + text[1][text[1].index(','):]
        self.write('large.csv', '\n'.join(text))
        self.refused('calibrate', '--observations', 'large.csv', '--size', '640x480', '-o', 'z.json',
                     says='large.csv:2: frame is "2147483648", too large')

    def test_a_call_that_fails_prints_no_doubt(self):
        rig = self.calibrated()
        rig['calibration']['doubts'] = ['the board was bent']
        self.write('doubted.json', rig)
        self.assertIn('the board was bent', vernier('check', 'doubted.json', '--no-mrcal', '--trials',
                                                    '200').stderr)
        for without in ('evidence', 'calibration'):
            part = {key: value for key, value in rig.items() if key != without}
            self.write('part.json', part)
            done = self.refused('check', 'part.json', says='no stored evidence to solve again')
            self.assertEqual(done.stderr.count('\n'), 1, done.stderr)
        few = vernier('check', 'doubted.json', '--holdout', '--training-frames', '50')
        self.assertEqual((few.returncode, few.stderr.count('\n')), (2, 1), few.stderr)

    def test_a_key_of_toml_that_is_repeated(self):
        self.write('d.toml', '[study]\n"tri\\u001bals" = 1\n"tri\\u001bals" = 2\n')
        self.refused('study', 'd.toml', '-o', 'd', says='d.toml:3: ""tri\\u001bals" = 2" defines what is '
                     'defined before; define every key and table once')

    def test_a_summary_that_is_none(self):
        rig = self.calibrated()
        for key, value, says in (('views', 10**6, 'calibration.views: is 1000000, and the evidence has 12'),
                                 ('pixel_sigma_px', 1e5, 'chi2, pixel_sigma_px and rms_px disagree'),
                                 ('source', 'me', '"me" is unknown')):
            self.write('s.json', {**rig, 'calibration': {**rig['calibration'], key: value}})
            self.refused('uncertainty', 's.json', '--grid', '4x3', says=says)

    def test_a_prior_in_millimetres(self):
        rig = json.loads((self.folder / 'rig.json').read_text())
        names = rig['parameter_names']
        rig['cameras'][1]['from_first']['translation_m'] = [-100, 0, 0]
        at = names.index('right.tx_m')
        rig['parameters'][at] = -100
        rig['covariance']['matrix'][at][at] = 4
        self.write('mm.json', rig)
        for words in (('calibrate', '--pairs', 'pairs.csv', '--prior', 'mm.json'),
                      ('combine', '--prior', 'mm.json', 'pairs.csv')):
            done = vernier(*words, '-o', 'out.json')
            self.assertEqual(done.returncode, 0, done.stderr)
            self.assertNotIn('nan', done.stdout)
            self.assertNotIn(' m: vertical disparity', done.stdout)
            self.assertIn('at 30 m nothing is in view of both cameras, whose baseline is 100 m: are the '
                          'lengths of the prior in metres?', done.stderr)
            found = json.loads(vernier(*words, '-o', 'out.json', '--json', '-q').stdout)
            self.assertEqual(found['observability']['vertical_disparity_px'], [None, None])
        near = vernier('calibrate', '--pairs', 'pairs.csv', '--prior', 'rig.json', '-o', 'out.json')
        self.assertIn('at 3 m: vertical disparity ', near.stdout)
        self.assertNotIn('in metres?', near.stderr)

    def test_options_without_effect(self):
        self.refused('study', 'study.toml', '-o', 's', '--shard', '00/4', says='--shard')
        self.refused('study', 'status', 's', '-o', 'x', says='leave them out')


if __name__ == '__main__':
    cli_test.PROGRAM = os.path.abspath(sys.argv.pop(1))
    unittest.main()
