#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""Draws scenes with and without what is hidden by depth, at three sizes, and counts the pixels that differ.

run.py [--crofton FILE] [--data FOLDER] [--scenes NAMES] [--sizes SIZES] [--cameras street,random] [--frames N] [--out FOLDER] [--report]
run.py --odd [--scenes NAMES] [--sizes SIZES] [--cameras origin,far] …

The first draws nine scenes along their streets. With --odd it draws those of odd_scenes.py, which are made to break it,
about the origin and 10^6 m away.

Each run is `crofton frames SCENE --occlude --verify`. Its JSON is kept in the folder, and runs whose JSON is there are
not made again: a run that was stopped goes on where it was. Prints a row a run. Exits with 1 if a pixel differs, if a
triangle that owns a pixel is hidden, if more triangles are listed for each that owns a pixel than MOST_LISTED says, or
if a run fails.
"""
import argparse
import json
import os
import pathlib
import subprocess
import sys
import time

import odd_scenes

ROOT = pathlib.Path(__file__).resolve().parents[2]
SCENES = {  # name: arguments, where {data} is the folder with scenes that others made
    "town": ["town"],
    "office": ["office"],
    "valley": ["valley"],
    "hall": ["hall"],
    "city": ["{data}/scenes/kaykit_city"],
    "forest": ["{data}/scenes/stk_black_forest.glb"],
    "dungeon": ["{data}/scenes/recast_dungeon.obj"],
    "MAP01": ["{data}/scenes/freedoom2_maps.wad", "--map", "MAP01"],
    "MAP07": ["{data}/scenes/freedoom2_maps.wad", "--map", "MAP07"],
}
MOST_LISTED = {"town": 4, "city": 5, "office": 5, "hall": 7, "valley": 8, "forest": 8,
               "dungeon": 4, "MAP01": 4, "MAP07": 4}  # for each triangle that owns a pixel
SIZES = ["480x270", "1280x720", "1279x719"]


def run(options, scene, size, camera, file):
    part = file.with_suffix(".part")
    if options.odd:
        arguments = map(str, odd_scenes.write(options.out, scene, camera == "far", size))
        arguments = [next(arguments), "--camera", next(arguments)]
    else:
        arguments = [a.format(data=options.data) for a in SCENES[scene]]
        arguments += ["--camera", camera, "--frames", str(options.frames)]
    command = [options.crofton, "frames", *arguments, "--size", size, "--occlude", "--verify", "--json", str(part)]
    started = time.monotonic()
    done = subprocess.run(command, stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True)
    if done.returncode not in (0, 1):
        print(f"{' '.join(command)}: status {done.returncode}\n{done.stderr}", file=sys.stderr)
        return False
    summary = json.loads(part.read_text())["summary"]
    summary["seconds"] = time.monotonic() - started
    file.write_text(json.dumps(summary, indent=1))
    part.unlink()
    return True


def report(files):
    """Prints what is known; True if nothing is wrong."""
    print("| scene | camera | size | frames | in view | listed | own a pixel | listed / own | at most | "
          "pixels changed | owners hidden |")
    print("|---|---|---|---|---|---|---|---|---|---|---|")
    frames = pixels = wrong = over = 0
    for (scene, size, camera), file in files:
        if not file.exists():
            print(f"| {scene} | {camera} | {size} | not run | | | | | | | |")
            continue
        s = json.loads(file.read_text())
        ratio = s["mean_occlusion_triangles_passed"] / max(s["mean_triangles_seen"], 1)
        most = MOST_LISTED.get(scene, "")
        over += most != "" and ratio > most
        print(f"| {scene} | {camera} | {size} | {s['frames']} | {s['mean_triangles_passed']:,.0f} | "
              f"{s['mean_occlusion_triangles_passed']:,.0f} | {s['mean_triangles_seen']:,.0f} | {ratio:.2f} | "
              f"{most} | {s['changed_pixels']} | {s['hidden_but_seen']} |")
        width, height = map(int, size.split("x"))
        frames += s["frames"]
        pixels += s["frames"] * width * height
        wrong += s["changed_pixels"] + s["mismatches"]
    print(f"{frames:,} frames, {pixels:,} pixels compared; {wrong:,} mismatches, {over} scenes list too much")
    return wrong == 0 and over == 0


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--crofton", default=str(ROOT / "build/release/bin/crofton"))
    parser.add_argument("--data", default=os.environ.get("CROFTON_SHARED_DATA", "/usr/share/crofton"),
                        help="folder with scenes/ (default: CROFTON_SHARED_DATA)")
    parser.add_argument("--odd", action="store_true", help="draw the scenes of odd_scenes.py")
    parser.add_argument("--scenes", help="default: all")
    parser.add_argument("--sizes", default=",".join(SIZES))
    parser.add_argument("--cameras", help="as of `crofton frames`: street (default), random, orbit; with --odd: "
                        "origin, far, by default both")
    parser.add_argument("--frames", type=int, default=120)
    parser.add_argument("--out", type=pathlib.Path, default=ROOT / "build/pictures")
    parser.add_argument("--report", action="store_true", help="print what is known and end")
    options = parser.parse_args()
    options.out.mkdir(parents=True, exist_ok=True)
    known = odd_scenes.SCENES if options.odd else SCENES
    scenes = options.scenes.split(",") if options.scenes else known
    cameras = (options.cameras or ("origin,far" if options.odd else "street")).split(",")
    keys = [(scene, size, camera) for size in options.sizes.split(",") for camera in cameras for scene in scenes]
    for scene, _, camera in keys:
        if scene not in known:
            parser.error(f"no scene {scene}; there are {', '.join(known)}")
        if options.odd and camera not in ("origin", "far"):
            parser.error(f"--odd has no cameras {camera}; there are origin and far")
    ending = "odd" if options.odd else options.frames
    files = [(key, options.out / f"{'_'.join(key)}_{ending}.json") for key in keys]
    complete = True
    for key, file in files:
        if not options.report and not file.exists():
            complete = run(options, *key, file) and complete
            print(*key, f"{json.loads(file.read_text())['seconds']:.0f} s" if file.exists() else "failed", flush=True)
    return 0 if report(files) and complete else 1


if __name__ == "__main__":
    sys.exit(main())
