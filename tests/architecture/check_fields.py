#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""check_fields.py ROOT: docs/fields.md names each field of the structs it lists, and tests that exist.

A struct of a room is written with its namespace; one of the World's without. Every struct of the World's answers must be listed.
"""
import pathlib
import re
import sys

ROOT = pathlib.Path(sys.argv[1])
problems, declared = [], {}


def fields_of(body):
    """The names of the data members of a struct's body."""
    while re.search(r"\{[^{}]*\}", body):
        body = re.sub(r"\{[^{}]*\}", "", body)
    found = set()
    for statement in body.split(";"):
        statement = re.sub(r"\[[^\]]*\]|=[^,]*", "", statement).strip()
        if statement and "(" not in statement and not re.match(r"(using|static|friend|struct|enum|class)\b|.*operator", statement):
            found |= {part.split()[-1] for part in re.sub(r"<[^<>]*>", "", statement).split(",") if part.split()}
    return found


for header in sorted(ROOT.glob("engine/*/*/include/crofton/*/*.hpp")):
    text = re.sub(r"//[^\n]*", "", header.read_text(encoding="utf-8"))
    for struct in re.finditer(r"^struct (\w+) \{\n(.*?)^\};", text, flags=re.S | re.M):
        if fields := fields_of(struct.group(2)):
            room = header.parent.name
            declared[struct.group(1) if room == "world" else f"{room}::{struct.group(1)}"] = (fields, header.name)

listed, name = {}, ""
for row in (ROOT / "docs/fields.md").read_text(encoding="utf-8").splitlines():
    cells = [cell.strip() for cell in row.strip("|").split("|")]
    if not row.startswith("|") or cells[0] in ("struct", "---"):
        continue
    name = cells[0].strip("`") or name
    listed.setdefault(name, set()).update(re.findall(r"`(\w+)`", cells[1]))
    problems += [f"no file tests/{test}" for test in re.findall(r"`([\w/.]+)`", cells[3]) if not (ROOT / "tests" / test).exists()]

for name, fields in listed.items():
    real = declared.get(name, (set(), ""))[0]
    problems += [f"{name}::{field} is in docs/fields.md or in the header only" for field in sorted(fields ^ real)]
for name, (_, header) in declared.items():
    if name not in listed and header in ("answers.hpp", "object_manifold.hpp") and name not in ("ObjectNames", "Revision"):
        problems.append(f"{name} is missing in docs/fields.md")
print("\n".join(problems))
sys.exit(1 if problems else 0)
