#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""Puts the libraries that a wheel needs into it, and names the oldest glibc that it runs with.

bindings/python/repair_wheel.py WHEEL     writes the repaired wheel beside it and removes WHEEL
"""
import pathlib
import re
import shutil
import sys
import tempfile

ROOT = pathlib.Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT / "packaging"))
from bundle import bundle, output  # noqa: E402


def main():
    wheel = pathlib.Path(sys.argv[1]).resolve()
    with tempfile.TemporaryDirectory() as folder:
        output(sys.executable, "-m", "wheel", "unpack", "--dest", folder, wheel)
        (root,) = pathlib.Path(folder).iterdir()
        (module,) = root.glob("crofton/_crofton*.so")
        (info,) = root.glob("*.dist-info")
        glibc = bundle([module], info / "licenses")
        shutil.copy(ROOT / "LICENSE", info / "licenses")
        text = (info / "WHEEL").read_text()
        (info / "WHEEL").write_text(re.sub(r"-linux_(\w+)$", rf"-manylinux_2_{glibc}_\1", text, flags=re.M))
        wheel.unlink()
        output(sys.executable, "-m", "wheel", "pack", "--dest-dir", wheel.parent, root)


if __name__ == "__main__":
    main()
