#!/usr/bin/env python3
# SPDX-FileCopyrightText: 2026 The Vernier authors
# SPDX-License-Identifier: Apache-2.0
"""INT, TERM and HUP to every verb that writes, and what becomes of the programs that it started.

    signals_test.py PROGRAM [unittest's options]
"""
import os
import pathlib
import signal
import subprocess
import sys
import time
import unittest

sys.dont_write_bytecode = True
import cli_test
import verb_calls
from faults_test import FaultCase

# Programs that end by no means but a signal, nor does the one that each of them starts. Both write
# their number. The first kind hangs before it is ready, the second at the first question.
NEVER = '''exec 3<&0
cat <&3 > /dev/null &
sleep 300 &
{ echo $!; echo $$; } > started.new
mv started.new started
%s
while :; do sleep 300; done
'''
HANGING = {'unready.sh': NEVER % '', 'silent.sh': NEVER % 'echo \'{"ready": true}\''}


def is_running(number):
    try:
        return pathlib.Path(f'/proc/{number}/stat').read_text().rpartition(')')[2].split()[0] not in 'ZX'
    except FileNotFoundError:
        return False


class EveryVerb(cli_test.Case):
    def test_a_signal_leaves_old_or_new_outputs_and_nothing_else(self):
        script = cli_test.ROOT / 'scripts/fault_trials.py'
        verbs = [call.name for call in verb_calls.calls() if call.outputs]
        done = subprocess.run([sys.executable, script, cli_test.PROGRAM, '--signals', '--kills',
                               str(len(verbs)), '--jobs', '2'], capture_output=True, text=True)
        self.assertEqual(done.returncode, 0, done.stdout + done.stderr)
        self.assertIn(f'{len(verbs)} kills, 0 trials failed', done.stdout)
        for verb in verbs:
            self.assertRegex(done.stdout, rf'(?m)^{verb} ')


class HangingPrograms(FaultCase):
    """They end with the program that started them, and so do those that they started."""

    def setUp(self):
        super().setUp()
        for name, text in HANGING.items():
            (self.folder / name).write_text(text)
            for kind, study in self.studies(f'command = "sh {name}"\ntime_limit_s = 200\n').items():
                (self.folder / f'{kind}.{name}.toml').write_text(study)
        (self.folder / 'tmp').mkdir()
        self.before = {file.name for file in self.folder.iterdir()}

    @staticmethod
    def studies(command):
        return {'localiser': verb_calls.STUDY + '[localiser]\nmethod = "program"\n' + command,
                'source': verb_calls.STUDY + '[sources]\n' + command,
                'system': '[study]\ntrials = 12\n[system]\nname = "program"\nsuccess_error = 0.02\n' +
                          command}

    def ended(self, words, signals):
        """Starts the program, sends the signals once the other one hangs; the code and what was said."""
        with subprocess.Popen([cli_test.PROGRAM, *words, '-q'], cwd=self.folder, text=True,
                              stdout=subprocess.DEVNULL, stderr=subprocess.PIPE,
                              env=dict(os.environ, TMPDIR=str(self.folder / 'tmp'))) as process:
            end = time.monotonic() + 60
            while not (self.folder / 'started').exists() and time.monotonic() < end:
                self.assertIsNone(process.poll(), 'it ended too early')
                time.sleep(0.002)
            for number in signals:
                process.send_signal(number)
            said = process.communicate(timeout=100)[1]
        children = (self.folder / 'started').read_text().split()
        (self.folder / 'started').unlink()
        self.assertEqual(len(children), 2)
        end = time.monotonic() + 20  # they are killed, but need not have ended yet
        while any(map(is_running, children)) and time.monotonic() < end:
            time.sleep(0.01)
        self.assertFalse([number for number in children if is_running(number)])
        self.assertEqual(os.listdir(self.folder / 'tmp'), [])
        return process.returncode, said.splitlines()

    def test_one_signal_ends_both(self):
        for number, (hanging, command) in enumerate((name, f'sh {name}') for name in HANGING):
            how = (signal.SIGTERM, signal.SIGINT)[number]
            calls = {
                'matcher': [*verb_calls.JUDGE, '--command', command + ' {left} {right} {output}.pfm',
                            '-o', 'out'],
                'localiser': ['localise', 'known.map', '--features', 'views.jsonl', '--rig', 'nominal',
                              '--method', 'program', '--time-limit-s', '200', '--command', command,
                              '-o', 'out.csv'],
                'source': ['servo', '--trials', '1', '--source', 'command=' + command, '--source',
                           'time_limit_s=200', '-o', 'out.csv'],
                'source of a view': ['simulate', '--pose', '10,7.5,0', '--source', 'command=' + command,
                                     '--source', 'time_limit_s=200', '--picture', 'out.svg'],
                'controller': ['drive', '--pose', '10,7.5,0', '--time-limit-s', '200', '--command',
                               command, '-o', 'out.jsonl']}
            for name, words in calls.items():
                with self.subTest(name, hanging=hanging):
                    self.assertEqual(self.ended(words, [how]), (
                        -how, [f'vernier: ended by {how.name}; unfinished files are removed']))
                    self.assertEqual({file.name for file in self.folder.iterdir()}, self.before)

    def test_a_second_signal_ends_a_study_and_its_program(self):
        for study in sorted(f'{kind}.{name}.toml' for kind in self.studies('') for name in HANGING):
            with self.subTest(study):
                code, said = self.ended(['study', study, '-o', study + '.out', '--threads', '1'],
                                        [signal.SIGTERM, signal.SIGHUP])
                self.assertIn(code, (-signal.SIGTERM, -signal.SIGHUP))
                self.assertEqual(said, [f'vernier: ended by {signal.Signals(-code).name}; unfinished '
                                        'files are removed'])
                self.assertFalse(list(self.folder.rglob('.vernier-*.tmp')))


if __name__ == '__main__':
    cli_test.PROGRAM = str(pathlib.Path(sys.argv.pop(1)).resolve())
    unittest.main()
