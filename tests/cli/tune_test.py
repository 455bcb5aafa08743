#!/usr/bin/env python3
# SPDX-FileCopyrightText: 2026 The Vernier authors
# SPDX-License-Identifier: Apache-2.0
"""The verb tune from outside: what it finds, says and costs, resuming, what it refuses.

    tune_test.py PROGRAM [unittest's options]
"""
import json
import pathlib
import signal
import subprocess
import sys
import tempfile
import time
import unittest


PROGRAM = None
# Larger errors of the calibration make it worse: the first of the values is the best.
SWEEP = '[sweep]\n"sources.calibration" = [0.1, 200, 30, 60, 15]\n'
STUDY = ('[study]\ntrials = 60\nprotocol = "near_path"\n[map]\nspacing_m = 4\n'
         '[world]\nfile = "small.world.toml"\n[rig]\nfile = "nominal"\n')
TUNE = '[tune]\nconfirm_worlds = ["yard.world.toml"]\nconfirm_trials = 24\n'


def untimed(json_value):
    """Without times."""
    if isinstance(json_value, dict):
        return {k: untimed(v) for k, v in json_value.items() if '_ms' not in k}
    return [untimed(v) for v in json_value] if isinstance(json_value, list) else json_value


class Tune(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.worlds = {}
        with tempfile.TemporaryDirectory() as folder:
            for seed, name in ((5, 'small.world.toml'), (6, 'yard.world.toml')):
                file = pathlib.Path(folder) / name
                subprocess.run([PROGRAM, 'world', 'make', '--seed', str(seed), '--size-m',
                                '10,8,2.5', '-o', file], check=True, capture_output=True)
                cls.worlds[name] = file.read_bytes()
        cls.worlds['copy.world.toml'] = cls.worlds['small.world.toml']

    def setUp(self):
        keeper = tempfile.TemporaryDirectory()
        self.addCleanup(keeper.cleanup)
        self.folder = pathlib.Path(keeper.name)
        for name, text in self.worlds.items():
            (self.folder / name).write_bytes(text)
        self.write(STUDY + SWEEP + TUNE)

    def write(self, text):
        (self.folder / 't.toml').write_text(text)

    def call(self, *words):
        return subprocess.run([PROGRAM, *map(str, words)], capture_output=True, text=True,
                              cwd=self.folder, timeout=300)

    def tune(self, *words, out='out', code=0):
        done = self.call('tune', 't.toml', '-o', out, '--json', '-q', *words)
        self.assertEqual(done.returncode, code, done.stderr)
        return json.loads(done.stdout)

    def refused(self, *about, words=('tune', 't.toml', '-o', 'out'), left=()):
        done = self.call(*words)
        self.assertEqual(done.returncode, 2, done.stdout)
        self.assertEqual(done.stderr.count('\n'), 1, done.stderr)
        for text in about:
            self.assertIn(text, done.stderr)
        found = {path.name for path in self.folder.iterdir()}
        self.assertLessEqual(found, {'t.toml', 'small.world.toml', 'copy.world.toml',
                                     'yard.world.toml', *left})

    def test_finds_the_least_error_and_says_what_it_cost(self):
        found = self.tune()
        candidates = found['candidates']
        self.assertEqual(found['winner']['settings'], {'sources.calibration': 0.1})
        self.assertEqual(candidates[0]['fate'], 'won')
        self.assertEqual(sorted(c['candidate'] for c in candidates), [1, 2, 3, 4, 5])
        self.assertEqual(found['trials'], sum(c['trials'] for c in candidates))
        self.assertEqual(found['grid_trials'], 5 * 60)
        self.assertLess(found['trials'], found['grid_trials'])
        # Compared with the second best, as the winner is the first of the list.
        self.assertEqual(found['reference']['candidate'], candidates[1]['candidate'])
        for one in (found['winner'], found['reference']):
            self.assertEqual(one['confirmed']['trials'], 24)
            low, high = one['confirmed']['success_interval_95']
            self.assertLessEqual(low, one['confirmed']['success'])
            self.assertLessEqual(one['confirmed']['success'], high)
        self.assertEqual(found['confirm_trials'], 48)
        self.assertNotIn('yard.world.toml', found['searched']['worlds'])
        self.assertNotIn(found['confirmed']['seed'], found['searched']['seeds'])
        self.assertEqual(json.loads((self.folder / 'out/tune.json').read_text()), found)
        text = self.call('tune', 't.toml', '-o', 'out', '-q').stdout
        for word in ('winner 1:', 'not searched', 'of a full grid', 'where it was searched than'):
            self.assertIn(word, text)
        self.assertLessEqual(max(map(len, text.splitlines())), 110)

    def test_threads_do_not_matter_and_nothing_is_computed_twice(self):
        one, two = self.tune('--threads', 1, out='one'), self.tune('--threads', 2, out='two')
        self.assertEqual(untimed(one), untimed(two))
        stores = list((self.folder / 'one').rglob('*.sqlite'))
        self.assertEqual(len(stores), 3)
        before = [store.read_bytes() for store in stores]
        self.assertEqual(self.tune(out='one'), one)
        self.assertEqual([store.read_bytes() for store in stores], before)

    def test_an_interrupted_search_goes_on_to_the_same_end(self):
        self.write((STUDY + SWEEP + TUNE).replace('= 60', '= 180'))
        whole = self.tune(out='whole')
        for how in (signal.SIGINT, signal.SIGKILL):
            stores = sum(1 for _ in self.folder.glob('cut/**/*.sqlite'))
            with subprocess.Popen([PROGRAM, 'tune', 't.toml', '-o', 'cut', '--threads', '1'],
                                  cwd=self.folder, stderr=subprocess.PIPE, text=True) as process:
                # Its first store is there as soon as the search begins.
                while process.poll() is None and not list(self.folder.glob('cut/**/*.sqlite')):
                    time.sleep(0.01)
                time.sleep(0.2 if stores else 0.05)
                process.send_signal(how)
                said = process.communicate()[1]
            self.assertEqual(process.returncode, -how, said)
            if how == signal.SIGINT:
                self.assertIn('tune t.toml -o cut --threads 1', (said.splitlines() or [''])[-1])
        self.assertEqual(untimed(self.tune(out='cut')), untimed(whole))

    def test_its_folders_are_studies(self):
        found = self.tune()
        status = json.loads(self.call('study', 'status', 'out/search', '--json').stdout)
        self.assertEqual(sum(cell['trials'] for cell in status['cells']), found['trials'])
        confirmed = found['winner']['folder']
        self.assertEqual(self.call('study', 'status', f'out/{confirmed}').returncode, 0)
        # The full grid goes on from the race, and the race has the same end on it.
        self.assertEqual(self.call('study', 't.toml', '-o', 'out/search', '-q').returncode, 0)
        self.assertEqual(untimed(self.tune()), untimed(found))

    def test_conditions_and_objectives(self):
        self.write(STUDY.replace('spacing_m = 4\n', '') + '[sweep]\n"map.spacing_m" = [2, 4]\n'
                   '"sources.calibration" = [0.1, 3]\n' + TUNE +
                   'conditions = ["sources.calibration"]\nobjective = "answered_right"\n'
                   'confirm_seed = 9\n')
        found = self.tune()
        self.assertEqual(found['objective'], 'answered_right')
        self.assertEqual(len(found['candidates']), 2)
        self.assertEqual(found['candidates'][0]['trials'], 2 * 60)
        self.assertEqual(found['winner']['confirmed']['trials'], 2 * 24)
        self.assertEqual(found['confirmed']['seed'], 9)

    def test_more_trials_go_on(self):
        self.write((STUDY + SWEEP + TUNE).replace('200, 30, 60, ', ''))
        fewer = self.tune()
        self.write((STUDY + SWEEP + TUNE).replace('= 60', '= 120').replace('200, 30, 60, ', ''))
        more = self.tune()
        self.assertEqual(more['grid_trials'], 2 * fewer['grid_trials'])

    def test_bad_input(self):
        self.write(STUDY + SWEEP)
        self.refused('t.toml', 'has no [tune]')
        self.write(STUDY + TUNE)
        self.refused('nothing to race')
        self.write(STUDY + '[sweep]\n"sources.calibration" = [1]\n' + TUNE)
        self.refused('nothing to race')
        self.write(STUDY + SWEEP + '[tune]\n')
        self.refused('t.toml:', 'confirm_worlds')
        for world, about in (('small.world.toml', 'is searched'), ('copy.world.toml', 'is the searched'),
                             ('none.world.toml', 'none.world.toml')):
            self.write(STUDY + SWEEP + TUNE.replace('yard.world.toml', world))
            self.refused(about)
        self.write(STUDY + SWEEP + TUNE + 'confirm_seed = 1\n')
        self.refused('t.toml:15', 'confirm_seed')
        self.write(STUDY + SWEEP + TUNE + 'objective = "speed"\n')
        self.refused('speed', 'answered_right')
        self.write(STUDY + SWEEP + TUNE + 'indiference = 0\n')
        self.refused('indifference')
        self.write(STUDY.replace('[map]', 'interval_width = 0.1\n[map]') + SWEEP + TUNE)
        self.refused('interval_width')
        self.write(STUDY + SWEEP + TUNE)
        self.refused('--output', words=('tune', 't.toml'))
        self.refused('none.toml', words=('tune', 'none.toml', '-o', 'out'))
        other = self.folder / 'other'
        other.mkdir()
        (other / 'mine.txt').write_text('kept')
        self.refused('mine.txt', words=('tune', 't.toml', '-o', 'other'), left=('other',))
        self.assertEqual([path.name for path in other.iterdir()], ['mine.txt'])

    def test_another_search_is_not_mixed_in(self):
        self.tune()
        before = (self.folder / 'out/tune.json').read_bytes()
        self.write((STUDY + SWEEP + TUNE).replace('[0.1,', '[0.2,'))
        self.refused('holds another study', left=('out',))
        self.assertEqual((self.folder / 'out/tune.json').read_bytes(), before)


if __name__ == '__main__':
    PROGRAM = str(pathlib.Path(sys.argv.pop(1)).resolve())
    unittest.main()
