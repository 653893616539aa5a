#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""Draws the frames of a flight over regions for docs/large_worlds.md, from what crofton frames measures.
crofton frames FOLDER --no-draw --real-time --csv - | flight.py > flight.svg"""
import csv
import sys

WIDTH, HEIGHT, LEFT, RIGHT, TOP, BOTTOM = 900, 320, 64, 14, 46, 40
LIMIT = 0.3  # milliseconds over the mean that a frame may take
KINDS = [("no region comes or goes", "#9aa3ad"), ("a region comes", "#1b9e77"), ("a region goes", "#d95f02"),
         ("both", "#3b4fa8")]


def text(x, y, what, anchor="start", extra=""):
    return f'<text x="{x:.1f}" y="{y:.1f}" text-anchor="{anchor}"{extra}>{what}</text>'


def main():
    rows = list(csv.DictReader(sys.stdin))[1:]  # the first frame begins with all that is near
    times = [(float(row["update_us"]) + float(row["cull_us"])) / 1000 for row in rows]
    kinds = [(float(row["regions_came"]) > 0) + 2 * (float(row["regions_went"]) > 0) for row in rows]
    mean = sum(times) / len(times)
    highest = 0.1 * (int(10 * max(max(times), mean + LIMIT)) + 1)

    def x_of(i):
        return LEFT + (WIDTH - LEFT - RIGHT) * i / len(times)

    def y_of(time):
        return HEIGHT - BOTTOM - (HEIGHT - TOP - BOTTOM) * time / highest

    lines = [f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {WIDTH} {HEIGHT}" font-family="sans-serif" font-size="13" fill="#333">',
             f'<rect width="{WIDTH}" height="{HEIGHT}" fill="white"/>']
    for tenth in range(round(10 * highest) + 1):
        y = y_of(tenth / 10)
        lines.append(f'<line x1="{LEFT}" x2="{WIDTH - RIGHT}" y1="{y:.1f}" y2="{y:.1f}" stroke="#e4e7ea"/>')
        lines.append(text(LEFT - 8, y + 4, f"{tenth / 10:.1f}", "end"))
    for second in range(len(times) // 60 + 1):
        lines.append(text(x_of(60 * second), HEIGHT - BOTTOM + 18, second, "middle"))
    lines.append(text(WIDTH - RIGHT, HEIGHT - 6, "seconds, 60 frames each", "end"))
    lines.append(text(8, TOP - 12, "ms"))
    width = max(1.0, 0.9 * (WIDTH - LEFT - RIGHT) / len(times))
    for i, (time, kind) in enumerate(zip(times, kinds)):
        lines.append(f'<rect x="{x_of(i):.2f}" y="{y_of(time):.2f}" width="{width:.2f}" height="{y_of(0) - y_of(time):.2f}" fill="{KINDS[kind][1]}"/>')
    for level, what in ((mean, f"mean {mean:.2f} ms"), (mean + LIMIT, f"mean + {LIMIT} ms")):
        y = y_of(level)
        lines.append(f'<line x1="{LEFT}" x2="{WIDTH - RIGHT}" y1="{y:.1f}" y2="{y:.1f}" stroke="#222" stroke-dasharray="5 4"/>')
        lines.append(text(WIDTH - RIGHT - 4, y - 5, what, "end", ' stroke="white" stroke-width="3" paint-order="stroke"'))
    x = LEFT
    for kind, (name, color) in enumerate(KINDS):
        label = f"{name}: {kinds.count(kind)}"
        lines.append(f'<rect x="{x}" y="14" width="12" height="12" fill="{color}"/>')
        lines.append(text(x + 18, 25, label))
        x += 34 + 7 * len(label)
    print("\n".join(lines + ["</svg>"]))


main()
