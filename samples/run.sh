#!/usr/bin/env bash
# Installs what is missing, builds, and runs the main job: 120 frames of the built-in town, culled, collided, drawn and counted.
#   samples/run.sh [options of 'crofton frames' …]      results in out/frames.{csv,json} and out/frames/*.png
set -euo pipefail
cd "$(dirname "$0")/.."
third_party/install.sh
[[ -x build/release/bin/crofton ]] || echo "Building; the first time this takes ten minutes of one core." >&2
log=$(mktemp)
trap 'rm -f "$log"' EXIT
if ! { cmake --preset release && cmake --build --preset release --target crofton_cli; } >"$log" 2>&1; then
    tail -n 60 "$log" >&2
    exit 1
fi
mkdir -p out/frames
build/release/bin/crofton frames town --csv out/frames.csv --json out/frames.json --png out/frames "$@"
echo "Written: out/frames.csv, out/frames.json and pictures in out/frames/"
