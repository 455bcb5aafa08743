#!/usr/bin/env python3
# SPDX-FileCopyrightText: 2026 The Vernier authors
# SPDX-License-Identifier: Apache-2.0
"""Checks that docs/api.md shows the programs of docs/examples/api as they are.

    api_page_test.py

Each block of C++ on the page is headed "cpp NAME.cpp" and equals that file; every file is on the
page; the programs include public headers only; headers and links that the page names exist.
`api_page_test.py --update` writes the files into the blocks.
"""
import re
import sys
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
EXAMPLES = ROOT / 'docs/examples/api'
PAGE = ROOT / 'docs/api.md'
BLOCK = re.compile(r'^```cpp (\S+)\n(.*?)^```$', re.M | re.S)


def public_headers():
    """What the modules install: the PUBLIC lists of their CMakeLists.txt."""
    headers = set()
    for module in ('calib', 'stereo', 'localise', 'sim'):
        text = (ROOT / module / 'CMakeLists.txt').read_text(encoding='utf-8')
        listed = re.search(r'PUBLIC\s(.*?)\n\s*[A-Z_]+\n', text, re.S).group(1)
        headers |= {f'{module}/{header}' for header in re.findall(r'\w+\.h', listed)}
    return headers


def update(text):
    """The page with the files in its blocks."""
    return BLOCK.sub(lambda block: f'```cpp {block[1]}\n'
                     f'{(EXAMPLES / block[1]).read_text(encoding="utf-8")}```', text)


def faults(text):
    """Every fault in words."""
    found = []
    public = public_headers()
    shown = dict(BLOCK.findall(text))
    files = {file.name: file.read_text(encoding='utf-8') for file in EXAMPLES.glob('*.cpp')}
    for name in sorted(shown.keys() | files.keys()):
        if name not in shown:
            found.append(f'docs/api.md does not show docs/examples/api/{name}')
        elif name not in files:
            found.append(f'docs/api.md shows {name}, which is not in docs/examples/api')
        elif shown[name] != files[name]:
            found.append(f'docs/api.md and docs/examples/api/{name} differ: run with --update')
    for name, source in sorted(files.items()):
        for header in re.findall(r'^#include "([^"]+)"', source, re.M):
            if header not in public:
                found.append(f'docs/examples/api/{name} includes {header}, which is not public')
        if 'internal' in source:
            found.append(f'docs/examples/api/{name} names what is internal')
    prose = BLOCK.sub('', text)
    for header in re.findall(r'`((?:calib|stereo|localise|sim)/[\w/]+\.h)`', prose):
        if not (ROOT / header).exists():
            found.append(f'docs/api.md names {header}, which is not there')
    for header in sorted(public):
        if f'`{header}`' not in prose:
            found.append(f'docs/api.md does not name {header}, which is public')
    for link in re.findall(r'\]\(([^)#:]+)(?:#[^)]*)?\)', prose):
        if not (PAGE.parent / link).exists():
            found.append(f'docs/api.md links to {link}, which is not there')
    return found


def main():
    text = PAGE.read_text(encoding='utf-8')
    if '--update' in sys.argv[1:]:
        text = update(text)
        PAGE.write_text(text, encoding='utf-8')
    found = faults(text)
    for line in found:
        print(line, file=sys.stderr)
    print(f'{len(BLOCK.findall(text))} programs on the page, {len(found)} faults')
    return 1 if found else 0


if __name__ == '__main__':
    sys.exit(main())
