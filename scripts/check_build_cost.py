#!/usr/bin/env python3
# SPDX-FileCopyrightText: 2026 The Vernier authors
# SPDX-License-Identifier: Apache-2.0
"""usage: scripts/check_build_cost.py [BUILD_FOLDER] [--top N] [--tolerance PERCENT]
                                  [--allow-cached]

Lists the translation units that cost more than 12 s to compile; exit code 1 if there is one.
BUILD_FOLDER defaults to build/release. --top N also lists the N slowest units. --tolerance raises all
limits by PERCENT.

The times are read from BUILD_FOLDER/compile_costs.tsv, written by a build with
-DVERNIER_MEASURE_BUILD=ON. Results from ccache are ignored: the last real compilation of a unit counts.
Unity build batches are excluded. Exit code 2 if fewer than 90 % of the other units were measured, those
of the sanitized tests apart, which are compiled later.
With --allow-cached, units found only in the compiler cache count towards the 90 %, and their number is
printed. A build with CCACHE_RECACHE=1 in its environment measures them all.

Seconds are CPU seconds (user plus system) of a machine that compiles scripts/reference_unit.cpp in
6 s. The check compiles that unit and converts what it reads. A unit that is above its limit is compiled
again, between two compilations of the reference, and counts only if it is above it then as well: a
machine that is slow, or slow for a while, makes no unit dear.

scripts/build_cost_exceptions.txt lists the units that may cost more, one per line:

    source  seconds  reason

A warning reports lines that are no longer needed.
"""
import json
import os
import re
import resource
import shlex
import subprocess
import sys
import tempfile
from pathlib import Path

LIMIT_S = 12.0
REFERENCE_S = 6.0  # to compile the reference unit, on the machine whose seconds the limits are
ENOUGH = 0.9  # of the units: a change leaves some targets unbuilt
ROOT = Path(__file__).resolve().parent.parent
REFERENCE = ROOT / "scripts/reference_unit.cpp"
EXCEPTIONS = Path(__file__).resolve().parent / "build_cost_exceptions.txt"
BATCH = re.compile(r"/unity_\d+_\w+\.\w+$")
LATER = re.compile(r"_sanitized\w*\.dir/")  # objects that scripts/test.sh makes after this check


class Unusable(Exception):
    """An unusable input: exit code 2."""


def read_exceptions(path):
    """{source: limit in seconds} from the file of exceptions."""
    limits = {}
    for number, line in enumerate(path.read_text(encoding="utf-8").splitlines(), 1):
        if not line.strip() or line.startswith("#"):
            continue
        words = line.split(maxsplit=2)
        try:
            source, limit, _ = words
            limit = float(limit)
        except ValueError:
            raise Unusable(f"{path}:{number}: expected 'source seconds reason': {line}") from None
        if not limit > LIMIT_S:
            raise Unusable(f"{path}:{number}: {limit:g} s is not above the general limit of {LIMIT_S:g} s")
        if source in limits:
            raise Unusable(f"{path}:{number}: {source} is listed twice")
        limits[source] = limit
    return limits


def read_costs(path):
    """{object: (CPU seconds, source)} of the last real compilation; objects found only in the cache."""
    costs = {}
    cached = set()
    for number, line in enumerate(path.read_text(encoding="utf-8").splitlines(), 1):
        fields = line.split("\t")
        try:
            seconds, outcome, unit, source = fields
            seconds = float(seconds)
        except ValueError:
            raise Unusable(f"{path}:{number}: expected 'seconds outcome object source'") from None
        if outcome == "compiled":
            costs[unit] = (seconds, source)
        elif outcome == "cached":
            cached.add(unit)
    return costs, cached - costs.keys()


def read_units(path):
    """{object: (command as words, its folder)} of this build folder, without removed sources."""
    units = {}
    for entry in json.loads(path.read_text(encoding="utf-8")):
        words = shlex.split(entry["command"])
        units[words[words.index("-o") + 1]] = (words, entry.get("directory", "."))
    return units


def compile_s(command):
    """CPU seconds of compiling a unit now, past the cache."""
    words, folder = command
    words = [str(word) for word in words]
    before = resource.getrusage(resource.RUSAGE_CHILDREN)
    with tempfile.TemporaryDirectory() as scratch:
        words[words.index("-o") + 1] = f"{scratch}/unit.o"
        # The dependency file that the command names stays as it is.
        words = [f"{scratch}/unit.d" if before_it == "-MF" else word
                 for before_it, word in zip(["", *words], words)]
        run = subprocess.run(words, cwd=folder, env={**os.environ, "CCACHE_DISABLE": "1"},
                             capture_output=True, text=True, check=False)
    if run.returncode != 0:
        raise Unusable(f"{words[words.index('-c') + 1]} does not compile: {run.stderr.strip()[-300:]}")
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    return sum(after[:2]) - sum(before[:2])


class Machine:
    """How fast this machine compiles, by the reference unit."""

    def __init__(self, words, folder):
        """`words` is the command of any unit: its compiler and include folders are taken."""
        includes = [word for flag, value in zip(words, words[1:]) if flag in ("-I", "-isystem")
                    for word in (flag, value)]
        self._command = ([words[0], "-std=c++20", "-O3", *includes, "-o", "unit.o", "-c", REFERENCE],
                         folder)

    def seconds_in_one(self):
        """Seconds of this machine, now, in one second of the limits."""
        return compile_s(self._command) / REFERENCE_S

    def cost(self, command):
        """What a unit costs by the limits' seconds, compiled between two of the reference."""
        before = self.seconds_in_one()
        seconds = compile_s(command)
        return seconds / max(before, self.seconds_in_one())


def name_of(source, build):
    """The source's path in the checkout; for a generated one, its path in the build folder."""
    path = Path(source)
    for folder in (build, ROOT):
        if path.is_relative_to(folder):
            return str(path.relative_to(folder))
    return source


def check(build, top, tolerance=0, allow_cached=False):
    """Prints the problems; returns the exit code."""
    build = build.resolve()
    log = build / "compile_costs.tsv"
    if not log.is_file():
        raise Unusable(f"no {log}; build with -DVERNIER_MEASURE_BUILD=ON first")
    exceptions = read_exceptions(EXCEPTIONS)
    units = read_units(build / "compile_commands.json")
    costs, cached = read_costs(log)
    costs = {unit: cost for unit, cost in costs.items() if unit in units}

    measured = {unit: (seconds, source) for unit, (seconds, source) in costs.items()
                if not BATCH.search(source)}
    batches = len(costs) - len(measured)
    machine = Machine(*next(iter(units.values()))) if measured else None
    speed = machine.seconds_in_one() if machine else 1.0
    slowest = {}  # by source; one may belong to several targets
    for unit, (seconds, source) in measured.items():
        name = name_of(source, build)
        if seconds / speed > slowest.get(name, (0.0, ""))[0]:
            slowest[name] = (seconds / speed, unit)

    def limit_of(name):
        return exceptions.get(name, LIMIT_S) * (1 + tolerance / 100)

    for name, (seconds, unit) in slowest.items():
        if seconds > limit_of(name):
            slowest[name] = (min(seconds, machine.cost(units[unit])), unit)
    ranking = sorted(slowest.items(), key=lambda item: -item[1][0])
    for name, (seconds, unit) in ranking[:top]:
        print(f"{seconds:8.2f} s  {name}  ({unit})")
    offenders = [(name, seconds, limit_of(name)) for name, (seconds, _) in ranking
                 if seconds > limit_of(name)]
    missing = [name for name in exceptions
               if not (ROOT / name).is_file() and not (build / name).is_file()]
    for name, seconds, limit in offenders:
        print(f"compilation too slow: {name}: {seconds:.1f} s, limit {limit:g} s",
              file=sys.stderr)
    for name in missing:
        print(f"{EXCEPTIONS.name}: {name} does not exist", file=sys.stderr)
    for name in exceptions:
        if name in slowest and slowest[name][0] <= LIMIT_S:
            print(f"warning: {EXCEPTIONS.name}: {name} takes {slowest[name][0]:.1f} s; "
                  "its exception is no longer needed", file=sys.stderr)

    cached &= units.keys()
    total = sum(seconds for seconds, _ in measured.values())
    words = (f"build cost: {len(measured)} of {len(units)} units measured, {total:.0f} CPU s in total; "
             f"{len(cached)} found only in the compiler cache")
    if machine:
        words += f"; one second of the limits is {speed:.2f} CPU s here"
    if batches:
        words += f"; unity build batches excluded: {batches}"
    if ranking:
        words += f"; slowest: {ranking[0][1][0]:.1f} s, {ranking[0][0]}"
    print(words)
    if offenders or missing:
        return 1
    # Batches count neither as measured nor as missing, those of targets that are not built included.
    single = sum(not (BATCH.search(words[words.index("-c") + 1]) or
                      (unit in costs and unit not in measured) or
                      (LATER.search(unit) and unit not in costs))
                 for unit, (words, _) in units.items())
    known = len(measured) + (len(cached) if allow_cached else 0)
    if not known or known < ENOUGH * single:
        raise Unusable(f"too few units were measured: {len(measured)} of "
                       f"{single}, {ENOUGH:.0%} are needed; build everything, with "
                       "CCACHE_RECACHE=1 if units came from the compiler cache")
    if allow_cached and cached:
        print(f"not measured: {len(cached)} units came from the compiler cache")
    return 0


def main():
    """Parses the command line and runs the check; returns the exit code."""
    arguments = sys.argv[1:]
    if arguments in (["-h"], ["--help"]):
        print(__doc__.strip())
        return 0
    allow_cached = "--allow-cached" in arguments
    if allow_cached:
        arguments.remove("--allow-cached")
    numbers = {"--top": 0, "--tolerance": 0}
    for option in numbers:
        if option in arguments:
            at = arguments.index(option)
            if at + 1 == len(arguments) or not arguments[at + 1].isdigit():
                print(__doc__.strip(), file=sys.stderr)
                return 2
            numbers[option] = int(arguments[at + 1])
            del arguments[at:at + 2]
    if len(arguments) > 1 or any(argument.startswith("-") for argument in arguments):
        print(__doc__.strip(), file=sys.stderr)
        return 2
    try:
        return check(Path(arguments[0]) if arguments else ROOT / "build/release",
                     numbers["--top"], numbers["--tolerance"], allow_cached)
    except (Unusable, OSError, ValueError) as problem:
        print(f"check_build_cost.py: {problem}", file=sys.stderr)
        return 2


if __name__ == "__main__":
    sys.exit(main())
