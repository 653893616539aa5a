#!/usr/bin/env python3
"""How the broadphase's cost grows with the number of boxes, as SVG on standard output.

  bench_collide --benchmark_filter=broadphase --benchmark_out=growth.json --benchmark_out_format=json
  bench/collide_growth.py growth.json > docs/pictures/collide_growth.svg
"""
import json
import math
import sys

WIDTH, HEIGHT, LEFT, RIGHT, TOP, BOTTOM = 720, 420, 76, 150, 24, 52
COLOURS = ["#1b6ca8", "#c0392b", "#2e8b57", "#8e44ad"]
LABELS = {"bounds/crofton": "Crofton, bounds", "boxes/crofton": "Crofton, exact boxes",
          "bounds/bullet": "Bullet, bounds", "bounds/embree": "Embree, bounds"}


def series(path):
    found = {}
    for run in json.load(open(path))["benchmarks"]:
        parts = run["name"].split("/")
        if parts[0] != "broadphase" or run.get("run_type") != "iteration" or "error_occurred" in run:
            continue
        count = int(parts[3])
        scale = {"ns": 1.0, "us": 1e3, "ms": 1e6, "s": 1e9}[run["time_unit"]]
        points = found.setdefault("/".join(parts[1:3]), {})
        points[count] = min(points.get(count, math.inf), run["cpu_time"] * scale / count)
    return found


def text(x, y, anchor, words, extra=""):
    return f'<text x="{x:.1f}" y="{y:.1f}" text-anchor="{anchor}"{extra}>{words}</text>'


def main():
    data = series(sys.argv[1])
    counts = sorted({count for points in data.values() for count in points})
    values = [value for points in data.values() for value in points.values()]
    low, high = math.floor(math.log10(min(values))), math.ceil(math.log10(max(values)))
    first, last = math.log10(counts[0]), math.log10(counts[-1])

    def x(count):
        return LEFT + (WIDTH - LEFT - RIGHT) * (math.log10(count) - first) / (last - first)

    def y(value):
        return HEIGHT - BOTTOM - (HEIGHT - TOP - BOTTOM) * (math.log10(value) - low) / (high - low)

    out = [f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {WIDTH} {HEIGHT}" font-family="sans-serif" '
           'font-size="13" fill="#222">', f'<rect width="{WIDTH}" height="{HEIGHT}" fill="white"/>']
    for power in range(low, high + 1):
        for factor in (1, 2, 5):
            value = factor * 10.0 ** power
            if value > 10.0 ** high:
                continue
            out.append(f'<line x1="{LEFT}" x2="{WIDTH - RIGHT}" y1="{y(value):.1f}" y2="{y(value):.1f}" stroke="#ddd"/>')
            out.append(text(LEFT - 8, y(value) + 4, "end", f"{value:g}"))
    for count in counts:
        out.append(text(x(count), HEIGHT - BOTTOM + 20, "middle", f"{count:,}"))
    out.append(text((LEFT + WIDTH - RIGHT) / 2, HEIGHT - 10, "middle", "moving boxes, about 1.2 pairs each"))
    out.append(text(18, HEIGHT / 2, "middle", "nanoseconds a box and update", f' transform="rotate(-90 18 {HEIGHT / 2})"'))
    ends = []
    for colour, (name, points) in zip(COLOURS, sorted(data.items())):
        line = " ".join(f"{x(count):.1f},{y(points[count]):.1f}" for count in sorted(points))
        out.append(f'<polyline points="{line}" fill="none" stroke="{colour}" stroke-width="2"/>')
        out += [f'<circle cx="{x(c):.1f}" cy="{y(points[c]):.1f}" r="3" fill="{colour}"/>' for c in points]
        end = max(points)
        ends.append((y(points[end]), x(end), colour, LABELS.get(name, name)))
    below = -math.inf
    for at, right, colour, label in sorted(ends):
        below = max(at + 4, below + 16)
        out.append(text(right + 8, below, "start", label, f' fill="{colour}"'))
    print("\n".join(out + ["</svg>"]))


main()
