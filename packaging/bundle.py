#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""Puts the libraries that compiled files need beside them, so that they run where these are not installed.

packaging/bundle.py LICENCES FILE...     FILEs in one folder; licences go into the folder LICENCES

What PEP 600 (manylinux) allows stays outside: the C and C++ runtime. The rest is copied under a name of its own, found by $ORIGIN.
Prints the oldest glibc that all of it runs with. auditwheel does the same for wheels; Debian 12 has no package of it.
"""
import pathlib
import re
import shutil
import subprocess
import sys

OUTSIDE = re.compile(r"(lib(c|m|dl|rt|pthread|stdc\+\+|gcc_s)|ld-linux[\w-]*)\.so\.\d+$")
LICENCES = {"libhwy": "libhwy1", "libqhull_r": "libqhull-r8.0", "libdraco": "libdraco7",
            "libmeshoptimizer": "libmeshoptimizer2d", "libstb": "libstb0"}  # Debian's packages


def output(*command):
    return subprocess.run([str(part) for part in command], check=True, capture_output=True, text=True).stdout


def needed(path):
    return [name for name in output("patchelf", "--print-needed", path).split() if not OUTSIDE.match(name)]


def place_of(name, path):
    found = re.search(rf"^\s*{re.escape(name)} => (/\S+)", output("ldd", path), re.M)
    if not found:
        sys.exit(f"bundle: {path.name} needs {name}, which is not installed")
    return pathlib.Path(found[1]).resolve()


def bundle(files, licences):
    """Copies what `files` need beside them. Returns the second number of the newest glibc that all of it asks for."""
    licences.mkdir(parents=True, exist_ok=True)
    paths, waiting = list(files), list(files)
    own_names = {output("patchelf", "--print-soname", path).strip(): path for path in files if ".so" in path.name}
    for path in files:  # before patchelf, whose work strip does not know
        output("strip", "--strip-unneeded", path)
    for own in own_names.values():
        output("patchelf", "--set-soname", own.name, own)
    while waiting:
        path = waiting.pop()
        for name in needed(path):
            own = own_names.get(name) or path.parent / name.replace(".so", "-crofton.so")
            if not own.exists():
                place = place_of(name, path)
                package = LICENCES.get(name.split(".")[0])
                if not package:
                    sys.exit(f"bundle: {name} is new: add the package that has its licence to LICENCES")
                shutil.copy(f"/usr/share/doc/{package}/copyright", licences / f"{package}.txt")
                shutil.copy(place, own)
                own.chmod(0o755)
                output("patchelf", "--set-soname", own.name, own)
                paths.append(own)
                waiting.append(own)
            output("patchelf", "--replace-needed", name, own.name, path)
        output("patchelf", "--set-rpath", "$ORIGIN", path)
    versions = re.findall(r"\bGLIBC_2\.(\d+)", "".join(output("readelf", "--version-info", "--wide", path) for path in paths))
    return max(map(int, versions))


if __name__ == "__main__":
    if len(sys.argv) < 3:
        sys.exit(__doc__)
    print(f"2.{bundle([pathlib.Path(name) for name in sys.argv[2:]], pathlib.Path(sys.argv[1]))}")
