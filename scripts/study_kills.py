#!/usr/bin/env python3
# SPDX-FileCopyrightText: 2026 The Vernier authors
# SPDX-License-Identifier: Apache-2.0
"""Kills a study (SIGKILL) at random moments, runs the same command again, and compares.

    study_kills.py PROGRAM --during study|merge|ranks [--kills 50] [--seed 1] [--ranks 4]

study   One process of two threads; it is killed until it ends by itself, and begun anew.
merge   `study merge` of four shards into a folder of its own each time.
ranks   One rank of several under mpirun, any of them; mpirun then ends the others.
After each kill the store must be readable or say that it was interrupted; in the end all results must
be those of a run that nobody killed, timings apart. The moment is drawn uniformly over the time that
the undisturbed command takes, so that most kills meet a process at work; how many did is printed. Exit
code 1 if one failed.
"""
import argparse
import contextlib
import json
import os
import pathlib
import random
import shutil
import signal
import sqlite3
import subprocess
import sys
import tempfile
import time

STUDY = '''[study]
trials = {trials}
protocol = "near_path"
[world]
file = "small.world.toml"
[map]
spacing_m = 4
[sweep]
"sources.calibration" = [0, 3]
'''
TIMES = slice(13, 15)  # of a trial's fields


def rows(store):
    with contextlib.closing(sqlite3.connect(store)) as database:
        found = database.execute('SELECT cell, block, trials, answered, successes, results'
                                 ' FROM trial_block ORDER BY cell, block').fetchall()
    result = []
    for row in found:
        trials = json.loads(row[5])
        for trial in trials:
            del trial[TIMES]
        result.append((*row[:5], trials))
    return result


def untimed(text):
    return [{key: value for key, value in cell.items() if '_ms_' not in key}
            for cell in json.loads(text)['cells']]


class Kills:
    def __init__(self, options, folder):
        self.program = str(pathlib.Path(options.program).resolve())
        self.ranks, self.folder, self.chance = options.ranks, folder, random.Random(options.seed)
        self.during = options.during
        # each rank starts anew, so that its work must last longer than the start
        trials = {'study': 240, 'merge': 240, 'ranks': 600}[self.during]
        self.file = folder / 's.toml'
        self.file.write_text(STUDY.format(trials=trials))
        self.call('world', 'make', '--seed', '5', '--size-m', '10,8,2.5', '-o',
                  folder / 'small.world.toml')
        self.whole = folder / 'whole'
        self.cells = untimed(self.call('study', self.file, '-o', self.whole, '--json'))
        self.rows = rows(self.whole / 'results.sqlite')
        self.met, self.failed = 0, []
        if self.during == 'merge':
            self.parts = [folder / f'part{i}' for i in range(4)]
            for i, part in enumerate(self.parts):
                self.call('study', self.file, '-o', part, '--shard', f'{i}/4')
        start = time.monotonic()
        self.finish(self.start(folder / 'timed'))
        self.seconds = time.monotonic() - start

    def call(self, *words):
        return subprocess.run([self.program, *map(str, words), '-q'], check=True,
                              capture_output=True, text=True).stdout

    def start(self, out):
        words = {'study': [self.program, 'study', self.file, '-o', out, '--threads', '2'],
                 'merge': [self.program, 'study', 'merge', *getattr(self, 'parts', []), '-o', out],
                 'ranks': ['mpirun', '--oversubscribe', '--bind-to', 'none', '-n', self.ranks,
                           self.program, 'study', self.file, '-o', out, '--threads', '1']}
        root = {'OMPI_ALLOW_RUN_AS_ROOT': '1', 'OMPI_ALLOW_RUN_AS_ROOT_CONFIRM': '1'}
        return subprocess.Popen([*map(str, words[self.during]), '--json', '-q'], text=True,
                                stdout=subprocess.PIPE, stderr=subprocess.PIPE, stdin=subprocess.DEVNULL,
                                start_new_session=True, env=dict(os.environ, **root))

    def finish(self, process):
        out, said = process.communicate(timeout=600)
        if process.returncode != 0:
            raise RuntimeError(f'exit {process.returncode}: {said[-500:]}')
        return out

    def victims(self, process):
        """The process, or the ranks that mpirun has started."""
        if self.during != 'ranks':
            return [process.pid]
        found = []
        for entry in pathlib.Path('/proc').glob('[0-9]*'):
            with contextlib.suppress(OSError, IndexError):
                parent = int((entry / 'stat').read_text().rsplit(')', 1)[1].split()[1])
                if parent == process.pid and os.readlink(entry / 'exe') == self.program:
                    found.append(int(entry.name))
        return sorted(found)

    def kill(self, process):
        """After a random time. Whether it met the command at work."""
        time.sleep(self.chance.random() * self.seconds)
        victims = self.victims(process)
        if process.poll() is not None or not victims:
            process.communicate(timeout=600)
            return False
        with contextlib.suppress(ProcessLookupError):
            os.kill(self.chance.choice(victims), signal.SIGKILL)
        process.communicate(timeout=600)
        return process.returncode != 0

    def check_readable(self, out):
        if not (out / 'study.toml').exists():
            return
        done = subprocess.run([self.program, 'study', 'status', out, '--json', '-q'],
                              capture_output=True, text=True)
        if done.returncode not in (0, 3) and 'was interrupted' not in done.stderr:
            raise RuntimeError('status: ' + done.stderr)

    def trial(self, number, out):
        """One kill; whether the command ended by itself since the last."""
        process = self.start(out)
        met = self.kill(process)
        self.met += met
        self.check_readable(out)
        if met and self.during != 'merge' and self.chance.random() < 0.7:
            return False  # it is killed again before it may end
        out_text = self.finish(self.start(out))
        if untimed(out_text) != self.cells:
            raise RuntimeError('another result')
        if rows(out / 'results.sqlite') != self.rows:
            raise RuntimeError('another store')
        return True

    def run(self, kills):
        number, folder = 0, None
        while number < kills:
            folder = folder or pathlib.Path(tempfile.mkdtemp(dir=self.folder)) / 'out'
            number += 1
            try:
                ended = self.trial(number, folder)
            except (RuntimeError, OSError, ValueError, subprocess.TimeoutExpired) as fault:
                self.failed.append(f'kill {number}: {fault}')
                ended = True
            if ended:
                shutil.rmtree(folder, ignore_errors=True)
                folder = None
        if folder:
            try:
                if untimed(self.finish(self.start(folder))) != self.cells:
                    self.failed.append('the last: another result')
            except RuntimeError as fault:
                self.failed.append(f'the last: {fault}')


def main():
    parser = argparse.ArgumentParser(description=__doc__.split('\n')[0])
    parser.add_argument('program')
    parser.add_argument('--during', choices=['study', 'merge', 'ranks'], required=True)
    parser.add_argument('--kills', type=int, default=50)
    parser.add_argument('--seed', type=int, default=1)
    parser.add_argument('--ranks', type=int, default=4)
    options = parser.parse_args()
    with tempfile.TemporaryDirectory() as folder:
        kills = Kills(options, pathlib.Path(folder))
        kills.run(options.kills)
    for fault in kills.failed:
        print(fault)
    print(f'during {options.during}: {options.kills} kills, {len(kills.failed)} failed; '
          f'{kills.met} met it at work; undisturbed it takes {kills.seconds:.2f} s')
    return 1 if kills.failed else 0


if __name__ == '__main__':
    sys.exit(main())
