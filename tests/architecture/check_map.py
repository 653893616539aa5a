#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""Compares the map in docs/architecture.md with the modules: what CMake links, and what files include.

check_map.py SOURCE_DIR     prints each false statement and exits with 1 if there is any.

The map has two parts. The table says `module | room for | uses`; "all CPU modules" stands for the library
crofton::crofton. The drawing has chains "a, b ← c": c uses a and b. Checked:
  - the table has a row for each module, and its `uses` are what the module's CMakeLists.txt names in DEPENDS;
  - each module that is named is included by at least one file of the module that names it;
  - each module that a file includes is named, or reached through one that is;
  - the drawing and the table have the same arrows.
"""
import pathlib
import re
import sys

LIBRARY = "all CPU modules"


def arrows_of_table(page):
    """{module: set of names} from the rows of the table."""
    rows = {}
    for line in page.splitlines():
        row = re.match(r"\| `(\w+)` \|.*\| ([^|]*) \|$", line)
        if row:
            rows[row[1]] = {LIBRARY} if LIBRARY in row[2] else set(re.findall(r"`(\w+)`", row[2]))
    return rows


def arrows_of_drawing(page):
    """{module: set of names} from the first block of code."""
    arrows = {}
    for line in page.split("```")[1].splitlines():
        for chain in re.split(r"\s{3,}", re.sub(r"\([^)]*\)", "", line)):
            links = [[name.strip() for name in part.split(",") if name.strip()] for part in chain.split("←")]
            for used, users in zip(links, links[1:]):
                for user in users:
                    arrows.setdefault(user, set()).update(used)
    return arrows


def depends_of(folder):
    """What the module's CMakeLists.txt links: targets of its own folder left out."""
    text = re.sub(r"#.*", "", (folder / "CMakeLists.txt").read_text(encoding="utf-8"))
    names = set()
    for call in re.findall(r"crofton_module\(([^)]*)\)", text):
        listed = re.search(r"\bDEPENDS\b(.*?)(?=\b(?:SOURCES|LINK|NO_EXCEPTIONS|NAME)\b|$)", call, re.S)
        names |= set(listed[1].split()) if listed else set()
    if re.search(r"target_link_libraries\(crofton_" + folder.name + r"\s+PUBLIC crofton\b", text) and not names:
        names = {LIBRARY}
    return {name for name in names if not name.startswith(folder.name + "_")}


def includes_of(folder, modules):
    """{included module: one file that includes it}."""
    found = {}
    for file in sorted(folder.rglob("*")):
        if file.suffix in (".hpp", ".h", ".cpp", ".c", ".in"):
            for name in re.findall(r"#include <crofton/(\w+)/", file.read_text(encoding="utf-8")):
                if name != folder.name and name in modules:
                    found.setdefault(name, file)
    return found


def reached_from(names, depends):
    """All modules that `names` reach."""
    reached, ahead = set(), list(names)
    while ahead:
        name = ahead.pop()
        if name not in reached:
            reached.add(name)
            ahead += depends.get(name, ())
    return reached


def check(source):
    engine = source / "engine"
    page = (source / "docs" / "architecture.md").read_text(encoding="utf-8")
    folders = {folder.name: folder for folder in engine.iterdir() if (folder / "CMakeLists.txt").is_file()}
    table, drawing = arrows_of_table(page), arrows_of_drawing(page)
    depends = {name: depends_of(folder) for name, folder in folders.items()}
    of_library = re.search(r"foreach\(module ([^)]*)\)", (engine / "CMakeLists.txt").read_text(encoding="utf-8"))
    depends[LIBRARY] = set(of_library[1].split()) & set(folders)

    if not table or not drawing:
        yield "docs/architecture.md has no table or no drawing"
    for name in sorted(set(folders) - set(table)):
        yield f"the table has no row for engine/{name}"
    for name in sorted(set(table) - set(folders)):
        yield f"the table has a row for `{name}`, which is no module"
    for name in sorted(set(folders) & set(table)):
        for used in sorted(table[name] - depends[name]):
            yield f"the table says that `{name}` uses `{used}`, which its CMakeLists.txt does not name"
        for used in sorted(depends[name] - table[name]):
            yield f"engine/{name}/CMakeLists.txt names {used}, which the table does not say"
        included = includes_of(folders[name], folders)
        for used in sorted(depends[name] - set(included) - {LIBRARY}):
            yield f"engine/{name}/CMakeLists.txt names {used}, of which no file of `{name}` includes anything"
        for used in sorted(set(included) - reached_from(depends[name], depends)):
            yield f"{included[used].relative_to(source)} includes a header of {used}, which `{name}` does not use"
    for name in sorted(set(table) | set(drawing)):
        for used in sorted(drawing.get(name, set()) - table.get(name, set())):
            yield f"the drawing has {used} ← {name}, the table does not"
        for used in sorted(table.get(name, set()) - drawing.get(name, set())):
            yield f"the table has {used} ← {name}, the drawing does not"


if __name__ == "__main__":
    statements = list(check(pathlib.Path(sys.argv[1])))
    print("\n".join(statements) or "the map is right")
    sys.exit(1 if statements else 0)
