#!/usr/bin/env python3
# SPDX-FileCopyrightText: 2026 The Vernier authors
# SPDX-License-Identifier: Apache-2.0
"""Impossible sizes: every one ends with a word, at exit code 2, in little time and memory.

    size_limits_test.py PROGRAM
"""
import os
import pathlib
import resource
import struct
import subprocess
import sys
import tempfile
import threading
import unittest
import zlib

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent))
sys.dont_write_bytecode = True
import verb_calls

ROOT = pathlib.Path(__file__).resolve().parents[2]
PRIOR = str(ROOT / 'docs/examples/datasheet.json')
PROGRAM = ''
MOST_CPU_S = 60
MB = 1 << 20
WORLD = 'format = "vernier/world"\nversion = 1\n'


class Done:
    """One call of the program: exit code, output and peak memory."""

    def __init__(self, *arguments, folder, cpu_s=MOST_CPU_S, virtual_mb=None):
        def limit():
            resource.setrlimit(resource.RLIMIT_CPU, (cpu_s, cpu_s + 1))
            resource.setrlimit(resource.RLIMIT_CORE, (0, 0))
            if virtual_mb:
                resource.setrlimit(resource.RLIMIT_AS, (virtual_mb * MB, virtual_mb * MB))

        with tempfile.TemporaryFile() as out, tempfile.TemporaryFile() as err:
            child = subprocess.Popen([PROGRAM, *map(str, arguments)], cwd=folder, stdout=out,
                                     stderr=err, preexec_fn=limit)
            _, status, used = os.wait4(child.pid, 0)
            child.returncode = self.code = os.waitstatus_to_exitcode(status)
            out.seek(0)
            err.seek(0)
            self.out = out.read().decode(errors='replace')
            self.err = err.read().decode(errors='replace')
        self.peak_mb = used.ru_maxrss / 1024


def png(width, height, depth=8, before_pixels=b'', value=0):
    """A PNG of one grey value: a thousand times smaller than its pixels."""
    def chunk(kind, data):
        return struct.pack('>I', len(data)) + kind + data + struct.pack('>I', zlib.crc32(kind + data))

    pack = zlib.compressobj(1)
    row = b'\0' + bytes([value]) * ((width * depth + 7) // 8)
    rows = b''.join(pack.compress(row) for _ in range(height)) + pack.flush()
    head = struct.pack('>IIBBBBB', width, height, depth, 0, 0, 0, 0)
    profile = chunk(b'iCCP', before_pixels) if before_pixels else b''
    return (b'\x89PNG\r\n\x1a\n' + chunk(b'IHDR', head) + profile + chunk(b'IDAT', rows) +
            chunk(b'IEND', b''))


class Case(unittest.TestCase):
    def setUp(self):
        self.temporary = tempfile.TemporaryDirectory()
        self.folder = pathlib.Path(self.temporary.name)

    def tearDown(self):
        self.temporary.cleanup()

    def call(self, *arguments, **limits):
        return Done(*arguments, folder=self.folder, **limits)

    def write(self, name, content):
        data = content if isinstance(content, bytes) else content.encode()
        (self.folder / name).write_bytes(data)
        return name

    def refused(self, *arguments, of, peak_mb=500, **limits):
        done = self.call(*arguments, **limits)
        self.assertEqual(done.code, 2, done.err)
        self.assertEqual(done.err.count('\n'), 1, done.err)
        self.assertIn(of, done.err)
        self.assertLess(done.peak_mb, peak_mb)
        self.assertEqual(done.out, '')
        return done


class Worlds(Case):
    def test_coordinates(self):
        for coordinate in ('1e308', '1e6', '100000', '-10001'):
            self.write('w.world.toml', WORLD + '[loose]\nsegments = [[0,0,0,0,0,2],\n'
                       f'[1,1,0,{coordinate},1,0]]\n[[route]]\npoints_m = [[0,0],[1,0]]\n')
            self.write('s.toml', '[study]\ntrials = 1\n[world]\nfile = "w.world.toml"\n')
            for call in (('world', 'info', 'w.world.toml'),
                         ('simulate', '--world', 'w.world.toml', '--pose', '0,0,0'),
                         ('study', 's.toml', '-o', 'out')):
                self.refused(*call, of='w.world.toml:5: loose segment 1 is farther than 10000 m')
            self.assertFalse((self.folder / 'out').exists())

    def test_a_wide_world_is_cheap(self):
        text = WORLD + '[loose]\nsegments = [\n'
        for x in (-9980, 0, 9980):
            for k in range(20):
                at = x + 0.7 * k
                text += f'[{at},{x + 2},0,{at},{x + 2},2.2],[{at},{x + 2},2.2,{x},{x + 3},2.2],\n'
        self.write('w.world.toml', text + ']\n[[route]]\npoints_m = [[2,0],[8,0]]\n')
        self.write('s.toml', '[study]\ntrials = 1\n[world]\nfile = "w.world.toml"\n')
        done = self.call('study', 's.toml', '-o', 'out')
        self.assertEqual(done.code, 0, done.err)
        self.assertLess(done.peak_mb, 300)
        done = self.call('simulate', '--world', 'w.world.toml', '--pose', '5000,5000,0')
        self.assertIn(done.code, (0, 2), done.err)
        self.assertLess(done.peak_mb, 300)

    def test_a_long_route_gives_no_map_of_one_place_a_leg(self):
        segments = '[loose]\nsegments = [[0,0,0,0,0,2]]\n'
        self.write('s.toml', '[study]\ntrials = 1\n[world]\nfile = "w.world.toml"\n')
        self.write('w.world.toml', WORLD + segments + '[[route]]\npoints_m = [[0,0],[1e9,0]]\n')
        self.refused('study', 's.toml', '-o', 'out', of='w.world.toml:6: route 0 is farther')
        self.write('w.world.toml', WORLD + segments + '[[route]]\npoints_m = [[0,0],[9000,0]]\n')
        self.write('s.toml', '[study]\ntrials = 1\n[world]\nfile = "w.world.toml"\n'
                   '[map]\nspacing_m = 0.01\n')
        self.refused('study', 's.toml', '-o', 'out', of='gives 900000 views')
        self.assertFalse((self.folder / 'out').exists())

    def test_templates_that_multiply(self):
        rows = ',\n'.join(f'[0,0,{0.01 * k:.2f},1,0,{0.01 * k:.2f}]' for k in range(1001))
        text = WORLD + f'[[template]]\nname = "t"\nsegments = [{rows}]\n'
        text += '[[instance]]\ntemplate = "t"\nat_m = [0,0,0]\n' * 1000
        self.write('w.world.toml', text)
        self.refused('world', 'info', 'w.world.toml', of='w.world.toml: has 1001000 segments')

    def test_surfaces_of_many_points(self):
        self.write('w.world.toml', WORLD + '[[surface]]\npolygon = [' +
                   '[0,0,0],[1,0,0],[1,1,0],' * 100 + ']\n')
        self.refused('world', 'info', 'w.world.toml', of='has 300 points, more than 200')


class Studies(Case):
    def test_sweeps_that_multiply(self):
        values = ', '.join(f'{k / 1000:g}' for k in range(200))
        self.write('s.toml', f'[study]\ntrials = 20\n[sweep]\n"sources.edge_loss" = [{values}]\n'
                   f'"sources.calibration" = [{values}]\n')
        self.refused('study', 's.toml', '-o', 'out', of='s.toml:3: the sweep has more than 10000 cells')
        self.assertFalse((self.folder / 'out').exists())

    def test_trials(self):
        for trials in ('1000000000000', '0', '-1', '9223372036854775807'):
            self.write('s.toml', f'[study]\ntrials = {trials}\n')
            self.refused('study', 's.toml', '-o', 'out', of='out of range; use 1 to 10000000')
        self.write('s.toml', '[study]\ntrials = 6000000\n[sweep]\n"study.seed" = [1, 2]\n')
        self.refused('study', 's.toml', '-o', 'out', of='2 cells of 6000000 trials are 12000000')


class Maps(Case):
    def route(self, length_m):
        self.write('w.world.toml', WORLD + '[loose]\nsegments = [[0,1,0,0,1,2]]\n'
                   f'[[route]]\npoints_m = [[0,0],[{length_m},0]]\n')
        return 'w.world.toml'

    def test_nodes(self):
        self.refused('map', 'make', '--world', self.route(9000), '--spacing-m', '0.01', '-o', 'w.map',
                     of='gives 900000 views')
        self.refused('map', 'make', '--world', self.route(900), '--headings', '360', '-o', 'w.map',
                     of='more than 100000')
        self.assertFalse((self.folder / 'w.map').exists())

    def test_lines_of_a_view(self):
        line = '{"a_m":[2,0,0],"b_m":[2,0,2],"kind":"vertical","sigma_m":0.02}'
        self.write('v.jsonl', '{"pose":[0,0,0],"lines":[' + ','.join([line] * 10_001) + ']}\n')
        call = ('--features', 'v.jsonl', '--rig', 'nominal', '-o', 'w.map')
        self.refused('map', 'make', *call, of='v.jsonl:1: lines: has 10001 entries; give at most 10000')
        look = '{"turn_rad":0,"lines":[]}'
        self.write('v.jsonl', '{"pose":[0,0,0],"looks":[' + ','.join([look] * 65) + ']}\n')
        self.refused('map', 'make', *call, of='v.jsonl:1: looks: has 65 entries; give at most 64')
        self.write('v.jsonl', '{"lines":[]}\n' * 100_001)
        self.refused('map', 'make', *call, of='v.jsonl:100001: is one of more than 100,000 positions')

    def test_a_large_map_costs_what_it_holds(self):
        self.write('v.jsonl', ''.join('{"pose":[%d,0,0],"lines":[]}\n' % i for i in range(100_000)))
        done = self.call('map', 'make', '--features', 'v.jsonl', '--rig', 'nominal', '-o', 'w.map')
        self.assertEqual(done.code, 3, done.err)
        done = self.call('map', 'info', 'w.map', '--json', cpu_s=10)
        self.assertEqual(done.code, 3, done.err)
        self.assertIn('"nodes":100000', done.out)
        self.assertLess(done.peak_mb, 400)

    def test_devices_are_no_maps(self):
        self.refused('map', 'info', '/dev/zero', of='/dev/zero: ')
        self.refused('localise', '/dev/full', '--world', 'workshop', of='/dev/full: ')
        self.refused('map', 'make', '--features', '/dev/zero', '-o', 'w.map', of='/dev/zero: ')


class Drives(Case):
    def test_poses(self):
        self.write('w.world.toml', WORLD + '[loose]\nsegments = [[0,1,0,0,1,2]]\ncorners = [[0,1,1]]\n'
                   '[[route]]\npoints_m = [[0,0],[9000,0]]\n')
        self.refused('odometry', '--world', 'w.world.toml', '--step-m', '0.001',
                     of='has more than 100000 poses')

    def test_memory_does_not_grow_with_the_drives(self):
        def peak(drives):
            done = self.call('odometry', '--world', 'workshop', '--leg', '2', '--drives', drives, '-q')
            self.assertIn(done.code, (0, 3), done.err)
            return done.peak_mb
        self.assertLess(peak(21), peak(1) + 8)  # 24 MB more if they are kept


class Images(Case):
    def evaluate(self, left, right='r1.png', **how):
        return self.refused('evaluate', '--left', left, '--right', right, '--truth', 't.pfm', **how)

    def test_pixels_by_the_thousand_a_byte(self):
        large = png(16000, 16000, 1)
        self.assertLess(len(large), 200_000)
        self.write('l1.png', large)
        self.write('r1.png', large + b'x')
        word = 'l1.png: has a header of 16000x16000 pixels, more than can be read (134217728)'
        self.evaluate('l1.png', of=word)
        self.refused('detect', '--left', 'l1.png', '--board', '9x6', '-o', 'c.vnl', of=word)
        self.refused('match', '--left', 'l1.png', '--right', 'r1.png', '--prior', PRIOR, '-o',
                     'p.csv', of=word)
        self.refused('rectify', '--rig', 'nominal', '--left', 'l1.png', '--right', 'r1.png', '-o',
                     'out', of=word)

    def test_other_heads(self):
        small = self.write('r1.png', png(64, 48))
        tiff = struct.pack('<2sHIH', b'II', 42, 8, 2) + b''.join(
            struct.pack('<HHII', tag, 4, 1, 40000) for tag in (256, 257)) + bytes(4)
        bmp = b'BM' + bytes(12) + struct.pack('<IiiHH', 40, 40000, -40000, 1, 24) + bytes(24)
        for name, content in (('l1.tif', tiff), ('l1.bmp', bmp), ('l1.pgm', b'P5 40000 40000 255\n'),
                              ('l1.ppm', b'P3 40000 40000 255\n')):
            self.evaluate(self.write(name, content), small,
                          of='has a header of 40000x40000 pixels')

    def test_maps(self):
        self.write('l1.png', png(640, 480))
        self.write('r1.png', png(640, 480, value=85))
        self.write('t.pfm', b'Pf\n20000 20000\n-1\n')
        self.evaluate('l1.png', of='t.pfm: has a header of 20000x20000 pixels')

    def test_devices_are_no_files(self):
        word = '/dev/zero: is a device, not a file'
        self.write('r1.png', png(64, 48))
        self.evaluate('/dev/zero', of=word)
        self.refused('rectify', '--rig', 'nominal', '--left', '/dev/zero', '--right', 'r1.png',
                     '-o', 'out', of=word)
        self.refused('calibrate', '--observations', '/dev/zero', '--size', '640x480', '-o',
                     'q.json', of=word)
        for call in (('world', 'info', '/dev/zero'), ('sample', '/dev/zero', '-o', 's.csv'),
                     ('convert', '/dev/zero', '-o', 'x.json'), ('study', '/dev/zero', '-o', 'out'),
                     ('diff', '/dev/zero', 'nominal')):
            self.refused(*call, of='/dev/zero')

    def test_files_of_gigabytes(self):
        with open(self.folder / 'w.world.toml', 'wb') as file:
            file.truncate((1 << 30) + 1)
        self.refused('world', 'info', 'w.world.toml', of='is larger than 1073741824 bytes')

    def test_pipes_are_read(self):
        image = png(64, 48)
        os.mkfifo(self.folder / 'l1.png')
        self.write('r1.png', png(64, 48, value=85))
        self.write('t.pfm', b'Pf\n64 48\n-1\n' + bytes(4 * 64 * 48))

        def feed():
            with open(self.folder / 'l1.png', 'wb') as pipe:
                pipe.write(image)

        writer = threading.Thread(target=feed, daemon=True)
        writer.start()
        done = self.call('rectify', '--rig', 'nominal', '--left', 'l1.png', '--right', 'r1.png',
                         '-o', 'out')
        writer.join(10)
        self.assertFalse(writer.is_alive())
        self.assertIn('64x48', done.err)  # it was read: the rig is of another size

    def test_libraries_say_nothing_beside_ours(self):
        """Of any verb that reads images; most refuse these grey ones, once they have read them."""
        odd = b'x\0\0no profile'
        for number in (1, 2):
            self.write(f'l{number}.png', png(640, 480, before_pixels=odd))
            self.write(f'r{number}.png', png(640, 480, value=85, before_pixels=odd))
        self.write('truth.png', png(640, 480, value=40, before_pixels=odd))
        self.write('depth.png', png(640, 480, depth=16, value=9, before_pixels=odd))
        self.write('K.txt', '500 0 320\n0 500 240\n0 0 1\n')
        self.write('known.map', verb_calls.map_file(verb_calls.features().splitlines()))
        pair = ('--left', 'l1.png', '--right', 'r1.png')
        truth = (*pair, '--truth', 'truth.png', '--truth-scale', '4', '--max-disparity', '20')
        for call, says in (
                (('rectify', '--rig', 'nominal', *pair, '-o', 'out'), 'row alignment'),
                (('detect', *pair, '--board', '9x6', '-o', 'c.vnl'), 'no 9x6 board'),
                (('calibrate', *pair, '--board', '9x6', '--square-m', '0.1', '-o', 'c.json'), 'no 9x6 board'),
                (('match', *pair, '--prior', 'nominal', '-o', 'p.csv'), 'no corner'),
                (('stereo', *pair, '--rectified', '--f-px', '500', '--baseline-m', '0.1', '-o', 'st'), 'no edges'),
                (('evaluate', *truth, '--matcher', 'edge', '-o', 'ev'), 'no edge'),
                (('characterise', *truth, '-o', 's.toml'), 'no edge'),
                (('lines', '--image', 'l1.png', '--depth', 'depth.png', '--rig', 'K.txt', '-o', 'l.jsonl'),
                 'no reliable line'),
                (('localise', 'known.map', *pair, '--rig', 'nominal'), 'too few lines'),
                (('odometry', '--left', 'l?.png', '--right', 'r?.png', '--rig', 'nominal', '-o', 'o.txt'),
                 'corner')):
            with self.subTest(call[0]):
                done = self.call(*call)
                self.assertIn(says, done.err)  # what is wrong with the images: they were read
                for word in ('libpng', 'OpenCV', 'iCCP', 'profile'):
                    self.assertNotIn(word, done.err)


class Numbers(Case):
    def test_samples_are_written_as_they_are_drawn(self):
        done = self.call('sample', 'nominal', '-n', 400_000, '-o', 's.csv', '-q')
        self.assertEqual(done.code, 0, done.err)
        size_mb = (self.folder / 's.csv').stat().st_size / MB
        self.assertGreater(size_mb, 60)
        self.assertLess(done.peak_mb, 120)

    def test_options(self):
        for call, word in (
                (('sample', 'nominal', '-n', '0', '-o', 's.csv'), 'not in range'),
                (('sample', 'nominal', '-n', '1e12', '-o', 's.csv'), '1e12'),
                (('uncertainty', 'nominal', '--grid', '100000x100000'), 'above 1000'),
                (('uncertainty', 'nominal', '--samples', '10000000'), 'not in range'),
                (('diff', 'nominal', 'nominal', '--grid', '1000x1000'), 'more than 100000'),
                (('advise', 'nominal', '--board', '1000x1000', '--square-m', '0.03'),
                 'more than 10000'),
                (('rectify', '--rig', 'nominal', '--left', 'l.png', '--right', 'r.png', '--size',
                  '100000x100000', '-o', 'out'), ''),
                (('detect', '--left', 'l.png', '--board', '1000x1000', '-o', 'c.vnl'), ''),
                (('world', 'make', '--size-m', '1e9,1,1', '-o', 'w.toml'), 'at most 200 m')):
            self.refused(*call, of=word)


if __name__ == '__main__':
    PROGRAM = str(pathlib.Path(sys.argv.pop(1)).resolve())
    unittest.main()
