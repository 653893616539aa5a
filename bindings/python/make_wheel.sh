#!/usr/bin/env bash
# SPDX-License-Identifier: MIT
# Builds bindings/python/dist/crofton-*.whl with what is installed: no downloads. PYTHON names the interpreter.
set -euo pipefail
cd "$(dirname "$0")"
build=$(mktemp -d)
trap 'rm -rf "$build"' EXIT
"${PYTHON:-/usr/bin/python3}" setup.py --quiet build --build-base "$build" egg_info --egg-base "$build" \
    bdist_wheel --dist-dir dist --bdist-dir "$build/wheel"
ls dist/*.whl
