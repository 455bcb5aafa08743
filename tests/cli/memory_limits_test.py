#!/usr/bin/env python3
# SPDX-FileCopyrightText: 2026 The Vernier authors
# SPDX-License-Identifier: Apache-2.0
"""Little memory (ulimit -v): a call ends well or with a word, never with 1, an abort or a fault.

    memory_limits_test.py PROGRAM
"""
import pathlib
import shutil
import sys
import unittest

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent))
sys.dont_write_bytecode = True
import size_limits_test
import verb_calls
from size_limits_test import png


class Memory(size_limits_test.Case):
    """Under ulimit -v a call ends well or with a word; never with 1, an abort or a fault."""

    def test_every_limit(self):
        self.write('l1.png', png(640, 480))
        self.write('r1.png', png(640, 480, value=85))
        self.write('big1.png', png(8000, 8000))
        self.write('big2.png', png(8000, 8000, value=85))
        self.write('s.toml', '[study]\ntrials = 1\n')
        self.write('views.jsonl', verb_calls.features())
        self.write('known.map', verb_calls.map_file(verb_calls.features().splitlines()))
        calls = (('sample', 'nominal', '-n', '10', '-o', 's.csv'),
                 ('world', 'info', 'workshop'),
                 ('study', 's.toml', '-o', 'out'),
                 ('uncertainty', 'nominal', '--grid', '600x600'),
                 ('rectify', '--rig', 'nominal', '--left', 'l1.png', '--right', 'r1.png', '-o', 'r'),
                 ('stereo', '--rectified', '--f-px', '500', '--baseline-m', '0.1', '--left',
                  'big1.png', '--right', 'big2.png', '-o', 'st'),
                 ('detect', '--left', 'big1.png', '--board', '9x6', '-o', 'c.vnl'),
                 ('map', 'make', '--world', 'workshop', '--spacing-m', '2', '-o', 'w.map'),
                 ('map', 'info', 'known.map'),
                 ('localise', 'known.map', '--features', 'views.jsonl', '--rig', 'nominal'),
                 ('odometry', '--world', 'workshop', '--leg', '2'))
        least_mb = self.least_virtual_mb()
        ran_out = 0
        for more_mb in (10, 40, 120, 400):
            for call in calls:
                done = self.call(*call, virtual_mb=least_mb + more_mb)
                said = f'{call[0]} with {least_mb + more_mb} MB: {done.code} {done.err[-300:]}'
                self.assertIn(done.code, (0, 2, 3), said)
                if done.code != 2:
                    continue
                self.assertTrue(done.err.splitlines()[-1].startswith('vernier: '), said)
                ran_out += 'out of memory' in done.err
        self.assertGreater(ran_out, 3)

    def test_every_verb(self):
        verb_calls.write_inputs(self.folder, size_limits_test.PROGRAM)
        least_mb = self.least_virtual_mb()
        ran_out = set()
        for more_mb in (3, 12):
            for call in verb_calls.calls():
                call.prepare(self.folder)
                done = self.call(*call.words, virtual_mb=least_mb + more_mb)
                said = f'{call.name} with {least_mb + more_mb} MB: {done.code} {done.err[-300:]}'
                self.assertIn(done.code, (call.code, 2), said)
                if done.code == 2 and call.code != 2:
                    self.assertTrue(done.err.splitlines()[-1].startswith('vernier: '), said)
                    self.assertIn('out of memory', done.err, said)
                    ran_out.add(call.name)
                for output in (self.folder / name for name in call.outputs):
                    if output.is_dir():
                        shutil.rmtree(output)
                    else:
                        output.unlink(missing_ok=True)
        self.assertGreater(len(ran_out), 8, ran_out)

    def test_images_once_their_codecs_are_loaded(self):
        """They are loaded where 256 MB are left, of which they take the larger part: larger images."""
        for side, value in (('left', 0), ('right', 85)):
            self.write(side + '1.png', png(11000, 11000, value=value))
        self.write('small1.png', png(64, 64))
        loaded_mb = self.least_virtual_mb('detect', '--left', 'small1.png', '--board', '9x6', '-o', 'c.vnl',
                                          code=2, says='no 9x6 board')
        pair = ('--left', 'left1.png', '--right', 'right1.png')
        ran_out = set()
        for more_mb in (0, 40, 160):
            for call in (('stereo', '--rectified', '--f-px', '500', '--baseline-m', '0.1', *pair, '-o', 'st'),
                         ('detect', '--left', 'left1.png', '--board', '9x6', '-o', 'c.vnl'),
                         ('rectify', '--rig', 'nominal', *pair, '-o', 'r'),
                         ('match', *pair, '--prior', 'nominal', '-o', 'p.csv')):
                done = self.call(*call, virtual_mb=loaded_mb + more_mb)
                said = f'{call[0]} with {loaded_mb + more_mb} MB: {done.code} {done.err[-300:]}'
                self.assertEqual(done.code, 2, said)
                self.assertTrue(done.err.splitlines()[-1].startswith('vernier: '), said)
                if 'out of memory' in done.err:
                    ran_out.add(call[0])
        self.assertGreater(len(ran_out), 2, ran_out)

    def least_virtual_mb(self, *call, code=0, says=''):
        """What a call needs to end so; of none: what the program needs to start at all."""
        too_few, enough = 50, 4000
        while enough - too_few > 1:
            middle = (too_few + enough) // 2
            done = self.call(*(call or ('--version',)), virtual_mb=middle)
            if done.code == code and says in done.err:
                enough = middle
            else:
                too_few = middle
        self.assertLess(enough, 4000)
        return enough


if __name__ == '__main__':
    size_limits_test.PROGRAM = str(pathlib.Path(sys.argv.pop(1)).resolve())
    unittest.main()
