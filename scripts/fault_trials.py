#!/usr/bin/env python3
# SPDX-FileCopyrightText: 2026 The Vernier authors
# SPDX-License-Identifier: Apache-2.0
"""Kills or signals every verb that writes at random moments and looks at what it leaves.

    fault_trials.py PROGRAM [--signals] [--kills 1000] [--seed 1] [--jobs 1] [--verb NAME ...]

Each trial starts a verb in a folder of its own, with or without old outputs there, and sends SIGKILL:
half of them after a random part of the time that the verb takes, half within 0.1 s of the first file
that it makes. Then
- every output file is the old one, or the new one complete, or absent where there was no old one;
- what else is there has a name that docs/robustness.md lists (.vernier-*.tmp, SQLite's companions);
- the same call again gives the result of an undisturbed one.
With --signals it sends INT, TERM or HUP instead, and asks for more (but repeats only what goes on with
the folder that was left):
- the program ended by that signal, or as usual if it was quicker, with one line of its own at most;
- no temporary file or folder, and no empty folder of outputs, is left;
- the outputs are all old or all new, but for the folder of a study;
- none of the programs that it had started runs on.
Exit code 1 if a trial fails. Times in results are not compared.
"""
import argparse
import collections
import concurrent.futures
import fnmatch
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
import time

ROOT = pathlib.Path(__file__).resolve().parents[1]
sys.path.insert(0, str(ROOT / 'tests/cli'))
sys.dont_write_bytecode = True
import verb_calls

OLD = b'an old file\n'
COMPANIONS = ('results*.sqlite-wal', 'results*.sqlite-shm', 'results*.sqlite-journal', 'results*.sqlite',
              '*.lock')
TEMPORARY = '.vernier-*.tmp'
SIGNALS = (signal.SIGINT, signal.SIGTERM, signal.SIGHUP)


def is_study(call):
    """Whether its output is the folder of a study."""
    return call.words[0] == 'study'


def running_in(folder):
    """Processes whose working folder it is."""
    found = []
    for process in pathlib.Path('/proc').iterdir():
        try:
            if process.name.isdigit() and os.readlink(process / 'cwd') == str(folder):
                found.append((process / 'cmdline').read_text().replace('\0', ' '))
        except OSError:  # it has ended, or is somebody else's
            continue
    return found


class Trials:
    def __init__(self, program, folder, signals):
        self.program = str(pathlib.Path(program).resolve())
        self.folder = folder.resolve()
        self.signals = signals
        self.inputs = folder / 'inputs'
        self.inputs.mkdir()
        verb_calls.write_inputs(self.inputs, self.program)
        self.reference, self.seconds, self.said = {}, {}, {}

    def place(self, call):
        folder = pathlib.Path(tempfile.mkdtemp(prefix=call.name + '-', dir=self.folder))
        for file in self.inputs.iterdir():
            (folder / file.name).symlink_to(file)
        (folder / 'tmp').mkdir()
        call.prepare(folder)
        return folder

    def start(self, call, folder):
        quiet = ['-q'] if self.signals else []
        return subprocess.Popen([self.program, *map(str, call.words), *quiet], cwd=folder,
                                stdin=subprocess.DEVNULL, stdout=subprocess.DEVNULL,
                                stderr=subprocess.PIPE, text=True, start_new_session=True,
                                env=dict(os.environ, TMPDIR=str(folder / 'tmp'),
                                         SOURCE_DATE_EPOCH='1'))  # the date in PDFs

    def finish(self, call, folder):
        """The undisturbed call. What is wrong with it, or an empty string."""
        call.prepare(folder)
        with self.start(call, folder) as process:
            said = process.communicate(timeout=300)[1]
        self.said.setdefault(call.name, said)
        return '' if process.returncode == call.code else f'exit {process.returncode}: {said[-300:]}'

    def files(self, folder):
        """Content by name of what is neither input nor temporary folder, times left out."""
        found = {}
        for file in sorted(folder.rglob('*')):
            name = str(file.relative_to(folder))
            if file.is_dir() or file.is_symlink() or name.startswith('tmp/'):
                continue
            content = file.read_bytes()
            if file.suffix == '.json':
                content = re.sub(rb'"[a-z_0-9]*_ms[a-z_0-9]*": ?[-+.e0-9]+', b'', content)
            found[name] = content
        return found

    def outcome(self, call, folder):
        """What a complete run leaves: its files, a store by what the program reads of it."""
        found = {name: content for name, content in self.files(folder).items()
                 if not name.endswith(('.sqlite', '-wal', '-shm', '-journal', '.lock'))
                 and not fnmatch.fnmatch(pathlib.Path(name).name, TEMPORARY)}
        if is_study(call):
            done = subprocess.run([self.program, 'study', 'status', 'out', '--json'], cwd=folder,
                                  capture_output=True, text=True)
            status = json.loads(done.stdout) if done.stdout else {'failed': done.stderr}
            for cell in status.get('cells', []):
                for key in [key for key in cell if '_ms' in key]:
                    del cell[key]
            found['status'] = json.dumps(status, sort_keys=True)
        if call.name == 'tune':  # which computes nothing again
            words = [*map(str, call.words), '--json']
            done = subprocess.run([self.program, *words], cwd=folder, capture_output=True, text=True)
            times = r'"[a-z_0-9]*(_ms|_s)[a-z_0-9]*": ?[-+.e0-9]+'
            found['status'] = re.sub(times, '', done.stdout) or done.stderr
        return found

    def learn(self, call):
        """An undisturbed run: its outcome, and the time it takes."""
        folder = self.place(call)
        start = time.monotonic()
        wrong = self.finish(call, folder)
        self.seconds[call.name] = time.monotonic() - start
        if wrong:
            raise RuntimeError(f'{call.name} undisturbed: {wrong}')
        self.reference[call.name] = self.outcome(call, folder)
        shutil.rmtree(folder)

    def put_old_files(self, call, folder):
        for name in self.reference[call.name]:
            if name != 'status' and name not in call.changes:
                (folder / name).parent.mkdir(exist_ok=True)
                (folder / name).write_bytes(OLD)

    def faults_of_files(self, call, folder, old):
        """A list of faults, and how many of the outputs are new."""
        faults, new = [], 0
        found, reference = self.files(folder), self.reference[call.name]
        leftovers = COMPANIONS if self.signals else (*COMPANIONS, TEMPORARY)
        for name, content in found.items():
            if name in reference:
                if content == reference[name]:
                    new += 1
                elif content != old.get(name):
                    faults.append(f'{name} is incomplete: {len(content)} bytes')
            elif not any(fnmatch.fnmatch(pathlib.Path(name).name, mask) for mask in leftovers):
                faults.append(f'{name} was left behind')
        faults += [f'{name} is gone' for name in old if name not in found]
        return faults, new

    def faults_of_ending(self, call, folder, how, code, said):
        """What the signal `how` left besides files, and what was said of it."""
        faults = []
        if code not in (-how, call.code):
            faults.append(f'exit {code} after {how.name}')
        lines = [line for line in said.splitlines() if line not in self.said[call.name].splitlines()]
        if len(lines) > 1 or lines and f'vernier: ended by {how.name}' not in lines[0]:
            faults.append(f'said after {how.name}: {lines}')
        faults += [f'{name} was left in TMPDIR' for name in os.listdir(folder / 'tmp')]
        faults += [f'the empty folder {name} was left' for name in call.outputs
                   if (folder / name).is_dir() and not os.listdir(folder / name)]
        end = time.monotonic() + 20  # they are killed, but need not have ended yet
        while (running := running_in(folder)) and time.monotonic() < end:
            time.sleep(0.01)
        return faults + [f'{words} runs on' for words in running]

    @staticmethod
    def wait_for_writing(process, folder):
        """Until the first new name appears beside the inputs."""
        def names():
            return {name for at in (folder, folder / 'tmp', folder / 'out', folder / 'models')
                    if at.is_dir() for name in os.listdir(at)}
        before = names()
        while process.poll() is None and names() <= before:
            time.sleep(0.0002)

    def disturb(self, call, folder, number, chance):
        """Starts the call and sends the signal. Returns whether it had ended, its code and what it said."""
        aimed = chance.random() < 0.5
        with self.start(call, folder) as process:
            if aimed:
                self.wait_for_writing(process, folder)
                time.sleep(0.1 * 10 ** chance.uniform(-4, 0))
            else:
                time.sleep(chance.random() * 1.1 * self.seconds[call.name])
            ended = process.poll() is not None
            try:
                os.killpg(process.pid, number)
            except ProcessLookupError:
                pass
            said = process.communicate(timeout=300)[1]
        return ended, process.returncode, said

    def trial(self, call, chance):
        """One kill. Returns (state when killed, faults)."""
        folder = self.place(call)
        every = [name for name in self.reference[call.name] if name != 'status']
        if not (is_study(call) or call.name == 'tune') and chance.random() < 0.5:
            self.put_old_files(call, folder)
        old = {name: (folder / name).read_bytes() for name in every if (folder / name).exists()}
        how = chance.choice(SIGNALS) if self.signals else signal.SIGKILL
        ended, code, said = self.disturb(call, folder, how, chance)
        faults, new = self.faults_of_files(call, folder, old)
        if self.signals:
            faults += self.faults_of_ending(call, folder, how, code, said)
            if 0 < new < len(every) and not is_study(call) and call.name != 'tune':
                faults.append(f'{new} of {len(every)} outputs are new')
        if ended or new == len(every):
            state = 'ended before' if ended else 'all new'
        else:
            state = 'some new' if new else 'none new'
        if call.grows or not self.signals:
            wrong = self.finish(call, folder)
            if wrong:
                faults.append('again: ' + wrong)
            elif self.outcome(call, folder) != self.reference[call.name]:
                faults.append('again: another result')
        shutil.rmtree(folder, ignore_errors=True)  # a killed program's child may write there still
        return state, faults


def main():
    parser = argparse.ArgumentParser(description=__doc__.split('\n')[0])
    parser.add_argument('program')
    parser.add_argument('--signals', action='store_true', help='INT, TERM and HUP in place of KILL')
    parser.add_argument('--kills', type=int, default=1000)
    parser.add_argument('--seed', type=int, default=1)
    parser.add_argument('--jobs', type=int, default=1)
    parser.add_argument('--verb', action='append', help='name of a call in tests/cli/verb_calls.py')
    options = parser.parse_args()
    calls = [call for call in verb_calls.calls()
             if call.outputs and (not options.verb or call.name in options.verb)]
    failed, tally = 0, collections.defaultdict(collections.Counter)
    with tempfile.TemporaryDirectory() as folder:
        trials = Trials(options.program, pathlib.Path(folder), options.signals)

        def one(number):
            call = calls[number % len(calls)]
            return call, trials.trial(call, random.Random(f'{options.seed} {number}'))
        with concurrent.futures.ThreadPoolExecutor(options.jobs) as pool:
            list(pool.map(trials.learn, calls))
            for number, (call, (state, faults)) in enumerate(pool.map(one, range(options.kills))):
                tally[call.name][state] += 1
                for fault in faults:
                    print(f'trial {number}, {call.name}: {fault}')
                failed += bool(faults)
    states = ('none new', 'some new', 'all new', 'ended before')
    print('{:<20}'.format('verb') + ''.join(f'{state:>14}' for state in states))
    for name, counts in tally.items():
        print(f'{name:<20}' + ''.join(f'{counts[state]:>14}' for state in states))
    print(f'{options.kills} kills, {failed} trials failed')
    return 1 if failed else 0


if __name__ == '__main__':
    sys.exit(main())
