#!/usr/bin/env python3
# SPDX-FileCopyrightText: 2026 The Vernier authors
# SPDX-License-Identifier: Apache-2.0
"""Checks that no result depends on the order in which a compiler evaluates the arguments of a call:
two random numbers drawn in one list of arguments, f(draws.normal(), draws.normal()), are exchanged
between GCC and Clang.

    draw_order_test.py [FILE…]

Lists in braces are evaluated from left to right. What draws through a lambda, or on both sides of an
operator of vectors, is not seen; the same figures from both compilers are the proof.
"""
import re
import sys
from pathlib import Path

import declared_names

ROOT = Path(__file__).resolve().parents[2]
FOLDERS = ("calib", "stereo", "localise", "sim", "cli", "datasets", "tests", "bench", "fuzz")
METHOD = r"(?:\.|->)(?:uniform|normal|normals|below)\("
STREAM = re.compile(r"\b(?:RandomStream|Random|mt19937(?:_64)?)\s*&?\s+(\w+)")


def blank(match):
    """The same number of lines and characters, without words."""
    return re.sub(r"[^\n]", " ", match.group(0))


def lists_in_parentheses(text):
    """Begin and the arguments of every list in parentheses."""
    stack = []
    for at, c in enumerate(text):
        if c in "([{":
            stack.append((c, at, []))
        elif c == "," and stack:
            stack[-1][2].append(at)
        elif c in ")]}" and stack:
            opening, begin, commas = stack.pop()
            if opening == "(":
                ends = [begin, *commas, at]
                yield begin, [text[a + 1:b] for a, b in zip(ends, ends[1:])]


def draw_pattern(text):
    """What draws in a file: methods of streams, and calls that are given a stream."""
    forms = [METHOD]
    streams = {name for name in STREAM.findall(text) if len(name) > 1}  # others are short for much else
    if streams:
        forms.append(rf"\b\w+\((?:[^()]*,\s*)?(?:{'|'.join(sorted(streams))})\s*[,)]")
    return re.compile("|".join(forms))


def draws_in(argument, draw):
    """Whether an argument draws when it is evaluated: not in the body of a lambda."""
    return bool(draw.search(re.sub(
        r"\[[^\[\]]*\]\s*(?:\([^()]*\))?\s*(?:->\s*[\w:<>]+\s*)?\{.*\}", "", argument, flags=re.S)))


def faults_of(text):
    text = declared_names.NOT_CODE.sub(blank, text)
    draw = draw_pattern(text)
    for begin, arguments in lists_in_parentheses(text):
        if re.search(r"\b(?:for|if|while|switch)\s*(?:constexpr\s*)?$", text[max(0, begin - 20):begin]):
            continue
        if sum(draws_in(argument, draw) for argument in arguments) > 1:
            yield text.count("\n", 0, begin) + 1


def main():
    files = [Path(file) for file in sys.argv[1:]] or sorted(
        file for folder in FOLDERS for file in (ROOT / folder).rglob("*")
        if file.suffix in (".h", ".cpp") and "draw_examples" not in file.parts)
    found = 0
    for file in files:
        for line in faults_of(file.read_text()):
            print(f"{file}:{line}: two random numbers in one list of arguments; draw them one after the other")
            found += 1
    print(f"{len(files)} files, {found} lists of arguments that draw twice")
    return 1 if found else 0


if __name__ == "__main__":
    sys.exit(main())
