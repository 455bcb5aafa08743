#!/usr/bin/env python3
# SPDX-FileCopyrightText: 2026 The Vernier authors
# SPDX-License-Identifier: Apache-2.0
"""Shards of a study: Slurm's arrays, merging, what is missing, processors of two kinds, kills.

    shards_test.py PROGRAM [unittest's options]
"""
import contextlib
import json
import os
import pathlib
import shutil
import sqlite3
import subprocess
import sys
import unittest

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent))
sys.dont_write_bytecode = True
import store_test
from store_test import STUDY, contents, untimed

ROOT = pathlib.Path(__file__).resolve().parents[2]


def fingerprint(text):
    """FNV-1a of 64 bits, as a store's rows have it (calib/base/fingerprint.h)."""
    state = 0xcbf29ce484222325
    for byte in text.encode():
        state = (state ^ byte) * 0x100000001b3 % 2**64
    return f'{state:016x}'


def set_note(store, key, value):
    """Changes a note of a store, checksum included."""
    checksum = fingerprint(''.join(f'{len(field)}:{field}' for field in (key, value)))
    with contextlib.closing(sqlite3.connect(store)) as database, database:
        database.execute('UPDATE remark SET value = ?, checksum = ? WHERE key = ?',
                         (value, checksum, key))


def note(store, key):
    with contextlib.closing(sqlite3.connect(store)) as database:
        return database.execute('SELECT value FROM remark WHERE key = ?', (key,)).fetchone()[0]


def rows(store):
    """All that a store holds of trials, but for the timings."""
    with contextlib.closing(sqlite3.connect(store)) as database:
        found = database.execute('SELECT cell, block, trials, answered, successes, results'
                                 ' FROM trial_block ORDER BY cell, block').fetchall()
    return [(*row[:5], [trial[:13] + trial[15:] for trial in json.loads(row[5])]) for row in found]


class ShardCase(store_test.Store):
    def setUp(self):
        super().setUp()
        self.parts = []

    def run_part(self, name, *words, **more):
        part = self.folder / name
        self.parts.append(part)
        return self.works('study', self.file, '-o', part, '-q', '--json', *words, **more)

    def merge(self, *parts, code=0, words=()):
        target = self.folder / f'merged{len(list(self.folder.glob("merged*")))}'
        done = self.works('study', 'merge', *(parts or self.parts), '-o', target, '--json', *words,
                          code=code)
        return done, target


class Arrays(ShardCase):
    def run_array(self, tasks, low, high, step, separate):
        for task in tasks:
            variables = {'ID': task, 'COUNT': len(tasks), 'MIN': low, 'MAX': high, 'STEP': step}
            env = dict(os.environ, **{f'SLURM_ARRAY_TASK_{key}': str(value)
                                      for key, value in variables.items()})
            self.run_part(f'task{task}' if separate else 'all', env=env)

    def test_arrays_from_0_from_1_and_in_steps(self):
        whole = rows(self.shared / 'done' / 'results.sqlite')
        for tasks, low, high, step in (([0, 1, 2], 0, 2, 1), ([1, 2, 3, 4], 1, 4, 1),
                                       ([1, 3], 1, 3, 2), ([10, 40, 70], 10, 70, 30)):
            for separate in (False, True):
                with self.subTest(tasks=tasks, separate=separate):
                    self.parts = []
                    self.run_array(tasks, low, high, step, separate)
                    names = {store.name for part in self.parts for store in part.glob('*.sqlite')}
                    self.assertEqual(names, {f'results-{i}-of-{len(tasks)}.sqlite'
                                             for i in range(len(tasks))})
                    done, target = self.merge(*dict.fromkeys(self.parts))
                    self.assertEqual(untimed(done.stdout), self.cells)
                    self.assertEqual(rows(target / 'results.sqlite'), whole)
                    for part in {*self.parts}:
                        shutil.rmtree(part)

    def test_an_option_is_before_an_array(self):
        env = dict(os.environ, SLURM_ARRAY_TASK_ID='0', SLURM_ARRAY_TASK_COUNT='4')
        self.run_part('part', '--shard', '1/2', env=env)
        self.assertTrue((self.parts[0] / 'results-1-of-2.sqlite').exists())

    def test_more_shards_than_blocks(self):
        for i in range(8):
            self.run_part(f'part{i}', '--shard', f'{i}/8')
        done, _ = self.merge()
        self.assertEqual(untimed(done.stdout), self.cells)


class Missing(ShardCase):
    def test_a_missing_shard_is_named(self):
        for i in (0, 1, 3):
            self.run_part(f'part{i}', '--shard', f'{i}/4')
        done, target = self.merge(code=3)
        line, = done.stderr.strip().splitlines()
        self.assertIn('1 of 6 blocks are missing from the merged study; run --shard 2/4 and merge again',
                      line)
        self.assertEqual(json.loads(done.stdout)['doubts'], [line.split('trustworthy: ')[1]])
        self.run_part('part2', '--shard', '2/4')
        done = self.works('study', 'merge', self.parts[-1], '-o', target, '--json')
        self.assertEqual(untimed(done.stdout), self.cells)

    def test_a_shard_that_lacks_a_block_is_named(self):
        for i in range(2):
            self.run_part('all', '--shard', f'{i}/2')
        with contextlib.closing(sqlite3.connect(self.parts[0] / 'results-1-of-2.sqlite')) as store:
            with store:
                store.execute('DELETE FROM trial_block WHERE block = 5')
        table = self.works('study', 'status', self.parts[0]).stdout
        self.assertIn('5 of 6 blocks done: run the study again to finish it, with --shard 1/2', table)
        status = json.loads(self.works('study', 'status', self.parts[0], '--json').stdout)
        self.assertEqual(status['missing_shards'], ['1/2'])
        done, _ = self.merge(self.parts[0], code=3)
        self.assertIn('run --shard 1/2 and merge again', done.stderr)

    def test_a_shard_with_queries_only_is_named_too(self):
        for i in range(7):
            self.run_part(f'part{i}', '--shard', f'{i}/8')
        done, _ = self.merge(code=3)
        self.assertIn('queries of the world ceiling are missing from the merged study; run --shard 7/8',
                      done.stderr)

    def test_no_store_at_all(self):
        self.run_part('part')
        (self.parts[0] / 'results.sqlite').unlink()
        done, _ = self.merge(code=3)
        self.assertIn('6 of 6 blocks are missing', done.stderr)

    def test_a_part_that_is_no_study(self):
        self.run_part('part')
        self.complains('study', 'merge', self.parts[0], self.folder / 'none', '-o',
                       self.folder / 'merged', of='none: is not a study folder')
        self.complains('study', 'merge', self.parts[0], '-o', self.parts[0],
                       of='is also the output folder')
        self.assertFalse((self.folder / 'merged').exists())


class Processors(ShardCase):
    def two_kinds(self):
        """Two shards, the second as if another kind of processor had computed it."""
        for i in range(2):
            self.run_part(f'part{i}', '--shard', f'{i}/2')
        self.here = note(self.parts[0] / 'results-0-of-2.sqlite', 'instruction_set')
        set_note(self.parts[1] / 'results-1-of-2.sqlite', 'instruction_set', 'ABACUS')

    def test_are_merged_where_that_is_allowed(self):
        self.two_kinds()
        target = self.folder / 'merged'
        before = [contents(part) for part in self.parts]
        line = self.complains('study', 'merge', *self.parts, '-o', target, of='ABACUS')
        self.assertIn('--allow-other-instruction-set', line)
        self.assertFalse(target.exists())
        self.assertEqual([contents(part) for part in self.parts], before)
        done = self.works('study', 'merge', *self.parts, '-o', target, '--json',
                          '--allow-other-instruction-set')
        self.assertEqual(untimed(done.stdout), self.cells)
        mixture = ', '.join(sorted(['ABACUS', self.here]))
        self.assertEqual(json.loads(done.stdout)['instruction_sets'], mixture)
        self.assertEqual(note(target / 'results.sqlite', 'instruction_set'), mixture)
        self.assertIn(f'instruction sets {mixture}', self.works('study', 'status', target).stdout)

    def test_go_on_where_that_is_allowed(self):
        self.run_part('part', '--shard', '0/2')
        store = self.parts[0] / 'results-0-of-2.sqlite'
        here = note(store, 'instruction_set')
        set_note(store, 'instruction_set', 'ABACUS')
        before = contents(self.parts[0])
        for shard in ([], ['--shard', '0/2'], ['--shard', '1/2']):
            words = ['study', self.file, '-o', self.parts[0], *shard]
            if shard == ['--shard', '0/2']:
                self.works(*words)  # nothing is missing
            else:
                self.complains(*words, of='instruction set ABACUS')
            self.assertEqual(contents(self.parts[0]), before)
        done = self.run_part('part', '--shard', '1/2', '--allow-other-instruction-set')
        self.assertEqual(untimed(done.stdout), self.cells)
        self.assertEqual(note(self.parts[0] / 'results-1-of-2.sqlite', 'instruction_set'),
                         ', '.join(sorted(['ABACUS', here])))
        # it was allowed once, and readers need not ask again
        self.assertEqual(untimed(self.works('study', 'status', self.parts[0], '--json').stdout),
                         self.cells)

    def test_results_that_differ_are_refused_on_one_kind_only(self):
        self.two_kinds()
        self.run_part('whole')
        store = self.parts[2] / 'results.sqlite'
        for value, refused in ((self.here, True), ('ABACUS', False)):
            with contextlib.closing(sqlite3.connect(store)) as database, database:
                row = database.execute('SELECT cell, block, trials, answered, successes, results'
                                       ' FROM trial_block WHERE block = 2').fetchone()
                trials = json.loads(row[5])
                trials[0][4] = trials[0][4][:2] + [trials[0][4][2] + 1e-15]
                fields = [*row[:5], json.dumps(trials, separators=(',', ':'))]
                text = ''.join(f'{len(str(field).encode())}:{field}' for field in fields)
                database.execute('UPDATE trial_block SET results = ?, checksum = ? WHERE block = 2',
                                 (fields[5], fingerprint(text)))
            set_note(store, 'instruction_set', value)
            words = ['study', 'merge', self.parts[0], self.parts[2], '-o', self.folder / 'merged',
                     '--allow-other-instruction-set']
            if refused:
                self.complains(*words, of='disagrees with another store on trial')
                self.assertFalse((self.folder / 'merged').exists())
            else:
                self.works(*words)


class Kills(ShardCase):
    def test_a_merge_is_completed_whatever_a_kill_left(self):
        merged, left = self.folder / 'merged', self.folder / 'left'
        for i in range(2):
            self.run_part(f'part{i}', '--shard', f'{i}/2')
        words = ['study', 'merge', *self.parts, '-o']
        expected = untimed(self.works(*words, merged, '--json').stdout)
        shutil.copytree(merged, left)
        # a log without its index, which no reader may make
        with contextlib.closing(sqlite3.connect(merged / 'results.sqlite')) as database:
            database.execute('PRAGMA journal_mode = WAL')
            database.execute('CREATE TABLE spare (x)')
            database.execute('DROP TABLE spare')
            database.commit()
            for ending in ('', '-wal'):
                shutil.copy(merged / f'results.sqlite{ending}', left / f'results.sqlite{ending}')
        self.assertGreater((left / 'results.sqlite-wal').stat().st_size, 0)
        self.assertEqual(untimed(self.works(*words, left, '--json').stdout), expected)

    def test_no_kill_changes_a_result(self):
        script = ROOT / 'scripts/study_kills.py'
        for during in ('study', 'merge'):
            done = subprocess.run([sys.executable, script, store_test.PROGRAM, '--during', during,
                                   '--kills', '6'], capture_output=True, text=True)
            self.assertEqual(done.returncode, 0, done.stdout + done.stderr)
            self.assertIn('6 kills, 0 failed', done.stdout)


if __name__ == '__main__':
    store_test.PROGRAM = os.path.abspath(sys.argv.pop(1))
    unittest.main()
