#!/usr/bin/env python3
# SPDX-FileCopyrightText: 2026 The Vernier authors
# SPDX-License-Identifier: Apache-2.0
"""A disk that fills while a verb writes: one line, exit code 2, the old output whole and nothing half
written; once there is room, the same call gives the same result.

    full_disk_test.py PROGRAM [unittest's options]
"""
import json
import pathlib
import shutil
import subprocess
import sys
import unittest

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent))
sys.dont_write_bytecode = True
import cli_test
import tune_test
import verb_calls
from faults_test import MAY_MOUNT, NAMESPACE, FaultCase

PAGE_KB = 4  # a small file system gives its room in pages

# The call twice on a disk of its own: with `room` kB left, and with all of it. The inputs are links,
# the old outputs are copied there.
SCRIPT = '''
mount -t tmpfs -o size=8m none disk && cd disk || exit 77
for file in ../*; do case $file in ../disk | ../full | ../free | ../old) ;; *) ln -s "$file" . ;; esac; done
cp -r ../old/. .
dd if=/dev/zero of=filler bs=4k 2>/dev/null
truncate -s -${room}k filler
"$@" > ../full/said.out 2> ../full/said.err; echo $? > ../full/code
rm filler
for file in * .[!.]*; do test -L "$file" || test ! -e "$file" || cp -r "$file" ../full; done
"$@" > ../free/said.out 2> ../free/said.err; echo $? > ../free/code
for file in * .[!.]*; do test -L "$file" || test ! -e "$file" || cp -r "$file" ../free; done
'''


class Left:
    """What a call said and left on the disk."""

    def __init__(self, folder):
        self.code = int((folder / 'code').read_text())
        self.out, self.err = ((folder / name).read_text() for name in ('said.out', 'said.err'))
        self.folder = folder

    def files(self):
        return contents(self.folder, but=('code', 'said.out', 'said.err'))


def contents(folder, but=()):
    """Of its files, by their names in it."""
    return {str(file.relative_to(folder)): file.read_bytes() for file in folder.rglob('*')
            if file.is_file() and str(file.relative_to(folder)) not in but}


def pages_kb(files):
    """The room that such files take."""
    return sum(-(-len(content) // (1024 * PAGE_KB)) * PAGE_KB for content in files.values())


@unittest.skipUnless(MAY_MOUNT, 'no permission to mount a small file system')
class FullDisk(FaultCase):
    def on_disk(self, room_kb, words, old=None):
        """Where the disk has so much room left, and where it has enough afterwards."""
        for name in ('disk', 'full', 'free', 'old'):
            shutil.rmtree(self.folder / name, ignore_errors=True)
            (self.folder / name).mkdir()
        for name, content in (old or {}).items():
            (self.folder / 'old' / name).parent.mkdir(parents=True, exist_ok=True)
            (self.folder / 'old' / name).write_bytes(content)
        run = subprocess.run([*NAMESPACE, 'sh', '-c', f'room={room_kb}; {SCRIPT}', 'sh', cli_test.PROGRAM,
                              *map(str, words)], cwd=self.folder, capture_output=True, text=True, timeout=300)
        self.assertEqual((run.returncode, run.stderr), (0, ''))
        return Left(self.folder / 'full'), Left(self.folder / 'free')

    def made_by(self, words, output):
        """What the call writes where there is room, which is removed."""
        done = self.run_in_folder(*words)
        self.assertEqual(done.returncode, 0, done.stderr)
        at = self.folder / output
        made = contents(self.folder / output) if at.is_dir() else {'': at.read_bytes()}
        made = {f'{output}/{name}'.rstrip('/'): content for name, content in made.items()}
        shutil.rmtree(at) if at.is_dir() else at.unlink()
        return made

    def expect_full(self, left):
        self.assertEqual(left.code, 2, left.err)
        self.assertEqual(left.err.count('\n'), 1, left.err)
        self.assertRegex(left.err, r'^vernier: .*(No space left on device|is full|no space)')
        self.assertEqual(left.out, '')

    def expect_old_or_new(self, words, output):
        """The disk fills when so much of the output is written: nothing new is left then, not even
        where an older output is replaced."""
        whole = self.made_by(words, output)
        size_kb = pages_kb(whole)
        self.assertGreaterEqual(size_kb, 8 * PAGE_KB, 'too small an output to fill a disk with')
        for part, old in ((0.3, {}), (0.7, {name: b'old\n' for name in whole})):
            room_kb = round(part * size_kb / PAGE_KB) * PAGE_KB
            with self.subTest(output=output, room_kb=room_kb, of=size_kb, old=bool(old)):
                full, free = self.on_disk(room_kb, words, old)
                self.expect_full(full)
                self.assertEqual(full.files(), old)
                self.assertEqual((free.code, free.err), (0, ''))
                self.assertEqual(free.files(), whole)

    def test_map_make(self):
        views = [json.loads(line) for line in verb_calls.features().splitlines()]
        with open(self.folder / 'many.jsonl', 'w') as file:
            for i in range(100):
                file.write(json.dumps({**views[i % 5], 'pose': [0.5 * i, 0, 0]}) + '\n')
        self.expect_old_or_new(['map', 'make', '--features', 'many.jsonl', '--rig', 'nominal', '-o',
                                'out.map', '-q'], 'out.map')

    def test_render(self):
        self.expect_old_or_new(['render', '--world', 'posts.world.toml', '--rig', 'rig.json', '--pose',
                                '3,2,90', '--pose', '3.5,2,90', '--samples', '1', '-o', 'out', '-q'], 'out')

    def test_export(self):
        self.assertEqual(self.run_in_folder('study', 'study.toml', '-o', 'done', '-q').returncode, 0)
        for ending in ('csv', 'npy'):
            self.expect_old_or_new(['export', 'done', '--trials', '-o', f'out.{ending}', '-q'],
                                   f'out.{ending}')

    def test_tune_goes_on_to_the_same_end(self):
        words = ['tune', 'tune.toml', '-o', 'out', '--threads', '1', '-q']
        whole = self.made_by(words, 'out')
        size_kb = pages_kb(whole)
        found = tune_test.untimed(json.loads(whole['out/tune.json']))
        for part in (0.25, 0.5, 0.75):
            room_kb = round(part * size_kb / PAGE_KB) * PAGE_KB
            with self.subTest(room_kb=room_kb, of=size_kb):
                full, free = self.on_disk(room_kb, words)
                self.expect_full(full)
                self.assertNotIn('out/tune.json', full.files())
                self.assertEqual((free.code, free.err), (0, ''))
                self.assertEqual(tune_test.untimed(json.loads(free.files()['out/tune.json'])), found)
                # The log of a store that could not be closed stays beside it, until it is written again.
                self.assertEqual({name for name in free.files() if not name.endswith(('-wal', '-shm'))},
                                 set(whole))

    def test_a_tune_that_is_done_keeps_its_result(self):
        """Where only tune.json is written again, on a disk without room."""
        words = ['tune', 'tune.toml', '-o', 'out', '--threads', '1', '-q']
        old = self.made_by(words, 'out')
        full, free = self.on_disk(0, words, old)
        self.expect_full(full)
        self.assertEqual(full.files(), old)
        self.assertEqual(free.code, 0, free.err)


if __name__ == '__main__':
    cli_test.PROGRAM = str(pathlib.Path(sys.argv.pop(1)).resolve())
    unittest.main()
