#!/usr/bin/env python3
# SPDX-FileCopyrightText: 2026 The Vernier authors
# SPDX-License-Identifier: Apache-2.0
"""Every input of every call taken away from its reader, and folders that may not be written.

    permissions_test.py PROGRAM [unittest's options]
"""
import glob
import pathlib
import re
import sys
import unittest

sys.dont_write_bytecode = True
import cli_test
import verb_calls
from faults_test import OtherCase

# Files that a file among a call's words names.
NAMED_WITHIN = {'study.toml': ['posts.world.toml'], 'tune.toml': ['posts.world.toml', 'yard.world.toml']}

# Of many images one that cannot be read is left out, with a warning. These are too few then.
LEFT_OUT = {'calibrate_images'}


def files_read(call, folder):
    """The input files of a call in the folder, by the names that it knows them by."""
    outputs = {name for name in call.outputs if name not in call.changes}
    found = []
    for word in map(str, call.words[1:]):
        if word in outputs:
            continue
        names = sorted(glob.glob(word, root_dir=folder))
        for name in names if len(names) < 4 else (names[0], names[len(names) // 2], names[-1]):
            inside = folder / name
            if inside.is_dir():
                found += sorted(str(file.relative_to(folder)) for file in inside.rglob('*')
                                if file.is_file())
            else:
                found.append(name)
            found += NAMED_WITHIN.get(name, [])
    return found


class Unreadable(OtherCase):
    def test_every_input_that_may_not_be_read_is_named(self):
        for call in verb_calls.calls():
            call.prepare(self.folder)
            for name in files_read(call, self.folder):
                with self.subTest(verb=call.name, input=name):
                    file = self.folder / name
                    mode = file.stat().st_mode & 0o777
                    file.chmod(0)
                    before = self.made()
                    done = self.run_as_other(*call.words, *([] if call.name in LEFT_OUT else ['-q']))
                    file.chmod(mode)
                    if call.name in LEFT_OUT:
                        warning, done.stderr = done.stderr.split('\n', 1)
                        self.assertIn(f'warning: {name}: cannot be read: Permission denied', warning)
                        self.fails_in_one_line(done, '2 views of the board; at least three')
                    else:
                        self.fails_in_one_line(done)
                        self.assertRegex(done.stderr, re.escape(name) + ': (cannot|is no file that can) be read')
                    self.assertEqual(done.stdout, '')
                    self.assertEqual(self.made(), before)


class Locked(OtherCase):
    def test_a_folder_that_convert_may_not_write(self):
        locked = self.folder / 'locked'
        locked.mkdir()
        (locked / 'left.cameramodel').write_text('kept')
        locked.chmod(0o555)
        before = self.made()
        for to, output in (('mrcal', 'locked/'), ('mrcal', 'locked/new/'), ('colmap', 'locked/'),
                           ('opencv', 'locked/'), ('opencv', 'locked/r.yml'),
                           ('kalibr', 'locked/r.yaml'), ('ros', 'locked/'), ('vernier', 'locked/r.json')):
            with self.subTest(to=to, output=output):
                done = self.run_as_other('convert', 'rig.json', '--to', to, '-o', output)
                self.fails_in_one_line(done, 'vernier: locked', 'Permission denied')
                self.assertEqual(done.stdout, '')
                self.assertEqual(self.made(), before)
        self.assertEqual((locked / 'left.cameramodel').read_text(), 'kept')
        locked.chmod(0o755)


if __name__ == '__main__':
    cli_test.PROGRAM = str(pathlib.Path(sys.argv.pop(1)).resolve())
    unittest.main()
