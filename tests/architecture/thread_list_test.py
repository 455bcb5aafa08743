#!/usr/bin/env python3
# SPDX-FileCopyrightText: 2026 The Vernier authors
# SPDX-License-Identifier: Apache-2.0
"""Checks that the thread sanitizer runs the tests that use threads.

    thread_list_test.py [FILE…]

Each source of tests that asks for several threads, starts some, or calls what uses all processors by
default is listed for it in tests/CMakeLists.txt, and scripts/thread_sanitizer.sh chooses each of its tests
that does so itself, and at least one. With FILEs, says which of them use threads.
"""
import fnmatch
import re
import sys
from pathlib import Path

TESTS = Path(__file__).resolve().parents[1]
ON_ALL = "run_study|success_curve|compare_split_halves|inject_calibration_error|monte_carlo_check"  # by default
USES = re.compile(r"^TEST.*Thread|std::(?:thread|jthread|async)\b|\btbb::|\bthreads = (?!1\b)\S|"
                  rf"\bfor_each_index\(|\b(?:{ON_ALL})\(", re.M)
# Their threads only feed a pipe to the one that reads.
FEEDS = {"calib/base/pipe_reading_test.cpp", "calib/base/read_whole_test.cpp"}


TEST = re.compile(r"^TEST(?:_F|_P)?\((\w+),\s*(\w+)\).*?^}", re.M | re.S)


def chosen(source, patterns):
    """The tests of a source, and which of them the patterns choose."""
    tests = {f"{test[1]}.{test[2]}": test[0] for test in TEST.finditer(source)}
    return tests, {name for name in tests for pattern in patterns if fnmatch.fnmatchcase(name, pattern)}


def main():
    if sys.argv[1:]:
        using = [name for name in sys.argv[1:] if USES.search(Path(name).read_text())]
        print(f"{len(sys.argv) - 1} files, {len(using)} use threads")
        return 0
    listed = re.search(r"vernier_test\(thread_tests.*?LIBRARIES", (TESTS / "CMakeLists.txt").read_text(), re.S)
    sources = set(re.findall(r"\S+_test\.cpp", listed.group(0)))
    script = (TESTS.parent / "scripts/thread_sanitizer.sh").read_text()
    patterns = ":".join(re.findall(r"^filter\+?='(.*)'", script, re.M)).strip(":").replace("::", ":").split(":")
    faults = 0
    for file in sorted(TESTS.rglob("*_test.cpp")):
        name, source = str(file.relative_to(TESTS)), file.read_text()
        if name in sources:
            tests, run = chosen(source, patterns)
            left_out = [test for test in tests if USES.search(tests[test]) and test not in run]
            if not run:
                left_out = ["all of its tests"]
            for test in left_out:
                print(f"{name}: in thread_tests, but scripts/thread_sanitizer.sh leaves out {test}")
                faults += 1
        if name not in sources | FEEDS and USES.search(source):
            print(f"{name}: uses threads and is not in thread_tests (tests/CMakeLists.txt)")
            faults += 1
    for name in sorted(sources):
        if not (TESTS / name).is_file():
            print(f"{name}: in thread_tests, but there is no such file")
            faults += 1
    print(f"{len(sources)} sources in thread_tests, {faults} faults")
    return 1 if faults or not sources else 0


if __name__ == "__main__":
    sys.exit(main())
