#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""check_messages.py ROOT: an error of the library that Python shows names nothing that Python does not have.

The names in the engine's messages (with an underscore, two colons or brackets, or constants) must be those of the package's
stub once bindings/python/src/convert.cpp has replaced some, or of options that Python does not pass on.
"""
import pathlib
import re
import sys

ROOT = pathlib.Path(sys.argv[1])
# Options that only other languages can set, so that these messages never reach Python.
NOT_IN_PYTHON = {"early_out", "max_steps", "face_tolerance", "least_gain", "max_objects"}
NO_MESSAGE = r"//[^\n]*|#include[^\n]*|\b(?:CROFTON_ASSERT|TraceZone)\b.*?;"

converted = (ROOT / "bindings/python/src/convert.cpp").read_text(encoding="utf-8")
table = re.search(r"kNames\[\] = \{(.*?)\};", converted, re.S)[1]
replaced = re.findall(r'\{"([^"]*)",\s*"([^"]*)"\}', table)
stub = set(re.findall(r"\w+", (ROOT / "bindings/python/crofton/__init__.pyi").read_text(encoding="utf-8")))
problems, messages = [], 0
for room in ("base", "bounds", "shape", "view", "world", "bake"):
    for path in sorted((ROOT / "engine" / room).glob("*/src/**/*.?pp")):
        if path.parts[-3] == "c_api":
            continue
        for text in re.findall(r'"((?:[^"\\\n]|\\.)*)"', re.sub(NO_MESSAGE, "", path.read_text(encoding="utf-8"), flags=re.S)):
            for what, by in replaced:
                text = text.replace(what, by)
            messages += " " in text
            for name, ending in re.findall(r"([A-Za-z_][\w:]*\w)(\(\))?", text) if " " in text else []:
                special = ending or "_" in name or "::" in name or re.match("k[A-Z]", name)
                if special and name.split("::")[-1] not in stub | NOT_IN_PYTHON:
                    problems.append(f'{path.relative_to(ROOT)}: Python has no {name}: "{text}"')
if messages < 300:
    problems.append(f"only {messages} messages were found")
if problems:
    sys.exit("\n".join(problems))
