#!/usr/bin/env python3
# SPDX-FileCopyrightText: 2026 The Vernier authors
# SPDX-License-Identifier: Apache-2.0
"""Checks that the sources of a module can share a unit of a unity build, as scripts/demo.sh makes it.

    unity_test.py [FILE…]

Fails if two sources of a module define the same name in unnamed namespaces within one namespace:
which of them meet in a unit changes with every source that is added. Functions may be overloaded, but
not by anything else. Types are compared without their namespaces. A constant of a header, which any
of them may include, counts like one of a source, and so does a type of a header of the module or of
one below it: sources that share the unit would find the local one instead. With files, these are
taken for the sources of one module.
"""
import collections
import re
import sys
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
MODULES = ("calib", "stereo", "localise", "sim", "cli")
TESTS = ("tests/calib", "tests/stereo", "tests/localise", "tests/sim", "fuzz")
NAMESPACE = re.compile(r"namespace ([\w:]+) \{")
TYPE = re.compile(r"(?:struct|class|enum class|enum) (\w+)\b(?!;)")
CONSTANT = re.compile(r"(?:constexpr|const|inline constexpr|static const|static|thread_local|auto) "
                      r"[^=({]*?\b(\w+)(?:\[\w*\])?\s*[={;]")
ALIAS = re.compile(r"using (\w+)(?: = |;)|using [\w:]+::(\w+);")
VARIABLE = re.compile(r"(?!using|return|template|friend|struct|class|enum|namespace)"
                      r"[\w:<>, ]+?[&* ](\w+)(?:\[\w*\])?\s*(?:=|\{|;$)")
DECLARATOR = re.compile(r",\s*(\w+)\s*(?==|\{)")
QUALIFIER = re.compile(r"\b(?:\w+::)+")
FUNCTION = re.compile(r"(?!using|return|template)[\w:<>,&* ]+?\b(\w+)\((.*)")


def parameter_lists(lines):
    """The types of a function's parameters, and of those that a call may give where the last ones have
    defaults: such a call is ambiguous beside another function. `lines` begin behind the opening bracket."""
    text = ""
    for line in lines:
        text += " " + line.strip()
        if text.count("(") + 1 <= text.count(")"):
            break
    parts = [part.strip() for part in text.split(") {")[0].split(");")[0].split(",")]
    types = [re.sub(r"\bconst |\s*&+$", "", re.sub(r"\s*\b\w+$", "", QUALIFIER.sub("", re.sub(r"\s*=.*", "", part))))
             for part in parts]
    least = next((number for number, part in enumerate(parts) if "=" in part), len(parts))
    return [",".join(types[:count]) for count in range(least, len(parts) + 1)]


def local_names(text):
    """(namespace, name) of all that unnamed namespaces define at the start of a line."""
    space, inside = "", False
    lines = text.split("\n")
    for number, line in enumerate(lines):
        if named := NAMESPACE.match(line):
            space = named[1]
        if line == "namespace {":
            inside = True
        elif line.strip() == "}  // namespace":
            inside = False
        elif inside and line and line[0] not in " }/#":
            if found := TYPE.match(line):
                yield space, "type " + found[1]
            elif found := ALIAS.match(line):
                if found[1]:  # what a using declaration brings is the same thing everywhere
                    yield space, f"{found[1]} = {line[found.end():]}"
            elif found := CONSTANT.match(line) or VARIABLE.match(line):
                yield space, found[1]
                statement = line
                while ";" not in statement and number + 1 < len(lines):
                    number += 1
                    statement += lines[number]
                for other in DECLARATOR.findall(re.sub(r"\{[^{}]*\}|\([^()]*\)|<[^<>]*>", "{",
                                                       statement[found.end():])):
                    yield space, other
            elif found := FUNCTION.match(line):
                for listed in parameter_lists([found[2]] + lines[number + 1:]):
                    yield space, f"{found[1]}({listed})"


def header_constants(text):
    """(namespace, name) of the constants that a header defines for all, at the start of a line."""
    space = ""
    for line in text.split("\n"):
        if named := NAMESPACE.match(line):
            space = named[1]
        if line.startswith(("inline constexpr ", "constexpr ", "inline const ")):
            if found := CONSTANT.match(line.removeprefix("inline ")):
                yield space, found[1]


def header_types(text):
    """Names of the types that a header defines for all, at the start of a line."""
    return {found[1] for line in text.split("\n") if (found := TYPE.match(line))}


def hidden_types(files, headers):
    """Local types that hide one of a header: (name, the two files)."""
    shared = {name: str(header) for header in headers
              for name in header_types(header.read_text(encoding="utf-8"))}
    for file in (file for file in files if file.suffix == ".cpp"):
        for space, name in local_names(file.read_text(encoding="utf-8")):
            name = name.removeprefix("type ").split(" = ")[0]
            if name in shared:
                yield f"{space}::{name}", [str(file), shared[name]]


def twice(files):
    """Names that more than one of the files defines: (name, the files)."""
    where, functions = collections.defaultdict(set), collections.defaultdict(set)
    aliases = collections.defaultdict(lambda: collections.defaultdict(set))
    for file in (file for file in files if file.suffix == ".h"):
        for space, name in header_constants(file.read_text(encoding="utf-8")):
            where[f"{space}::{name}"].add(str(file))
    for file in (file for file in files if file.suffix == ".cpp"):
        for space, name in local_names(file.read_text(encoding="utf-8")):
            if " = " in name:  # an alias may be given twice, if it is the same
                aliases[f"{space}::{name.split(' = ')[0]}"][name].add(str(file))
                continue
            where[f"{space}::{name}"].add(str(file))
            if "(" in name:
                functions[f"{space}::{name.split('(')[0]}"].add(str(file))
    for name, meanings in aliases.items():
        if len(meanings) > 1 or name in where:
            where[name] |= set().union(*meanings.values())
    for name, files_of_function in functions.items():
        if name in where:
            where[name] |= files_of_function
    return [(name, sorted(found)) for name, found in sorted(where.items()) if len(found) > 1]


def main():
    modules = [[Path(name) for name in sys.argv[1:]]] if len(sys.argv) > 1 else [
        [file for ext in ("cpp", "h") for file in (ROOT / module).rglob(f"*.{ext}")
         if "node_modules" not in file.parts]
        for module in MODULES + TESTS]
    faults = [fault for files in modules for fault in twice(files)]
    for number, files in enumerate(modules):
        headers = [file for below in modules[:number + 1] for file in below if file.suffix == ".h" and
                   (number < len(MODULES) or ROOT / "cli" not in file.parents)]  # no test includes it
        faults += hidden_types(files, headers)
    for name, files in faults:
        print(f"{name} is defined in {' and '.join(files)}: share it, or rename one")
    print(f"{sum(map(len, modules))} sources, {len(faults)} names defined twice")
    return 1 if faults else 0


if __name__ == "__main__":
    sys.exit(main())
