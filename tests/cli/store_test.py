#!/usr/bin/env python3
# SPDX-FileCopyrightText: 2026 The Vernier authors
# SPDX-License-Identifier: Apache-2.0
"""The folder and the stores of a study from outside: who may write, what readers leave, damage.

    store_test.py PROGRAM [unittest's options]
"""
import fcntl
import json
import os
import pathlib
import random
import re
import shutil
import signal
import subprocess
import sys
import tempfile
import unittest

PROGRAM = None
STUDY = '''[study]
trials = 12
protocol = "near_path"
[world]
file = "small.world.toml"
[map]
spacing_m = 4
'''
INPUTS = ['rig.json', 'study.toml', 'world.world.toml']
NOBODY = 65534


def untimed(text):
    return [{k: v for k, v in c.items() if '_ms_' not in k} for c in json.loads(text)['cells']]


def contents(folder):
    return {path.name: path.read_bytes() for path in folder.iterdir()}


def shell_as_root(script, *words):
    """Runs a script in mount points of its own; nothing where that is not permitted."""
    if os.geteuid() != 0 or not shutil.which('unshare'):
        return None
    if subprocess.run(['unshare', '-m', 'mount', '-t', 'tmpfs', 'tmpfs', '/mnt'],
                      capture_output=True).returncode != 0:
        return None
    return subprocess.run(['unshare', '-m', 'sh', '-c', script, 'sh', *map(str, words)],
                          capture_output=True, text=True)


class Store(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.temporary = tempfile.TemporaryDirectory()
        cls.shared = pathlib.Path(cls.temporary.name)
        cls.shared.chmod(0o755)
        cls.world = cls.shared / 'small.world.toml'
        subprocess.run([PROGRAM, 'world', 'make', '--seed', '5', '--size-m', '10,8,2.5', '-o',
                        cls.world], check=True, capture_output=True)
        (cls.shared / 's.toml').write_text(STUDY)
        done = subprocess.run([PROGRAM, 'study', cls.shared / 's.toml', '-o', cls.shared / 'done',
                               '--json', '-q'], check=True, capture_output=True, text=True)
        cls.cells = untimed(done.stdout)

    @classmethod
    def tearDownClass(cls):
        cls.temporary.cleanup()

    def setUp(self):
        self.folder = pathlib.Path(tempfile.mkdtemp(dir=self.shared))
        self.folder.chmod(0o755)
        self.addCleanup(lambda: shutil.rmtree(self.folder, ignore_errors=True))
        self.file = self.folder / 's.toml'
        self.file.write_text(STUDY)
        (self.folder / 'small.world.toml').write_bytes(self.world.read_bytes())
        self.out = self.folder / 'out'

    def call(self, *words, **more):
        return subprocess.run([PROGRAM, *map(str, words)], capture_output=True, text=True, **more)

    def works(self, *words, code=0, **more):
        done = self.call(*words, **more)
        self.assertEqual(done.returncode, code, done.stderr)
        return done

    def complains(self, *words, of, **more):
        done = self.call(*words, **more)
        self.assertEqual(done.returncode, 2, done.stdout + done.stderr)
        self.assertEqual(done.stdout, '')
        line, = done.stderr.strip().splitlines()
        self.assertTrue(line.startswith('vernier: '), line)
        self.assertIn(of, line)
        return line

    def run_study(self, *words, **more):
        return self.works('study', self.file, '-o', self.out, '--json', '-q', *words, **more)

    def finished(self):
        shutil.copytree(self.shared / 'done', self.out)
        return self.out


class Readers(Store):
    def verbs(self, folder, page):
        return [('study', 'status', folder, '--json', '-q'),
                ('report', folder, '--no-proof', '-q', '-o', page),
                ('study', self.file, '-o', folder, '--json', '-q')]

    def test_a_folder_without_permission_to_write_is_read(self):
        out = self.finished()
        before = contents(out)
        for path in out.iterdir():
            path.chmod(0o444)
        out.chmod(0o555)
        pages = self.folder / 'pages'
        pages.mkdir()
        pages.chmod(0o777)
        other = {'user': NOBODY, 'group': NOBODY, 'extra_groups': []} if os.geteuid() == 0 else {}
        if other:
            try:
                reached = subprocess.run([PROGRAM, '--version'], capture_output=True, **other)
            except OSError:
                self.skipTest('another user cannot run the program')
            self.assertEqual(reached.returncode, 0)
        for words in self.verbs(out, pages / 'r.html'):
            done = self.works(*words, **other)
            if '--json' in words:
                self.assertEqual(untimed(done.stdout), self.cells)
        self.works('study', 'merge', out, '-o', pages / 'merged', '-q', **other)
        self.assertEqual(contents(out), before)
        out.chmod(0o755)

    def test_results_of_a_program_that_has_changed_or_moved_are_read(self):
        program = self.folder / 'own.py'
        program.write_text(
            'import json, sys\n'
            'nodes = json.loads(sys.stdin.readline())["nodes"]\n'
            'for _ in range(nodes):\n'
            '    sys.stdin.readline()\n'
            'print(json.dumps({"ready": True}), flush=True)\n'
            'for line in sys.stdin:\n'
            '    number = json.loads(line)["question"]\n'
            '    print(json.dumps({"question": number, "status": "unsure"}), flush=True)\n')
        self.file.write_text(STUDY + '[localiser]\nmethod = "program"\ncommand = "python3 own.py"\n')
        ran = json.loads(self.run_study(cwd=self.folder).stdout)
        told = 'the files of the program "python3 own.py" were others when the study ran'
        for change in (lambda: None, lambda: program.write_text('import sys\n')):
            change()
            elsewhere = self.works('study', 'status', self.out, '--json', cwd='/')
            self.assertIn(told, elsewhere.stderr)
            self.assertEqual(untimed(elsewhere.stdout), untimed(json.dumps(ran)))
            here = self.works('study', 'status', self.out, '--json', cwd=self.folder)
            self.assertEqual(untimed(here.stdout), untimed(json.dumps(ran)))
            self.assertEqual(told in here.stderr, program.read_text() == 'import sys\n')
        for verb in (('export', self.out, '-o', self.folder / 'cells.csv'),
                     ('report', self.out, '--no-proof', '-o', self.folder / 'r.html')):
            self.assertIn(told, self.works(*verb, cwd='/').stderr)

    def test_a_disk_mounted_for_reading_is_read(self):
        out = self.finished()
        before = contents(out)
        script = ('mount --bind "$2" "$2" && mount -o remount,ro,bind "$2" || exit 77;'
                  '"$1" study status "$2" --json -q && "$1" study "$3" -o "$2" -q >&2')
        done = shell_as_root(script, PROGRAM, out, self.file)
        if done is None or done.returncode == 77:
            self.skipTest('mounting is not permitted')
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertEqual(untimed(done.stdout), self.cells)
        self.assertEqual(contents(out), before)

    def test_nothing_is_written_where_nothing_is_missing(self):
        out = self.finished()
        before = {path.name: (path.stat().st_mtime_ns, path.stat().st_ino)
                  for path in out.iterdir()}
        self.run_study()
        self.run_study('--shard', '1/2')
        for words in self.verbs(out, self.folder / 'r.html'):
            self.works(*words)
        self.assertEqual({path.name: (path.stat().st_mtime_ns, path.stat().st_ino)
                          for path in out.iterdir()}, before)

    def test_a_folder_without_trials_says_so(self):
        out = self.finished()
        (out / 'results.sqlite').unlink()
        table = self.works('study', 'status', out).stdout
        self.assertIn('no trials are stored yet\n0 of 6 blocks done', table)
        text = self.works('study', 'status', out, '--json', '-q').stdout
        for said in (table, text):
            self.assertNotRegex(said, r'(?i)\b-?(nan|inf)\b')
        cell, = json.loads(text)['cells']
        self.assertEqual(cell['trials'], 0)
        for key in ('success', 'success_interval_binomial_95', 'coverage', 'cpu_ms_mean'):
            self.assertIsNone(cell[key])
        self.complains('report', out, '-o', self.folder / 'r.html', of='contains no finished block')


class Writers(Store):
    def test_a_second_writer_is_told(self):
        out = self.finished()
        (out / 'results.sqlite').unlink()
        before = contents(out)
        with open(out / 'results.sqlite.lock', 'w+') as lock:  # as a first one would
            lock.write('process 4711 on that machine\n')
            lock.flush()
            fcntl.lockf(lock, fcntl.LOCK_EX | fcntl.LOCK_NB)
            self.complains('study', self.file, '-o', out, '-q',
                           of='results.sqlite: is being written by process 4711 on that machine')
            (out / 'results.sqlite.lock').unlink()
        self.assertEqual(contents(out), before)

    def test_two_writers_at_once_lose_nothing(self):
        self.file.write_text(STUDY.replace('12', '48'))
        first = subprocess.Popen([PROGRAM, 'study', self.file, '-o', self.out, '--threads', '1'],
                                 stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True)
        for line in first.stderr:
            if 'blocks: ' in line:
                break
        first.send_signal(signal.SIGSTOP)
        running = json.loads(self.works('study', 'status', self.out, '--json', '-q').stdout)
        if running['blocks_done'] < running['blocks_total']:
            self.complains('study', self.file, '-o', self.out, '-q',
                           of=f'is being written by process {first.pid} on ')
        first.send_signal(signal.SIGCONT)
        first.communicate()
        self.assertEqual(first.returncode, 0)
        self.assertEqual(sorted(contents(self.out)), sorted([*INPUTS, 'results.sqlite']))
        done = json.loads(self.works('study', 'status', self.out, '--json', '-q').stdout)
        self.assertEqual(done['blocks_done'], done['blocks_total'])

    def test_killed_and_resumed_gives_the_same(self):
        self.file.write_text(STUDY.replace('12', '24'))
        for attempt in range(3):
            running = subprocess.Popen([PROGRAM, 'study', self.file, '-o', self.out],
                                       stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True)
            for line in running.stderr:
                if re.search(f'blocks: [{attempt}-9]', line):
                    break
            running.kill()
            running.communicate()
            done = json.loads(self.works('study', 'status', self.out, '--json', '-q').stdout)
            self.assertGreaterEqual(done['blocks_done'], attempt)
        resumed = self.run_study()
        self.assertEqual(sorted(contents(self.out)), sorted([*INPUTS, 'results.sqlite']))
        self.out = self.folder / 'whole'
        self.assertEqual(untimed(resumed.stdout), untimed(self.run_study().stdout))

    def test_shards_in_one_folder_start_at_once(self):
        running = [subprocess.Popen([PROGRAM, 'study', self.file, '-o', self.out, '-q', '--shard',
                                     f'{i}/3'], stdout=subprocess.DEVNULL, stderr=subprocess.PIPE,
                                    text=True) for i in range(3)]
        for shard in running:
            said = shard.communicate()[1]
            self.assertEqual((shard.returncode, said), (0, ''))
        self.assertEqual(untimed(self.works('study', 'status', self.out, '--json', '-q').stdout),
                         self.cells)
        self.assertEqual(sorted(contents(self.out)),
                         sorted([*INPUTS, *(f'results-{i}-of-3.sqlite' for i in range(3))]))

    def test_a_full_disk_is_said_and_the_run_goes_on(self):
        script = ('mount -t tmpfs -o size=600k tmpfs /mnt || exit 77; mkdir /mnt/out;'
                  'for f in rig.json study.toml world.world.toml; do cp "$3/$f" /mnt/out; done;'
                  'dd if=/dev/zero of=/mnt/filler bs=1k 2>/dev/null; truncate -s -${4}k /mnt/filler;'
                  '"$1" study "$2" -o /mnt/out -q >/mnt/../dev/null; echo "code $?" >&2;'
                  'rm /mnt/filler; "$1" study "$2" -o /mnt/out -q --json')
        for room in ('4', '60', '84'):
            done = shell_as_root(script, PROGRAM, self.file, self.shared / 'done', room)
            if done is None or done.returncode == 77:
                self.skipTest('mounting is not permitted')
            lines = done.stderr.strip().splitlines()
            self.assertEqual(len(lines), 2, done.stderr)
            self.assertRegex(lines[0], r'^vernier: .*(no space|full)')
            self.assertEqual(lines[1], 'code 2')
            self.assertEqual(done.returncode, 0, done.stderr)
            self.assertEqual(untimed(done.stdout), self.cells)


class Folders(Store):
    def test_another_study_is_refused(self):
        out = self.finished()
        before = contents(out)
        for old, new, of in (
                ('[map]', '[sources]\ncalibration = 3\n[map]',
                 'holds another study: sources.calibration is 1 there and 3 here'),
                ('near_path', 'path', 'study.protocol is near_path there and path here'),
                ('[map]', '[rig]\nfile = "other.json"\n[map]', 'the rig file differs'),
                ('trials = 12', 'trials = 12\nseed = 2', 'study.seed is 1 there and 2 here'),
                ('trials = 12', 'trials = 6', 'study.trials is 12 there and 6 here'),
                ('small.world', 'other.world', 'the world file differs')):
            self.file.write_text(STUDY.replace(old, new))
            (self.folder / 'other.world.toml').write_bytes(self.world.read_bytes() + b'\n# more\n')
            (self.folder / 'other.json').write_bytes(before['rig.json'] + b'\n')
            line = self.complains('study', self.file, '-o', out, of=of)
            self.assertIn('give another -o DIR', line)
            self.assertEqual(contents(out), before)

    def test_the_same_study_written_otherwise_goes_on(self):
        out = self.finished()
        before = contents(out)
        self.file.write_text('# the same\n' + STUDY.replace('spacing_m = 4', 'spacing_m   = 4.0')
                             + '[camera]\nheight_m = 1.2\n')
        self.assertEqual(untimed(self.run_study().stdout), self.cells)
        self.assertEqual(contents(out), before)

    def test_a_study_may_be_extended(self):
        out = self.finished()
        self.file.write_text(STUDY + '[sweep]\n"sources.calibration" = [1, 10]\n')
        cells = untimed(self.run_study().stdout)
        self.assertEqual(len(cells), 2)
        self.assertEqual(cells[0]['success'], self.cells[0]['success'])
        self.assertEqual((out / 'study.toml').read_bytes(), self.file.read_bytes())
        self.file.write_text(STUDY)
        self.complains('study', self.file, '-o', out, of='sources.calibration is 10 there and 1')
        shutil.rmtree(out)
        self.finished()
        self.file.write_text(STUDY.replace('12', '13'))
        self.assertEqual(json.loads(self.run_study().stdout)['cells'][0]['trials'], 13)

    def test_a_folder_with_other_files_is_refused(self):
        self.out.mkdir()
        (self.out / 'rig.json').write_text('my own')
        self.complains('study', self.file, '-o', self.out, of='holds other files ("rig.json")')
        self.assertEqual(contents(self.out), {'rig.json': b'my own'})
        self.complains('study', self.file, '-o', self.folder, of='holds other files')
        self.complains('study', 'merge', self.shared / 'done', '-o', self.out,
                       of='holds other files')
        self.assertEqual(contents(self.out), {'rig.json': b'my own'})

    def test_inputs_without_results_are_begun_anew(self):
        """As a killed start leaves them."""
        self.out.mkdir()
        for name in ('rig.json', 'world.world.toml'):
            shutil.copy(self.shared / 'done' / name, self.out / name)
        self.assertEqual(untimed(self.run_study().stdout), self.cells)

    def test_a_failed_start_leaves_nothing(self):
        route = self.world.read_text()
        route = route[:route.index('[[route]]')]
        (self.folder / 'no_route.world.toml').write_text(route)
        for old, new in (('small', 'missing'), ('small', 'no_route'),
                         ('[map]', '[rig]\nfile = "missing.json"\n[map]')):
            self.file.write_text(STUDY.replace(old, new))
            for out in (self.out, self.folder / 'a' / 'b'):
                self.complains('study', self.file, '-o', out, of='')
                self.assertFalse(out.exists())
                self.assertFalse((self.folder / 'a').exists())
            self.out.mkdir()
            self.complains('study', self.file, '-o', self.out, of='')
            self.assertEqual(contents(self.out), {})
            self.out.rmdir()


class Shards(Store):
    def test_slurm_variables_are_read_strictly(self):
        out = self.finished()

        def array(**variables):
            named = {f'SLURM_ARRAY_TASK_{key}': value for key, value in variables.items()}
            return {**os.environ, **named}

        for variables, of in (
                ({'ID': 'x', 'COUNT': '2'}, '_ID: "x" is not a whole number'),
                ({'ID': '', 'COUNT': '2'}, '_ID: "" is not a whole number'),
                ({'ID': '1 ', 'COUNT': '2'}, 'is not a whole number'),
                ({'ID': '+1', 'COUNT': '2'}, 'is not a whole number'),
                ({'ID': '99999999999999999999', 'COUNT': '2'}, 'is not a whole number'),
                ({'ID': '-9223372036854775808', 'MIN': '9223372036854775807', 'COUNT': '2'},
                 'is not a whole number'),
                ({'ID': '4294967296', 'COUNT': '2'}, '4294967296 is not one of 2 tasks'),
                ({'ID': '1', 'MIN': '2', 'COUNT': '2'}, '1 is not one of 2 tasks from 2'),
                ({'ID': '1', 'COUNT': '0'}, '_COUNT: 0 is not 1 to 1000000'),
                ({'ID': '1', 'COUNT': '2', 'STEP': '0'}, '_STEP: 0 is not 1 or more'),
                ({'ID': '5', 'MIN': '1', 'MAX': '7', 'COUNT': '4', 'STEP': '1'},
                 '4 tasks are not 1 to 7 in steps of 1'),
                ({'ID': '4', 'MIN': '1', 'MAX': '7', 'COUNT': '4', 'STEP': '2'},
                 '4 is not one of 4 tasks from 1 in steps of 2'),
                ({'ID': '7', 'MIN': '8', 'MAX': '2', 'COUNT': '4'}, '4 tasks are not 8 to 2'),
                ({'ID': '3'}, '_COUNT: is not set'), ({'COUNT': '3'}, '_ID: is not set')):
            self.complains('study', self.file, '-o', out, '-q', of=of, env=array(**variables))
        for shard in ('0/0', '2/2', '-1/2', '1/-2', '1', '/', '1/2/3', '1/2 ', ' 1/2', '4294967296/2',
                      '0/99999999999999999999'):
            self.complains('study', self.file, '-o', out, f'--shard={shard}', of='is not i/n with')

        done = self.works('study', self.file, '-o', self.folder / 'part', '-q', '--json', env=array(
            ID='9223372036854775807', MIN='9223372036854775805', MAX='9223372036854775807',
            STEP='2', COUNT='2'))
        self.assertEqual(json.loads(done.stdout)['blocks_done'], 3)
        self.assertTrue((self.folder / 'part' / 'results-1-of-2.sqlite').exists())

    def test_merge_refuses_another_study_and_keeps_the_target(self):
        self.file.write_text(STUDY.replace('12', '6') + '[sources]\ncalibration = 3\n')
        self.run_study()
        line = self.complains('study', 'merge', self.shared / 'done', self.out, '-o',
                              self.folder / 'merged', of='is not part of the same study as')
        self.assertIn('sources.calibration is 3 there and 1 here', line)
        self.assertFalse((self.folder / 'merged').exists())
        before = contents(self.out)
        self.complains('study', 'merge', self.shared / 'done', '-o', self.out,
                       of='holds another study')
        self.assertEqual(contents(self.out), before)

    def test_merge_adds_to_the_same_study(self):
        for i in range(2):
            self.works('study', self.file, '-o', self.folder / f'part{i}', '--shard', f'{i}/2',
                       '-q')
        self.works('study', 'merge', self.folder / 'part0', '-o', self.out, '-q', code=3)
        merged = self.works('study', 'merge', self.folder / 'part1', '-o', self.out, '-q', '--json')
        self.assertEqual(untimed(merged.stdout), self.cells)


class Damage(Store):
    def test_a_damaged_store_changes_no_result(self):
        out = self.finished()
        whole = (out / 'results.sqlite').read_bytes()
        places = random.Random(12)
        damaged = [whole[:int(len(whole) * share)] for share in (0, 0.001, 0.3, 0.999)]
        for _ in range(20):
            bits = bytearray(whole)
            bits[places.randrange(len(bits))] ^= 1 << places.randrange(8)
            damaged.append(bytes(bits))
        refused = 0
        for store in damaged:
            (out / 'results.sqlite').write_bytes(store)
            done = self.call('study', self.file, '-o', out, '--json', '-q')
            if done.returncode == 0:
                self.assertEqual(untimed(done.stdout), self.cells)
                continue
            refused += 1
            self.assertEqual(done.returncode, 2, done.stderr)
            line, = done.stderr.strip().splitlines()
            self.assertIn('results.sqlite: ', line)
            self.complains('study', 'status', out, of='results.sqlite: ')
        self.assertGreater(refused, 3)
        (out / 'results.sqlite').unlink()
        self.assertEqual(untimed(self.run_study().stdout), self.cells)

    def test_stores_of_two_kinds_of_processors_are_not_mixed(self):
        for i in range(2):
            self.works('study', self.file, '-o', self.out, '--shard', f'{i}/2', '-q')
        store = self.out / 'results-1-of-2.sqlite'
        bits = bytearray(store.read_bytes())
        at = bits.rindex(b'instruction_set')
        bits[at + 15] ^= 1
        store.write_bytes(bytes(bits))
        self.complains('study', 'status', self.out, of='results-1-of-2.sqlite: is damaged: a note has')


if __name__ == '__main__':
    PROGRAM = os.path.abspath(sys.argv.pop(1))
    unittest.main()
