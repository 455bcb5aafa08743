#!/usr/bin/env python3
# SPDX-FileCopyrightText: 2026 The Vernier authors
# SPDX-License-Identifier: Apache-2.0
"""`vernier convert` from outside: formats by name, all files or none, what is lost is said.

    convert_test.py PROGRAM [unittest's options]
"""
import json
import os
import re
import sys
import unittest

import cli_test
from cli_test import ROOT, Case

NOMINAL = ROOT / 'datasets/rigs/nominal.rig.json'


class Convert(Case):
    def setUp(self):
        super().setUp()
        self.nominal = json.loads(NOMINAL.read_text())

    def out(self, *parts):
        return self.folder.joinpath(*parts)

    def rig(self, name='back.json'):
        return json.loads(self.out(name).read_text())

    def fisheye(self):
        rig = {'format': 'vernier/rig', 'version': 1, 'cameras': self.nominal['cameras']}
        for camera in rig['cameras']:
            camera['model'] = 'fisheye4'
            camera['parameters'].update(k2=0.01, k3=0, k4=0)
        self.out('fisheye.json').write_text(json.dumps(rig))
        return self.out('fisheye.json')

    def expect_nominal(self, *inputs):
        self.works('convert', *inputs, '-o', self.out('back.json'))
        back = self.rig()
        self.assertEqual(back['parameter_names'], self.nominal['parameter_names'])
        for name, a, b in zip(back['parameter_names'], back['parameters'],
                              self.nominal['parameters']):
            self.assertAlmostEqual(a, b, delta=1e-12 * (1 + abs(b)), msg=name)

    def test_there_and_back_by_name(self):
        cases = {'mrcal': ['left.cameramodel', 'right.cameramodel'],
                 'opencv': ['intrinsics.yml', 'extrinsics.yml'],
                 'kalibr': ['camchain.yaml'],
                 'ros': ['left.yaml', 'right.yaml'],
                 'colmap': ['cameras.txt', 'images.txt', 'points3D.txt', 'rig_config.json']}
        for to, files in cases.items():
            with self.subTest(to):
                done = self.works('convert', 'nominal', '--to', to, '-o', f'{self.out(to)}/',
                                  '--json')
                said = json.loads(done.stdout)
                self.assertEqual((said['from'], said['to']), ('vernier', to))
                self.assertEqual(said['files'], [str(self.out(to, f)) for f in files])
                self.assertEqual([c['name'] for c in said['cameras']], ['left', 'right'])
                self.assertEqual(sorted(p.name for p in self.out(to).iterdir()), sorted(files))
                inputs = [self.out(to)] if to == 'colmap' else [self.out(to, f) for f in files]
                self.expect_nominal(*inputs)
        self.expect_nominal(self.out('colmap', 'rig_config.json'))

    def test_single_files(self):
        for to, file in (('opencv', 'rig.yml'), ('kalibr', 'rig.yaml')):
            self.works('convert', 'nominal', '--to', to, '-o', self.out(file))
            self.expect_nominal(self.out(file))
        self.complains('convert', 'nominal', '-o', self.out('x.cameramodel'),
                       of='mrcal stores this rig in 2 files; give a folder',
                       leaves=[self.out('x.cameramodel')])
        self.works('convert', 'nominal', '--to', 'mrcal', '-o', self.folder)
        self.works('convert', self.out('left.cameramodel'), '-o', self.out('one.json'))
        self.works('convert', self.out('one.json'), '-o', self.out('again.cameramodel'))
        self.assertEqual(self.out('again.cameramodel').read_text(),
                         self.out('left.cameramodel').read_text())

    SENSOR = ('%YAML:1.0\nsensor_type: camera\nT_BS:\n  cols: 4\n  rows: 4\n  data: [1, 0, 0, {x},\n'
              '    0, 1, 0, 0,\n    0, 0, 1, 0,\n    0, 0, 0, 1]\nrate_hz: 20\n'
              'resolution: [752, 480]\ncamera_model: pinhole\nintrinsics: [458, 457, 367, 248]\n'
              'distortion_model: radial-tangential\n'
              'distortion_coefficients: [-0.28, 0.07, 0.0002, 1e-05]\n')

    def write_sensors(self):
        for i in (0, 1):
            self.out(f'mav0/cam{i}').mkdir(parents=True)
            self.out(f'mav0/cam{i}/sensor.yaml').write_text(self.SENSOR.format(x=0.11 * i))

    def test_asl_folders_and_files(self):
        self.write_sensors()
        files = [self.out(f'mav0/cam{i}/sensor.yaml') for i in (0, 1)]
        for inputs in (files, [self.out('mav0')], [self.folder]):
            done = self.works('convert', *inputs, '-o', self.out('back.json'), '--json')
            said = json.loads(done.stdout)
            self.assertEqual(said['from'], 'asl')
            self.assertEqual([c['name'] for c in said['cameras']], ['cam0', 'cam1'])
            rig = dict(zip(self.rig()['parameter_names'], self.rig()['parameters']))
            self.assertAlmostEqual(rig['cam1.tx_m'], -0.11)
        self.complains('convert', 'nominal', '--to', 'asl', '-o', self.out('x.yaml'),
                       of='asl is only read', leaves=[self.out('x.yaml')])
        self.complains('convert', files[0], '-o', files[0], of='', leaves=[])

    def test_kitti_calibrations(self):
        k = '700 0 600 {p} 0 700 180 0 0 0 1 0'
        calib = self.out('calib.txt')
        calib.write_text(''.join(f'P{i}: {k.format(p=-70 * i)}\n' for i in range(4)))
        self.complains('convert', calib, '-o', self.out('r.json'), of='does not state the size',
                       leaves=[self.out('r.json')])
        self.works('convert', calib, '--cameras', 'P2,P3', '--names', 'left,right', '--size',
                   '1241x376', '-o', self.out('back.json'))
        rig = dict(zip(self.rig()['parameter_names'], self.rig()['parameters']))
        self.assertAlmostEqual(rig['right.tx_m'], -0.1)
        for wrong in ('P2,P4', 'P2,P2', ','):
            self.complains('convert', calib, '--cameras', wrong, '--size', '1241x376', '-o',
                           self.out('r.json'), of='--cameras', leaves=[self.out('r.json')])
        calib.write_text(k.format(p=0) + ' ' + k.format(p=-70))
        self.works('convert', calib, '--size', '1241x376', '-o', self.out('back.json'))
        self.assertEqual([c['name'] for c in self.rig()['cameras']], ['left', 'right'])

    def test_kept_cameras_keep_their_covariance(self):
        self.works('convert', 'nominal', '--cameras', 'right', '-o', self.out('back.json'))
        names = self.nominal['parameter_names']
        own = [i for i, name in enumerate(names)
               if name.startswith('right.') and not name.endswith(('_rad', '_m'))]
        self.assertEqual(self.rig()['parameter_names'], [names[i] for i in own])
        matrix = self.nominal['covariance']['matrix']
        for i, row in zip(own, self.rig()['covariance']['matrix']):
            for j, value in zip(own, row):
                self.assertAlmostEqual(value, matrix[i][j], delta=1e-12 * abs(matrix[i][j]))
        self.assertEqual(self.rig()['covariance']['kind'], self.nominal['covariance']['kind'])

    def three_cameras(self):
        """A rig of a, b, c with a covariance and no views."""
        rig = {key: self.nominal[key] for key in ('format', 'version')}
        left, right = self.nominal['cameras']
        rig['cameras'] = [{**left, 'name': 'a'}, {**right, 'name': 'b'}, {**right, 'name': 'c'}]
        values = dict(zip(self.nominal['parameter_names'], self.nominal['parameters']))
        old = {'a': 'left', 'b': 'right', 'c': 'right'}
        poses = ('wx_rad', 'wy_rad', 'wz_rad', 'tx_m', 'ty_m', 'tz_m')
        own = [n.split('.')[1] for n in values if n.startswith('left.')]
        names = [(c, p) for c in 'abc' for p in own] + [(c, p) for c in 'bc' for p in poses]
        rig['parameter_names'] = ['.'.join(n) for n in names]
        rig['parameters'] = [values[f'{old[c]}.{p}'] for c, p in names]
        rig['covariance'] = {'kind': 'prior', 'matrix': [
            [(i == j) * (0.01 if p.endswith('_px') else 1e-6) for j in range(len(names))]
            for i, (c, p) in enumerate(names)]}
        self.out('three.json').write_text(json.dumps(rig))
        return self.out('three.json')

    def test_a_rig_of_three_says_how_to_get_a_pair(self):
        three, pair = self.three_cameras(), self.out('pair.json')
        board = ('--board', '9x6', '--square-m', '0.03', '--pixel-sigma', '0.2')
        advice = ('advise', three, '--reduce', 'depth', *board)
        remedy = '--cameras a,b -o pair.json'
        self.complains(*advice, of='name two of them, as in --cameras a,b')
        self.works(*advice, '--cameras', 'a,b')
        image = ROOT / 'datasets/none.png'
        self.complains('rectify', '--rig', three, '--left', image, '--right', image, '-o',
                       f'{self.out("r")}/', of=remedy)
        self.complains('plan', three, '--depth-error', '0.05', of='name two of them, as in --cameras a,b')
        self.works('convert', three, '--cameras', 'b,c', '-o', pair)
        self.works('advise', pair, *advice[2:])
        self.assertEqual(len(self.rig('pair.json')['covariance']['matrix']),
                         len(self.nominal['parameters']))

    def test_a_binary_colmap_model_is_refused_with_the_remedy(self):
        self.out('model').mkdir()
        self.out('model/cameras.bin').write_bytes(b'x')
        for name in ('model', 'model/cameras.bin'):
            self.complains('convert', self.out(name), '-o', self.out('r.json'),
                           of='binary form', leaves=[self.out('r.json')])

    def test_xml_is_called_so(self):
        self.out('r.xml').write_text('<?xml version="1.0"?>\n<opencv_storage></opencv_storage>\n')
        self.complains('convert', self.out('r.xml'), '--from', 'opencv', '-o', self.out('r.json'),
                       of='is XML, which is not read', leaves=[self.out('r.json')])

    def test_what_is_lost_is_said(self):
        done = self.works('convert', 'nominal', '--to', 'opencv', '--names', 'a,b', '-o',
                          self.out('r.yml'), '--json')
        lost = json.loads(done.stdout)['lost']
        self.assertIn('opencv cannot store the covariance; only rig.json stores uncertainty',
                      lost)
        self.assertIn('opencv cannot store names: camera "a" is number 1', lost)
        for line in lost:
            self.assertIn(line, done.stderr.splitlines())
        quiet = self.works('convert', 'nominal', '--to', 'kalibr', '-o', self.out('k.yaml'), '-q')
        self.assertEqual(quiet.stderr, '')

    def test_a_rig_json_keeps_all(self):
        self.works('convert', 'nominal', '--names', 'port,starboard', '-o', self.out('back.json'))
        back = self.rig()
        self.assertEqual(back['covariance'], self.nominal['covariance'])
        for a, b in zip(back['parameters'], self.nominal['parameters'], strict=True):
            self.assertAlmostEqual(a, b, delta=1e-15)
        self.assertEqual(back['parameter_names'][0], 'port.f_px')
        self.assertEqual(len(back['evidence']['observations']),
                         len(self.nominal['evidence']['observations']))
        done = self.works('convert', 'nominal', '--model', 'opencv5', '-o', self.out('back.json'))
        self.assertIn('the covariance belongs to another model and is dropped', done.stderr)
        self.assertNotIn('covariance', self.rig())
        self.assertEqual(self.rig()['cameras'][1]['model'], 'opencv5')
        # and the smallest model that holds it is the first one again
        self.works('convert', self.out('back.json'), '--to', 'opencv', '-o', self.out('r.yml'))
        self.expect_nominal(self.out('r.yml'))

    def test_all_files_or_none(self):
        self.complains('convert', self.fisheye(), '--to', 'mrcal', '-o', f'{self.out("new")}/',
                       of='mrcal has no lens model like fisheye4', leaves=[self.out('new')])
        self.out('models').mkdir()
        self.out('models', 'left.cameramodel').write_text('old')
        os.mkfifo(self.out('models', 'right.cameramodel'))
        self.complains('convert', 'nominal', '--to', 'mrcal', '-o', self.out('models'),
                       of='right.cameramodel: exists and is not a regular file')
        self.assertEqual(self.out('models', 'left.cameramodel').read_text(), 'old')
        self.assertEqual(len(list(self.out('models').iterdir())), 2)
        self.complains('convert', 'nominal', '--to', 'mrcal', '-o', f'{self.out("no", "such")}/',
                       of='cannot be written', leaves=[self.out('no')])

    def test_a_reconstruction_is_spared(self):
        self.works('convert', 'nominal', '--to', 'colmap', '-o', self.folder)
        self.works('convert', 'nominal', '-o', self.out('cameras.txt'))  # our own may be replaced
        self.out('points3D.txt').write_text('1 0 0 1 9 9 9 0.1 1 1\n')
        before = self.out('images.txt').read_bytes()
        self.complains('convert', self.fisheye(), '--to', 'colmap', '-o', self.folder,
                       of='contains a COLMAP reconstruction that would be overwritten')
        self.assertEqual(self.out('images.txt').read_bytes(), before)

    def test_inputs_are_spared(self):
        def spares(*words, file):
            before = file.read_bytes()
            self.complains('convert', *words, of='is an input and would be overwritten')
            self.assertEqual(file.read_bytes(), before)
        self.works('convert', 'nominal', '-o', self.out('rig.json'))
        spares(self.out('rig.json'), '-o', self.out('rig.json'), file=self.out('rig.json'))
        for to in ('mrcal', 'opencv', 'kalibr', 'ros', 'colmap'):
            folder = self.out(to)
            self.works('convert', 'nominal', '--to', to, '-o', f'{folder}/')
            inputs = [folder] if to == 'colmap' else sorted(folder.iterdir())
            spares(*inputs, '--from', to, '--to', to, '-o', folder,
                   file=sorted(folder.iterdir())[0])
        self.works('convert', self.out('mrcal', 'left.cameramodel'),
                   self.out('mrcal', 'right.cameramodel'), '--names', 'a,b', '--to', 'mrcal', '-o',
                   self.out('mrcal'))

    def test_millimetres(self):
        self.works('convert', 'nominal', '--to', 'kalibr', '-o', self.out('k.yaml'))
        text = self.out('k.yaml').read_text()
        tx = json.dumps(self.nominal['cameras'][1]['from_first']['translation_m'][0])
        self.assertIn(tx, text)
        self.out('k.yaml').write_text(text.replace(tx, str(1000 * float(tx))))
        done = self.works('convert', self.out('k.yaml'), '-o', self.out('back.json'))
        self.assertIn('if the file is in millimetres, add --unit-m 0.001', done.stderr)
        self.works('convert', self.out('k.yaml'), '--unit-m', '0.001', '-o', self.out('back.json'))
        self.assertAlmostEqual(self.rig()['cameras'][1]['from_first']['translation_m'][0],
                               float(tx), places=15)

    def test_bad_usage(self):
        out = self.out('out.json')
        self.works('convert', 'nominal', '--to', 'kalibr', '-o', self.out('k.yaml'))
        self.works('convert', 'nominal', '--to', 'mrcal', '-o', self.folder)
        self.out('plain.yaml').write_text('key: 1\n')
        self.out('broken.yaml').write_text('cam0: [1, 2\n')
        for words, of in (
                (['nominal', '-o', self.out('x.yaml')], 'add --to, one of vernier, mrcal'),
                (['nominal', '--to', 'hugin', '-o', out], '--to: unknown format "hugin"'),
                ([self.out('plain.yaml'), '-o', out], 'set --from to opencv, kalibr, ros or asl'),
                ([self.out('broken.yaml'), '-o', out], 'broken.yaml:2: is not YAML'),
                ([self.folder, '-o', out], 'is a folder without a cameras.txt'),
                ([self.out('a.xml'), '-o', out], 'cannot tell the format from the file name'),
                ([self.out('none.cameramodel'), '-o', out], 'none.cameramodel: cannot be read'),
                ([self.out('k.yaml'), self.out('left.cameramodel'), '-o', out],
                 'is not of the format kalibr like'),
                ([self.out('k.yaml'), self.out('k.yaml'), '-o', out], 'a Kalibr rig is a single'),
                ([self.out('k.yaml'), '--size', '640x480', '-o', out],
                 '--size: kalibr files contain the image size'),
                (['nominal', '--unit-m', '0.001', '-o', out], '--unit-m: rig.json files are in metres'),
                (['nominal', '--unit-m', '-1', '-o', out], '--unit-m'),
                (['nominal', '--names', 'a', '-o', out], '1 names for 2 cameras'),
                (['nominal', '--names', 'a,a', '-o', out], 'two cameras have the same name'),
                (['nominal', '--names', '../a,b', '--to', 'ros', '-o', self.folder],
                 'its name is not valid as a file name'),
                ([self.out('k.yaml'), '--model', 'pinhole', '-o', out],
                 'is not in the model pinhole; choose a larger model'),
                (['nominal', '--model', 'fisheye9', '-o', out], 'unknown model')):
            with self.subTest(of):
                self.complains('convert', *words, of=of, leaves=[out])

    def test_json_of_opencv(self):
        # as cv::FileStorage writes a file named .json
        self.works('convert', 'nominal', '--to', 'opencv', '-o', self.out('r.yml'))
        keys = {}
        for key, rest in re.findall(r'^(\w+): (!!opencv-matrix\n(?: +.*\n)+|.*)', self.out('r.yml').read_text(), re.M):
            found = dict(re.findall(r'(\w+): (.*)', rest)) if rest.startswith('!!') else None
            keys[key] = (int(rest) if rest.isdigit() else rest) if found is None else {
                'type_id': 'opencv-matrix', 'rows': int(found['rows']), 'cols': int(found['cols']),
                'dt': 'd', 'data': json.loads(found['data'])}
        self.out('r.json').write_text(json.dumps(keys, indent=4))
        self.expect_nominal(self.out('r.json'))

    def test_opencv_without_sizes(self):
        self.works('convert', 'nominal', '--to', 'opencv', '-o', self.out('r.yml'))
        lines = self.out('r.yml').read_text().splitlines()
        self.out('r.yml').write_text('\n'.join(x for x in lines if not x.startswith('image_')))
        self.complains('convert', self.out('r.yml'), '-o', self.out('back.json'),
                       of='the file does not give the image size')
        self.works('convert', self.out('r.yml'), '--size', '640x480', '-o', self.out('back.json'))
        self.assertEqual(self.rig()['cameras'][0]['size_px'], [640, 480])
        done = self.works('convert', self.out('r.yml'), '--size', '640x480,1280x960', '-o', self.out('back.json'))
        self.assertEqual([c['size_px'] for c in self.rig()['cameras']], [[640, 480], [1280, 960]])
        self.assertIn('camera "right": its principal point', done.stderr)
        self.assertNotIn('camera "left": its principal point', done.stderr)


if __name__ == '__main__':
    cli_test.PROGRAM = os.path.abspath(sys.argv.pop(1))
    unittest.main(module='__main__')
