#!/usr/bin/env bash
# SPDX-License-Identifier: MIT
# Installs what is missing, builds, and runs the main job: 120 frames of the built-in town, culled, collided, drawn and counted.
#   samples/run.sh [options of 'crofton frames' …]      results in out/frames.{csv,json} and out/frames/*.png
set -euo pipefail
cd "$(dirname "$0")/.."
third_party/install.sh
cmake --preset release >/dev/null
# Ninja's progress on one line, or a line a step where there is no terminal; warnings and errors as they come.
cmake --build --preset release --target crofton_cli >&2
mkdir -p out/frames
build/release/bin/crofton frames town --csv out/frames.csv --json out/frames.json --png out/frames "$@"
echo "Written: out/frames.csv, out/frames.json and pictures in out/frames/"
