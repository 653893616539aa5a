#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""check_print.py ROOT: fails where the command line or the viewer prints other than by assets/print.hpp.

Names come from files, and a terminal obeys some of their characters. std::fputs is for text that is written in the source.
"""
import pathlib
import re
import sys

PRINTS = re.compile(r"std::(?:v?f?printf|cout|cerr|puts|fwrite)\b|\bfputs\([^;]*c_str\(\)")
OWN = ("print.cpp", "file.cpp", "progress_bar.cpp")  # the filter, files, and a bar that moves the cursor

bad = [f"{path}: {match[0]}" for path in sorted(pathlib.Path(sys.argv[1], "samples/crofton").rglob("*.cpp"))
       if path.name not in OWN for match in PRINTS.finditer(path.read_text(encoding="utf-8"))]
if bad:
    sys.exit("\n".join(["Use print_to() or print_text_to() of assets/print.hpp:", *bad]))
