#!/usr/bin/env python3
# SPDX-FileCopyrightText: 2026 The Vernier authors
# SPDX-License-Identifier: Apache-2.0
"""Every line of tests/sanitizer_exclusions.txt names a test that exists, in order and once."""
import re
import unittest
from pathlib import Path

TESTS = Path(__file__).resolve().parent.parent


class SanitizerExclusions(unittest.TestCase):
    def test_each_names_a_test(self):
        lines = [line for line in (TESTS / "sanitizer_exclusions.txt").read_text().splitlines()
                 if not line.startswith("#")]
        self.assertTrue(lines)
        self.assertEqual(lines, sorted(set(lines)))
        sources = "\n".join(file.read_text() for file in TESTS.glob("**/*_test.cpp"))
        for line in lines:
            suite, name = re.fullmatch(r"(?:\w+/)?(\w+)\.(\w+)(?:/[\w*]+)?", line).groups()
            self.assertRegex(sources, rf"TEST(?:_F|_P)?\({suite},\s*{name}\)", line)


if __name__ == "__main__":
    unittest.main()
