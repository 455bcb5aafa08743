#!/usr/bin/env python3
# SPDX-FileCopyrightText: 2026 The Vernier authors
# SPDX-License-Identifier: Apache-2.0
"""Numbers, control characters and long words on the command line: one line, exit code 2.

    command_line_limits_test.py PROGRAM
"""
import os
import pathlib
import sys
import unittest

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent))
sys.dont_write_bytecode = True
import text_faults
from text_faults import Run


class CommandLine(text_faults.TextCase):
    def test_whole_numbers_of_the_command_line(self):
        cases = ('18446744073709551616', '010', '1e3', ' 5', '5 ', '+5', '0x10', '1_000', "'5",
                 '1.5', '-1', '', '9' * 100_000, '\x1b[31m', '5,5')
        for text in cases:
            for words in (('sample', 'nominal', '-o', 's.csv', '--seed'),
                          ('sample', 'nominal', '-o', 's.csv', '-n'),
                          ('world', 'make', '-o', 'w2.toml', '--seed'),
                          ('map', 'make', '--world', 'workshop', '-o', 'w.map', '--seed'),
                          ('localise', 'w.map', '--world', 'workshop', '-n'),
                          ('odometry', '--world', 'workshop', '--drives'),
                          ('study', 's.toml', '-o', 'study', '--threads')):
                self.refuses(text[:30], '-', *words[:-1], f'{words[-1]}={text}'
                             if words[-1].startswith('--') else f'{words[-1]}{text}')
        seed = Run(self.folder, 'sample', 'nominal', '-n', '1', '-o', 'largest.csv', '--seed',
                   '18446744073709551615')
        self.assertEqual(seed.code, 0, seed.err)

    def test_real_numbers_of_the_command_line(self):
        for text in ('nan', 'inf', '-inf', '1e309', '0x10', '1_000', ' 1', '1 ', '', '1,5',
                     '9' * 100_000):
            for words in (('sample', 'nominal', '-o', 's.csv', '--psi-c'),
                          ('stereo', '--rig', 'nominal', '--left', 'left.pgm', '--right',
                           'right.pgm', '-o', 'e.csv', '--epipolar-reject-deg'),
                          ('map', 'make', '--world', 'workshop', '-o', 'w.map', '--spacing-m'),
                          ('odometry', '--world', 'workshop', '--step-m'),
                          ('diff', 'nominal', 'nominal', '--focus')):
                self.refuses(text[:30], '-', *words[:-1], f'{words[-1]}={text}')

    def test_control_characters_and_long_words_never_reach_the_terminal(self):
        for words in (('sample', '\x1b[31m.json', '-o', 's.csv'), ('\x1b[31m',),
                      ('sample', 'good.json', '--\x1b[31m'),
                      ('convert', 'good.json', '--to', '\x1b[31m', '-o', 'k'),
                      ('sample', 'good.json', 'a\x1b[31m', '-o', 's.csv'),
                      ('sample', 'x' * 100_000, '-o', 's.csv'), ('x' * 100_000,),
                      ('convert', 'good.json', '--to', 'x' * 100_000, '-o', 'k'),
                      ('advise', 'good.json', '--covariance', 'x' * 100_000)):
            self.refuses(words[-1][:20], '', *words)


if __name__ == '__main__':
    text_faults.PROGRAM = os.path.abspath(sys.argv.pop(1))
    unittest.main()
