# SPDX-FileCopyrightText: 2026 The Vernier authors
# SPDX-License-Identifier: Apache-2.0
"""Which names the project's headers declare, and which files use one without including it.

Not a compiler: it reads lines that start in the first column, as clang-format leaves declarations
at namespace scope. Where it cannot tell (a name declared in several headers, a function named but
not called) it says nothing.
"""
import re

INCLUDE = re.compile(r'^\s*#include "([^"]+)"', re.MULTILINE)
NOT_CODE = re.compile(
    r'//[^\n]*|/\*.*?\*/|R"\((?:.|\n)*?\)"|"(?:\\.|[^"\\\n])*"|'
    r"(?<![0-9a-zA-Z_])'(?:\\.|[^'\\\n])+'", re.DOTALL)
TYPE = re.compile(
    r"^(?:template ?<[^\n]*>\n)?(?:struct|class|enum class|enum|union) (?:alignas\([^)]*\) )?(\w+)\b"
    r"[^;\n]*[{:]|^using (\w+) =|^inline const(?:expr)?\b[^=({\n]*?\b(\w+)(?:\[[^\]]*\])*\s*[={]",
    re.MULTILINE)
FUNCTION = re.compile(
    r"^(?!using|namespace|template|struct|class|enum|return|static_assert|if|for|#|typedef|HWY_)"
    r"(?:[A-Za-z_][\w:<>,&*\s]*?[\s&*>])?(\w+)\(", re.MULTILINE)
USE = re.compile(r"(?<![\w.])(?<!->)([A-Za-z_]\w*)\b(\s*[(<]?)")


def code_of(text):
    """The text without comments, strings and include lines."""
    text = re.sub(r"^\s*#include[^\n]*$", "", text, flags=re.MULTILINE)
    return NOT_CODE.sub(lambda m: "" if m.group(0).startswith("/") else '""', text)


def declared(text):
    """(types and constants, functions) that a header declares at namespace scope."""
    code = code_of(text)
    types = {name for names in TYPE.findall(code) for name in names if name}
    return types, {name for name in FUNCTION.findall(code)} - types


def uses_without_include(root, files):
    """(path, name, header) of each use of a name whose header reaches a file only through others."""
    texts = {path: (root / path).read_text(encoding="utf-8") for path in files}
    includes = {path: set(INCLUDE.findall(text)) for path, text in texts.items()}
    where, types = {}, set()
    for path in files:
        if not path.endswith(".h"):
            continue
        of_types, functions = declared(texts[path])
        types |= of_types
        for name in of_types | functions:
            where.setdefault(name, set()).add(path)
    for path in files:
        yield from missing_in(path, texts[path], includes, where, types)


def reached(path, includes):
    """All that a file includes, directly or not."""
    seen, waiting = set(), list(includes[path])
    while waiting:
        header = waiting.pop()
        if header in seen or header not in includes:
            continue
        seen.add(header)
        waiting.extend(includes[header])
    return seen


def missing_in(path, text, includes, where, types):
    called, named = set(), set()
    for name, after in USE.findall(code_of(text)):
        named.add(name)
        if after.strip():
            called.add(name)
    all_reached = reached(path, includes)
    for name in sorted(named & where.keys()):
        headers = (where[name] & all_reached) - {path}
        if len(headers) != 1 or path in where[name] or headers & includes[path]:
            continue
        if name in types or name in called:
            yield path, name, headers.pop()
