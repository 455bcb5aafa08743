#!/usr/bin/env python3
# SPDX-FileCopyrightText: 2026 The Vernier authors
# SPDX-License-Identifier: Apache-2.0
"""usage: scripts/check_build_cost.py [BUILD_FOLDER] [--top N] [--tolerance PERCENT]
                                  [--allow-cached]

Lists the units that cost more than 12 CPU seconds to compile; exit code 1 if there is one.
BUILD_FOLDER is build/release; --top N lists the N dearest besides. --tolerance raises all limits by so
many per cent, for machines whose cores are shared: there the same unit costs up to half as much again.

What a unit costs is in BUILD_FOLDER/compile_costs.tsv, which a build with
-DVERNIER_MEASURE_BUILD=ON writes. CPU seconds are user and system time: they do not depend on how
many compilers run beside each other. What ccache gave back cost nothing and says nothing: a unit
counts by the last time it was compiled in earnest. Batches of a unity build are left out. Exit code
2 if fewer than 90 % of the other units were measured, for then the check says nothing. With
--allow-cached those count towards the 90 % that only ever came from the compiler cache; how many is
printed. CCACHE_RECACHE=1 in the environment of a build measures them all.

scripts/build_cost_exceptions.txt names the units that may cost more, one a line:

    source  CPU seconds  reason

A warning says which line is needed no longer.
"""
import json
import re
import shlex
import sys
from pathlib import Path

LIMIT_S = 12.0
ENOUGH = 0.9  # of the units: a change leaves some targets unbuilt
ROOT = Path(__file__).resolve().parent.parent
EXCEPTIONS = Path(__file__).resolve().parent / "build_cost_exceptions.txt"
BATCH = re.compile(r"/unity_\d+_\w+\.\w+$")


class Unusable(Exception):
    """An input that the check cannot work with: exit code 2."""


def read_exceptions(path):
    """{source: limit in seconds} of the file of exceptions."""
    limits = {}
    for number, line in enumerate(path.read_text(encoding="utf-8").splitlines(), 1):
        if not line.strip() or line.startswith("#"):
            continue
        words = line.split(maxsplit=2)
        try:
            source, limit, _ = words
            limit = float(limit)
        except ValueError:
            raise Unusable(f"{path}:{number}: not 'source seconds reason': {line}") from None
        if not limit > LIMIT_S:
            raise Unusable(f"{path}:{number}: {limit:g} s is within the limit of {LIMIT_S:g} s")
        if source in limits:
            raise Unusable(f"{path}:{number}: {source} stands there twice")
        limits[source] = limit
    return limits


def read_costs(path):
    """{object: (CPU seconds, source)} as last compiled in earnest; the objects only ever cached."""
    costs = {}
    cached = set()
    for number, line in enumerate(path.read_text(encoding="utf-8").splitlines(), 1):
        fields = line.split("\t")
        try:
            seconds, outcome, unit, source = fields
            seconds = float(seconds)
        except ValueError:
            raise Unusable(f"{path}:{number}: not 'seconds outcome object source'") from None
        if outcome == "compiled":
            costs[unit] = (seconds, source)
        elif outcome == "cached":
            cached.add(unit)
    return costs, cached - costs.keys()


def read_units(path):
    """The objects that this build folder makes, those of removed sources left out."""
    units = set()
    for entry in json.loads(path.read_text(encoding="utf-8")):
        words = shlex.split(entry["command"])
        units.add(words[words.index("-o") + 1])
    return units


def name_of(source, build):
    """The source's path in the checkout; for a generated one, its path in the build folder."""
    path = Path(source)
    for folder in (build, ROOT):
        if path.is_relative_to(folder):
            return str(path.relative_to(folder))
    return source


def check(build, top, tolerance=0, allow_cached=False):
    """Prints what is wrong; returns the exit code."""
    build = build.resolve()
    log = build / "compile_costs.tsv"
    if not log.is_file():
        raise Unusable(f"no {log}; build with -DVERNIER_MEASURE_BUILD=ON first")
    exceptions = read_exceptions(EXCEPTIONS)
    units = read_units(build / "compile_commands.json")
    costs, cached = read_costs(log)
    costs = {unit: cost for unit, cost in costs.items() if unit in units}

    dearest = {}  # by source; one may belong to several targets
    batches = 0
    for unit, (seconds, source) in costs.items():
        if BATCH.search(source):
            batches += 1
            continue
        name = name_of(source, build)
        if seconds > dearest.get(name, (0.0, ""))[0]:
            dearest[name] = (seconds, unit)
    ranking = sorted(dearest.items(), key=lambda item: -item[1][0])

    for name, (seconds, unit) in ranking[:top]:
        print(f"{seconds:8.2f} s  {name}  ({unit})")

    def limit_of(name):
        return exceptions.get(name, LIMIT_S) * (1 + tolerance / 100)

    offenders = [(name, seconds, limit_of(name)) for name, (seconds, _) in ranking
                 if seconds > limit_of(name)]
    missing = [name for name in exceptions
               if not (ROOT / name).is_file() and not (build / name).is_file()]
    for name, seconds, limit in offenders:
        print(f"too dear to compile: {name}: {seconds:.1f} CPU s, the limit is {limit:g} s",
              file=sys.stderr)
    for name in missing:
        print(f"{EXCEPTIONS.name}: there is no {name}", file=sys.stderr)
    for name in exceptions:
        if name in dearest and dearest[name][0] <= LIMIT_S:
            print(f"warning: {EXCEPTIONS.name}: {name} costs {dearest[name][0]:.1f} s and needs no "
                  "exception now", file=sys.stderr)

    cached &= units
    measured = [seconds for seconds, source in costs.values() if not BATCH.search(source)]
    words = (f"build cost: {len(measured)} of {len(units)} units measured, "
             f"{sum(measured):.0f} CPU s together; "
             f"{len(cached)} known from the compiler cache alone")
    if batches:
        words += f"; batches of a unity build left out: {batches}"
    if ranking:
        words += f"; the dearest {ranking[0][1][0]:.1f} s, {ranking[0][0]}"
    print(words)
    if offenders or missing:
        return 1
    known = len(measured) + (len(cached) if allow_cached else 0)
    if not known or known < ENOUGH * (len(units) - batches):
        raise Unusable(f"too few units were measured to judge: {len(measured)} of "
                       f"{len(units) - batches}, {ENOUGH:.0%} are needed; build all, and with "
                       "CCACHE_RECACHE=1 what came from the compiler cache")
    if allow_cached and cached:
        print(f"not measured: {len(cached)} units came from the compiler cache")
    return 0


def main():
    """The command line; returns the exit code."""
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
