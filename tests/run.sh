#!/usr/bin/env bash
# SPDX-License-Identifier: MIT
# Installs what is missing, builds, and runs every test.   tests/run.sh [PRESET] [ctest options …]
set -euo pipefail
cd "$(dirname "$0")/.."
preset=release
if [[ $# -gt 0 && $1 != -* ]]; then preset=$1; shift; fi
third_party/install.sh --tests
log=$(mktemp)
trap 'rm -f "$log"' EXIT
cmake --preset "$preset" -DCROFTON_TESTS=ON >"$log" 2>&1 || { cat "$log" >&2; exit 1; }
cmake --build --preset "$preset"
ctest --preset "$preset" -j "$(nproc)" "$@"
