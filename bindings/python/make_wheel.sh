#!/usr/bin/env bash
# SPDX-License-Identifier: MIT
# Builds bindings/python/dist/crofton-*.whl with what is installed: no downloads. PYTHON names the interpreter. The wheel runs on any
# Linux with the glibc that its name says: repair_wheel.py puts Highway and Qhull into it.
set -euo pipefail
cd "$(dirname "$0")"
build=$(mktemp -d)
trap 'rm -rf "$build"' EXIT
python=${PYTHON:-/usr/bin/python3}
"$python" setup.py --quiet build --build-base "$build" egg_info --egg-base "$build" \
    bdist_wheel --dist-dir dist --bdist-dir "$build/wheel"
"$python" repair_wheel.py dist/crofton-*-linux_*.whl
ls dist/*.whl
