#!/usr/bin/env python3
# SPDX-FileCopyrightText: 2026 The Vernier authors
# SPDX-License-Identifier: Apache-2.0
"""Checks the include lines of the five modules against rooms.toml.

    include_test.py [--graph] [--update]

Fails on an include of a room that is not among those a room may include, on an arrow that runs back
(an include of a room further down the file), on a file that belongs to no room, on a permission
that nothing uses, on a public header that includes an internal one, and on a file that uses a name
of the project without including the header that declares it; and where docs/architecture.md does
not show the rooms as rooms.toml has them, or names a file that is not there or lacks a name beside
it. --graph prints the arrows, --update writes the rooms into that page.
"""
import argparse
import re
import sys
from pathlib import Path

import declared_names

ROOT = Path(__file__).resolve().parents[2]
MODULES = ("calib", "stereo", "localise", "sim", "cli")
INCLUDE = re.compile(r'^\s*#include "([^"]+)"', re.MULTILINE)


def read_rooms(file):
    """The rooms in their order: a list of dictionaries (a small part of TOML suffices)."""
    rooms = []
    text = re.sub(r"#.*", "", file.read_text(encoding="utf-8"))
    for block in text.split("[[room]]")[1:]:
        room = {"public": []}
        for key, strings in re.findall(r'(\w+) = (\[[^\]]*\]|"[^"]*")', block):
            values = re.findall(r'"([^"]*)"', strings)
            room[key] = values if strings.startswith("[") else values[0]
        rooms.append(room)
    return rooms


def sources():
    """Paths of the modules' C++ files below the root."""
    for module in MODULES:
        for file in sorted((ROOT / module).rglob("*")):
            if file.suffix in (".h", ".cpp", ".inc") and "node_modules" not in file.parts:
                yield file.relative_to(ROOT).as_posix()


def room_of(path, rooms):
    """The room of a file; None if it has none. Public headers belong to the room that lists them."""
    folder, name = path.rsplit("/", 1)
    for room in rooms:
        if room["name"] == folder or (
                room["name"].startswith(folder + "/") and name in room["public"]):
            return room["name"]
    return None


def faults(rooms):
    """Every fault in words, and the arrows: (from, to) -> include lines."""
    order = {room["name"]: place for place, room in enumerate(rooms)}
    allowed = {room["name"]: set(room["may_include"]) for room in rooms}
    public = {f"{room['name'].split('/')[0]}/{h}" for room in rooms for h in room["public"]}
    found, arrows = [], {}
    for room in rooms:
        for other in room["may_include"]:
            if order.get(other, len(order)) >= order[room["name"]]:
                found.append(f"rooms.toml: {room['name']} may not include {other}: it is not below it")
    for path in sources():
        here = room_of(path, rooms)
        if here is None:
            found.append(f"{path}: belongs to no room; put it into one or list it in rooms.toml")
            continue
        for included in INCLUDE.findall((ROOT / path).read_text(encoding="utf-8")):
            there = room_of(included, rooms) if (ROOT / included).exists() else None
            if there is None:
                found.append(f"{path}: includes {included}, which is in no room")
                continue
            if path in public and included not in public:
                found.append(f"{path}: a public header includes {included}, which is internal")
            if there != here:
                arrows.setdefault((here, there), []).append((path, included))
                if there not in allowed[here]:
                    found.append(f"{path}: includes {included}, but {here} may not include {there}")
    for room in rooms:
        for other in room["may_include"]:
            if (room["name"], other) not in arrows:
                found.append(f"rooms.toml: {room['name']} does not include {other}; take it out")
    return found, arrows


def diagram(rooms):
    """The rooms by module, the lowest at the bottom: each includes only what stands below it."""
    levels, lines = {}, []
    for room in rooms:
        module = room["name"].split("/")[0]
        below = [levels[other] for other in room["may_include"] if other.split("/")[0] == module]
        levels[room["name"]] = max(below, default=-1) + 1
    for module in reversed(MODULES):
        lines.append("+" + "-" * 78 + "+")
        names = [name for name in levels if name.split("/")[0] == module]
        title = module
        for level in sorted({levels[name] for name in names}, reverse=True):
            here = [name.partition("/")[2] or "(the module's own folder)"
                    for name in names if levels[name] == level]
            lines.append(f"| {title:<10}{'   '.join(here):<67}|")
            title = ""
    return "\n".join(lines + ["+" + "-" * 78 + "+"]) + "\n"


def table(rooms):
    """The rooms as a table in Markdown, the lowest first."""
    lines = ["| room | purpose | public headers | may include |", "| --- | --- | --- | --- |"]
    for room in rooms:
        lines.append(f"| `{room['name']}` | {room['purpose']} | "
                     f"{', '.join(f'`{header}`' for header in room['public']) or 'none'} | "
                     f"{', '.join(room['may_include']) or 'nothing'} |")
    return "\n".join(lines) + "\n"


FILE = r"[\w/]+\.(?:cpp|h|inc|js|toml)"
PAGE_PARTS = re.compile(r"(^```text rooms\n)(.*?)(^```$)(.*?)(^\| room \|.*?\n)(?=\n)", re.M | re.S)


def step_faults(page):
    """Rows of a page that name a file which is not there or lacks a name beside it: those of three
    cells, "| step | files | names |", and of two, "| for | files and names |"."""
    found = []
    for row in re.findall(r"^\| .* \|$", page.read_text(encoding="utf-8"), re.M):
        cells = row.strip("| ").split(" | ")
        names = re.findall(rf"`({FILE})`", cells[1]) if len(cells) in (2, 3) else []
        if not names or "/" not in names[0]:
            continue
        text, folder = "", ""
        for name in names:  # a name without a folder is in the one before
            folder = name.rpartition("/")[0] or folder
            file = ROOT / folder / name.rpartition("/")[2]
            if not file.is_file():
                found.append(f"{page.name}: names {folder}/{file.name}, which is not there")
                continue
            text += file.read_text(encoding="utf-8")
        for function in re.findall(r"`([\w:]+)`", cells[-1]):
            if not re.search(rf"\b{function.split('::')[-1]}\b", text):
                found.append(f"{page.name}: {function} is not in {', '.join(names)}")
    return found


def page_faults(rooms, page, update):
    """Where the page does not show the rooms as they are; written there if `update`."""
    text = page.read_text(encoding="utf-8")
    found = PAGE_PARTS.search(text)
    if not found:
        return [f"{page.name}: has no diagram or no table of the rooms"]
    right = found[1] + diagram(rooms) + found[3] + found[4] + table(rooms)
    if found[0] == right:
        return []
    if update:
        page.write_text(text.replace(found[0], right), encoding="utf-8")
        return []
    return [f"{page.name}: its rooms are not those of rooms.toml; run include_test.py --update"]


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("--graph", action="store_true", help="print the arrows and their number")
    parser.add_argument("--update", action="store_true", help="write the rooms into the page")
    options = parser.parse_args()
    rooms = read_rooms(Path(__file__).with_name("rooms.toml"))
    found, arrows = faults(rooms)
    if options.graph:
        for (here, there), lines in sorted(arrows.items()):
            print(f"{here} -> {there}: {len(lines)}")
    files = list(sources())
    missing = declared_names.uses_without_include(ROOT, files)
    found += [f"{path}: uses {name} but does not include {header}" for path, name, header in missing]
    page = ROOT / "docs/architecture.md"
    found += page_faults(rooms, page, options.update) + step_faults(page)
    for line in found:
        print(line, file=sys.stderr)
    print(f"{len(files)} files in {len(rooms)} rooms, {len(arrows)} arrows, {len(found)} faults")
    return 1 if found else 0


if __name__ == "__main__":
    sys.exit(main())
