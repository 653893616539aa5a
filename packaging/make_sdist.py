#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""Makes Python's source package, crofton-VERSION.tar.gz: the package in front, what it is built of in the folder source.

packaging/make_sdist.py FOLDER     of what is committed; the same bytes for the same commit
"""
import gzip
import io
import pathlib
import re
import subprocess
import sys
import tarfile

ROOT = pathlib.Path(__file__).resolve().parents[1]
FRONT = ["bindings/python/pyproject.toml", "bindings/python/setup.py", "bindings/python/README.md", "bindings/python/crofton"]
BEHIND = ["CMakeLists.txt", "LICENSE", "cmake", "engine", "third_party", "bindings/python/CMakeLists.txt", "bindings/python/src",
          "bindings/python/crofton", "samples/crofton/assets"]


def committed(paths):
    """(name, bytes) of files below `paths`, and the time of the commit."""
    data = subprocess.run(["git", "archive", "HEAD", *paths], cwd=ROOT, check=True, capture_output=True).stdout
    with tarfile.open(fileobj=io.BytesIO(data)) as archive:
        return [(member, archive.extractfile(member).read()) for member in archive if member.isfile()]


def main():
    out = pathlib.Path(sys.argv[1])
    version = re.search(r"project\(crofton VERSION ([0-9.]+)", (ROOT / "CMakeLists.txt").read_text()).group(1)
    name = f"crofton-{version}"
    files = {}
    for member, data in committed(FRONT):
        files[member.name.removeprefix("bindings/python/")] = (member, data)
    for member, data in committed(BEHIND):
        files[f"source/{member.name}"] = (member, data)
    member, readme = files["README.md"]
    info = (f"Metadata-Version: 2.1\nName: crofton\nVersion: {version}\nSummary: Exact culling and collision, and bounds and triangulations "
            f"chosen by integral geometry\nLicense: MIT\nRequires-Python: >=3.9\nDescription-Content-Type: text/markdown\n\n").encode()
    files["PKG-INFO"] = (member, info + readme)
    out.mkdir(parents=True, exist_ok=True)
    packed = io.BytesIO()
    with tarfile.open(fileobj=packed, mode="w", format=tarfile.PAX_FORMAT) as archive:
        for path, (member, data) in sorted(files.items()):
            entry = tarfile.TarInfo(f"{name}/{path}")
            entry.size, entry.mode, entry.mtime = len(data), member.mode & 0o755 | 0o644, member.mtime
            archive.addfile(entry, io.BytesIO(data))
    path = out / f"{name}.tar.gz"
    path.write_bytes(gzip.compress(packed.getvalue(), 9, mtime=0))
    print(path)


if __name__ == "__main__":
    main()
