#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""Draws docs/theory.md's picture: sixty uniform lines through a disc, and where they cross a spiral.   crofton.py > crofton.svg"""
import math
import random
import statistics

random.seed(2)
R, LINES, PIECES = 150, 60, 240

STYLE = """<style>
svg { background: #fff; }
.disc { fill: none; stroke: #888; stroke-width: 1; stroke-dasharray: 4 3; }
.line { stroke: #9ab; stroke-width: 0.8; }
.curve { fill: none; stroke: #1f5fbf; stroke-width: 3; stroke-linecap: round; }
.dot { fill: #d2491e; stroke: #fff; stroke-width: 0.8; }
text { fill: #222; }
@media (prefers-color-scheme: dark) {
svg { background: #16191d; }
.line { stroke: #56677a; }
.curve { stroke: #6aa8ff; }
.dot { fill: #ff8a5c; stroke: #16191d; }
text { fill: #e4e7ea; }
}
</style>"""


def spiral(t):
    angle, radius = 2.7 * math.pi * t + 0.4, 125 * (1 - 0.62 * t)
    return radius * math.cos(angle), 0.86 * radius * math.sin(angle)


def crossings(curve, normal, p):
    """Where the line { x : dot(normal, x) = p } crosses the polyline."""
    side = [x * normal[0] + y * normal[1] - p for x, y in curve]
    for a, b, s, t in zip(curve, curve[1:], side, side[1:]):
        if (s >= 0) != (t >= 0):
            u = s / (s - t)
            yield a[0] + u * (b[0] - a[0]), a[1] + u * (b[1] - a[1])


curve = [spiral(i / PIECES) for i in range(PIECES + 1)]
length = sum(math.dist(a, b) for a, b in zip(curve, curve[1:]))
lines, dots, counts = [], [], []
for _ in range(LINES):
    phi, p = random.uniform(0, math.pi), random.uniform(-R, R)
    n, half = (math.cos(phi), math.sin(phi)), math.sqrt(R * R - p * p)
    lines.append([p * n[0] + half * n[1], p * n[1] - half * n[0], p * n[0] - half * n[1], p * n[1] + half * n[0]])
    found = list(crossings(curve, n, p))
    dots += found
    counts.append(len(found))
counted = math.pi * statistics.mean(counts)
error = math.pi * statistics.stdev(counts) / math.sqrt(LINES)

print('<svg xmlns="http://www.w3.org/2000/svg" viewBox="-170 -165 610 330" font-family="sans-serif" font-size="13">')
print("<title>Crofton's formula: a curve's length from the number of times random lines cross it</title>")
print(STYLE)
print(f'<circle class="disc" r="{R}"/>')
for line in lines:
    print('<line class="line" x1="%.1f" y1="%.1f" x2="%.1f" y2="%.1f"/>' % tuple(line))
print('<polyline class="curve" points="%s"/>' % " ".join("%.1f,%.1f" % q for q in curve))
for dot in dots:
    print('<circle class="dot" cx="%.1f" cy="%.1f" r="3.2"/>' % dot)
for y, text in [(-72, f"{LINES} uniform lines meet"), (-52, "the disc of radius R;"), (-32, f"they cross the curve {len(dots)} times."),
                (-2, "Crofton: length ℓ = n̄ · πR,"), (18, "n̄ the crossings a line."),
                (48, f"counted: {len(dots)}/{LINES} · πR = {counted:.2f} R ± {error:.2f} R"), (68, f"in truth: {length / R:.2f} R")]:
    print(f'<text x="172" y="{y}">{text}</text>')
print("</svg>")
