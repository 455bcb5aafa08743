#!/usr/bin/env python3
# SPDX-FileCopyrightText: 2026 The Vernier authors
# SPDX-License-Identifier: Apache-2.0
"""Every verb refuses text that is too deep, says a key twice or holds a number out of range, in each
kind of file it reads: exit code 2, one line that names the file and the fault.

    verb_texts_test.py PROGRAM
"""
import os
import pathlib
import re
import shutil
import sys
import unittest

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent))
sys.dont_write_bytecode = True
import text_faults
import verb_calls
from text_faults import NOMINAL, ROOT, json_faults, toml_faults, yaml_faults

SHIPPED = {'nominal': 'named.json', 'workshop': 'named.world.toml'}  # in whose place a file is given
NO_TEXT = {'.pgm', '.png', '.jpg', '.map', '.sqlite', '.npy', '.pfm', '.html'}  # maps: text_limits_test.py
# calls of verb_calls.py that read none
WITHOUT_TEXT = {'doctor', 'world', 'map_info', 'calibrate_images', 'servo_program', 'evaluate_program',
                'drive_program'}
NAMES_OTHERS = {'study': ['posts.world.toml'], 'tune': ['posts.world.toml', 'yard.world.toml']}

SOURCES = '[sources]\nedge_loss = 0.1\n'
SCENES = '[[scene]]\nname = "a"\nleft = "left.pgm"\nright = "right.pgm"\n'
TARGET = 'target_type: aprilgrid\ntagCols: 6\ntagRows: 6\ntagSize: 0.1\ntagSpacing: 0.3\n'
TRACKS = '1\n0 3 3\n0.5 1.5 2.5\n0.5 1.5 4.5\n0 1 2\n7 8 9\n'
OWN_STUDY = ('[study]\ntrials = 2\n[world]\nfile = "posts.world.toml"\n[rig]\nfile = "rig.json"\n'
             '[sources]\nfile = "sources.toml"\n')
FURTHER_FILES = {
    'sources.toml': SOURCES, 'scenes.toml': SCENES, 'target.yaml': TARGET, 'own_rig.toml': OWN_STUDY,
    'places.csv': 'image,x_m,y_m,heading_deg\nleft.pgm,1.5,2,3\n',
    'path.txt': '0 0 0 0 0 0 0 1\n1 1.5 0 0 0 0 0 1\n',
    'corners.vnl': '# filename x y level\nleft1.jpg 10.5 20.5 0\n',
    'tracks.txt': TRACKS,
    'scores/evaluation.json': '{"matchers": {"edge": {"rms": 0.5}}, "scenes": []}',
    'model/images.txt': ''.join(f'{i} 1.0 0 0 0 {i}.5 0 0 1 a{i}.png\n\n' for i in (1, 2, 3))}


def further_calls():
    """Of files that the calls of verb_calls.py do not give, with the files that these name themselves."""
    pair = ['--left', 'left.pgm', '--right', 'right.pgm']
    board = ['--board', '9x6', '--size', '640x480']
    robot = ['--world', 'workshop', '--rig', 'nominal', '--sources', 'sources.toml']
    calls = [
        ('detect', ['detect', '--left', 'left.pgm', '--target', 'target.yaml', '-o', 'out.vnl']),
        ('calibrate', ['calibrate', '--corners', 'corners.vnl', *board, '--square-m', '0.1', '-o', 'out.json']),
        ('calibrate', ['calibrate', '--pairs', 'pairs.csv', '--prior', 'rig.json', '-o', 'out.json']),
        ('calibrate', ['calibrate', '--observations', 'corners.csv', '--size', '640x480', '--prior',
                       'rig.json', '-o', 'out.json']),
        ('check', ['check', 'rig.json']),
        ('combine', ['combine', 'rig.json', 'nominal', '-o', 'out.json']),
        ('plan', ['plan', '--success', '0.9', '--study', 'own_rig.toml']),
        ('plan', ['plan', 'nominal', '--success', '0.9', '--world', 'posts.world.toml']),
        ('evaluate', ['evaluate', '--scenes', 'scenes.toml']),
        ('evaluate', ['evaluate', *pair, '--truth', 'truth.pgm', '--truth-scale', '4',
                      '--max-disparity', '20', '--psi-c', '1', '--rig', 'rig.json']),
        ('characterise', ['characterise', '--scenes', 'scenes.toml', '-o', 'out.toml']),
        ('world_info', ['world', 'info', 'posts.world.toml', '--rig', 'nominal']),
        ('world_sets', ['world', 'sets', 'posts.world.toml', '--rig', 'nominal', '-o', 'out.toml']),
        ('world_view', ['world', 'view', 'posts.world.toml', '--rig', 'nominal', '--sources',
                        'sources.toml', '-o', 'out.html']),
        ('world_import', ['world', 'import', 'tracks.txt', '--colmap', 'model', '-o', 'out.toml']),
        ('world_build', ['world', 'build', '--features', 'views.jsonl', '--rig', 'nominal', '-o', 'out.toml']),
        ('simulate', ['simulate', *robot, '--pose', '10,7.5,0']),
        ('drive', ['drive', *robot, '--pose', '10,7.5,0', '--commands', 'commands.csv', '-o', 'out.jsonl']),
        ('servo', ['servo', *robot, '--trials', '1']),
        ('render', ['render', '--world', 'posts.world.toml', '--rig', 'nominal', '--pose', '3,2,90',
                    '-o', 'out']),
        ('lines', ['lines', '--image', 'left.pgm', '--depth', 'depth.png', '--rig', 'K.txt', '--poses',
                   'path.txt', '-o', 'out.jsonl']),
        ('map', ['map', 'make', *robot, '-o', 'out.map']),
        ('map', ['map', 'make', *pair, '--rig', 'rig.json', '--poses', 'places.csv', '-o', 'out.map']),
        ('localise', ['localise', 'known.map', *robot]),
        ('localise', ['localise', 'known.map', *pair, '--rig', 'rig.json', '--poses', 'places.csv']),
        ('odometry', ['odometry', *robot]),
        ('odometry', ['odometry', '--left', 'left[12].pgm', '--right', 'right[12].pgm', '--rig',
                      'rig.json', '--truth', 'path.txt']),
        ('report', ['report', 'scores', '-o', 'out.html']),
        ('report', ['report', 'begun', '--calibration', 'rig.json', '-o', 'out.html'])]
    return [(name, words, []) for name, words in calls] + [
        ('study', ['study', 'own_rig.toml', '-o', 'out'], ['rig.json', 'sources.toml'])]


def with_number(text, word):
    """With another word for the last number with a point, or else the last one."""
    found = (list(re.finditer(r'-?\d+\.\d+(?=[,\s])', text)) or list(re.finditer(r'-?\d+(?=[,\s])', text)))
    begin, end = found[-1].span()
    return text[:begin] + word + text[end:]


def of(faults, *names):
    return [(name, text) for name, text in faults if name in names]


SAID = {'deep inside': 'is nested', 'deep list': 'is nested', 'deep flow': 'is nested',
        'doubled key': 'twice|a second time|is defined before', 'number 1e309': '1e309',
        'number in a mesh': 'room.ply:10: vertex 0 has a word where a number belongs'}


def faults(name, good):
    """What is wrong with a text of this kind, and the text."""
    ending = pathlib.Path(name).suffix
    if ending == '.json':
        found = of(json_faults(good), 'deep inside', 'doubled key', 'number 1e309')
    elif ending in ('.jsonl', '.segments'):
        first, _, others = good.partition('\n')
        found = [(what, text + '\n' + others) for what, text in
                 of(json_faults(first), 'deep inside', 'doubled key', 'number 1e309')]
    elif ending == '.toml':
        found = of(toml_faults(good), 'deep list', 'doubled key', 'number 1e309')
    elif ending in ('.yaml', '.yml'):
        found = of(yaml_faults(good), 'deep flow', 'doubled key') + [
            ('number 1e309', with_number(good, '1e309'))]
    elif ending in ('.csv', '.txt', '.vnl'):
        found = [('number 1e309', with_number(good, '1e309'))]  # lines are not deep and have no keys
    elif ending == '.ply':
        found = [('number in a mesh', good.replace('end_header\n0 0 0', 'end_header\n1e309 0 0'))]
    else:
        raise AssertionError(f'{name}: say here what is wrong text of this kind')
    return found


class VerbTexts(text_faults.TextCase):
    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        verb_calls.write_inputs(cls.folder, text_faults.PROGRAM)
        (cls.folder / 'named.json').write_text(NOMINAL)
        shutil.copy(ROOT / 'datasets/worlds/workshop.world.toml', cls.folder / 'named.world.toml')
        for name, text in FURTHER_FILES.items():
            (cls.folder / name).parent.mkdir(exist_ok=True)
            (cls.folder / name).write_text(text)
        for name in ('left', 'right'):
            for i in (1, 2):
                shutil.copy(cls.folder / f'{name}.pgm', cls.folder / f'{name}{i}.pgm')

    def texts_of(self, words):
        """The files with text among the words, or in a folder that is one."""
        texts = []
        for word in words:
            at = self.folder / word
            if os.path.isabs(word) or not at.exists():
                continue
            inside = [word] if at.is_file() else [f'{word}/{file.name}' for file in sorted(at.iterdir())
                                                          if file.is_file()]
            texts += [name for name in inside if pathlib.Path(name).suffix not in NO_TEXT]
        return list(dict.fromkeys(texts))

    def all_calls(self):
        for call in verb_calls.calls():
            call.prepare(self.folder)
        calls = [(call.name, call.words, NAMES_OTHERS.get(call.name, [])) for call in verb_calls.calls()]
        for name, words, others in calls + further_calls():
            words = [SHIPPED.get(str(word), str(word)) for word in words]
            for text in self.texts_of(words) + others:
                yield name, words, text

    def test_every_verb_refuses_every_kind_of_file(self):
        read = {}
        for verb, words, name in self.all_calls():
            if name in read.setdefault(verb, []):
                continue
            read[verb].append(name)
            good = (self.folder / name).read_text()
            for what, text in faults(name, good):
                self.assertNotEqual(text, good, name)
                self.write(name, text)
                said = self.refuses(what, name, *words)
                with self.subTest(verb=verb, file=name, fault=what, said=said[:300]):
                    self.assertRegex(said, SAID[what])
            self.write(name, good)
        named = {call.name for call in verb_calls.calls()}
        self.assertEqual(named - set(read), WITHOUT_TEXT, 'give these verbs faulty files too')
        self.assertFalse([file for file in self.folder.iterdir() if file.name.startswith('out')])


if __name__ == '__main__':
    text_faults.PROGRAM = os.path.abspath(sys.argv.pop(1))
    unittest.main()
