#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""check_names.py ROOT: fails where a test of doctest has a semicolon in its name, at which CMake would cut it."""
import pathlib
import re
import sys

CASE = re.compile(r'TEST_CASE\w*\(\s*"((?:[^"\\]|\\.)*)"')

bad = [f"{path}: {name}" for path in sorted(pathlib.Path(sys.argv[1], "tests").rglob("*.cpp"))
       for name in CASE.findall(path.read_text()) if ";" in name]
if bad:
    sys.exit("\n".join(["These names hold a semicolon, at which CMake cuts them. Use a comma or a full stop.", *bad]))
