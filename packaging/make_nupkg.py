#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""Makes Crofton.VERSION.nupkg: the classes for .NET Standard 2.0 and the native library for Linux on x86-64.

packaging/make_nupkg.py FOLDER [LIBRARIES]     after bindings/csharp/test.sh; the same bytes for the same files. LIBRARIES: the
folder of libcrofton.so and libcrofton_bake.so, build/shared/engine
"""
import pathlib
import re
import shutil
import sys
import tempfile
import zipfile

from bundle import bundle

ROOT = pathlib.Path(__file__).resolve().parents[1]
NUSPEC = """<?xml version="1.0" encoding="utf-8"?>
<package xmlns="http://schemas.microsoft.com/packaging/2013/05/nuspec.xsd">
  <metadata>
    <id>Crofton</id>
    <version>{version}</version>
    <authors>The Crofton developers</authors>
    <description>Exact culling and collision detection for games. Needs glibc {glibc} or newer on Linux.</description>
    <license type="file">LICENSE</license>
    <readme>README.md</readme>
    <dependencies><group targetFramework=".NETStandard2.0" /></dependencies>
  </metadata>
</package>
"""
TYPES = """<?xml version="1.0" encoding="utf-8"?>
<Types xmlns="http://schemas.openxmlformats.org/package/2006/content-types">
  <Default Extension="rels" ContentType="application/vnd.openxmlformats-package.relationships+xml" />
  <Default Extension="nuspec" ContentType="application/octet" />
  <Default Extension="dll" ContentType="application/octet" />
  <Default Extension="so" ContentType="application/octet" />
  <Default Extension="md" ContentType="text/markdown" />
  <Default Extension="txt" ContentType="text/plain" />
</Types>
"""
RELATIONS = """<?xml version="1.0" encoding="utf-8"?>
<Relationships xmlns="http://schemas.openxmlformats.org/package/2006/relationships">
  <Relationship Type="http://schemas.microsoft.com/packaging/2010/07/manifest" Target="/Crofton.nuspec" Id="R1" />
</Relationships>
"""


def main():
    out = pathlib.Path(sys.argv[1])
    libraries = pathlib.Path(sys.argv[2]) if len(sys.argv) > 2 else ROOT / "build/shared/engine"
    version = re.search(r"project\(crofton VERSION ([0-9.]+)", (ROOT / "CMakeLists.txt").read_text()).group(1)
    with tempfile.TemporaryDirectory() as name:
        folder = pathlib.Path(name)
        native = folder / "runtimes/linux-x64/native"
        native.mkdir(parents=True)
        for library in ("libcrofton.so", "libcrofton_bake.so"):
            shutil.copy((libraries / library).resolve(), native / library)
        glibc = bundle(sorted(native.iterdir()), folder / "licences")
        (folder / "lib/netstandard2.0").mkdir(parents=True)
        shutil.copy(ROOT / "build/csharp/Crofton.dll", folder / "lib/netstandard2.0")
        shutil.copy(ROOT / "LICENSE", folder / "LICENSE")
        shutil.copy(ROOT / "bindings/csharp/README.md", folder)
        (folder / "Crofton.nuspec").write_text(NUSPEC.format(version=version, glibc=f"2.{glibc}"))
        (folder / "[Content_Types].xml").write_text(TYPES)
        (folder / "_rels").mkdir()
        (folder / "_rels/.rels").write_text(RELATIONS)
        out.mkdir(parents=True, exist_ok=True)
        package = out / f"Crofton.{version}.nupkg"
        with zipfile.ZipFile(package, "w", zipfile.ZIP_DEFLATED) as archive:
            for path in sorted(p for p in folder.rglob("*") if p.is_file()):
                entry = zipfile.ZipInfo(str(path.relative_to(folder)))
                entry.compress_type, entry.external_attr = zipfile.ZIP_DEFLATED, 0o644 << 16
                archive.writestr(entry, path.read_bytes())
        print(package)


if __name__ == "__main__":
    main()
