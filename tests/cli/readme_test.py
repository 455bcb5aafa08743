#!/usr/bin/env python3
# SPDX-FileCopyrightText: 2026 The Vernier authors
# SPDX-License-Identifier: Apache-2.0
"""Runs the README's commands, and checks that its C++ is the example that the build compiles.

    readme_test.py PROGRAM EXAMPLE_PROGRAM
"""
import os
import pathlib
import re
import subprocess
import sys
import tempfile

ROOT = pathlib.Path(__file__).resolve().parents[2]
IMAGES = '/usr/share/doc/opencv-doc/examples/data'
if not os.path.exists(f'{IMAGES}/left01.jpg'):
    IMAGES = f'{ROOT}/build/opencv-doc{IMAGES}'


def block(text, language, tag):
    found = re.findall(rf'^```{language} {tag}\n(.*?)^```', text, re.M | re.S)
    assert len(found) == 1, f'README.md has {len(found)} blocks "{language} {tag}"'
    return found[0]


def main():
    program, example = map(os.path.abspath, sys.argv[1:])
    text = (ROOT / 'README.md').read_text()
    source = (ROOT / 'docs/examples/success_of_sampled_rigs.cpp').read_text()
    assert block(text, 'cpp', 'example') == source, 'the README and docs/examples differ'
    for link in re.findall(r'\]\(([^)#]+)\)', text):
        assert (ROOT / link).exists(), f'README.md names {link}, which is not there'
    if not os.path.exists(f'{IMAGES}/left01.jpg'):
        print('readme: skipped: opencv-doc has no images here')
        return
    with tempfile.TemporaryDirectory() as folder:
        (pathlib.Path(folder) / 'study.toml').write_text(block(text, 'toml', 'study'))
        environment = dict(os.environ, IMAGES=IMAGES, EXAMPLES=str(ROOT / "docs/examples"),
                           PATH=f'{os.path.dirname(program)}:{os.environ["PATH"]}')
        subprocess.run(['bash', '-euo', 'pipefail', '-c', block(text, 'sh', 'run')], cwd=folder,
                       env=environment, check=True)
        said = subprocess.run([example, 'rig.json'], cwd=folder, check=True, capture_output=True,
                              text=True).stdout
        assert 'of this direction is' in said and 'at   10 m' in said, said
        assert (pathlib.Path(folder) / 'report.html').stat().st_size > 100_000
    print('the README holds')


main()
