#!/usr/bin/env bash
# SPDX-License-Identifier: MIT
# Makes the pictures of the README and of the pages anew, beside this script. Needs a build (tests/run.sh or samples/run.sh), and Chromium for
# pages and maps.   docs/pictures/make.sh [CROFTON]
set -euo pipefail
cd "$(dirname "$0")"
crofton=${1:-../../build/release/bin/crofton}
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT

"$crofton" view --no-window --script verdicts.json --after 8 --screenshot verdicts.png
"$crofton" view --no-window --size 960x540 --script clusters.json --after 8 --screenshot clusters.png
"$crofton" frames town --camera orbit --frames 12 --size 960x540 --png "$work/town"
cp "$work"/town/*0003.png town.png
"$crofton" study radiosity room --edge 0.1 --error 0.02 --out "$work/room.glb"
"$crofton" view "$work/room.glb" --no-window --size 800x450 --script room.json --after 3 --screenshot room.png
"$crofton" frames town --camera street --frames 120 --size 960x540 --png "$work/street"
cp "$work"/street/*0035.png street.png
"$crofton" bake town --instances 200000 --no-occluders --no-clusters --regions 8x8 --threads 0 --folder "$work/regions"
"$crofton" view "$work/regions" --no-window --size 960x400 --script regions.json --after 6 --screenshot regions.png
"$crofton" bake town --instances 1000000 --no-occluders --no-clusters --regions 36x36 --threads 0 --folder "$work/flight"
"$crofton" frames "$work/flight" --no-draw --real-time --frames 300 --csv - | ./flight.py >flight.svg
./crofton.py >crofton.svg
./rooms.py >rooms.svg
if command -v chromium >/dev/null; then
    "$crofton" frames town --frames 120 --camera street --occlude --size 640x360 --verify --report "$work/report.html"
    chromium --headless --no-sandbox --disable-gpu --hide-scrollbars --user-data-dir="$work/chromium" \
        --blink-settings=preferredColorScheme=1 --window-size=960,1250 --screenshot="$work/report.png" \
        "file://$work/report.html" >/dev/null 2>&1
    cp "$work/report.png" report.png
    "$crofton" pvs town --cells 16x1x16 --epsilon 2e-3 --out "$work/pvs.crofton" --svg "$work/pvs.svg"
    chromium --headless --no-sandbox --disable-gpu --hide-scrollbars --user-data-dir="$work/chromium" --window-size=1200,994 --force-device-scale-factor=0.6 \
        --screenshot="$work/pvs.png" "file://$work/pvs.svg" >/dev/null 2>&1
    cp "$work/pvs.png" pvs.png
fi
