#!/usr/bin/env python3
# SPDX-FileCopyrightText: 2026 The Vernier authors
# SPDX-License-Identifier: Apache-2.0
"""A study on several processes under mpirun. Skips itself where there is no mpirun.

    ranks_test.py PROGRAM [unittest's options]
"""
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
from shards_test import rows
from store_test import INPUTS, NOBODY, STUDY, contents, shell_as_root, untimed

ROOT = pathlib.Path(__file__).resolve().parents[2]
MPIRUN = ['mpirun', '--quiet', '--oversubscribe', '--bind-to', 'none']
# mpirun refuses root unless told twice
ENVIRONMENT = dict(os.environ, OMPI_ALLOW_RUN_AS_ROOT='1', OMPI_ALLOW_RUN_AS_ROOT_CONFIRM='1')
LONG = STUDY.replace('trials = 12', 'trials = 3000')


def has_mpi():
    doctor = subprocess.run([store_test.PROGRAM, 'doctor', '--json'], capture_output=True, text=True)
    found = {one['what']: one['found'] for one in json.loads(doctor.stdout)['findings']}
    return found['MPI']


def ours(said):
    """The program's own lines: mpirun adds its notes about exit codes."""
    return [line for line in said.splitlines() if line.startswith(('vernier: ', 'study: ', 'warning: '))]


class RankCase(store_test.Store):
    def setUp(self):
        if not shutil.which('mpirun'):
            self.skipTest('no mpirun; install openmpi-bin')
        if not has_mpi():
            self.skipTest('built without MPI')
        super().setUp()

    def on_ranks(self, count, *words, **more):
        more.setdefault('env', ENVIRONMENT)
        return subprocess.run([*MPIRUN, '-n', str(count), store_test.PROGRAM, *map(str, words)],
                              capture_output=True, text=True, stdin=subprocess.DEVNULL, timeout=200,
                              **more)

    def study_on(self, count, *words, **more):
        return self.on_ranks(count, 'study', self.file, '-o', self.out, *words, **more)

    def refused(self, done, of, code=2):
        self.assertEqual(done.returncode, code, done.stderr)
        self.assertEqual(done.stdout, '')
        line, = ours(done.stderr)
        self.assertIn(of, line)
        return line


class Results(RankCase):
    def test_are_those_of_one_process(self):
        whole = rows(self.shared / 'done' / 'results.sqlite')
        for count, words in ((4, []), (2, ['--threads', '2']), (3, ['--threads', '1'])):
            with self.subTest(count=count):
                done = self.study_on(count, '--json', '-q', *words)
                self.assertEqual((done.returncode, ours(done.stderr)), (0, []))
                self.assertEqual(untimed(done.stdout), self.cells)
                self.assertEqual(sorted(contents(self.out)), sorted([*INPUTS, 'results.sqlite']))
                self.assertEqual(rows(self.out / 'results.sqlite'), whole)
                again = self.study_on(count, '--json', '-q')
                self.assertEqual(untimed(again.stdout), self.cells)
                shutil.rmtree(self.out)

    def test_one_rank_is_a_plain_run(self):
        done = self.study_on(1, '--json', '-q')
        self.assertEqual(untimed(done.stdout), self.cells)

    def test_a_plain_run_goes_on_from_ranks_and_back(self):
        for trials, ranks in ((4, 2), (8, 0), (12, 3)):
            self.file.write_text(STUDY.replace('trials = 12', f'trials = {trials}'))
            if ranks:
                done = self.study_on(ranks, '--json', '-q')
            else:
                done = self.run_study()
            self.assertEqual(done.returncode, 0, done.stderr)
            self.assertEqual(json.loads(done.stdout)['cells'][0]['trials'], trials)

    def test_a_shard_on_ranks(self):
        for i in range(2):
            done = self.study_on(2, '--shard', f'{i}/2', '--json', '-q')
            self.assertEqual(done.returncode, 0, done.stderr)
        self.assertEqual(untimed(done.stdout), self.cells)
        self.assertEqual(sorted(path.name for path in self.out.glob('*.sqlite')),
                         [f'results-{i}-of-2.sqlite' for i in range(2)])

    def test_progress_is_said_once(self):
        done = self.study_on(3)
        self.assertEqual(done.stderr.count('study: blocks: 6 of 6'), 1)
        self.assertEqual(done.stdout.count('success: answered, within 1 m'), 1)


class BadInput(RankCase):
    def test_is_said_once(self):
        self.refused(self.on_ranks(3, 'study', self.folder / 'none.toml', '-o', self.out), 'none.toml')
        self.refused(self.on_ranks(3, 'study', self.file), 'no output folder')
        self.refused(self.on_ranks(3, 'study', 'status', self.shared / 'done'),
                     'study status: is the work of one process, and mpirun started 3')
        self.refused(self.on_ranks(2, 'study', 'merge', self.shared / 'done', '-o', self.out),
                     'leave mpirun out')
        self.refused(self.study_on(2, '--shard', '2/2'), 'is not i/n with')
        self.assertFalse(self.out.exists())

    def test_is_said_once_however_late_a_rank_starts(self):
        """mpirun ends those that are still starting when rank 0 has refused."""
        for _ in range(5):
            self.refused(self.on_ranks(16, 'study', 'status', self.shared / 'done'), 'leave mpirun out')

    def test_another_study_in_the_folder(self):
        out = self.finished()
        before = contents(out)
        self.file.write_text(STUDY.replace('near_path', 'path'))
        self.refused(self.study_on(3), 'holds another study')
        self.assertEqual(contents(out), before)

    def test_a_folder_that_may_not_be_written(self):
        if os.geteuid() != 0:
            self.skipTest('needs root, to be another user')
        locked = self.folder / 'locked'
        locked.mkdir(0o555)
        other = {'user': NOBODY, 'group': NOBODY, 'extra_groups': []}
        try:
            if subprocess.run([store_test.PROGRAM, '--version'], capture_output=True,
                              **other).returncode:
                raise OSError
        except OSError:
            self.skipTest('another user cannot run the program')
        self.out = locked / 'out'
        env = dict(ENVIRONMENT, TMPDIR='/tmp', HOME='/tmp')
        self.refused(self.study_on(2, env=env, **other), 'Permission denied')

    def test_a_second_job_in_the_folder(self):
        self.file.write_text(LONG)
        first = subprocess.Popen([*MPIRUN, '-n', '2', store_test.PROGRAM, 'study', self.file, '-o',
                                  self.out], env=ENVIRONMENT, text=True, stdin=subprocess.DEVNULL,
                                 stdout=subprocess.DEVNULL, stderr=subprocess.PIPE)
        for line in first.stderr:
            if 'blocks: ' in line:
                break
        self.refused(self.study_on(2), 'is being written by process')
        first.send_signal(signal.SIGTERM)
        first.communicate(timeout=60)
        self.assertFalse(list(self.folder.rglob('.vernier*')))

    def test_a_full_disk(self):
        script = ('mount -t tmpfs -o size=600k tmpfs /mnt || exit 77; mkdir /mnt/out;'
                  'for f in rig.json study.toml world.world.toml; do cp "$3/$f" /mnt/out; done;'
                  'dd if=/dev/zero of=/mnt/filler bs=1k 2>/dev/null; truncate -s -60k /mnt/filler;'
                  'mpirun --quiet --oversubscribe -n 3 "$1" study "$2" -o /mnt/out -q >&2;'
                  ' echo "code $?" >&2; rm /mnt/filler;'
                  'mpirun --quiet --oversubscribe -n 3 "$1" study "$2" -o /mnt/out -q --json')
        os.environ.update(ENVIRONMENT)
        done = shell_as_root(script, store_test.PROGRAM, self.file, self.shared / 'done')
        if done is None or done.returncode == 77:
            self.skipTest('mounting is not permitted')
        line, = ours(done.stderr)
        self.assertRegex(line, r'(no space|full)')
        self.assertIn('code 2', done.stderr)
        self.assertEqual(untimed(done.stdout), self.cells)


class WithoutMpi(store_test.Store):
    def test_it_says_once_what_to_install(self):
        if has_mpi():
            self.skipTest('built with MPI')
        for rank in range(2):
            env = dict(os.environ, OMPI_COMM_WORLD_RANK=str(rank), OMPI_COMM_WORLD_SIZE='2')
            done = self.call('study', self.file, '-o', self.out, env=env)
            self.assertEqual(done.returncode, 0 if rank else 2)
            self.assertEqual(len(done.stderr.splitlines()), 0 if rank else 1, done.stderr)
        self.complains('study', self.file, '-o', self.out, of='install Debian\'s libopenmpi-dev',
                       env=dict(env, OMPI_COMM_WORLD_RANK='0'))
        self.assertFalse(self.out.exists())


class Ends(RankCase):
    def start(self, count=3, *words):
        self.file.write_text(LONG)
        return subprocess.Popen([*MPIRUN, '-n', str(count), store_test.PROGRAM, 'study', self.file, '-o',
                                 self.out, '--threads', '1', *words], env=ENVIRONMENT, text=True,
                                stdin=subprocess.DEVNULL, stdout=subprocess.PIPE,
                                stderr=subprocess.PIPE)

    def blocks_done(self):
        done = self.works('study', 'status', self.out, '--json', '-q')
        return json.loads(done.stdout)['blocks_done']

    def test_signals_keep_what_is_done(self):
        for number in (signal.SIGINT, signal.SIGTERM):
            with self.subTest(number.name):
                shutil.rmtree(self.out, ignore_errors=True)
                running = self.start()
                for line in running.stderr:
                    if 'blocks: 6 of' in line:
                        break
                running.send_signal(number)
                said = running.communicate(timeout=60)[1]
                self.assertNotEqual(running.returncode, 0)
                self.assertRegex(said, r'vernier: ended by SIGTERM after \d+ blocks, which are stored; '
                                 'go on with: vernier study')
                self.assertGreaterEqual(self.blocks_done(), 6)

    def test_no_kill_of_a_rank_changes_a_result(self):
        done = subprocess.run([sys.executable, ROOT / 'scripts/study_kills.py', store_test.PROGRAM,
                               '--during', 'ranks', '--kills', '3'], capture_output=True, text=True)
        self.assertEqual(done.returncode, 0, done.stdout + done.stderr)
        self.assertIn('3 kills, 0 failed', done.stdout)


if __name__ == '__main__':
    store_test.PROGRAM = os.path.abspath(sys.argv.pop(1))
    unittest.main()
