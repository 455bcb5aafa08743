#!/usr/bin/env python3
# SPDX-FileCopyrightText: 2026 The Vernier authors
# SPDX-License-Identifier: Apache-2.0
"""How much faster a study is on two threads and on two ranks than on one: wall time of the whole
command, paired runs in turn.

    study_scaling.py PROGRAM [--trials 3000] [--repeat 3]

Prints each round, the medians, and the machine's load beside the runs themselves (running tasks of
others, sampled in /proc/loadavg each second).
"""
import argparse
import os
import pathlib
import shutil
import statistics
import subprocess
import sys
import tempfile
import threading
import time

STUDY = '''[study]
trials = {trials}
protocol = "near_path"
[world]
file = "small.world.toml"
[map]
spacing_m = 1
'''


class Load(threading.Thread):
    """The number of tasks that can run, sampled."""

    def __init__(self):
        super().__init__(daemon=True)
        self.seen, self.done = [], threading.Event()

    def run(self):
        while not self.done.wait(1):
            self.seen.append(int(pathlib.Path('/proc/loadavg').read_text().split()[3].split('/')[0]))


def main():
    parser = argparse.ArgumentParser(description=__doc__.split('\n')[0])
    parser.add_argument('program')
    parser.add_argument('--trials', type=int, default=3000)
    parser.add_argument('--repeat', type=int, default=3)
    options = parser.parse_args()
    program = str(pathlib.Path(options.program).resolve())
    mpirun = ['mpirun', '--quiet', '--oversubscribe', '--bind-to', 'none', '-n', '2']
    ways = {'1 thread': ['--threads', '1'], '2 threads': ['--threads', '2']}
    if shutil.which('mpirun'):
        ways['2 ranks'] = ['--threads', '1']
    env = dict(os.environ, OMPI_ALLOW_RUN_AS_ROOT='1', OMPI_ALLOW_RUN_AS_ROOT_CONFIRM='1')
    times = {way: [] for way in ways}
    with tempfile.TemporaryDirectory() as name:
        folder = pathlib.Path(name)
        (folder / 's.toml').write_text(STUDY.format(trials=options.trials))
        subprocess.run([program, 'world', 'make', '--seed', '5', '--size-m', '10,8,2.5', '-o',
                        folder / 'small.world.toml'], check=True, capture_output=True)
        load = Load()
        load.start()
        for turn in range(options.repeat):
            for way, words in ways.items():
                out = folder / 'out'
                start = time.monotonic()
                subprocess.run([*(mpirun if 'ranks' in way else []), program, 'study',
                                folder / 's.toml', '-o', out, '-q', *words], check=True, env=env,
                               stdin=subprocess.DEVNULL, stdout=subprocess.DEVNULL)
                times[way].append(time.monotonic() - start)
                shutil.rmtree(out)
            print(', '.join(f'{way} {times[way][-1]:.2f} s' for way in ways), flush=True)
        load.done.set()
    for way in list(ways)[1:]:
        ratios = [one / two for one, two in zip(times['1 thread'], times[way])]
        print(f'{way} / 1: median {statistics.median(ratios):.3f}, from {min(ratios):.3f} to '
              f'{max(ratios):.3f}')
    print(f'{os.cpu_count()} cores; tasks that could run, these included: median '
          f'{statistics.median(load.seen or [0]):.0f}')


if __name__ == '__main__':
    sys.exit(main())
