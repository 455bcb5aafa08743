#!/usr/bin/env python3
# SPDX-FileCopyrightText: 2026 The Vernier authors
# SPDX-License-Identifier: Apache-2.0
"""The limits that docs/robustness.md states: what is just above one is refused with a word, what is at
it is not, where that is cheap.

    stated_limits_test.py PROGRAM
"""
import json
import pathlib
import struct
import sys
import unittest

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent))
sys.dont_write_bytecode = True
import size_limits_test
import verb_calls
from size_limits_test import ROOT, WORLD, png

NOMINAL = (ROOT / 'datasets/rigs/nominal.rig.json').read_text()


class Case(size_limits_test.Case):
    def passes(self, *arguments, but, says):
        """At the limit another fault is found: `says` and not `but`."""
        done = self.refused(*arguments, of=says, peak_mb=1200)
        self.assertNotIn(but, done.err)


class Options(Case):
    def test_numbers_of_the_command_line(self):
        """At the limit the next fault is that there is no such file."""
        for largest, call in (
                (10_000, ('odometry', '--world', 'none.toml', '--drives')),
                (100_000, ('check', 'none.json', '--trials')),
                (100_000_000, ('sample', 'none.json', '-o', 's.csv', '-n')),
                (1_000_000, ('uncertainty', 'none.json', '--samples')),
                (1000, ('render', '--world', 'none.toml', '-o', 'out', '--poses')),
                (16, ('render', '--world', 'none.toml', '--pose', '0,0,0', '-o', 'out', '--samples')),
                (4096, ('study', 'none.toml', '-o', 'out', '--threads')),
                (12, ('localise', 'none.map', '--world', 'none.toml', '--looks'))):
            with self.subTest(call[0] + ' ' + call[-1]):
                self.refused(*call, largest + 1, of='not in range')
                self.passes(*call, largest, but='range', says='none.')

    def test_lists_and_grids(self):
        missing = ('detect', '--left', 'none*.png', '-o', 'c.vnl', '--board')
        for call, above, at, word in (
                (('uncertainty', 'none.json', '--grid'), '1001x1000', '1000x1000', 'above 1000'),
                (('uncertainty', 'none.json', '--distances-m'), ','.join(map(str, range(1, 102))),
                 ','.join(map(str, range(1, 101))), 'more than 100'),
                (('diff', 'none.json', 'nominal', '--grid'), '401x250', '400x250', 'more than 100000'),
                (missing, '101x100', '100x100', 'more than 10000'),
                (('advise', 'none.json', '--square-m', '0.03', '--board'), '101x100', '100x100',
                 'more than 10000')):
            with self.subTest(f'{call[0]} {call[-1]}'):
                self.passes(*call, at, but=word, says='none')
                if 'none.json' in call:
                    call = ['nominal' if w == 'none.json' else w for w in call]
                self.refused(*call, above, of=word)

    def test_parts_of_a_study(self):
        self.write('s.toml', '[study]\ntrials = 1\n')
        self.refused('study', 's.toml', '-o', 'out', '--shard', '0/1000001', of='1000000')
        self.write('s.toml', '[study]\ntrials = 10000001\n')
        self.refused('study', 's.toml', '-o', 'out', of='out of range; use 1 to 10000000')
        self.assertFalse((self.folder / 'out').exists())


class Texts(Case):
    JSON = ('report', 'a', '-o', 'r.html')

    def setUp(self):
        super().setUp()
        (self.folder / 'a').mkdir()

    def test_lengths(self):
        """Files of zero bytes, which are the fault where the length is none."""
        for megabytes, name, call in (
                (256, 'a/evaluation.json', self.JSON),
                (64, 'a.toml', ('study', 'a.toml', '-o', 'out')),
                (64, 'a.world.toml', ('world', 'info', 'a.world.toml')),
                (32, 'a.yaml', ('convert', 'a.yaml', '--from', 'ros', '-o', 'r.json')),
                (64, 'a.cameramodel', ('convert', 'a.cameramodel', '-o', 'r.json'))):
            with self.subTest(name):
                with open(self.folder / name, 'wb') as file:
                    file.truncate(megabytes * 1_000_000 + 1)
                self.refused(*call, of=f'may have {megabytes} MB')
                if megabytes < 100:
                    with open(self.folder / name, 'wb') as file:
                        file.truncate(megabytes * 1_000_000)
                    self.passes(*call, but='MB', says=f'{name}:1: holds a zero byte')

    def test_values(self):
        """Of JSON 16 million take four seconds: tests/calib/base/json_reader_test.cpp has a smaller limit."""
        self.write('s.toml', 'zz = [' + '1,' * 4_000_000 + '1]\n')
        self.refused('study', 's.toml', '-o', 'out', of='holds more than 4000000 values')
        self.write('a.yaml', 'zz: [' + '1,' * 2_000_000 + '1]\n')
        self.refused('convert', 'a.yaml', '--from', 'ros', '-o', 'r.json', of='holds more than 2000000 values')

    def test_keys(self):
        for count, call, name, text in (
                (10_000, self.JSON, 'a/evaluation.json',
                 lambda n: json.dumps({f'k{i}': 1 for i in range(n)})),
                (10_000, ('convert', 'a.yaml', '--from', 'ros', '-o', 'r.json'), 'a.yaml',
                 lambda n: ''.join(f'k{i}: 1\n' for i in range(n))),
                (1_000, ('convert', 'a.cameramodel', '-o', 'r.json'), 'a.cameramodel',
                 lambda n: '{' + ''.join(f"'k{i}': 1," for i in range(n)) + '}')):
            with self.subTest(name):
                self.write(name, text(count + 1))
                self.refused(*call, of=f'more than {count} keys')
                self.write(name, text(count))
                self.passes(*call, but='keys', says=name)

    def test_lines(self):
        call = ('calibrate', '--observations', 'o.csv', '--size', '640x480', '-o', 'r.json')
        self.write('o.csv', 'frame,camera,row,col,X,Y,Z,qx,qy\n' + 'x' * 20_001 + '\n')
        self.refused(*call, of='o.csv:2: the line has 20001 bytes')
        self.write('o.csv', 'frame,camera,row,col,X,Y,Z,qx,qy\n' + 'x' * 20_000 + '\n')
        self.passes(*call, but='20000 bytes', says='o.csv:2')


class Rigs(Case):
    def with_change(self, change):
        rig = json.loads(NOMINAL)
        for key in ('covariance', 'covariance_mvb', 'parameter_names', 'parameters', 'calibration', 'evidence'):
            rig.pop(key)
        change(rig)
        self.write('rig.json', json.dumps(rig))
        return self.call('convert', 'rig.json', '-o', 'r.json')

    def test_cameras(self):
        def named(name):
            return lambda rig: rig['cameras'][0].update(name=name)

        def size(side):
            return lambda rig: rig['cameras'][0].update(size_px=[side, 480])

        def parameter(**values):
            return lambda rig: rig['cameras'][0]['parameters'].update(values)

        def far(x):
            return lambda rig: rig['cameras'][1]['from_first'].update(translation_m=[x, 0, 0])

        for says, above, at in (
                ('100 letters', named('n' * 101), named('n' * 100)),
                ('1 to 1,000,000', size(1_000_001), size(1_000_000)),
                ('holds a number beyond 1e+09', parameter(ox_px=1.0001e9), parameter(ox_px=1e9)),
                ('holds a number beyond 1e+09', far(-1.0001e9), far(-1e9)),
                ('differ by a factor of 1000', parameter(ax=1000.1), parameter(ax=1000)),
                ('differ by a factor of 1000', parameter(ax=0.000999), parameter(ax=0.001))):
            with self.subTest(says):
                done = self.with_change(above)
                self.assertEqual((done.code, says in done.err), (2, True), done.err)
                self.assertTrue(done.err.startswith('vernier: rig.json'), done.err)
                self.assertEqual(self.with_change(at).code, 0, self.with_change(at).err)

    def test_number_of_cameras(self):
        def cameras(count):
            def change(rig):
                rig['cameras'] = [rig['cameras'][0]] + [
                    dict(rig['cameras'][1], name=f'c{i}') for i in range(1, count)]
            return change

        self.assertIn('it has 33 cameras', self.with_change(cameras(33)).err)
        self.assertEqual(self.with_change(cameras(32)).code, 0)

    def test_variances(self):
        for variance, refused in ((1.1e30, True), (1e30, False)):
            rig = json.loads(NOMINAL)
            matrix = rig['covariance']['matrix']
            matrix[0] = [0] * len(matrix)
            for row in matrix:
                row[0] = 0
            matrix[0][0] = variance
            self.write('rig.json', json.dumps(rig))
            done = self.call('convert', 'rig.json', '-o', 'r.json')
            self.assertEqual('holds a number beyond 1e+30' in done.err, refused, done.err)


class Worlds(Case):
    def test_every_kind_of_feature_is_counted(self):
        for kind, row, count in (('corners', '[0,0,0.01]', 1001), ('surfaces', '[[0,0,0],[1,0,0],[1,1,0]]', 1001),
                                 ('segments', '[0,0,0,1,0,0]', 1001)):
            template = f'[[template]]\nname = "t"\n{kind} = [{",".join([row] * count)}]\n'
            instances = '[[instance]]\ntemplate = "t"\nat_m = [0,0,0]\n' * 1000
            self.write('w.world.toml', WORLD + template + instances)
            self.refused('world', 'info', 'w.world.toml', of=f'has {count * 1000} {kind}, more than 1000000')

    def test_a_map_of_a_million_nodes(self):
        """By parts of a thousand nodes, which are all the same."""
        nodes = 1000
        one = verb_calls.map_file([json.dumps({'pose': [0, 0, 0], 'lines': []})] * nodes)
        rig_bytes = -(-struct.unpack('<Q', one[24:32])[0] // 8) * 8
        rig, part = one[16:40 + rig_bytes], one[40 + rig_bytes:]
        extend = ('map', 'make', '--features', 'v.jsonl', '--rig', 'nominal', '--extend', 'm.map')
        self.write('v.jsonl', '{"pose":[0,0,0],"lines":[]}\n')
        for call, parts, says in ((extend, 1000, 'would have more than 1000000 nodes'),
                                  (('map', 'info', 'm.map'), 1001, 'it has more nodes than it can hold')):
            with self.subTest(parts=parts):
                self.write('m.map', b'VERNMAP\0' + struct.pack('<II', 1, parts * nodes) + rig + part * parts)
                self.refused(*call, of=says)


class Meshes(Case):
    HEAD = ('ply\nformat binary_little_endian 1.0\nelement vertex {}\nproperty float x\nproperty float y\n'
            'property float z\nelement face {}\nproperty list {} uchar vertex_indices\nend_header\n')
    IMPORT = ('world', 'import', 'm.ply', '--unit', 'm', '--up', 'z', '-o', 'w.toml')

    def mesh(self, faces, content, count='uint', vertices=((0, 0, 0), (4, 0, 0), (4, 3, 0))):
        points = b''.join(struct.pack('<3f', *v) for v in vertices)
        self.write('m.ply', self.HEAD.format(len(vertices), faces, count).encode() + points + content)

    def test_elements_and_lists(self):
        self.write('m.ply', self.HEAD.format(12_000_001, 1, 'uint'))
        self.refused(*self.IMPORT, of='has 12000001 of element vertex')
        self.write('m.ply', self.HEAD.format(12_000_000, 1, 'uint'))
        self.refused(*self.IMPORT, of='ends too early')
        for entries, says in ((1_000_001, 'has a list too long'), (1_000_000, 'has a face of 1000000 corners'),
                              (2_001, 'has a face of 2001 corners')):
            self.mesh(1, struct.pack('<I', entries) + bytes(entries))
            self.refused(*self.IMPORT, of=says)
        self.mesh(1, struct.pack('<I', 2_000) + bytes(2_000))
        self.passes(*self.IMPORT, but='corners', says='m.ply')

    def test_triangles(self):
        self.mesh(3_000_001, b'\3\0\1\2' * 3_000_001, count='uchar')
        self.refused(*self.IMPORT, of='has too many triangles')

    def test_coordinates(self):
        for x, unit, says, but in ((1.1e9, 'm', 'vertex 0 is further than 1e9 units away', '10 km'),
                                   (1e9, 'mm', 'is larger than 10 km', 'units away'),
                                   (10_001, 'm', 'is larger than 10 km', 'units away')):
            room = verb_calls.room().replace('end_header\n0 0 0', f'end_header\n{x} 0 0')
            self.write('m.ply', room)
            self.passes('world', 'import', 'm.ply', '--unit', unit, '--up', 'z', '-o', 'w.toml', says=says, but=but)


class Images(Case):
    def test_sides_and_pixels(self):
        self.write('l1.png', png(640, 480))
        self.write('r1.png', png(640, 480, value=85))
        call = ('evaluate', '--left', 'l1.png', '--right', 'r1.png', '--truth', 't.pfm')
        self.write('t.pfm', f'Pf\n{(1 << 20) + 1} 1\n-1\n')
        self.refused(*call, of='t.pfm: has the size 1048577 x 1')
        self.write('t.pfm', f'Pf\n{1 << 20} 1\n-1\n')
        self.passes(*call, but='has the size', says='t.pfm: ')

    def test_rendered_pixels(self):
        rig = json.loads(NOMINAL)
        for key in ('covariance', 'covariance_mvb', 'parameter_names', 'parameters', 'calibration', 'evidence'):
            rig.pop(key)
        rig['cameras'][0]['size_px'] = [10_001, 10_000]
        self.write('rig.json', json.dumps(rig))
        self.refused('render', '--world', 'workshop', '--rig', 'rig.json', '--pose', '10,7.5,0', '-o', 'out',
                     of='10001x10000 px cannot be rendered (limit: 1e8 pixels)')


if __name__ == '__main__':
    size_limits_test.PROGRAM = str(pathlib.Path(sys.argv.pop(1)).resolve())
    unittest.main()
