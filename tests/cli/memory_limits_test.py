#!/usr/bin/env python3
# SPDX-FileCopyrightText: 2026 The Vernier authors
# SPDX-License-Identifier: Apache-2.0
"""Little memory (ulimit -v): a call ends well or with a word, never with 1, an abort or a fault.

    memory_limits_test.py PROGRAM
"""
import pathlib
import shutil
import struct
import sys
import unittest

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent))
sys.dont_write_bytecode = True
import size_limits_test
import verb_calls
from size_limits_test import ROOT, png


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
        ran_out, names = 0, set()
        for more_mb in (10, 40, 120, 400):
            for call in calls:
                done = self.call(*call, virtual_mb=least_mb + more_mb)
                said = f'{call[0]} with {least_mb + more_mb} MB: {done.code} {done.err[-300:]}'
                self.assertIn(done.code, (0, 2, 3), said)
                if done.code != 2:
                    continue
                self.assertTrue(done.err.splitlines()[-1].startswith('vernier: '), said)
                if 'out of memory' in done.err:
                    ran_out += 1
                    names.add(call[0])
        self.assertGreater(ran_out, 3)
        self.assertLessEqual({'uncertainty', 'rectify', 'stereo', 'detect'}, names)

    CODECS_MB = 256  # OpenCV's image codecs are loaded where so much is left

    # Calls of verb_calls.py that need 20 MB or more than the least, where they have 3 and 12: most by the
    # image codecs. All of them run out.
    RUN_OUT = {'detect', 'match', 'rectify', 'stereo', 'evaluate', 'characterise', 'characterise_sequence',
               'world_build', 'render', 'lines', 'calibrate', 'check', 'world_view'}

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
        self.assertEqual(self.RUN_OUT - ran_out, set(), 'had enough')

    def grid(self, side):
        """A crumpled sheet of side x side vertices as a mesh."""
        points = b''.join(struct.pack('<3f', 0.05 * i, 0.05 * j, 0.3 * ((i + j) % 2))
                          for i in range(side) for j in range(side))
        corners = [i * side + j for i in range(side - 1) for j in range(side - 1)]
        faces = b''.join(struct.pack('<B3iB3i', 3, a, a + 1, a + side, 3, a + 1, a + side + 1, a + side)
                         for a in corners)
        head = ('ply\nformat binary_little_endian 1.0\nelement vertex {}\nproperty float x\n'
                'property float y\nproperty float z\nelement face {}\n'
                'property list uchar int vertex_indices\nend_header\n')
        return head.format(side * side, 2 * (side - 1) ** 2).encode() + points + faces

    def test_larger_inputs_run_out_in_the_middle(self):
        """With some megabytes more than they need to start, and with more until they end well; `tune` goes
        on with what it has stored."""
        verb_calls.write_inputs(self.folder)
        far = ',\n'.join(f'[{i % 200},{i // 200},0,{i % 200},{i // 200},2]' for i in range(60_000))
        large = (f'\n[[template]]\nname = "far"\nsegments = [{far}]\n[[instance]]\ntemplate = "far"\n'
                 'at_m = [300, 300, 0]\n')
        shipped = (ROOT / 'datasets/worlds/workshop.world.toml').read_text()
        self.write('large.world.toml', shipped + large)
        self.write('begun/world.world.toml', verb_calls.WORLD + large)
        self.write('grid.ply', self.grid(150))
        self.write('workshop.toml', verb_calls.TUNE.replace('posts.world.toml', 'workshop')
                   .replace('trials = 120', 'trials = 12'))
        self.least_mb = self.least_virtual_mb()
        world = ('--world', 'large.world.toml')
        for call, output, code, first_mb in (
                (('world', 'import', 'grid.ply', '--unit', 'm', '--up', 'z', '-o', 'o.toml'), 'o.toml', 0, 8),
                (('tune', 'workshop.toml', '-o', 'out', '--threads', '1'), 'out/tune.json', 0, 8),
                (('servo', *world, '--trials', '1', '--threads', '1', '-o', 'o.csv'), 'o.csv', 0, 8),
                (('drive', *world, '--pose', '10,7.5,0', '--commands', 'commands.csv', '-o', 'o.jsonl'),
                 'o.jsonl', 0, 8),
                (('export', 'begun', '-o', 'e.csv'), 'e.csv', 3, 8),
                (('render', '--world', 'posts.world.toml', '--pose', '3,2,90', '--samples', '1', '-o', 'r'),
                 'r/render.json', 0, self.CODECS_MB + 50)):
            with self.subTest(call[0]):
                self.runs_out_from(first_mb, call, output, code)

    def runs_out_from(self, first_mb, call, output, code):
        """With so many megabytes more than the least, and with others until it ends well."""
        base_mb = self.CODECS_MB if first_mb > self.CODECS_MB else 0
        more_mb = first_mb - base_mb
        self.assertTrue(self.runs_out(call, self.least_mb + first_mb, output, code))
        ran_out = True
        while ran_out:
            more_mb *= 1.4
            self.assertLess(more_mb, 500)
            ran_out = self.runs_out(call, self.least_mb + base_mb + more_mb, output, code)

    def runs_out(self, call, virtual_mb, output, code):
        done = self.call(*call, virtual_mb=int(virtual_mb))
        said = f'{call[0]} with {virtual_mb} MB: {done.code} {done.err[-300:]}'
        self.assertIn(done.code, (code, 2), said)
        self.assertEqual((self.folder / output).exists(), done.code == code, said)
        (self.folder / output).unlink(missing_ok=True)
        if done.code == 2:
            self.assertTrue(done.err.splitlines()[-1].startswith('vernier: out of memory; '), said)
        return done.code == 2

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
                         ('match', *pair, '--prior', 'nominal', '-o', 'p.csv'),
                         ('evaluate', *pair, '--truth', 'right1.png', '--truth-scale', '4', '-o', 'e')):
                done = self.call(*call, virtual_mb=loaded_mb + more_mb)
                said = f'{call[0]} with {loaded_mb + more_mb} MB: {done.code} {done.err[-300:]}'
                self.assertEqual(done.code, 2, said)
                self.assertTrue(done.err.splitlines()[-1].startswith('vernier: '), said)
                if 'out of memory' in done.err:
                    ran_out.add(call[0])
        self.assertLessEqual({'stereo', 'detect', 'rectify', 'evaluate'}, ran_out)

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
