#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""Writes the address of the project's page into the metadata of every package, once there is one.

packaging/homepage.py URL     then commit. Again with another address replaces it
packaging/homepage.py         prints what each package says; exit status 1 where they differ
"""
import re
import sys
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
# Of each file: the line after which the address is written, and how.
PLACES = {
    "CMakeLists.txt": (r"^project\(crofton .*\n", '        HOMEPAGE_URL "{}"\n'),
    "bindings/web/package.json": (r'^  "license": .*\n', '  "homepage": "{}",\n'),
    "bindings/rust/Cargo.toml": (r"^license = .*\n", 'homepage = "{}"\n'),
    "bindings/python/setup.py": (r"^    license=.*\n", '    url="{}",\n'),
    "bindings/csharp/Crofton.csproj": (r"^    <PackageLicenseExpression>.*\n", "    <PackageProjectUrl>{}</PackageProjectUrl>\n"),
    "packaging/make_nupkg.py": (r"^    <license .*\n", "    <projectUrl>{}</projectUrl>\n"),
    "packaging/debian/control": (r"^Standards-Version: .*\n", "Homepage: {}\n"),
    "packaging/vcpkg/crofton/vcpkg.json": (r'^  "license": .*\n', '  "homepage": "{}",\n'),
    "packaging/conan/conanfile.py": (r"^    license = .*\n", '    homepage = "{}"\n'),
}


def pattern_of(line, written):
    before, after = (re.escape(part) for part in written.split("{}"))
    return re.compile(rf"({line})(?:{before}(\S+?){after})?", re.M)


def main():
    if len(sys.argv) > 2 or len(sys.argv) == 2 and not re.fullmatch(r'https?://[^\s"<>&]+', sys.argv[1]):
        sys.exit(__doc__)
    said = {}
    for name, (line, written) in PLACES.items():
        text, pattern = (ROOT / name).read_text(encoding="utf-8"), pattern_of(line, written)
        found = pattern.search(text)
        if not found:
            sys.exit(f"homepage: {name} has no line like {line}")
        said[name] = found[2]
        if len(sys.argv) == 2:
            text = pattern.sub(lambda match: match[1] + written.format(sys.argv[1]), text, count=1)
            (ROOT / name).write_text(text, encoding="utf-8")
    if len(sys.argv) == 1:
        print("\n".join(f"{name}: {address or 'none'}" for name, address in said.items()))
        sys.exit(len(set(said.values())) > 1)


if __name__ == "__main__":
    main()
