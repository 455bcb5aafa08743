#!/usr/bin/env python3
# SPDX-FileCopyrightText: 2026 The Vernier authors
# SPDX-License-Identifier: Apache-2.0
"""The program on a failing machine: full disks, missing permissions, signals, other writers, planted
links. Outputs are whole or not there, and every fault is one line.

    faults_test.py PROGRAM [unittest's options]
"""
import hashlib
import json
import os
import pathlib
import re
import shutil
import signal
import subprocess
import sys
import time
import unittest

sys.dont_write_bytecode = True
import cli_test
import verb_calls
from cli_test import Case, vernier

NAMESPACE = ['unshare', '--mount'] if os.geteuid() == 0 else ['unshare', '--user', '--map-root-user',
                                                               '--mount']
MAY_MOUNT = subprocess.run([*NAMESPACE, 'mount', '-t', 'tmpfs', 'none', '/mnt'],
                           capture_output=True).returncode == 0
MATCHER = '''#!/bin/sh
# a disparity map of 200 x 120 zeros: left, right, output
ls -l /proc/self/fd >&2
{ printf 'Pf\\n200 120\\n-1\\n'; head -c 96000 /dev/zero; } > "$3"
'''


class FaultCase(Case):
    def setUp(self):
        super().setUp()
        verb_calls.write_inputs(self.folder, cli_test.PROGRAM)
        self.inputs = {str(file.relative_to(self.folder)) for file in self.folder.rglob('*')}

    def made(self):
        """What is in the folder besides the inputs."""
        return {str(file.relative_to(self.folder)) for file in self.folder.rglob('*')
                if str(file.relative_to(self.folder)) not in self.inputs}

    def run_in_folder(self, *words, **more):
        return subprocess.run([cli_test.PROGRAM, *map(str, words)], cwd=self.folder,
                              capture_output=True, text=True, timeout=200, **more)

    def fails_in_one_line(self, done, *parts):
        self.assertEqual(done.returncode, 2, done.stderr)
        lines = done.stderr.strip().splitlines()
        self.assertEqual(len(lines), 1, done.stderr)
        self.assertTrue(lines[0].startswith('vernier: '), lines[0])
        for part in parts:
            self.assertIn(part, lines[0])


class Disk(FaultCase):
    def on_small_disk(self, size, *words, before='', after=''):
        """Runs the program in a file system of `size`, in which the inputs are links. Returns the run and
        the names left there."""
        disk = self.folder / 'disk'
        disk.mkdir(exist_ok=True)
        script = (f'mount -t tmpfs -o size={size} none disk && cd disk && {before} '
                  f'for file in ../*.* ../{" ../".join(verb_calls.FOLDERS)}; do '
                  'test -e "${file#../}" || ln -s "$file" . ; done; "$@"; code=$?; '
                  'find . -mindepth 1 ! -type l > ../left; '
                  f'test -f old && cat old > ../old_now; {after} exit $code')
        done = subprocess.run([*NAMESPACE, 'sh', '-c', script, 'sh', cli_test.PROGRAM,
                               *map(str, words)],
                              cwd=self.folder, capture_output=True, text=True, timeout=200)
        return done, (self.folder / 'left').read_text().split()

    @unittest.skipUnless(MAY_MOUNT, 'no permission to mount a small file system')
    def test_a_full_disk_leaves_nothing_new(self):
        for call in verb_calls.calls():
            if not call.outputs or call.name.startswith('study') and call.grows:
                continue
            with self.subTest(verb=call.name):
                call.prepare(self.folder)
                pages = 1 + sum(-(-(self.folder / name).stat().st_size // 4096) for name in call.changes)
                copies = ''.join(f'cp ../{name} .; ' for name in call.changes)
                same = ''.join(f'cmp {name} ../{name} || exit 99; ' for name in call.changes)
                done, left = self.on_small_disk(f'{4 * pages}k', *call.words, after=same,
                                                before=copies + 'head -c 4096 /dev/zero > old;')
                self.assertEqual(done.returncode, 2, done.stderr)
                self.assertIn('No space left on device', done.stderr.splitlines()[-1])
                self.assertEqual(sorted(left), sorted(f'./{name}' for name in ('old', *call.changes)))

    @unittest.skipUnless(MAY_MOUNT, 'no permission to mount a small file system')
    def test_a_disk_that_fills_while_writing_keeps_the_old_file(self):
        done, left = self.on_small_disk('64k', 'sample', 'nominal', '-n', 5000, '-q', '-o', 'old',
                                        before='echo kept > old;')
        self.fails_in_one_line(done, 'old: cannot be written: No space left on device', 'free space')
        self.assertEqual(left, ['./old'])
        self.assertEqual((self.folder / 'old_now').read_text(), 'kept\n')
        done, left = self.on_small_disk('16k', 'uncertainty', 'rig.json', '--distances-m', '1,inf',
                                        '--grid', '6x4', '-o', 'out', '-q')
        self.fails_in_one_line(done, 'No space left on device')
        self.assertEqual(left, [])

    @unittest.skipUnless(MAY_MOUNT, 'no permission to mount a small file system')
    def test_a_full_temporary_folder_is_named(self):
        matcher = self.folder / 'matcher.sh'
        matcher.write_text(MATCHER)
        done = subprocess.run(
            [*NAMESPACE, 'sh', '-c', 'mkdir t && mount -t tmpfs -o size=8k none t && TMPDIR=$PWD/t '
             'exec "$@"', 'sh', cli_test.PROGRAM, 'evaluate', '--left', 'left.pgm', '--right',
             'right.pgm', '--truth', 'truth.pgm', '--truth-scale', '4', '--max-disparity', '20', '-q',
             '--command', 'sh matcher.sh {left} {right} {output}.pfm'],
            cwd=self.folder, capture_output=True, text=True, timeout=100)
        self.fails_in_one_line(done, 'TMPDIR', 'No space left on device')

    def test_a_limit_on_the_size_of_files_is_said(self):
        done = subprocess.run(['sh', '-c', 'ulimit -f 8; exec "$@"', 'sh', cli_test.PROGRAM, 'sample',
                               'nominal', '-n', '5000', '-q', '-o', 'out.csv'],
                              cwd=self.folder, capture_output=True, text=True)
        self.fails_in_one_line(done, 'out.csv', 'File too large', 'ulimit -f')
        self.assertEqual(self.made(), set())

    def test_few_descriptors_suffice_for_many_files(self):
        done = subprocess.run(['sh', '-c', 'ulimit -n 16; exec "$@"', 'sh', cli_test.PROGRAM,
                               'uncertainty', 'rig.json', '--distances-m', '1,2,3,4,inf', '--grid',
                               '3x2', '-o', 'out'], cwd=self.folder, capture_output=True, text=True)
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertGreater(len(self.made()), 20)


class OtherCase(FaultCase):
    """As somebody who may not write everywhere; root becomes nobody for it."""

    def setUp(self):
        super().setUp()
        self.others = []
        if os.geteuid() == 0:
            if not shutil.which('setpriv'):
                self.skipTest('root may write everywhere, and there is no setpriv')
            self.others = ['setpriv', '--reuid=65534', '--regid=65534', '--clear-groups']
            self.folder.chmod(0o777)
            if subprocess.run([*self.others, 'test', '-x', cli_test.PROGRAM]).returncode != 0:
                self.skipTest('the program is in a folder of root')

    def run_as_other(self, *words, **more):
        return subprocess.run([*self.others, cli_test.PROGRAM, *map(str, words)], cwd=self.folder,
                              capture_output=True, text=True, **more)


class Permission(OtherCase):
    def test_a_folder_that_may_not_be_written(self):
        locked = self.folder / 'locked'
        locked.mkdir()
        (locked / 'out.csv').write_text('kept')
        locked.chmod(0o555)
        done = self.run_as_other('sample', 'nominal', '-n', 5, '-o', 'locked/out.csv')
        self.fails_in_one_line(done, 'locked/out.csv: cannot be written: Permission denied')
        self.assertEqual((locked / 'out.csv').read_text(), 'kept')
        for words in (('uncertainty', 'rig.json', '-o', 'locked/new'),
                      ('study', 'study.toml', '-o', 'locked/new'),
                      ('stereo', '--rig', 'rig.json', '--left', 'left.pgm', '--right', 'right.pgm',
                       '--max-disparity', '20', '-o', 'locked/new', '-q')):
            with self.subTest(verb=words[0]):
                self.fails_in_one_line(self.run_as_other(*words), 'locked', 'Permission denied')
        locked.chmod(0o755)

    def test_two_outputs_of_which_one_may_not_be_written(self):
        (self.folder / 'locked').mkdir(0o555)
        done = self.run_as_other('match', '--left', 'left.pgm', '--right', 'right.pgm', '--prior',
                                 'rig.json', '--picture', 'out.png', '-o', 'locked/out.csv', '-q')
        self.fails_in_one_line(done, 'locked/out.csv', 'Permission denied')
        self.assertEqual(self.made(), {'locked'})

    def test_an_input_that_may_not_be_read(self):
        (self.folder / 'rig.json').chmod(0)
        done = self.run_as_other('sample', 'rig.json', '-n', 5, '-o', 'out.csv')
        self.fails_in_one_line(done, 'rig.json', 'Permission denied')

    def test_a_temporary_folder_that_is_missing_or_locked(self):
        (self.folder / 'locked').mkdir(0o555)
        (self.folder / 'matcher.sh').write_text(MATCHER)
        for name, why in (('locked', 'Permission denied'), ('none', 'No such file'),
                          ('rig.json', 'Not a directory')):
            with self.subTest(name):
                done = self.run_as_other(
                    'evaluate', '--left', 'left.pgm', '--right', 'right.pgm', '--truth', 'truth.pgm',
                    '--truth-scale', '4', '--max-disparity', '20', '-q', '--command',
                    'sh matcher.sh {left} {right} {output}.pfm',
                    env=dict(os.environ, TMPDIR=str(self.folder / name)))
                self.fails_in_one_line(done, str(self.folder / name), 'TMPDIR', why)


class EarlyOutputs(OtherCase):
    """An output that cannot be written is found before anything is read: here are no inputs."""
    READ_FIRST = {'convert'}  # the format of its input says whether it writes a file or a folder
    ENDINGS = ('csv', 'html', 'json', 'jsonl', 'map', 'npy', 'ply', 'png', 'segments', 'svg', 'toml',
               'txt', 'vnl')

    def setUp(self):
        super().setUp()
        self.empty = self.folder / 'empty'
        self.empty.mkdir()
        self.empty.chmod(0o777)
        for name in ('folder', *('folder.' + ending for ending in self.ENDINGS)):
            (self.empty / name).mkdir()
        (self.empty / 'a_file').write_text('kept')
        (self.empty / 'locked').mkdir(0o555)

    def test_bad_outputs_are_found_first(self):
        files = (('folder', 'is a folder'), ('none/out', 'No such file or directory'),
                 ('locked/out', 'Permission denied'), ('a_file/out', 'Not a directory'))
        folders = (('a_file', 'is no folder'), ('a_file/out', ''), ('locked', 'Permission denied'),
                   ('locked/a/b', 'Permission denied'))
        verbs, before = 0, sorted(self.empty.rglob('*'))
        for call in verb_calls.calls():
            if not call.outputs or call.words[0] in self.READ_FIRST:
                continue
            verbs += 1
            for output in call.outputs:
                for bad, why in files if '.' in output else folders:
                    if call.words[0] == 'study' and call.grows and bad == 'locked':
                        continue  # it may hold the results already: then nothing is written
                    with self.subTest(verb=call.name, output=output, bad=bad):
                        bad += pathlib.Path(output).suffix
                        words = [bad if word == output else str(word) for word in call.words]
                        done = subprocess.run([*self.others, cli_test.PROGRAM, *words],
                                              cwd=self.empty, capture_output=True, text=True)
                        self.fails_in_one_line(done, f'vernier: {bad}: ', why)
                        self.assertEqual(done.stdout, '')
        self.assertGreater(verbs, 25)
        self.assertEqual(sorted(self.empty.rglob('*')), before)


class Names(FaultCase):
    def test_planted_links_are_not_followed(self):
        victim = self.folder / 'victim'
        victim.write_text('untouched')
        for call in verb_calls.calls():
            plain = [name for name in call.outputs if '.' in name]
            if not plain:
                continue
            call.prepare(self.folder)

            def plant():
                for name in plain:
                    os.symlink('victim', self.folder / f'{name}.{os.getpid()}.tmp')
            with self.subTest(verb=call.name):
                done = self.run_in_folder(*call.words, preexec_fn=plant)
                self.assertEqual(done.returncode, call.code, done.stderr)
                self.assertEqual(victim.read_text(), 'untouched')
                self.assertFalse(any((self.folder / name).is_symlink() for name in plain))

    def test_devices_folders_and_inputs_are_no_outputs(self):
        os.mkfifo(self.folder / 'pipe')
        (self.folder / 'folder').mkdir()
        for name, part in (('/dev/null', 'not a regular file'), ('/dev/full', 'not a regular file'),
                           ('pipe', 'not a regular file'), ('folder', 'is a folder'),
                           ('/dev/stdout', 'not a regular file'), ('rig.json', 'input')):
            with self.subTest(name):
                self.fails_in_one_line(
                    self.run_in_folder('sample', 'rig.json', '-n', 5, '-q', '-o', name), name, part)
        self.assertTrue(pathlib.Path('/dev/null').is_char_device())

    def test_no_library_is_taken_from_the_current_folder(self):
        needed = subprocess.run(['ldd', cli_test.PROGRAM], capture_output=True, text=True,
                                check=True).stdout
        names = re.findall(r'^\s*(lib\S+) => ', needed, re.MULTILINE)
        self.assertTrue(names)
        if any(name.startswith('libvernier') for name in names):
            self.skipTest('built with shared libraries, which CMake finds by a folder of the build')
        for name in names:
            (self.folder / name).write_bytes(b'')
        done = self.run_in_folder('--version')
        self.assertEqual((done.returncode, done.stderr), (0, ''))

    def test_a_loop_of_links_is_named(self):
        os.symlink('b.csv', self.folder / 'a.csv')
        os.symlink('a.csv', self.folder / 'b.csv')
        self.fails_in_one_line(
            self.run_in_folder('sample', 'rig.json', '-n', 5, '-q', '-o', 'a.csv'), 'a.csv')

    def test_the_replaced_file_hands_on_its_permissions(self):
        out = self.folder / 'out.csv'
        out.write_text('old')
        out.chmod(0o640)
        self.assertEqual(self.run_in_folder('sample', 'nominal', '-n', 5, '-o', out).returncode, 0)
        self.assertEqual(out.stat().st_mode & 0o7777, 0o640)
        out.unlink()
        self.run_in_folder('sample', 'nominal', '-n', 5, '-o', out, preexec_fn=lambda: os.umask(0o77))
        self.assertEqual(out.stat().st_mode & 0o7777, 0o600)

    def test_two_outputs_of_convert_are_all_or_none(self):
        (self.folder / 'models').mkdir()
        left = self.folder / 'models/left.cameramodel'
        left.write_text('old')
        (self.folder / 'models/right.cameramodel').mkdir()
        done = self.run_in_folder('convert', 'rig.json', '--to', 'mrcal', '-o', 'models/')
        self.fails_in_one_line(done, 'right.cameramodel')
        self.assertEqual(left.read_text(), 'old')
        self.assertEqual(len(self.made()), 3)

    def test_pipes_are_read(self):
        reference = self.run_in_folder('sample', 'rig.json', '-n', 5, '-o', 'one.csv')
        self.assertEqual(reference.returncode, 0)
        done = subprocess.run(['bash', '-c', '"$0" sample <(cat rig.json) -n 5 -o two.csv',
                               cli_test.PROGRAM], cwd=self.folder, capture_output=True, text=True)
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertEqual((self.folder / 'one.csv').read_bytes(),
                         (self.folder / 'two.csv').read_bytes())
        os.mkfifo(self.folder / 'pipe.json')
        with subprocess.Popen(['sh', '-c', 'cat rig.json > pipe.json'], cwd=self.folder) as writer:
            done = self.run_in_folder('convert', 'pipe.json', '--to', 'opencv', '-o', 'r.yml')
            self.assertEqual(done.returncode, 0, done.stderr)
            writer.wait()
        # read twice: to tell the format, and for the rig
        os.mkfifo(self.folder / 'pipe.yml')
        with subprocess.Popen(['sh', '-c', 'cat r.yml > pipe.yml'], cwd=self.folder) as writer:
            done = self.run_in_folder('convert', 'pipe.yml', '-o', 'r1.json')
            self.assertEqual(done.returncode, 0, done.stderr)
            writer.wait()
        self.assertEqual(self.run_in_folder('convert', 'r.yml', '-o', 'r2.json').returncode, 0)
        self.assertEqual((self.folder / 'r1.json').read_bytes(),
                         (self.folder / 'r2.json').read_bytes())


class Writers(FaultCase):
    def test_several_writers_of_one_file(self):
        whole = set()
        for seed in range(4):
            self.run_in_folder('sample', 'nominal', '-n', 300, '--seed', seed, '-o', f'{seed}.csv')
            whole.add(hashlib.sha256((self.folder / f'{seed}.csv').read_bytes()).digest())
        self.inputs.update(f'{seed}.csv' for seed in range(4))
        running = [subprocess.Popen([cli_test.PROGRAM, 'sample', 'nominal', '-n', '300', '--seed',
                                     str(seed % 4), '-o', 'out.csv', '-q'], cwd=self.folder,
                                    stdout=subprocess.DEVNULL)
                   for seed in range(8)]
        self.assertEqual([process.wait() for process in running], [0] * 8)
        self.assertIn(hashlib.sha256((self.folder / 'out.csv').read_bytes()).digest(), whole)
        self.assertEqual(self.made(), {'out.csv'})

    def test_several_writers_of_one_folder(self):
        running = [subprocess.Popen([cli_test.PROGRAM, 'uncertainty', 'rig.json', '--distances-m',
                                     '1,inf', '--grid', '6x4', '-o', 'out', '-q'], cwd=self.folder,
                                    stdout=subprocess.DEVNULL) for _ in range(3)]
        self.assertEqual([process.wait() for process in running], [0] * 3)
        self.assertFalse(list(self.folder.rglob('*.tmp')))
        json.loads((self.folder / 'out/uncertainty.json').read_text())


class Signals(FaultCase):
    # cells enough for seconds, though each block is quick
    LONG = verb_calls.STUDY.replace('trials = 120', 'trials = 20000')

    def disturbed(self, words, signals, wait_for, **more):
        """Starts the program, sends the signals once wait_for() is true. Returns the ended run."""
        process = subprocess.Popen([cli_test.PROGRAM, *map(str, words)], cwd=self.folder, text=True,
                                   stdout=subprocess.PIPE, stderr=subprocess.PIPE, **more)
        limit = time.monotonic() + 60
        while not wait_for() and process.poll() is None and time.monotonic() < limit:
            time.sleep(0.002)
        for number in signals:
            process.send_signal(number)
        out, said = process.communicate(timeout=100)
        return subprocess.CompletedProcess(words, process.returncode, out, said)

    def is_writing(self):
        return any(self.folder.rglob('.vernier-*.tmp'))

    def test_signals_remove_temporary_files(self):
        (self.folder / 'out.csv').write_text('kept')
        for number in (signal.SIGINT, signal.SIGTERM, signal.SIGHUP):
            with self.subTest(number.name):
                done = self.disturbed(['sample', 'nominal', '-n', 500000, '-o', 'out.csv', '-q'],
                                      [number], self.is_writing)
                self.assertEqual(done.returncode, -number)
                self.assertEqual(done.stderr,
                                 f'vernier: ended by {number.name}; unfinished files are removed\n')
                self.assertEqual(self.made(), {'out.csv'})
                self.assertEqual((self.folder / 'out.csv').read_text(), 'kept')

    def test_an_ignored_signal_stays_ignored(self):
        done = self.disturbed(['sample', 'nominal', '-n', 20000, '-o', 'out.csv', '-q'],
                              [signal.SIGHUP], self.is_writing,
                              preexec_fn=lambda: signal.signal(signal.SIGHUP, signal.SIG_IGN))
        self.assertEqual(done.returncode, 0, done.stderr)

    def test_a_study_ends_at_a_block_and_goes_on(self):
        (self.folder / 'long.toml').write_text(self.LONG)
        self.inputs.add('long.toml')

        def store():
            return any((self.folder / 'out').glob('results.sqlite*'))
        self.inputs.add('out')
        for number in (signal.SIGINT, signal.SIGTERM, signal.SIGHUP):
            with self.subTest(number.name):
                shutil.rmtree(self.folder / 'out', ignore_errors=True)
                done = self.disturbed(['study', 'long.toml', '-o', 'out', '-q', '--threads', '2'],
                                      [number], store)
                self.assertEqual(done.returncode, -number, done.stderr)
                self.assertRegex(done.stderr, rf'^vernier: ended by {number.name} after \d+ blocks, '
                                 r'which are stored; go on with: vernier study long\.toml -o out -q '
                                 r'--threads 2\n$')
                self.assertFalse(self.is_writing())
        shutil.rmtree(self.folder / 'out', ignore_errors=True)  # gone if no block was done
        done = self.disturbed(['study', 'long.toml', '-o', 'out', '-q', '--threads', '2'],
                              [signal.SIGTERM, signal.SIGTERM], store)
        self.assertEqual(done.returncode, -signal.SIGTERM, done.stderr)

    def test_an_interrupted_study_has_the_same_results(self):
        (self.folder / 'some.toml').write_text(self.LONG.replace('20000', '2000'))
        self.assertEqual(self.run_in_folder('study', 'some.toml', '-o', 'whole').returncode, 0)
        for after_s in (0.1, 0.3, 0.2):
            end = time.monotonic() + after_s
            self.disturbed(['study', 'some.toml', '-o', 'parts', '-q', '--threads', '1'],
                           [signal.SIGINT], lambda: time.monotonic() > end)
        results = []
        for folder in ('parts', 'whole'):
            done = self.run_in_folder('study', 'some.toml', '-o', folder, '--json')
            cells = json.loads(done.stdout)['cells']
            results.append([{k: v for k, v in cell.items() if '_ms_' not in k} for cell in cells])
        self.assertEqual(*results)

    def test_the_child_ends_with_the_program(self):
        (self.folder / 'slow.sh').write_text('echo $$ > started; sleep 60; true\n')
        (self.folder / 'tmp').mkdir()
        self.inputs |= {'slow.sh', 'tmp', 'started'}
        for limit in ([], ['--time-limit-s', '50']):
            with self.subTest(limit=limit):
                (self.folder / 'started').unlink(missing_ok=True)
                done = self.disturbed(
                    ['evaluate', '--left', 'left.pgm', '--right', 'right.pgm', '--truth', 'truth.pgm',
                     '--truth-scale', '4', '--max-disparity', '20', '-q', *limit, '--command',
                     'sh slow.sh {left} {right} {output}.pfm'], [signal.SIGTERM],
                    lambda: (self.folder / 'started').exists(),
                    env=dict(os.environ, TMPDIR=str(self.folder / 'tmp')))
                self.assertEqual(done.returncode, -signal.SIGTERM)
                self.assertEqual(os.listdir(self.folder / 'tmp'), [])
                child = (self.folder / 'started').read_text().strip()
                time.sleep(0.2)
                self.assertFalse(child and pathlib.Path(f'/proc/{child}/exe').exists())


class Children(FaultCase):
    def test_children_inherit_no_descriptor_and_no_signal(self):
        """Of every kind of program of the user's that a verb starts: they end at once, after a look
        round. (The reader of meshes is the program itself, and mrcal's script is Vernier's.)"""
        look = 'sh look.sh'
        (self.folder / 'look.sh').write_text(
            'ls /proc/self/fd > seen; grep -E "SigBlk|SigIgn" /proc/self/status >> seen; exit 1\n')
        (self.folder / 'own.study.toml').write_text(
            verb_calls.STUDY + f'[localiser]\nmethod = "program"\ncommand = "{look}"\n')
        pair = ('--left', 'left.pgm', '--right', 'right.pgm')
        calls = {
            'matcher': ('evaluate', *pair, '--truth', 'truth.pgm', '--truth-scale', '4', '--max-disparity',
                        '20', '-q', '--command', look + ' {left} {right} {output}.pfm'),
            'localiser': ('localise', 'known.map', '--features', 'views.jsonl', '--rig', 'nominal',
                          '--method', 'program', '--command', look),
            'localiser of a study': ('study', 'own.study.toml', '--threads', '1', '-o', 'own'),
            'source': ('servo', '--trials', '1', '--source', 'command=' + look),
            'controller': ('drive', '--pose', '10,7.5,0', '--command', look)}
        for name, words in calls.items():
            with self.subTest(name), open(self.folder / 'rig.json') as extra:
                self.run_in_folder(*words, pass_fds=[extra.fileno()])
                seen = (self.folder / 'seen').read_text().split()
                (self.folder / 'seen').unlink()
                self.assertEqual(seen[:seen.index('SigBlk:')], ['0', '1', '2', '3'])  # 3: of ls itself
                usual = (1 << 31) - 1  # the others are glibc's own
                self.assertEqual([int(word, 16) & usual for word in (seen[-3], seen[-1])], [0, 0])


class Codecs(FaultCase):
    def test_image_codecs_that_cannot_be_loaded(self):
        """Empty files in their place: what reads no image works, the others say so."""
        (self.folder / 'empty').mkdir()
        names = {file.name for folder in ('/usr/lib', '/usr/local/lib', '/lib64')
                 for file in pathlib.Path(folder).rglob('libopencv_imgcodecs.so.*')}
        for name in names:
            (self.folder / 'empty' / name).touch()
        env = dict(os.environ, LD_LIBRARY_PATH=str(self.folder / 'empty'))
        if not names or self.run_in_folder('--version', env=env).returncode != 0:
            self.skipTest('the image codecs are linked, or are in an unusual place')
        for words in (('detect', '--left', cli_test.IMAGES / 'left01.jpg', '--board', '9x6', '-o', 'c.vnl'),
                      ('stereo', '--rig', 'rig.json', '--left', 'left.pgm', '--right', 'right.pgm', '-o', 'out')):
            with self.subTest(words[0]):
                done = self.run_in_folder(*words, env=env)
                self.fails_in_one_line(done, 'libopencv_imgcodecs', 'cannot be loaded', 'install')
        self.assertEqual(self.made(), {'empty'} | {f'empty/{name}' for name in names})
        found = json.loads(self.run_in_folder('doctor', '--json', env=env).stdout)['findings']
        codecs = next(one for one in found if 'codecs' in one['what'])
        self.assertFalse(codecs['found'])
        self.assertIn('cannot be loaded', codecs['value'])


class Kills(Case):
    def test_no_kill_leaves_a_half_output(self):
        script = cli_test.ROOT / 'scripts/fault_trials.py'
        verbs = [call.name for call in verb_calls.calls() if call.outputs]
        done = subprocess.run([sys.executable, script, cli_test.PROGRAM, '--kills', str(len(verbs))],
                              capture_output=True, text=True)
        self.assertEqual(done.returncode, 0, done.stdout + done.stderr)
        self.assertIn(f'{len(verbs)} kills, 0 trials failed', done.stdout)
        for verb in verbs:
            self.assertRegex(done.stdout, rf'(?m)^{verb} ')


if __name__ == '__main__':
    cli_test.PROGRAM = str(pathlib.Path(sys.argv.pop(1)).resolve())
    unittest.main()
