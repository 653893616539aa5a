#!/usr/bin/env bash
# SPDX-License-Identifier: MIT
# Builds the wheel, installs it into an environment of its own, build/python, tests it there and runs the README's
# program. Says so and does nothing where a tool is missing. PYTHON names the interpreter.
#   bindings/python/test.sh [FOLDER]     FOLDER: an unpacked source package that the wheel is built of, in place of this checkout
set -euo pipefail
cd "$(dirname "$0")/../.."
source packaging/need_tools.sh
export PYTHON=${PYTHON:-/usr/bin/python3}
need_tools python --python "$PYTHON" cmake ninja
"$PYTHON" -c 'import numpy, pytest, setuptools, wheel, venv, ensurepip' 2>/dev/null ||
    { echo "python: skipped, modules are missing; third_party/install.sh --python installs them"; exit 0; }
rm -rf build/python bindings/python/dist
bindings/python/make_wheel.sh "$@"
"$PYTHON" -m venv --system-site-packages build/python
build/python/bin/pip install --quiet --no-index --no-deps bindings/python/dist/*.whl
# From the environment's folder: the package's sources beside the tests have no compiled module.
root=$PWD
cd build/python
bin/python -m pytest -q -p no:cacheprovider "$root/bindings/python/tests"
sed -n '/^```python$/,/^```$/{/^```/d;p}' "$root/bindings/python/README.md" >readme.py
bin/python readme.py
