#!/usr/bin/env python3
# SPDX-FileCopyrightText: 2026 The Vernier authors
# SPDX-License-Identifier: Apache-2.0
"""vernier render as a user calls it.

    render_test.py PROGRAM [unittest's options]
"""
import hashlib
import json
import math
import os
import pathlib
import random
import struct
import subprocess
import sys
import unittest

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent))
sys.dont_write_bytecode = True
import verb_calls

PROGRAM = pathlib.Path(sys.argv[1]).resolve()
POSE = ('--pose', '10,7.5,0')


def has_embree():
    report = json.loads(subprocess.run([PROGRAM, 'doctor', '--json'], capture_output=True, text=True,
                                       timeout=60).stdout)
    return 'missing' not in json.dumps(report).split('Embree')[1][:80]


def floats(file):
    """Width, height and rows, from the top, of a PFM file."""
    kind, size, scale, data = file.read_bytes().split(b'\n', 3)
    assert kind == b'Pf' and float(scale) < 0
    width, height = map(int, size.split())
    values = struct.unpack(f'<{width * height}f', data)
    return width, height, [values[i * width:(i + 1) * width] for i in reversed(range(height))]


def hashes(folder):
    return {str(file.relative_to(folder)): hashlib.sha256(file.read_bytes()).hexdigest()
            for file in sorted(folder.rglob('*')) if file.is_file()}


@unittest.skipUnless(has_embree(), 'built without Embree')
class Render(verb_calls.ProgramCase):
    program = PROGRAM

    def done(self, *words):
        run = self.run_program(*words, '--json')
        self.assertIn(run.returncode, (0, 3), run.stderr)
        return json.loads(run.stdout)

    def refused(self, *words, of):
        before = sorted(self.folder.rglob('*'))
        run = self.run_program('render', *words)
        self.assertEqual(run.returncode, 2, run.stdout + run.stderr)
        self.assertEqual(run.stderr.count('\n'), 1, run.stderr)
        self.assertIn(of, run.stderr)
        self.assertEqual(run.stdout, '')
        self.assertEqual(sorted(self.folder.rglob('*')), before)

    def test_one_pose_is_a_pair_with_its_truth(self):
        made = self.done('render', *POSE, '-o', 'one')
        self.assertEqual(len(made['poses']), 1)
        folder = self.folder / 'one'
        for name in ('left', 'right', 'rectified/left', 'rectified/right', 'rectified/occluded'):
            head = (folder / f'{name}.png').read_bytes()[:26]
            self.assertEqual(head[:4], b'\x89PNG')
            width, height, depth, colour = struct.unpack('>IIBB', head[16:26])
            self.assertEqual((width, height, depth, colour), (640, 480, 8, 0), name)
        edges = json.loads((folder / 'edges.json').read_text())
        self.assertEqual(len(edges['edges']), made['poses'][0]['edges'])
        self.assertEqual({e['shown_as'] for e in edges['edges']},
                         {'border', 'outline', 'line', 'bar'})
        camera = json.loads((folder / 'rectified/rig.json').read_text())['cameras']
        f_b = -camera[0]['parameters']['f_px'] * camera[1]['from_first']['translation_m'][0]
        width, height, depths = floats(folder / 'rectified/depth.pfm')
        disparities = floats(folder / 'rectified/disparity.pfm')[2]
        self.assertEqual((width, height), (640, 480))
        chance, known = random.Random(1), 0
        for _ in range(500):
            x, y = chance.randrange(width), chance.randrange(height)
            if math.isfinite(depths[y][x]):
                self.assertAlmostEqual(depths[y][x] * disparities[y][x] / f_b, 1, places=5)
                known += 1
        self.assertGreater(known, 480)

    def test_an_image_of_little_but_white_is_doubted(self):
        run = self.run_program('render', *POSE, '--exposure', '1e6', '-o', 'white', '--json')
        self.assertEqual(run.returncode, 3, run.stderr)
        self.assertIn('lower --exposure', run.stderr)
        self.assertGreater(json.loads(run.stdout)['poses'][0]['saturated'], 0.9)

    def test_edges_lie_on_the_surfaces_of_the_truth(self):
        self.done('render', *POSE, '-o', 'one')
        disparities = floats(self.folder / 'one/rectified/disparity.pfm')[2]
        near = far = 0
        for edge in json.loads((self.folder / 'one/edges.json').read_text())['edges']:
            if edge['shown_as'] == 'bar':
                continue
            u1, v1, u2, v2 = edge['left_px']
            u, v = (u1 + u2) / 2, (v1 + v2) / 2
            if not (3 < u < 636 and 3 < v < 476):
                continue
            # The middle of an image is not that of the edge, but disparity is linear along the image.
            d = sum(edge['disparity_px']) / 2
            seen = [disparities[round(v) + j][round(u) + i] for j in (-2, 0, 2) for i in (-2, 0, 2)]
            if min(abs(d - s) for s in seen if math.isfinite(s)) < 0.6:
                near += 1
            else:
                far += 1
        self.assertGreater(near, 40 * max(1, far))

    def test_repeats_to_the_byte(self):
        first = self.done('render', *POSE, '--samples', 2, '-o', 'a')
        for threads, name in ((1, 'b'), (8, 'c')):
            self.done('render', *POSE, '--samples', 2, '--threads', threads, '-o', name)
            self.assertEqual(hashes(self.folder / name), hashes(self.folder / 'a'))
        self.done('render', *POSE, '--samples', 2, '--seed', 2, '-o', 'd')
        a, d = hashes(self.folder / 'a'), hashes(self.folder / 'd')
        self.assertNotEqual(a['left.png'], d['left.png'])
        self.assertEqual(a['rectified/disparity.pfm'], d['rectified/disparity.pfm'])
        self.assertEqual(a['edges.json'], d['edges.json'])
        self.assertGreater(first['poses'][0]['exposure'], 0)

    def test_a_set_is_read_by_evaluate_and_characterise(self):
        made = self.done('render', '--poses', 2, '-o', 'set')
        self.assertEqual([pose['folder'] for pose in made['poses']], ['000/', '001/'])
        scores = self.done('evaluate', '--scenes', 'set/pairs.toml', '--matcher', 'edge')
        text = json.dumps(scores)
        self.assertIn('"edge"', text)
        run = self.run_program('evaluate', '--scenes', 'set/pairs.toml', '--matcher', 'sgbm', '--json')
        self.assertIn(run.returncode, (0, 3), run.stderr)
        run = self.run_program('characterise', '--scenes', 'set/pairs.toml', '--json', '-q')
        self.assertIn(run.returncode, (0, 3), run.stderr)

    def test_the_comparison_writes_sources_that_a_study_reads(self):
        made = self.done('render', '--poses', 3, '--compare', '-o', 'set')['comparison']
        self.assertEqual(made['pairs'], 3)
        self.assertEqual(made['sources']['lateral_shift_px']['default'], 3)
        self.assertLess(made['sources']['lateral_shift_px']['shown'], 1.5)
        self.assertGreater(made['by']['contrast'][0]['pair_loss'], made['by']['contrast'][4]['pair_loss'])
        clear = made['by']['clear steps'][0]
        self.assertLess(clear['pair_loss'], 0.2)
        self.assertLess(clear['median_shift_px'], 0.1)
        self.assertEqual(json.loads((self.folder / 'set/comparison.json').read_text()), made)
        page = (self.folder / 'set/comparison.html').read_text()
        self.assertEqual(page.count('<svg'), 4 * len(made['by']))
        (self.folder / 'study.toml').write_text('[study]\ntrials = 2\n[sources]\n'
                                                'file = "set/sources.toml"\ncalibration = 0\n')
        study = self.run_program('study', 'study.toml', '-o', 'out', '--threads', 1, '-q')
        self.assertIn(study.returncode, (0, 3), study.stderr)

    def test_bad_input_is_refused_in_one_line(self):
        self.refused('-o', 'out', of='--pose or --poses')
        self.refused(*POSE, '--poses', 3, '-o', 'out', of='--pose')
        self.refused('--pose', '1,2', '-o', 'out', of='--pose')
        self.refused('--pose', '10,8.5,0', '-o', 'out', of='--pose 10,8.5,0')
        self.refused(*POSE, '--texture', 5, '-o', 'out', of='texture')
        self.refused(*POSE, '--gamma', 0, '-o', 'out', of='gamma')
        self.refused(*POSE, '--world', 'nowhere', '-o', 'out', of='nowhere')
        (self.folder / 'lines.world.toml').write_text(
            'format = "vernier/world"\nversion = 1\n[loose]\nsegments = [[0, 0, 0, 5, 5, 2]]\n')
        self.refused('--world', 'lines.world.toml', '--pose', '1,2,0', '-o', 'out', of='no surfaces')
        rig = json.loads((verb_calls.ROOT / 'datasets/rigs/nominal.rig.json').read_text())
        for camera in rig['cameras']:
            camera['size_px'] = [90000, 90000]
        (self.folder / 'huge.rig.json').write_text(json.dumps(
            {key: rig[key] for key in ('format', 'version', 'cameras')}))
        self.refused('--rig', 'huge.rig.json', *POSE, '-o', 'out', of='90000x90000')
        (self.folder / 'taken').write_text('a file')
        self.refused(*POSE, '--samples', 1, '-q', '-o', 'taken', of='taken')
        if os.geteuid() != 0:
            (self.folder / 'closed').mkdir(mode=0o500)
            self.refused(*POSE, '--samples', 1, '-q', '-o', 'closed/out', of='closed')
        self.refused(*POSE, '--samples', 1, '-q', '-o', '/proc/out', of='/proc')

    def test_does_not_overwrite_what_it_reads(self):
        (self.folder / 'rectified').mkdir()
        rig = self.folder / 'rectified/rig.json'
        rig.write_text((verb_calls.ROOT / 'datasets/rigs/nominal.rig.json').read_text())
        self.refused('--rig', 'rectified/rig.json', *POSE, '-o', '.', of='is an input')


if __name__ == '__main__':
    unittest.main(argv=[sys.argv[0]] + sys.argv[2:])
