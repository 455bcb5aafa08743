# SPDX-FileCopyrightText: 2026 The Vernier authors
# SPDX-License-Identifier: Apache-2.0
"""Deep, long, doubled, cut and foreign text of each format, and a test case that gives it to the
program (text_limits_test.py, verb_texts_test.py, command_line_limits_test.py)."""
import json
import os
import pathlib
import re
import resource
import signal
import subprocess
import tempfile
import unittest

ROOT = pathlib.Path(__file__).resolve().parents[2]
NOMINAL = (ROOT / 'datasets/rigs/nominal.rig.json').read_text()
PROGRAM = ''

DEEP = 100_000
LONG = 4_000_000
MAX_LINE = 600
MOST_CPU_S = 30  # ends what hangs; what they take is in docs/results.md
MAX_MEMORY_KB = 300_000


class Run:
    """A finished call, with the largest memory it had."""

    def __init__(self, folder, *arguments, limit_s=300):
        with tempfile.TemporaryFile() as out, tempfile.TemporaryFile() as err:
            child = subprocess.Popen(
                [PROGRAM, *map(str, arguments)], cwd=folder, stdout=out, stderr=err,
                stdin=subprocess.DEVNULL, preexec_fn=lambda: resource.setrlimit(
                    resource.RLIMIT_CPU, (MOST_CPU_S, MOST_CPU_S + 1)))
            signal.signal(signal.SIGALRM, lambda *_: child.kill())
            signal.alarm(limit_s)
            _, status, usage = os.wait4(child.pid, 0)
            signal.alarm(0)
            child.returncode = self.code = os.waitstatus_to_exitcode(status)
            self.memory_kb = usage.ru_maxrss
            out.seek(0)
            err.seek(0)
            self.out, self.err = out.read(), err.read()


def json_faults(good):
    """Name and text of faulty files; `good` is one that is read."""
    value = json.loads(good)
    first = next(iter(value)) if isinstance(value, dict) else None
    yield 'deep lists', '[' * DEEP
    yield 'deep objects', '{"a":' * DEEP + '1' + '}' * DEEP
    if first:
        inside = good.rstrip()[:-1]
        yield 'deep inside', inside + ', "deep": ' + '[' * DEEP + ']' * DEEP + '}'
        yield 'doubled key', inside + f', {json.dumps(first)}: {json.dumps(value[first])}}}'
        yield 'long key', inside + ', "' + 'k' * LONG + '": 1}'
        yield 'not UTF-8', inside + ', "k\udcff": 1}'
        yield 'many values', inside + ', "more": [' + '{},' * (LONG // 3) + '1,]}'
        yield 'zero byte', inside + ', "k\0": 1}'
    number = re.search(r'-?\d+\.\d+(e-?\d+)?', good)
    if number:
        begin, end = number.span()
        yield 'number 1e309', good[:begin] + '1e309' + good[end:]
        yield 'long number', good[:begin] + '1.' + '1' * LONG + good[end:]
        yield 'text for a number', good[:begin] + '"' + '\\u001b[31m' * 1000 + '"' + good[end:]
    yield 'cut', good[:len(good) // 2]
    yield 'something behind', good + '{}'
    yield 'control characters', '\x1b[31m' * (LONG // 5)
    yield 'empty', ''


def toml_faults(good):
    yield 'deep dotted key', good + '\n' + '.'.join(['a'] * 50_000) + ' = 1\n'
    yield 'deep header', good + '\n[' + '.'.join(['a'] * 50_000) + ']\n'
    yield 'deep list', good + '\nzz = ' + '[' * DEEP
    yield 'deep table', good + '\nzz = ' + '{a=' * DEEP
    header = re.search(r'(?m)^\[[^\[].*$', good)
    key = re.search(r'(?m)^(\w+ *= *)(\S+)', good)
    if header:
        yield 'doubled header', good + '\n' + header.group(0) + '\n'
    if key:
        begin, end = key.span()
        yield 'doubled key', good[:end] + '\n' + key.group(0) + good[end:]
        yield 'number 1e309', good[:begin] + key.group(1) + '1e309' + good[end:]
        yield 'whole number too large', (good[:begin] + key.group(1) + '99999999999999999999' +
                                         good[end:])
        yield 'long number', good[:begin] + key.group(1) + '1' * LONG + good[end:]
        yield 'long text', good[:begin] + key.group(1) + '"' + 'x' * LONG + '"' + good[end:]
        yield 'text of control characters', (good[:begin] + key.group(1) + '"' +
                                             '\\u001b[31m' * 1000 + '"' + good[end:])
    yield 'unknown key', 'k' * 200 + ' = 1\n' + good
    yield 'long key', 'k' * LONG + ' = 1\n' + good
    yield 'not UTF-8', '# \udcff\n' + good
    yield 'zero byte', '# \0\n' + good
    yield 'cut', good[:len(good) // 2].rstrip('\n') + '\n[cu'
    yield 'header that is none', '[/\n' + good
    yield 'key that is none', '\U0002f830 = 1\n' + good
    yield 'control characters', '\x1b[31m' * (LONG // 5)


def yaml_faults(good):
    yield 'deep flow', good + '\nzz: ' + '[' * DEEP
    yield 'deep maps', good + '\nzz: ' + '{a: ' * DEEP
    yield 'deep block', '- ' * DEEP
    key = re.search(r'(?m)^(\w+:).*$', good)
    yield 'doubled key', good + '\n' + key.group(1) + ' 1\n'
    yield 'aliases', 'a: &a 1\nb: *a\n' + good
    yield 'two documents', good + '\n---\na: 1\n'
    yield 'long list', good + '\nzz: [' + '1, ' * (LONG // 3) + ']]'
    yield 'long text', good + '\nzz: "' + 'x' * LONG + '"\n'
    yield 'not UTF-8', good + '\nzz: \udcff\n'
    yield 'zero byte', good + '\nzz: \0\n'
    yield 'cut', good + '\nzz: [1, 2'
    yield 'control characters', '\x1b[31m' * (LONG // 5)
    yield 'tags', ''.join(f'%TAG !a{i}! b\n' for i in range(50_000)) + '---\n' + good


def python_faults(good):
    yield 'deep', '[' * DEEP
    yield 'doubled key', good.replace('{', "{ 'lensmodel': 'LENSMODEL_PINHOLE',", 1)
    yield 'number 1e309', re.sub(r'\d+\.\d+', '1e309', good, count=1)
    yield 'long number', re.sub(r'\d+\.\d+', '1' * LONG, good, count=1)
    yield 'many values', good.replace('{', "{ 'more': [" + '1,' * (LONG // 2) + '],', 1)
    yield 'long word', good.replace('{', '{ ' + 'x' * LONG, 1)
    yield 'not UTF-8', good.replace('{', "{ 'k\udcff': 1,", 1)
    yield 'cut', good[:len(good) // 2]
    yield 'control characters', '\x1b[31m' * (LONG // 5)


def table_faults(good):
    """Of text in lines: CSV, .vnl and COLMAP's."""
    lines = good.splitlines(keepends=True)
    last = lines[-1].rstrip('\n')
    number = re.search(r'\d+\.\d+', last)
    for name, word in (('number 1e309', '1e309'), ('long number', '1' * 10_000),
                       ('control characters for a number', '\x1b[31m' * 100), ('nan', 'nan')):
        yield name, ''.join(lines[:-1]) + last[:number.start()] + word + last[number.end():] + '\n'
    end = list(re.finditer(r'-?\d+(\.\d+)?', last))[-1]
    yield 'nan at the end', ''.join(lines[:-1]) + last[:end.start()] + 'nan' + last[end.end():] + '\n'
    whole = re.search(r'\d+', last)
    yield 'whole number too large', (''.join(lines[:-1]) + last[:whole.start()] + '4294967297' +
                                     last[whole.end():] + '\n') if whole.start() == 0 else 'x'
    yield 'long line', good + 'x' * LONG + '\n'
    yield 'many fields', good + '1,' * 5_000 + '\n'
    yield 'not UTF-8', good + '\udcff\n'
    yield 'zero byte', good + '\0\n'
    yield 'cut', good.rstrip('\n')[:-8] + '\n'


class TextCase(unittest.TestCase):
    """Calls of the program in a folder with a rig and two images."""

    @classmethod
    def setUpClass(cls):
        cls.temporary = tempfile.TemporaryDirectory()
        cls.folder = pathlib.Path(cls.temporary.name)
        (cls.folder / 'good.json').write_text(NOMINAL)
        for name in ('left.pgm', 'right.pgm'):
            (cls.folder / name).write_bytes(b'P5\n64 48\n255\n' + bytes(64 * 48))

    @classmethod
    def tearDownClass(cls):
        cls.temporary.cleanup()

    def refuses(self, what, file, *arguments):
        """Runs a verb on a faulty file; `file` is the one that the line must begin with. Returns what
        it says."""
        done = Run(self.folder, *arguments)
        said = done.err.decode(errors='surrogateescape')
        with self.subTest(verb=' '.join(map(str, arguments[:2])), fault=what, said=said[:300]):
            self.assertEqual(done.code, 2)
            self.assertEqual(done.out, b'')
            self.assertEqual(len(said.splitlines()), 1)
            self.assertLess(len(done.err), MAX_LINE)
            self.assertTrue(said.startswith(f'vernier: {file}'), f'does not begin with {file}')
            self.assertEqual(re.findall('[\x00-\x09\x0b-\x1f\x7f]', said), [])
            self.assertLess(done.memory_kb, MAX_MEMORY_KB)
        return said

    def write(self, name, text):
        (self.folder / name).parent.mkdir(exist_ok=True)
        (self.folder / name).write_bytes(text.encode('utf-8', 'surrogateescape'))
