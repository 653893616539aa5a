#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""Draws the rooms of engine/ for docs/architecture.md, from what CMake links.
rooms.py > rooms.svg"""
import pathlib
import re
import sys

ROOT = pathlib.Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT / "tests/architecture"))
import check_map  # noqa: E402

LIBRARIES = [("crofton::crofton", "a game links it", ["base", "bounds", "shape", "view", "world", "c_api"], "#e8f1fb", "#2f6fb0"),
             ("crofton::bake", "tools link it too", ["bake"], "#fdf0e0", "#b06f2f"),
             ("crofton::study", "teaching and research", ["study"], "#eef6ea", "#4f8a3a"),
             ("crofton::render", "uses base only", ["render"], "#f4ecf7", "#7d4f94")]
WIDTH, ROW, LEFT, BOX = 900, 58, 190, 104


def main():
    engine = ROOT / "engine"
    modules = check_map.modules_of(engine)
    rooms = {}
    for name, (folder, _) in modules.items():
        parts = folder.relative_to(engine).parts
        rooms.setdefault(parts[0], []).append("/".join(parts[1:]) or parts[0])
    order = {room: re.findall(room + r"/(\w+)", (engine / "CMakeLists.txt").read_text()) for room in rooms}
    lines, y = [], 10
    for library, note, members, fill, ink in LIBRARIES:
        height = ROW * len(members) + 14
        lines.append(f'<rect x="8" y="{y}" width="{WIDTH - 16}" height="{height}" rx="8" fill="{fill}" stroke="{ink}"/>')
        lines.append(f'<text x="{WIDTH - 20}" y="{y + 22}" text-anchor="end" fill="{ink}" font-weight="bold">{library}</text>')
        lines.append(f'<text x="{WIDTH - 20}" y="{y + 40}" text-anchor="end" fill="{ink}">{note}</text>')
        for i, room in enumerate(members):
            top = y + 10 + ROW * i
            lines.append(f'<text x="24" y="{top + 30}" font-weight="bold" font-size="17">{room}/</text>')
            names = [n for n in order.get(room, []) if n in rooms[room]] or []
            for k, name in enumerate(names):
                lines.append(f'<rect x="{LEFT - 60 + k * (BOX + 8)}" y="{top + 6}" width="{BOX}" height="38" rx="5" fill="white" stroke="{ink}"/>')
                lines.append(f'<text x="{LEFT - 60 + k * (BOX + 8) + BOX / 2}" y="{top + 30}" text-anchor="middle">{name}</text>')
        y += height + 12
    print(f'<svg xmlns="http://www.w3.org/2000/svg" width="{WIDTH}" height="{y}" viewBox="0 0 {WIDTH} {y}" '
          'font-family="sans-serif" font-size="14">')
    print(f'<title>The rooms of engine/: each uses its own modules and rooms above it</title><rect width="{WIDTH}" height="{y}" fill="white"/>')
    print("\n".join(lines))
    print("</svg>")


if __name__ == "__main__":
    main()
