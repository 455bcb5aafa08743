#!/usr/bin/env python3
# SPDX-FileCopyrightText: 2026 The Vernier authors
# SPDX-License-Identifier: Apache-2.0
"""Checks that the thread sanitizer runs the tests that use threads: each source of tests that asks for
several, or starts some, is listed for it in tests/CMakeLists.txt.

A test of threads has "Thread" in its name, which scripts/thread_sanitizer.sh chooses by.
"""
import re
import sys
from pathlib import Path

TESTS = Path(__file__).resolve().parents[1]
USES = re.compile(r"^TEST.*Thread|std::(?:thread|jthread|async)\b|\btbb::|\bthreads = (?:[2-9]|\{)", re.M)
# Their threads only feed a pipe to the one that reads.
FEEDS = {"calib/base/pipe_reading_test.cpp", "calib/base/read_whole_test.cpp"}


def main():
    listed = re.search(r"vernier_test\(thread_tests.*?LIBRARIES", (TESTS / "CMakeLists.txt").read_text(), re.S)
    sources = set(re.findall(r"\S+_test\.cpp", listed.group(0)))
    missing = sorted(
        name for file in TESTS.rglob("*_test.cpp")
        if (name := str(file.relative_to(TESTS))) not in sources | FEEDS and USES.search(file.read_text()))
    for name in missing:
        print(f"{name}: uses threads and is not in thread_tests (tests/CMakeLists.txt)")
    gone = sorted(name for name in sources if not (TESTS / name).is_file())
    for name in gone:
        print(f"{name}: in thread_tests, but there is no such file")
    print(f"{len(sources)} sources in thread_tests")
    return 1 if missing or gone or not sources else 0


if __name__ == "__main__":
    sys.exit(main())
