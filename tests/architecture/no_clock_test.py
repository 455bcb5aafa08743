#!/usr/bin/env python3
# SPDX-FileCopyrightText: 2026 The Vernier authors
# SPDX-License-Identifier: Apache-2.0
"""Checks that no test measures time: a bound in seconds fails on a busy machine and under sanitizers.

    no_clock_test.py [FILE…]

How fast something is and how it grows is measured in bench/, as a ratio in one run. Tests in Python may
read the monotonic clock to end their waiting, but assert nothing of it.
"""
import re
import sys
from pathlib import Path

TESTS = Path(__file__).resolve().parents[1]
CLOCKS = {
    ".cpp": re.compile(r"_?[cC]lock::now\(|\bclock\(\)|clock_gettime|gettimeofday|std::time\(|ru_[us]time"),
    ".py": re.compile(r"perf_counter|process_time|thread_time|time\.time\(|ru_[us]time|os\.times\(|"
                      r"assert.*(?:monotonic|\bseconds\b|\belapsed\b|\btook\b)"),
}
CLOCKS[".h"] = CLOCKS[".cpp"]


def main():
    files = [Path(file) for file in sys.argv[1:]] or sorted(
        file for file in TESTS.rglob("*") if file.suffix in CLOCKS and "architecture" not in file.relative_to(TESTS).parts)
    found = 0
    for file in files:
        for number, line in enumerate(file.read_text().splitlines(), 1):
            if CLOCKS[file.suffix].search(line):
                print(f"{file}:{number}: reads a clock; measure time in bench/")
                found += 1
    print(f"{len(files)} files, {found} readings of a clock")
    return 1 if found else 0


if __name__ == "__main__":
    sys.exit(main())
