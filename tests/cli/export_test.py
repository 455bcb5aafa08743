# SPDX-FileCopyrightText: 2026 The Vernier authors
# SPDX-License-Identifier: Apache-2.0
"""Tables of studies, as files and in the terminal: export_test.py PROGRAM."""
import ast
import csv
import json
import os
import pathlib
import re
import struct
import subprocess
import sys
import tempfile
import unittest

PROGRAM = None
ROOT = pathlib.Path(__file__).resolve().parents[2]
STUDY = '''[study]
trials = 12
protocol = "near_path"
[map]
spacing_m = 2
[sweep]
"localiser.method" = ["lines", "pgh_baseline_vectorised"]
"sources.calibration" = [0.1, 10]
'''
# The table of cells in docs/file-formats.md, and that of trials.
DOCUMENTED = {which: re.findall(r'`([^`]+)`', section) for which, section in re.findall(
    r'Columns of (cells|trials): (.*?)\n\n', (ROOT / 'docs/file-formats.md').read_text(), re.S)}


def read_npy(file):
    """A structured array without NumPy: rows as dictionaries."""
    data = file.read_bytes()
    length, = struct.unpack('<H', data[8:10])
    head = ast.literal_eval(data[10:10 + length].decode())
    rows, at = [], 10 + length
    for _ in range(head['shape'][0]):
        row = {}
        for name, kind in head['descr']:
            if kind.startswith('<U'):
                size = 4 * int(kind[2:])
                row[name] = data[at:at + size].decode('utf-32-le').rstrip('\0')
            else:
                code, size = {'<f8': ('<d', 8), '<i8': ('<q', 8), '|b1': ('?', 1)}[kind]
                row[name], = struct.unpack(code, data[at:at + size])
            at += size
        rows.append(row)
    assert at == len(data)
    return rows


def python_with_pandas():
    for python in (sys.executable, '/usr/bin/python3'):
        if subprocess.run([python, '-c', 'import numpy, pandas'], capture_output=True).returncode == 0:
            return python
    return None


class WithStudy(unittest.TestCase):
    """Tests of a small finished study."""
    @classmethod
    def setUpClass(cls):
        cls.temporary = tempfile.TemporaryDirectory()
        cls.folder = pathlib.Path(cls.temporary.name)
        (cls.folder / 'study.toml').write_text(STUDY)
        cls.works('study', 'study.toml', '-o', 'results', '-q')

    @classmethod
    def tearDownClass(cls):
        cls.temporary.cleanup()

    @classmethod
    def call(cls, *words):
        return subprocess.run([PROGRAM, *words], capture_output=True, text=True, cwd=cls.folder)

    @classmethod
    def works(cls, *words):
        done = cls.call(*words)
        assert done.returncode == 0, done.stderr
        return done


class Export(WithStudy):
    def complains(self, *words, of):
        done = self.call(*words)
        self.assertEqual(done.returncode, 2, done.stderr)
        self.assertIn(of, done.stderr)
        self.assertEqual(len(done.stderr.strip().splitlines()), 1)

    def exported(self, name, *words):
        self.works('export', 'results', *words, '-o', name)
        if name.endswith('.npy'):
            return read_npy(self.folder / name)
        with open(self.folder / name, newline='') as file:
            return list(csv.DictReader(file))

    def test_cells_are_those_of_status(self):
        cells = json.loads(self.works('study', 'status', 'results', '--json', '-q').stdout)['cells']
        rows = self.exported('cells.csv')
        self.assertEqual(len(rows), 4)
        for i, (row, cell) in enumerate(zip(rows, cells)):
            self.assertEqual(row['cell'], str(i + 1))
            self.assertEqual(row['localiser.method'], cell['settings']['localiser.method'])
            for key in ('trials', 'maps', 'success', 'coverage', 'median_error_m', 'cpu_ms_p95',
                        'world_ceiling', 'unaliased_share', 'failed'):
                self.assertEqual(float(row[key]), cell[key], key)
            self.assertEqual([float(row['success_low']), float(row['success_high'])],
                             cell['success_interval_95'])
        settings = self.exported('all.csv', '--settings')
        self.assertEqual(settings[0]['study.seed'], '1')
        self.assertLessEqual(set(rows[0]), set(settings[0]))
        self.assertLessEqual(set(cells[0]['settings']), set(settings[0]))

    def test_trials_add_up_to_the_cells(self):
        cells, trials = self.exported('cells.csv'), self.exported('trials.csv', '--trials')
        self.assertEqual(len(trials), 48)
        for cell in cells:
            mine = [t for t in trials if t['cell'] == cell['cell']]
            self.assertEqual([t['trial'] for t in mine], [str(i) for i in range(12)])
            self.assertEqual([t['block'] for t in mine], [str(i // 2) for i in range(12)])
            right = sum(t['success'] == 'true' for t in mine)
            self.assertEqual(right / 12, float(cell['success']))
            for t in mine:
                self.assertEqual(t['answered'] == 'true', t['status'] == 'answered')
                near = t['error_m'] and float(t['error_m']) <= 1
                self.assertEqual(t['success'] == 'true', bool(near and t['answered'] == 'true'))

    def test_both_formats_say_the_same(self):
        for words in ([], ['--trials'], ['--settings']):
            for a, b in zip(self.exported('same.csv', *words), self.exported('same.npy', *words)):
                self.assertEqual(list(a), list(b))
                for key, value in b.items():
                    if isinstance(value, bool):
                        self.assertEqual(a[key], str(value).lower(), key)
                    elif isinstance(value, str):
                        self.assertEqual(a[key], value, key)
                    elif value != value:
                        self.assertEqual(a[key], '', key)
                    else:
                        self.assertEqual(float(a[key]), value, key)

    def test_the_columns_are_as_documented(self):
        for which, words in (('cells', []), ('trials', ['--trials'])):
            columns = list(self.exported('columns.csv', *words)[0])
            swept = ['localiser.method', 'sources.calibration']
            self.assertEqual([c for c in columns if c not in swept], DOCUMENTED[which])
            self.assertEqual([c for c in columns if c in swept], swept)

    def test_pandas_reads_them_in_three_lines(self):
        python = python_with_pandas()
        if not python:
            self.skipTest('no Python with NumPy and pandas (Debian: python3-pandas)')
        text = (ROOT / 'docs/file-formats.md').read_text()
        examples = re.findall(r'```python export\n(.*?)```', text, re.S)
        self.assertEqual(len(examples), 2)
        self.works('export', 'results', '-o', 'results.csv')
        self.works('export', 'results', '--trials', '-o', 'trials.npy')
        for example in examples:
            self.assertLessEqual(len(example.strip().splitlines()), 3)
            done = subprocess.run([python, '-c', example], capture_output=True, text=True,
                                  cwd=self.folder)
            self.assertEqual(done.returncode, 0, done.stderr)
            self.assertIn('success', done.stdout)
            self.assertIn('sources.calibration', done.stdout)

    def test_shards_export_as_the_whole(self):
        for shard in ('0/2', '1/2'):
            self.works('study', 'study.toml', '-o', 'parts', '--shard', shard, '-q')
        self.works('export', 'parts', '--trials', '-o', 'parts.csv')
        whole = self.exported('whole.csv', '--trials')
        with open(self.folder / 'parts.csv', newline='') as file:
            for a, b in zip(csv.DictReader(file), whole, strict=True):
                for row in (a, b):
                    row['cpu_ms'] = row['wall_ms'] = None
                self.assertEqual(a, b)

    def test_an_unfinished_study_says_so(self):
        self.works('study', 'study.toml', '-o', 'half', '--shard', '0/2', '-q')
        for words in ([], ['--trials']):
            done = self.call('export', 'half', *words, '-o', 'half.csv')
            self.assertEqual(done.returncode, 3, done.stderr)
            self.assertIn('12 of 24 blocks', done.stderr)

    def test_without_answers_none_of_them_is_right_or_wrong(self):
        (self.folder / 'lost.toml').write_text(
            '[study]\ntrials = 6\n[map]\nspacing_m = 2\n[sources]\nedge_loss = 0.95\n')
        self.works('study', 'lost.toml', '-o', 'lost', '-q')
        self.works('export', 'lost', '-o', 'lost.csv')
        with open(self.folder / 'lost.csv', newline='') as file:
            row, = csv.DictReader(file)
        self.assertEqual((float(row['coverage']), row['success_when_answered']), (0, ''))
        cell, = json.loads(self.works('study', 'status', 'lost', '--json', '-q').stdout)['cells']
        self.assertIsNone(cell['success_when_answered'])

    def test_bad_input_is_told(self):
        self.complains('export', 'results', '-o', 'x.xlsx', of='neither of the endings .csv and .npy')
        self.complains('export', 'nowhere', '-o', 'x.csv', of='is not a study folder')
        self.complains('export', 'results', '--trials', '--settings', '-o', 'x.csv',
                       of='--settings is for the table of cells')
        self.complains('export', 'results', '-o', 'nowhere/x.csv', of='nowhere')
        store = self.folder / 'results/results.sqlite'
        (self.folder / 'alias.csv').symlink_to(store)
        self.complains('export', 'results', '-o', 'alias.csv', of='is an input')
        self.assertEqual([f.name for f in self.folder.glob('x.*')], [])


class Table(WithStudy):
    """What the terminal shows."""
    def lines(self, sweep):
        (self.folder / 'swept.toml').write_text(STUDY.split('[sweep]')[0] + sweep)
        name = f'swept{len(list(self.folder.iterdir()))}'
        return self.works('study', 'swept.toml', '-o', name, '-q').stdout.splitlines()

    def test_tables_stay_in_their_columns(self):
        for keys in range(4):
            sweep = '[sweep]\n' if keys else ''
            sweep += ''.join(['"sources.calibration" = [0.1, 10]\n',
                              '"localiser.method" = ["lines", "pgh_baseline_vectorised"]\n',
                              '"sources.lateral_shift_mode" = ["common", "independent"]\n'][:keys])
            lines = self.lines(sweep)
            self.assertLessEqual(max(map(len, lines)), 80, lines)
            table = lines[:lines.index('')]
            self.assertEqual(len(table), 1 + max(1, 2 ** keys if keys else 1))
            # Numbers of a column end at the same place: below the end of its head.
            end = table[0].index('trials') + len('trials')
            for row in table[1:]:
                self.assertEqual(row[:end].split()[-1], '12', row)

    def test_comparisons_are_adjusted(self):
        text = self.works('study', 'status', 'results').stdout
        comparisons = json.loads(self.works('study', 'status', 'results', '--json').stdout)
        self.assertIn('p by Holm', text)
        rows = re.findall(r'^(\d+), (\d+) +(\d+) +(\d+) +([\d.<]+) +([\d.<]+)$', text, re.M)
        self.assertEqual(len(rows), len(comparisons['comparisons']))
        for row, pair in zip(rows, comparisons['comparisons']):
            self.assertEqual([int(row[2]), int(row[3])], [pair['only_a'], pair['only_b']])
            self.assertGreaterEqual(pair['p_value_holm'], pair['p_value'])


if __name__ == '__main__':
    PROGRAM = os.path.abspath(sys.argv.pop(1))
    unittest.main()
