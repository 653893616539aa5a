#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""Compares the map in docs/architecture.md with the rooms: what CMake links, and what files include.

check_map.py SOURCE_DIR     prints each false statement and exits with 1 if there is any.

The map's table has a row for each room, in order: `| `room/` | modules | … |`. Checked:
  - the table has the rooms of engine/CMakeLists.txt in the same order, and each room's modules;
  - a module names only modules of its own room and of rooms above it in DEPENDS;
  - each module that is named is included by at least one file of the module that names it;
  - each module that a file includes is named, or reached through one that is.
"""
import pathlib
import re
import sys


def rows_of(page):
    """[(room, [modules])] of the table, in its order."""
    rows = re.findall(r"^\| `(\w+)/` \|([^|]*)\|", page.split("\n## ")[0], re.M)
    return [(room, re.findall(r"`(\w+)`", modules)) for room, modules in rows]


def modules_of(engine):
    """{name: (folder, depends)} of all that crofton_module declares, and of the headers in simd."""
    modules = {"simd": (engine / "base" / "simd", set())}
    for path in sorted(engine.rglob("CMakeLists.txt")):
        text = re.sub(r"#.*", "", path.read_text(encoding="utf-8"))
        for call in re.findall(r"crofton_module\(([^)]*)\)", text):
            name = re.search(r"NAME\s+(\w+)", call)[1]
            listed = re.search(r"\bDEPENDS\b(.*?)(?=\b(?:SOURCES|LINK|HOT|UNITY)\b|$)", call, re.S)
            modules[name] = (path.parent, set(listed[1].split()) if listed else set())
    return modules


def includes_of(folder, names):
    """{included module: one file that includes it}."""
    found = {}
    for file in sorted(folder.rglob("*")):
        if file.suffix in (".hpp", ".h", ".cpp", ".c", ".in"):
            for name in re.findall(r"#include <crofton/(\w+)/", file.read_text(encoding="utf-8")):
                if name in names:
                    found.setdefault(name, file)
    return found


def reached_from(names, modules):
    """All modules that `names` reach."""
    reached, ahead = set(), list(names)
    while ahead:
        name = ahead.pop()
        if name not in reached:
            reached.add(name)
            ahead += modules[name][1]
    return reached


def check(source):
    engine = source / "engine"
    page = (source / "docs" / "architecture.md").read_text(encoding="utf-8")
    listed = re.search(r"set\(CROFTON_ROOMS ([^)]*)\)", (engine / "CMakeLists.txt").read_text(encoding="utf-8"))
    rooms = listed[1].split() + ["render"]
    modules = modules_of(engine)
    room_of = {name: folder.relative_to(engine).parts[0] for name, (folder, _) in modules.items()}
    rows = rows_of(page)
    if [room for room, _ in rows] != rooms:
        yield f"the table's rooms are {[room for room, _ in rows]}, engine/CMakeLists.txt has {rooms}"
    for room, named in rows:
        there = {folder.name for name, (folder, _) in modules.items() if room_of[name] == room and folder.parent != engine}
        if set(named) != there:
            yield f"the table says that {room} holds {sorted(named)}; engine/{room} has {sorted(there)}"
    for name, (folder, depends) in sorted(modules.items()):
        for used in sorted(depends):
            if rooms.index(room_of[used]) > rooms.index(room_of[name]):
                yield f"{name} in {room_of[name]} uses {used} of {room_of[used]}, a room below"
        if name.startswith("render"):
            yield from (f"render uses {used}" for used in sorted(depends) if room_of[used] not in ("base", "render"))
            continue
        included = includes_of(folder, modules)
        own = {name, "capi" if name == "bake_capi" else name}
        for used in sorted(depends - set(included)):
            yield f"{folder.relative_to(source)}/CMakeLists.txt names {used}, of which no file there includes anything"
        for used in sorted(set(included) - reached_from(depends, modules) - own):
            yield f"{included[used].relative_to(source)} includes a header of {used}, which `{name}` does not use"


if __name__ == "__main__":
    statements = list(check(pathlib.Path(sys.argv[1])))
    print("\n".join(statements) or "the map is right")
    sys.exit(1 if statements else 0)
