#!/usr/bin/env python3
# SPDX-FileCopyrightText: 2026 The Vernier authors
# SPDX-License-Identifier: Apache-2.0
"""Deep, long, doubled, cut and foreign text for every kind of file: one line that names the file,
exit code 2, 300 MB, no hang. Every verb: verb_texts_test.py.

    text_limits_test.py PROGRAM
"""
import json
import os
import pathlib
import random
import re
import sys
import unittest

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent))
sys.dont_write_bytecode = True
import text_faults
import verb_calls
from text_faults import (LONG, NOMINAL, ROOT, Run, json_faults, python_faults, table_faults,
                         toml_faults, yaml_faults)

WORLD = (ROOT / 'datasets/worlds/workshop.world.toml').read_text()


class TextLimits(text_faults.TextCase):
    def test_rigs(self):
        verbs = [('sample', 'rig.json', '-n', '2', '-o', 's.csv')]
        others = [('convert', 'rig.json', '--to', 'kalibr', '-o', 'k.yaml'),
                  ('diff', 'good.json', 'rig.json'), ('diff', 'rig.json', 'good.json'),
                  ('report', 'rig.json', '-o', 'r.html'), ('uncertainty', 'rig.json'),
                  ('advise', 'rig.json'), ('check', 'rig.json'),
                  ('combine', 'rig.json', 'good.json', '-o', 'c.json'),
                  ('stereo', '--rig', 'rig.json', '--left', 'left.pgm', '--right', 'right.pgm',
                   '-o', 'e.csv'),
                  ('rectify', '--rig', 'rig.json', '--left', 'left.pgm', '--right', 'right.pgm',
                   '-o', 'out'),
                  ('match', '--prior', 'rig.json', '--left', 'left*.pgm', '--right', 'right*.pgm',
                   '-o', 'p.csv'),
                  ('simulate', '--rig', 'rig.json', '--pose', '5,5,0')]
        for what, text in json_faults(NOMINAL):
            self.write('rig.json', text)
            for verb in verbs:
                self.refuses(what, 'rig.json', *verb)
        for what, text in json_faults(NOMINAL):
            if what not in ('deep inside', 'doubled key', 'number 1e309'):
                continue
            self.write('rig.json', text)
            for verb in others:
                self.refuses(what, 'rig.json', *verb)

    def changed(self, change):
        rig = json.loads(NOMINAL)
        change(rig)
        return json.dumps(rig)

    def test_values_of_rigs(self):
        def camera(key, value):
            def change(rig):
                rig['cameras'][0][key] = value
            return change

        def parameter(name, value):
            def change(rig):
                rig['cameras'][0]['parameters'][name] = value
                index = rig['parameter_names'].index('left.' + name)
                rig['parameters'][index] = value
            return change

        def variance(row, column, value):
            def change(rig):
                rig['covariance']['matrix'][row][column] = value
            return change

        def indefinite(rig):
            matrix = rig['covariance']['matrix']
            matrix[0][1] = matrix[1][0] = 2 * (matrix[0][0] * matrix[1][1]) ** 0.5

        def many_cameras(rig):
            rig['cameras'] = [dict(rig['cameras'][1], name=f'c{i}') for i in range(1000)]

        changes = {
            'width beyond int': camera('size_px', [1e300, 480]),
            'width 2^32 + 1': camera('size_px', [4294967297, 480]),
            'long name': camera('name', 'n' * 100_000),
            'name of control characters': camera('name', '\x1b[31mleft'),
            'long model': camera('model', 'm' * 100_000),
            'focal length 1e300': parameter('f_px', 1e300),
            'negative focal length': parameter('f_px', -500),
            'not symmetric': variance(0, 1, 0.5),
            'negative variance': variance(0, 0, -1),
            'variance 1e300': variance(0, 0, 1e300),
            'not positive semi-definite': indefinite,
            'many cameras': many_cameras,
            'version 2^32 + 1': lambda rig: rig.update(version=4294967297),
            'unknown kind': lambda rig: rig['covariance'].update(kind='k' * 100_000),
            'long parameter name': lambda rig: rig['parameter_names'].append('p' * 100_000),
            'other format': lambda rig: rig.update(format='f' * 100_000),
        }
        for what, change in changes.items():
            self.write('rig.json', self.changed(change))
            self.refuses(what, 'rig.json', 'sample', 'rig.json', '-n', '2', '-o', 's.csv')
        for what in ('not symmetric', 'not positive semi-definite', 'focal length 1e300'):
            self.write('rig.json', self.changed(changes[what]))
            for verb in (('uncertainty', 'rig.json'), ('advise', 'rig.json'),
                         ('diff', 'rig.json', 'good.json'), ('report', 'rig.json', '-o', 'r.html'),
                         ('convert', 'rig.json', '--to', 'kalibr', '-o', 'k.yaml'),
                         ('stereo', '--rig', 'rig.json', '--left', 'left.pgm', '--right',
                          'right.pgm', '-o', 'e.csv'),
                         ('rectify', '--rig', 'rig.json', '--left', 'left.pgm', '--right',
                          'right.pgm', '-o', 'out')):
                self.refuses(what, 'rig.json', *verb)

    def test_rigs_that_stereo_cannot_use(self):
        """The rig is blamed, not the images."""
        def turned(rig):
            rig['cameras'][1]['from_first']['rotation_rad'] = [0, 3.1, 0]
            names = [f'right.{w}_rad' for w in ('wx', 'wy', 'wz')]
            for name, value in zip(names, (0, 3.1, 0)):
                rig['parameters'][rig['parameter_names'].index(name)] = value

        def near(rig):
            rig['cameras'][1]['from_first']['translation_m'] = [0, 0, 0]
            for axis in 'xyz':
                rig['parameters'][rig['parameter_names'].index(f'right.t{axis}_m')] = 0

        def three(rig):
            rig['cameras'].append(dict(rig['cameras'][1], name='third'))
            for key in ('parameter_names', 'parameters', 'covariance'):
                del rig[key]

        width, height = json.loads(NOMINAL)['cameras'][0]['size_px']
        for seed, name in enumerate(('l.pgm', 'r.pgm')):
            (self.folder / name).write_bytes(f'P5\n{width} {height}\n255\n'.encode() +
                                             random.Random(seed).randbytes(width * height))
        for what, change in (('turned', turned), ('near', near), ('three', three)):
            self.write('rig.json', self.changed(change))
            for verb in (('stereo', '-o', 'e.csv'), ('rectify', '-o', 'out')):
                self.refuses(what, 'rig.json: ', verb[0], '--rig', 'rig.json', '--left', 'l.pgm',
                             '--right', 'r.pgm', *verb[1:])

    def test_studies_worlds_and_sources(self):
        study = '[study]\ntrials = 2\nseed = 1\n[world]\nfile = "workshop"\n[rig]\nfile = "nominal"\n'
        for what, text in toml_faults(study):
            self.write('s.toml', text)
            self.refuses(what, 's.toml', 'study', 's.toml', '-o', 'study')
        self.assertFalse((self.folder / 'study').exists())
        for what, text in toml_faults(WORLD):
            self.write('w.toml', text)
            self.refuses(what, 'w.toml', 'world', 'info', 'w.toml')
        self.refuses(what, 'w.toml', 'simulate', '--world', 'w.toml', '--pose', '5,5,0')
        for what, text in toml_faults('[sources]\nedge_loss = 0.1\n'):
            self.write('sources.toml', text)
            self.write('s.toml', study + '[sources]\nfile = "sources.toml"\n')
            self.refuses(what, 'sources.toml', 'study', 's.toml', '-o', 'study')
        self.assertFalse((self.folder / 'study').exists())

    def test_scenes(self):
        scenes = '[[scene]]\nname = "a"\nleft = "left.pgm"\nright = "right.pgm"\n'
        for what, text in toml_faults(scenes):
            self.write('scenes.toml', text)
            self.refuses(what, 'scenes.toml', 'evaluate', '--scenes', 'scenes.toml')
        self.refuses(what, 'scenes.toml', 'characterise', '--scenes', 'scenes.toml', '-o', 'c.toml')

    def test_evaluations(self):
        good = '{"matchers": {"edge": {"rms": 0.5}}, "scenes": [{"name": "a", "matchers": {}}]}'
        for what, text in json_faults(good):
            if what == 'text for a number':
                continue
            self.write('evaluation/evaluation.json', text)
            self.refuses(what, 'evaluation/evaluation.json', 'report', 'evaluation', '-o', 'r.html')

    def test_yaml_of_other_tools(self):
        for kind, name in (('kalibr', 'camchain.yaml'), ('ros', 'left.yaml'), ('opencv', 'cv.yml')):
            folder = self.folder / kind
            folder.mkdir(exist_ok=True)
            made = Run(folder, 'convert', ROOT / 'datasets/rigs/nominal.rig.json', '--to', kind,
                       '-o', folder if kind == 'ros' else folder / name)
            self.assertEqual(made.code, 0, made.err)
            good = (folder / name).read_text()
            for what, text in yaml_faults(good):
                self.write(f'{kind}/faulty.yaml', text)
                self.refuses(what, f'{kind}/faulty.yaml', 'convert', f'{kind}/faulty.yaml',
                             '--from', kind, '-o', 'rig2.json')
        target = 'target_type: aprilgrid\ntagCols: 6\ntagRows: 6\ntagSize: 0.1\ntagSpacing: 0.3\n'
        for what, text in yaml_faults(target):
            self.write('target.yaml', text)
            self.refuses(what, 'target.yaml', 'detect', '--left', 'left*.pgm', '--target',
                         'target.yaml', '-o', 'c.vnl')

    def test_mrcal_and_colmap(self):
        made = Run(self.folder, 'convert', 'good.json', '--to', 'mrcal', '-o', 'mrcal/')
        self.assertEqual(made.code, 0, made.err)
        good = (self.folder / 'mrcal/left.cameramodel').read_text()
        for what, text in python_faults(good):
            self.write('mrcal/left.cameramodel', text)
            self.refuses(what, 'mrcal/left.cameramodel', 'convert', 'mrcal/left.cameramodel',
                         'mrcal/right.cameramodel', '-o', 'rig2.json')
        made = Run(self.folder, 'convert', 'good.json', '--to', 'colmap', '-o', 'colmap/')
        self.assertEqual(made.code, 0, made.err)
        config = self.folder / 'colmap/rig_config.json'
        config_text = config.read_text()
        (self.folder / 'colmap/rigs.txt').unlink(missing_ok=True)
        for what, text in json_faults(config_text):
            self.write('colmap/rig_config.json', text)
            self.refuses(what, 'colmap/rig_config.json', 'convert', 'colmap', '-o', 'rig2.json')
        config.write_text(config_text)
        cameras = (self.folder / 'colmap/cameras.txt').read_text()
        for what, text in table_faults(cameras):
            self.write('colmap/cameras.txt', text)
            self.refuses(what, 'colmap/cameras.txt', 'convert', 'colmap', '-o', 'rig2.json')

    def test_tables(self):
        rows = ''.join(f'0,{camera},{r},{c},{c / 10},{r / 10},0.0,{50 + 10 * c}.5,{60 + 10 * r}.5\n'
                       for camera in (0, 1) for r in range(3) for c in range(4))
        header = 'frame,camera,row,col,X,Y,Z,qx,qy\n'
        pairs = ('pair,u_left_px,v_left_px,u_right_px,v_right_px,sigma_px\n'
                 '1,100.5,100.5,90.5,100.5,0.2\n')
        for name, good, arguments in (
                ('o.csv', header + rows, ('--observations', 'o.csv', '--size', '640x480')),
                ('p.csv', pairs, ('--pairs', 'p.csv', '--prior', 'good.json'))):
            for what, text in table_faults(good):
                self.write(name, text)
                self.refuses(what, name, 'calibrate', *arguments, '-o', 'rig2.json')

    def test_views(self):
        line = {'a_m': [2.5, 0.5, 0.25], 'b_m': [2.5, 0.5, 1.5], 'kind': 'vertical', 'sigma_m': 0.02}
        good = json.dumps({'pose': [1.5, -2, 0.5], 'lines': [line], 'image_lines_px': [[9, 20, 9, 200]]})
        self.write('v.jsonl', good + '\n')
        made = Run(self.folder, 'map', 'make', '--features', 'v.jsonl', '--rig', 'good.json', '-o',
                   'v.map')
        self.assertEqual(made.code, 0, made.err)
        looks = json.dumps({'looks': [{'turn_rad': 0.0, 'lines': [line]}]})
        for before in (good, looks):
            for what, text in json_faults(before):
                if what == 'long key':
                    continue  # a key that is not known is passed over
                self.write('w.jsonl', good + '\n' + text + '\n' if text else '')
                for verb in (('localise', 'v.map'), ('map', 'make', '-o', 'w.map')):
                    self.refuses(what, 'w.jsonl', *verb, '--features', 'w.jsonl', '--rig', 'good.json')
        self.assertFalse((self.folder / 'w.map').exists())
        for what, other in (('huge standard deviation', {'sigma_m': 1e300}),
                            ('long kind', {'kind': 'k' * LONG})):
            self.write('w.jsonl', json.dumps({'pose': [0, 0, 0], 'lines': [{**line, **other}]}))
            self.refuses(what, 'w.jsonl', 'localise', 'v.map', '--features', 'w.jsonl', '--rig',
                         'good.json')

    def test_poses_of_images(self):
        good = 'image,x_m,y_m,heading_deg\nright.pgm,1,2,3\nleft.pgm,3.5,-2.5,90.5\n'
        for what, text in table_faults(good):
            self.write('poses.csv', text)
            self.refuses(what, 'poses.csv', 'map', 'make', '--left', 'left.pgm', '--right', 'right.pgm',
                         '--rig', 'good.json', '--poses', 'poses.csv', '-o', 'w.map')

    def test_trajectories(self):
        for name in ('left', 'right'):
            for i in range(2):
                (self.folder / f'{name}{i}.pgm').write_bytes((self.folder / f'{name}.pgm').read_bytes())
        tum = '# time_s x y z qx qy qz qw\n0 0 0 0 0 0 0 1\n1 1.5 0 0 0 0 0 1.0\n'
        kitti = '1 0 0 0 0 1 0 0 0 0 1 0\n1 0 0 1.5 0 1 0 0 0 0 1.0 0\n'
        for good in (tum, kitti):
            for what, text in table_faults(good):
                if what == 'whole number too large' and text != 'x':
                    continue  # it is a time
                self.write('path.txt', text)
                self.refuses(what, 'path.txt', 'odometry', '--left', 'left[01].pgm', '--right',
                             'right[01].pgm', '--rig', 'good.json', '--truth', 'path.txt')

    def test_commands_of_a_drive(self):
        drive = ('drive', '--world', 'workshop', '--rig', 'good.json', '--pose', '10,7.5,0',
                 '--commands', 'commands.txt', '-o', 'd.jsonl')
        for what, text in table_faults('speed_mps,turn_radps,duration_s\n0.3,0.1,0.5\n'):
            self.write('commands.txt', text)
            self.refuses(what, 'commands.txt', *drive)
        good = '{"speed_mps": 0.3, "turn_radps": 0.1, "duration_s": 0.5}'
        for what, text in json_faults(good):
            self.write('commands.txt', good + '\n' + text + '\n' if text else '')
            self.refuses(what, 'commands.txt', *drive)
        self.assertFalse((self.folder / 'd.jsonl').exists())

    def test_tunes(self):
        self.write('posts.world.toml', verb_calls.WORLD)
        self.write('yard.world.toml', verb_calls.WORLD.replace('[5, 2]', '[6, 2]'))
        for what, text in toml_faults(verb_calls.TUNE):
            self.write('t.toml', text)
            self.refuses(what, 't.toml', 'tune', 't.toml', '-o', 'tuned')
        self.assertFalse((self.folder / 'tuned').exists())

    def test_segments_of_images(self):
        verb_calls.write_seen(self.folder)
        build = ('world', 'build', '--segments', 'seen.segments', '--poses', 'seen.csv', '-o', 'b.toml')
        good = (self.folder / 'seen.segments').read_text()
        first, _, others = good.partition('\n')
        for what, text in json_faults(first):
            if what == 'long key':
                continue  # a key that is not known is passed over
            self.write('seen.segments', text + '\n' + others if text else '')
            self.refuses(what, 'seen.segments', *build)
        self.write('seen.segments', good)
        for what, text in table_faults((self.folder / 'seen.csv').read_text()):
            self.write('seen.csv', text)
            self.refuses(what, 'seen.csv', *build)

    def test_meshes_and_lists_of_lines(self):
        room = verb_calls.room()
        lines = '0 0 0 0 0 2\n4 0 0 4 0 2\n4 3 0 4 3 2\n0 3 0 0 3 2.5\n'
        vertex = re.search(r'(?m)^0 0 2\.5$', room)
        faults = [('number 1e309', room[:vertex.start()] + '0 0 1e309' + room[vertex.end():]),
                  ('nan', room[:vertex.start()] + '0 0 nan' + room[vertex.end():]),
                  ('long number', room[:vertex.start()] + '0 0 ' + '1' * LONG + room[vertex.end():]),
                  ('more elements than there are', room.replace('element face ', 'element face 9')),
                  ('2^32 elements', room.replace('element vertex ', 'element vertex 42949672')),
                  ('vertex that is none', room.rstrip()[:-1] + '99999999\n'),
                  ('long line', room.replace('element face', 'x' * LONG + '\nelement face')),
                  ('zero byte', room.replace('end_header', '\0\nend_header')),
                  ('cut', room[:len(room) // 2])]
        for what, text in faults:
            self.write('room.ply', text)
            self.refuses(what, 'room.ply', 'world', 'import', 'room.ply', '-o', 'i.toml')
        for what, text in table_faults(lines):
            self.write('lines.txt', text)
            self.refuses(what, 'lines.txt', 'world', 'import', 'lines.txt', '--unit', 'm', '--up', 'z',
                         '-o', 'i.toml')
        self.assertFalse((self.folder / 'i.toml').exists())

    def test_rigs_of_data_sets(self):
        projection = '500 0 320 0 0 500 240 0 0 0 1 0'
        other = '500 0 320 -60.5 0 500 240 0 0 0 1 0'
        kitti = ('convert', 'calib.txt', '--from', 'kitti', '--size', '640x480', '-o', 'k.json')
        for what, text in table_faults(f'P0: {projection}\nP1: {other}\n'):
            if what == 'many fields':
                continue  # other lines are passed over
            self.write('calib.txt', text)
            self.refuses(what, 'calib.txt', *kitti)
        sensor = ('sensor_type: camera\nT_BS:\n  cols: 4\n  rows: 4\n'
                  '  data: [1.0, 0.0, 0.0, {}, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, '
                  '0.0, 0.0, 0.0, 1.0]\n'
                  'resolution: [752, 480]\ncamera_model: pinhole\nintrinsics: [458.6, 457.2, 367.2, '
                  '248.3]\ndistortion_model: radial-tangential\n'
                  'distortion_coefficients: [-0.28, 0.07, 0.0002, 1.7e-05]\n')
        for name, x in (('cam0', 0.0), ('cam1', 0.11)):
            self.write(f'{name}/sensor.yaml', sensor.format(x))
        asl = ('convert', 'cam0/sensor.yaml', 'cam1/sensor.yaml', '--from', 'asl', '-o', 'k.json')
        self.assertEqual(Run(self.folder, *asl).code, 0)
        (self.folder / 'k.json').unlink()
        for what, text in yaml_faults(sensor.format(0.0)):
            self.write('cam0/sensor.yaml', text)
            self.refuses(what, 'cam0/sensor.yaml', *asl)
        self.assertFalse((self.folder / 'k.json').exists())

    def test_maps(self):
        good = verb_calls.map_file(verb_calls.features().splitlines())
        (self.folder / 'v.jsonl').write_text(verb_calls.features())
        chance = random.Random(7)
        faults = [('empty', b''), ('other version', good[:8] + b'\x63' + good[9:]),
                  ('something behind', good + bytes(24)), ('text', b'\x1b[31m' * (LONG // 5)),
                  ('a million nodes', good[:12] + b'\x40\x42\x0f\x00' + good[16:]),
                  ('a part of 2^63 bytes', good[:24] + b'\xff' * 7 + b'\x7f' + good[32:])]
        faults += [(f'cut at {n}', good[:n]) for n in (7, 15, 39, 500, len(good) // 2, len(good) - 8)]
        for at in chance.sample(range(len(good) - 8), 12):
            bit = 1 << chance.randrange(8)
            faults.append((f'bit {bit} at {at}', good[:at] + bytes([good[at] ^ bit]) + good[at + 1:]))
        for what, content in faults:
            (self.folder / 'bad.map').write_bytes(content)
            for verb in (('map', 'info', 'bad.map'),
                         ('localise', 'bad.map', '--features', 'v.jsonl', '--rig', 'good.json'),
                         ('map', 'make', '--features', 'v.jsonl', '--rig', 'good.json', '--extend',
                          'bad.map')):
                self.refuses(what, 'bad.map', *verb)
            self.assertEqual((self.folder / 'bad.map').read_bytes(), content)


if __name__ == '__main__':
    text_faults.PROGRAM = os.path.abspath(sys.argv.pop(1))
    unittest.main()
