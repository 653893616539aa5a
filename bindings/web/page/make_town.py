#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""Makes bindings/web/page/town.bin, the page's town: the built-in one of the command line, in few bytes.

bindings/web/page/make_town.py [--check]     --check: exit status 1 where the file is not what would be made

Needs a build of the library and its samples: cmake --preset release && cmake --build --preset release --target crofton_cli
"""
import subprocess
import sys
import zlib
from pathlib import Path

ROOT = Path(__file__).resolve().parents[3]
FILE = Path(__file__).with_name("town.bin")
BUILD = ROOT / "build/release"


def make():
    program = ROOT / "build/town_data"
    includes = [f"-I{p}" for kind in ("include", "internal") for p in sorted((ROOT / "engine").glob(f"**/{kind}"))]
    archives = [BUILD / "samples/crofton/assets/libcrofton_assets.a", BUILD / "engine/libcrofton_bake.a", BUILD / "engine/libcrofton.a"]
    if missing := [str(a) for a in archives if not a.exists()]:
        sys.exit(f"make_town: no {missing[0]}: cmake --preset release && cmake --build --preset release --target crofton_cli")
    flags = (BUILD / "build.ninja").read_text(encoding="utf-8")
    decoders = [f"-l{name}" for name in ("draco", "meshoptimizer") if f"lib{name}" in flags]
    subprocess.run(["g++", "-std=c++20", "-O1", *includes, f"-I{ROOT}/samples/crofton", ROOT / "bindings/web/native/town_data.cpp", *archives,
                    "-lqhull_r", "-lhwy", "-lpthread", "-lstb", *decoders, "-o", program], check=True)
    return subprocess.run([program], check=True, stdout=subprocess.PIPE).stdout


data = make()
if "--check" in sys.argv[1:]:
    sys.exit(0 if zlib.decompress(FILE.read_bytes()) == data else f"make_town: {FILE} is not today's town; run without --check")
FILE.write_bytes(zlib.compress(data, 9))
print(f"{FILE}: {FILE.stat().st_size} bytes")
