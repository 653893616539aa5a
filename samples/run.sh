#!/usr/bin/env bash
# SPDX-License-Identifier: MIT
# Installs what is missing, builds, and runs the main job: 120 frames at street level through the built-in town, each drawn
# without and with occlusion, counted, and checked by brute force.
#   samples/run.sh                                        results in out/report.html, out/frames.{csv,json}, out/frames/*.png
#   samples/run.sh [options of 'crofton frames town' …]   these in place of --camera street --occlude --verify
set -euo pipefail
cd "$(dirname "$0")/.."
third_party/install.sh
cmake --preset release >/dev/null
# Ninja's progress on one line, or a line a step where there is no terminal; warnings and errors as they come.
cmake --build --preset release --target crofton_cli >&2
mkdir -p out/frames
if [ $# -eq 0 ]; then set -- --camera street --occlude --verify; fi
build/release/bin/crofton frames town --csv out/frames.csv --json out/frames.json --png out/frames --report out/report.html "$@"
echo "Written: out/report.html, a page to look at; out/frames.csv, out/frames.json and pictures in out/frames/"
