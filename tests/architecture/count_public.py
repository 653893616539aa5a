#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""Counts what a user of the library meets. The library may install at most 40 headers (docs/architecture.md).

  count_public.py ROOT            headers of each part; fails above 40 for the library, C++ and C together
  count_public.py ROOT --names    also types and functions, by doxygen
"""
import argparse
import pathlib
import subprocess
import sys
import tempfile
import xml.etree.ElementTree as ElementTree

LIMIT = 40
COMPONENTS = ("render", "study")


def part_of(header):
    module = header.parts[header.parts.index("engine") + 1]
    return "C" if module == "capi" else module if module in COMPONENTS else "library"


def parts(root):
    found = {}
    for header in sorted((root / "engine").glob("*/include/**/*.h*")):
        found.setdefault(part_of(header), []).append(header)
    return found


def names(headers, is_c):
    """How many types (classes, structs, unions, enums) and functions these headers have in public, details left out."""
    with tempfile.TemporaryDirectory() as folder:
        settings = {"INPUT": " ".join(map(str, headers)), "GENERATE_XML": "YES", "GENERATE_HTML": "NO", "GENERATE_LATEX": "NO",
                    "OUTPUT_DIRECTORY": folder, "EXTRACT_ALL": "YES", "QUIET": "YES", "WARNINGS": "NO", "EXTENSION_MAPPING": "h=C++",
                    "MACRO_EXPANSION": "YES", "EXPAND_ONLY_PREDEF": "YES", "PREDEFINED": "CROFTON_API= __cplusplus"}
        file = pathlib.Path(folder, "Doxyfile")
        file.write_text("".join(f"{key}={value}\n" for key, value in settings.items()))
        subprocess.run(["doxygen", file], check=True, stdout=subprocess.DEVNULL)
        types = functions = 0
        for compound in ElementTree.parse(f"{folder}/xml/index.xml").getroot():
            kind, name = compound.get("kind"), compound.find("name").text
            if "detail" in name:
                continue
            types += kind in ("class", "struct", "union")
            if kind not in ("class", "struct", "file" if is_c else "namespace"):
                continue
            members = ElementTree.parse(f"{folder}/xml/{compound.get('refid')}.xml").getroot().iter("memberdef")
            public = [member.get("kind") for member in members if member.get("prot") == "public"]
            types += public.count("enum")
            functions += public.count("function")
        return types, functions


def main():
    options = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    options.add_argument("root", type=pathlib.Path)
    options.add_argument("--names", action="store_true")
    arguments = options.parse_args()
    found = parts(arguments.root.resolve())
    for part, headers in found.items():
        text = f"{part}: {len(headers)} headers"
        if arguments.names:
            text += ", {} types, {} functions".format(*names(headers, part == "C"))
        print(text)
    installed = len(found["library"]) + len(found["C"])
    if installed > LIMIT:
        sys.exit(f"{installed} headers of the library are installed: at most {LIMIT}. Give what users need a place in one of them; "
                 "what only the engine needs belongs into internal/.")


if __name__ == "__main__":
    main()
