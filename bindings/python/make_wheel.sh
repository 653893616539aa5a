#!/usr/bin/env bash
# SPDX-License-Identifier: MIT
# Builds bindings/python/dist/crofton-*.whl with what is installed: no downloads. PYTHON names the interpreter. The wheel runs on any
# Linux with the glibc that its name says: repair_wheel.py puts Highway and Qhull into it.
#   bindings/python/make_wheel.sh [FOLDER]     of the source package that is unpacked in FOLDER; of this checkout where none is named
set -euo pipefail
here=$(realpath "$(dirname "$0")")
cd "${1:-$here}"
build=$(mktemp -d)
trap 'rm -rf "$build"' EXIT
python=${PYTHON:-/usr/bin/python3}
"$python" setup.py --quiet build --build-base "$build" egg_info --egg-base "$build" \
    bdist_wheel --dist-dir "$here/dist" --bdist-dir "$build/wheel"
"$python" "$here/repair_wheel.py" "$here"/dist/crofton-*-linux_*.whl
ls "$here"/dist/*.whl
