#!/usr/bin/env python3
# SPDX-FileCopyrightText: 2026 The Vernier authors
# SPDX-License-Identifier: Apache-2.0
"""Standard output and error closed, full or a pipe whose reader has gone: no verb falls over it.

    streams_test.py PROGRAM [unittest's options]
"""
import dataclasses
import json
import os
import pathlib
import re
import signal
import subprocess
import sys
import tempfile
import unittest

sys.dont_write_bytecode = True
import verb_calls

PROGRAM = ''


class Streams(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.temporary = tempfile.TemporaryDirectory()
        cls.inputs, cls.runs = (pathlib.Path(cls.temporary.name) / name for name in ('inputs', 'runs'))
        cls.inputs.mkdir()
        cls.runs.mkdir()
        verb_calls.write_inputs(cls.inputs, PROGRAM)
        cls.reference = {}
        for call in verb_calls.calls():
            folder, done = cls.run_in_folder(call, '')
            assert done.returncode == call.code, (call.name, done.stderr)
            cls.reference[call.name] = (done, cls.content(folder))

    @classmethod
    def tearDownClass(cls):
        cls.temporary.cleanup()

    @classmethod
    def run_in_folder(cls, call, redirection):
        """In a folder of its own, with the shell's redirection."""
        folder = pathlib.Path(tempfile.mkdtemp(dir=cls.runs))
        for file in cls.inputs.iterdir():
            (folder / file.name).symlink_to(file)
        call.prepare(folder)
        done = subprocess.run(['sh', '-c', f'exec "$@" {redirection}', 'sh', PROGRAM,
                               *map(str, call.words)],
                              cwd=folder, capture_output=True, text=True, timeout=120)
        return folder, done

    @staticmethod
    def content(folder):
        """Names and sizes of the files made; sizes vary with the digits of times."""
        return {str(file.relative_to(folder)): file.stat().st_size
                for file in folder.rglob('*') if file.is_file() and not file.is_symlink()}

    def expect_same_files(self, call, folder):
        expected, found = self.reference[call.name][1], self.content(folder)
        self.assertEqual(found.keys(), expected.keys())
        for name, size in expected.items():
            self.assertLess(abs(found[name] - size), 0.02 * size + 100, name)

    def test_every_verb_is_among_the_calls(self):
        def listed(*words):
            text = subprocess.run([PROGRAM, *words, '--help'], capture_output=True, text=True).stdout
            _, _, verbs = text.partition('Subcommands:')
            return re.findall(r'(?m)^  ([a-z]+)  ', verbs)
        called = {tuple(call.words[:2]) for call in verb_calls.calls()}
        self.assertEqual({words[0] for words in called}, set(listed()))
        for verb in listed():
            for under in listed(verb):
                self.assertIn((verb, under), called)

    def test_a_missing_or_full_standard_error_changes_nothing(self):
        for call in verb_calls.calls():
            for redirection in ('2>&-', '2>/dev/full'):
                with self.subTest(verb=call.name, redirection=redirection):
                    folder, done = self.run_in_folder(call, redirection)
                    self.assertEqual(done.returncode, call.code)
                    self.assertEqual(len(done.stdout.splitlines()),
                                     len(self.reference[call.name][0].stdout.splitlines()))
                    self.expect_same_files(call, folder)

    def test_a_missing_or_full_standard_output_is_said_and_leaves_the_files_whole(self):
        for call in verb_calls.calls():
            for redirection in ('>&-', '>&- 2>&- <&-', '>/dev/full 2>/dev/full'):
                with self.subTest(verb=call.name, redirection=redirection):
                    folder, done = self.run_in_folder(call, redirection)
                    self.assertEqual(done.returncode, 2)
                    if '2>' not in redirection:
                        self.assertIn('vernier: standard output: cannot be written',
                                      done.stderr.splitlines()[-1])
                    self.expect_same_files(call, folder)

    def test_warnings_and_doubts_are_in_the_object_of_a_quiet_call_too(self):
        warned = 0
        for call in verb_calls.calls():
            if '--json' in call.words:
                continue
            with self.subTest(verb=call.name):
                folder, done = self.run_in_folder(
                    dataclasses.replace(call, words=[*call.words, '--json', '--quiet']), '')
                self.assertEqual(done.returncode, call.code, done.stderr)
                found = json.loads(done.stdout)
                lines = self.reference[call.name][0].stderr.splitlines()
                for begin, key in (('warning: ', 'warnings'), ('vernier: not trustworthy: ', 'doubts')):
                    for line in lines:
                        if line.startswith(begin):
                            self.assertIn(line[len(begin):], found[key])
                            warned += 1
                self.assertNotIn('warning: ', done.stderr)
                self.expect_same_files(call, folder)
        self.assertGreater(warned, 5)

    def test_help_and_complaints_too(self):
        for words, redirection, code in ((['--help'], '>&-', 2), (['--version'], '>/dev/full', 2),
                                         (['study', '--help'], '>&- 2>&-', 2),
                                         (['sample', '--help'], '2>&-', 0),
                                         (['nothing'], '2>&-', 2), ([], '2>/dev/full', 2), (['doctor'], '>/dev/full', 2),
                                         (['sample', 'no such rig'], '>&- 2>&-', 2)):
            with self.subTest(words=words, redirection=redirection):
                done = self.run_in_folder(verb_calls.Call('', words, []), redirection)[1]
                self.assertEqual(done.returncode, code)

    def test_a_reader_that_goes_ends_it_as_any_program(self):
        read, write = os.pipe()
        os.close(read)
        try:
            done = subprocess.run([PROGRAM, 'diff', 'nominal', 'nominal', '-q'], stdout=write,
                                  stderr=subprocess.PIPE, text=True)
            self.assertEqual((done.returncode, done.stderr), (-signal.SIGPIPE, ''))
            done = subprocess.run([PROGRAM, 'diff', 'nominal', 'nominal', '-q'], stdout=write,
                                  stderr=subprocess.PIPE, text=True, restore_signals=False)
            self.assertEqual(done.returncode, 2)  # Python ignores the signal, and so may others
            self.assertIn('standard output: cannot be written', done.stderr)
            done = subprocess.run([PROGRAM, 'diff', 'nominal', 'nominal', '-q'], stderr=write,
                                  stdout=subprocess.PIPE, text=True)
            self.assertEqual(done.returncode, 0)
        finally:
            os.close(write)

    def test_a_reader_of_standard_error_that_goes_midway_changes_nothing(self):
        folder = pathlib.Path(tempfile.mkdtemp(dir=self.runs))
        (folder / 'posts.world.toml').symlink_to(self.inputs / 'posts.world.toml')
        (folder / 'larger.toml').write_text(verb_calls.STUDY.replace('trials = 120', 'trials = 1200'))
        cells = []
        for output in ('whole', 'disturbed'):
            words = [PROGRAM, 'study', 'larger.toml', '-o', output, '--threads', '2', '--json']
            with subprocess.Popen(words, cwd=folder, stdout=subprocess.PIPE, stderr=subprocess.PIPE,
                                  text=True) as process:
                self.assertRegex(process.stderr.readline(), '^study: ')
                if output == 'disturbed':
                    process.stderr.close()
                    told = process.stdout.read()
                else:
                    told, said = process.communicate(timeout=300)
                    self.assertGreater(said.count('\nstudy: blocks: '), 5)  # more was to come
                self.assertEqual(process.wait(timeout=300), 0)
            cells.append([{key: value for key, value in cell.items() if '_ms' not in key}
                          for cell in json.loads(told)['cells']])
        self.assertEqual(*cells)

    def test_a_standard_output_that_does_not_block_gets_all(self):
        read, write = os.pipe()
        os.set_blocking(write, False)
        with subprocess.Popen([PROGRAM, 'report', '--help'], stdout=write) as process:
            os.close(write)
            with os.fdopen(read) as output:
                text = output.read()
            self.assertEqual(process.wait(), 0)
        self.assertIn('Example:', text)


if __name__ == '__main__':
    PROGRAM = str(pathlib.Path(sys.argv.pop(1)).resolve())
    unittest.main()
