#!/usr/bin/env python3
# SPDX-FileCopyrightText: 2026 The Vernier authors
# SPDX-License-Identifier: Apache-2.0
"""Studies of what an estimator is told, from outside: told_study_test.py PROGRAM [unittest's options]."""
import json
import os
import pathlib
import shutil
import signal
import subprocess
import sys
import unittest

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent))
sys.dont_write_bytecode = True
import store_test
from ranks_test import ENVIRONMENT, MPIRUN, has_mpi, ours
from store_test import INPUTS, STUDY, Store, contents

TOLD = STUDY + '[rig]\ntruth = "nominal"\n'
# A hundred calibrations of some 0.3 s each: none is done soon.
SLOW = TOLD + '[calibration]\nviews = 100\n'


class Told(Store):
    def write(self, text):
        self.file.write_text(text)
        shutil.rmtree(self.out, ignore_errors=True)

    def refused(self, text, of):
        self.write(text)
        line = self.complains('study', self.file, '-o', self.out, of=of)
        self.assertTrue(line.startswith(f'vernier: {self.file}:'), line)
        self.assertFalse(self.out.exists())


class NothingSeen(Told):
    def test_is_a_doubt(self):
        (self.folder / 'empty.world.toml').write_text(
            'format = "vernier/world"\nversion = 1\nname = "empty"\n[[route]]\npoints_m = [[0, 0], [3, 0]]\n')
        self.write('[study]\ntrials = 12\n[world]\nfile = "empty.world.toml"\n')
        doubt, = json.loads(self.run_study(code=3).stdout)['doubts']
        self.assertIn('too little was seen in every trial of cell', doubt)
        # One of two cells is a result, and a remark.
        self.write('[study]\ntrials = 12\n[world]\nfile = "workshop"\n'
                   '[sweep]\n"world.file" = ["workshop", "empty.world.toml"]\n')
        done = self.works('study', self.file, '-o', self.out, '--json')
        self.assertIn('too little was seen in every trial of cell', done.stderr)
        self.assertEqual(json.loads(done.stdout).get('doubts', []), [])


class WithoutEffect(Told):
    def test_requests_are_refused_where_they_stand(self):
        for text, of in (
                ('[localiser]\nmethod = "pgh"\nlooks = 2\n', 'localiser.looks has no effect: localiser.method is "pgh"'),
                ('[histograms]\nmax_lines = 40\n', 'histograms.max_lines has no effect: localiser.ranker is "view"'),
                ('[sweep]\n"sources.corner_loss" = [0, 0.5]\n', 'sources.corner_loss has no effect')):
            with self.subTest(text):
                self.refused(STUDY + text, of)
        # Where it begins only: what an older program stored can be read.
        self.write(STUDY)
        self.run_study()
        copy = self.out / 'study.toml'
        copy.write_text(copy.read_text() + '[localiser]\nmethod = "pgh"\nlooks = 2\n')
        self.works('study', 'status', self.out)

    def test_sources_are_told(self):
        self.write(STUDY + '[sources]\nmoved = 0.5\ncorner_loss = 0.3\nmissed_alike = 0.2\n')
        done = self.works('study', self.file, '-o', self.out, '--json')
        told = [line for line in done.stderr.splitlines() if 'no effect' in line]
        self.assertEqual([line.split(': ', 2)[2] for line in told],
                         ['sources.corner_loss has no effect: localiser.method is "lines"',
                          'sources.missed_alike has no effect: sources.missed is 0'])
        self.write(STUDY.replace('small', 'loose') + '[sources]\nmoved = 0.5\n')
        lines = ''.join(f'[[segment]]\nsegment = [{x}, {y}, 0, {x}, {y}, 2]\n'
                        for x in range(6) for y in (-2, 2))
        (self.folder / 'loose.world.toml').write_text(
            'format = "vernier/world"\nversion = 1\nname = "loose"\n'
            '[[route]]\npoints_m = [[0, 0], [3, 0]]\n' + lines)
        done = self.call('study', self.file, '-o', self.out, '--json')
        self.assertIn('sources.moved has no effect: the world loose.world.toml has no furniture', done.stderr)

    def test_a_rig_that_is_told_twice_is_named_at_its_line(self):
        text = TOLD + 'file = "nominal"\n[sweep]\n"calibration.views" = [3, 5]\n'
        line = text.splitlines().index('file = "nominal"') + 1
        self.refused(text, f':{line}: rig.file has no effect')


class NoCalibration(Told):
    def test_is_a_doubt_that_names_the_cell(self):
        self.write(TOLD + '[calibration]\nviews = 4\ndistance_m = 1000\n'
                   '[sweep]\n"sources.calibration" = [0, 1]\n')
        done = self.run_study(code=3)
        doubt, = json.loads(done.stdout)['doubts']
        self.assertRegex(doubt, r'^cell "sources.calibration = 1": all 100 calibrations failed, the '
                         'first by: frame 0, camera 0: .')
        table = self.works('study', 'status', self.out, code=3)
        self.assertNotIn('nan', table.stdout)
        self.assertIn('calibrations from 4 views: 100 of 100 failed', table.stdout)
        self.assertIn(doubt, table.stderr)
        merged = self.works('study', 'merge', self.out, '-o', self.folder / 'merged', code=3)
        self.assertIn(doubt, merged.stderr)

    def test_an_impossible_rig_is_a_failed_trial(self):
        self.write(TOLD + '[calibration]\nviews = 4\n[sources]\ncalibration = 1000\n')
        done = self.run_study(code=3)
        cell, = json.loads(done.stdout)['cells']
        self.assertEqual(cell['trials'], 12)
        self.assertGreaterEqual(cell['failed'], 10)
        self.assertIn('a rig that no cameras can have', done.stderr)


class Calibrations(Told):
    def test_are_told_once_and_at_which_scale(self):
        self.write(TOLD + '[calibration]\n[sweep]\n"calibration.views" = [4, 5]\n'
                   '"sources.calibration" = [0.5, 1, 2]\n')
        lines = [line for line in self.works('study', self.file, '-o', self.out, '-q').stdout.splitlines()
                 if line.startswith('calibrations from')]
        self.assertEqual([line.split()[2] for line in lines], ['4', '5'])
        for line in lines:
            self.assertIn('depth at 5 m at psi_c = 1: rms error', line)

    def interrupted(self, *command, number=signal.SIGINT, **more):
        """What it says when a signal comes while calibrations are recorded."""
        running = subprocess.Popen(list(map(str, command)), text=True, stdin=subprocess.DEVNULL,
                                   stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, **more)
        said = ''
        for line in running.stderr:
            said += line
            if 'recorded calibrations: ' in line:
                break
        running.send_signal(number)
        said += running.communicate(timeout=100)[1]
        return running.returncode, said

    def test_can_be_interrupted(self):
        self.write(SLOW)
        code, said = self.interrupted(store_test.PROGRAM, 'study', self.file, '-o', self.out,
                                               '--threads', '2')
        self.assertEqual(code, -signal.SIGINT)
        self.assertIn('study: recorded calibrations: 0 of 100', said)
        self.assertRegex(said, 'vernier: ended by SIGINT after 0 blocks, which are stored; go on with: ')
        self.assertNotIn('recorded calibrations: 100 of 100', said)
        self.assertFalse(self.out.exists())

    def test_can_be_interrupted_on_ranks(self):
        if not shutil.which('mpirun') or not has_mpi():
            self.skipTest('no mpirun, or built without MPI')
        self.write(SLOW)
        code, said = self.interrupted(*MPIRUN, '-n', '2', store_test.PROGRAM, 'study', self.file,
                                         '-o', self.out, '--threads', '1', env=ENVIRONMENT)
        self.assertNotEqual(code, 0)
        line = ours(said)[-1]
        self.assertRegex(line, 'vernier: ended by SIGTERM after 0 blocks, which are stored; go on with')
        self.assertFalse(self.out.exists() and list(self.out.glob('*.lock')))


class Refusals(Told):
    def test_name_the_line(self):
        self.refused(STUDY.replace('small.world.toml', 'nosuch'), ':5: world "nosuch": no such file')
        self.refused(STUDY + '[rig]\nfile = "nosuch"\n', ':9: rig "nosuch": no such file')
        self.refused(TOLD.replace('nominal', 'nosuch') + '[calibration]\n',
                     ':9: rig "nosuch": no such file')
        self.refused(TOLD + '[sweep]\n"rig.file" = ["nominal", "nosuch"]\n',
                     ':11: rig "nosuch": no such file')
        self.refused(TOLD + '[calibration]\nobservations = "c.vnl"\n', ':11: c.vnl: no such file')
        self.refused(TOLD + '[calibration]\nmodel = "pinhole"\n[sources]\ncalibration = 2\n',
                     ':11: calibration.model: sources.calibration = 2 cannot scale')
        rig = json.loads((pathlib.Path(os.environ['VERNIER_SHARE']) if 'VERNIER_SHARE' in os.environ else
                          pathlib.Path(store_test.PROGRAM).parent / 'share/vernier')
                         .joinpath('rigs/nominal.rig.json').read_text())
        bare = {key: rig[key] for key in ('format', 'version', 'cameras')}
        (self.folder / 'bare.json').write_text(json.dumps(bare))
        self.refused(STUDY + '[rig]\nfile = "bare.json"\n',
                     ':9: bare.json has no covariance to draw what is told of the rig from; calibrate it '
                     'with vernier calibrate, or set sources.calibration = 0')
        self.refused(TOLD + 'file = "bare.json"\n', 'or set rig.error = "given": its difference from rig.truth')
        (self.folder / 'one.json').write_text(json.dumps(
            {'format': rig['format'], 'version': rig['version'], 'cameras': rig['cameras'][:1]}))
        self.refused(STUDY + '[rig]\nfile = "one.json"\n[sources]\ncalibration = 0\n',
                     'one.json is a rig of 1 camera; name a rig of two cameras')

    def test_a_study_in_a_report_twice(self):
        out = self.finished()
        page = self.folder / 'page.html'
        self.complains('report', out, out.parent / '.' / 'out', '--no-proof', '-o', page,
                       of='is given twice; give each study once')
        self.assertFalse(page.exists())


class OwnFolder(Told):
    def test_tables_and_figures_in_the_folder_of_a_study_are_left_alone(self):
        out = self.finished()
        before = contents(out)
        self.works('export', out, '-o', out / 'x.csv')
        self.works('report', out, '--no-proof', '--figures', out, '-q', '-o', out / 'page.html')
        self.complains('export', out, '-o', out / 'study.toml', of='study.toml')
        made = contents(out)
        for name, content in before.items():
            self.assertEqual(made[name], content)
        self.assertIn('x.csv', made)
        self.file.write_text(STUDY.replace('trials = 12', 'trials = 18'))
        self.assertEqual(json.loads(self.run_study().stdout)['cells'][0]['trials'], 18)
        self.assertEqual(contents(out)['x.csv'], made['x.csv'])
        self.works('study', 'merge', out, '-o', self.folder / 'merged', '-q')
        self.assertEqual(sorted(contents(self.folder / 'merged')), sorted([*INPUTS, 'results.sqlite']))


if __name__ == '__main__':
    store_test.PROGRAM = os.path.abspath(sys.argv.pop(1))
    unittest.main()
