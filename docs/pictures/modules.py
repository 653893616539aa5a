#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""Draws the map of the modules, in 0.1 and now, for docs/architecture.md. Reads today's arrows from engine/*/CMakeLists.txt.
modules.py > modules.svg"""
import pathlib
import re

# 0.1, as its build files had it.
BEFORE = {
    "core": [], "geometry": ["core"], "measure": ["geometry"], "fit": ["measure"], "tree": ["fit"], "scene": ["fit"], "cull": ["tree"],
    "collide": ["scene", "tree"], "triangulate": ["measure"], "radiosity": ["tree", "triangulate"], "bake": ["tree", "scene"],
    "render": ["core", "geometry"], "capi": ["fit", "scene", "cull", "collide", "triangulate", "bake"],
}
LEFT_OUT = {"simd", "study"}  # what kernels share; and what uses every module


def today():
    modules = {}
    for path in sorted(pathlib.Path(__file__).parents[2].glob("engine/*/CMakeLists.txt")):
        uses = re.search(r"crofton_module\(NAME \w+\s+DEPENDS ([a-z_ ]+)", path.read_text())
        modules[path.parent.name] = uses[1].split() if uses else []
    modules["render"] = ["core", "geometry"]
    return {name: [other for other in used if other not in LEFT_OUT] for name, used in modules.items() if name not in LEFT_OUT}


def levels(modules):
    """Each module one level above the highest that it uses; and of its arrows those that no other path says."""
    level, below = {}, {}

    def visit(name):
        if name not in level:
            for other in modules[name]:
                visit(other)
            below[name] = {other for direct in modules[name] for other in below[direct] | {direct}}
            level[name] = 1 + max((level[other] for other in modules[name]), default=-1)
        return level[name]

    for name in modules:
        visit(name)
    arrows = [(name, other) for name in modules for other in modules[name]
              if not any(other in below[direct] for direct in modules[name])]
    return level, arrows


def place(level, arrows, left, width, top):
    """Rows of boxes, row `top` the highest; each row is put in the order of the mean place of what its modules use."""
    at, rows = {}, {}
    for name in sorted(level):
        rows.setdefault(level[name], []).append(name)
    for row in sorted(rows):
        def mean(name):
            used = [at[other][0] for user, other in arrows if user == name and other in at]
            return sum(used) / len(used) if used else left
        rows[row].sort(key=lambda name: (mean(name), name))
        for i, name in enumerate(rows[row]):
            at[name] = (left + width * (i + 1) / (len(rows[row]) + 1), 58 * (top - row) + 66)
    return at


def draw(title, modules, left, width, top):
    level, arrows = levels(modules)
    at = place(level, arrows, left, width, top)
    out = [f'<text class="title" x="{left + width / 2}" y="28">{title}</text>']
    for user, used in arrows:
        (x0, y0), (x1, y1) = at[user], at[used]
        out.append(f'<path class="arrow" d="M{x0:.0f} {y0 + 14:.0f} C{x0:.0f} {y0 + 38:.0f} {x1:.0f} {y1 - 38:.0f} {x1:.0f} {y1 - 14:.0f}"/>')
    for name, (x, y) in at.items():
        kind = {"world": "door", "render": "component"}.get(name, "module")
        half = 5 + 3.9 * len(name)
        out.append(f'<rect class="{kind}" x="{x - half:.0f}" y="{y - 13:.0f}" width="{2 * half:.0f}" height="26" rx="5"/>'
                   f'<text x="{x:.0f}" y="{y + 4:.0f}">{name}</text>')
    return out


STYLE = """<style>
svg { background: #fff; }
text { font: 12px sans-serif; text-anchor: middle; fill: #222; }
.title { font-size: 15px; }
.note { text-anchor: start; }
.arrow { fill: none; stroke: #9ab; stroke-width: 1.2; }
rect { stroke: #567; fill: #eef3f8; }
.door { fill: #ffe2a8; stroke: #b37a00; }
.component { stroke-dasharray: 4 3; fill: #fff; }
@media (prefers-color-scheme: dark) {
svg { background: #16191d; }
text { fill: #e4e7ea; }
.arrow { stroke: #56677a; }
rect { fill: #24303c; stroke: #8ab; }
.door { fill: #5d4610; stroke: #ffc966; }
.component { fill: #16191d; }
}
</style>"""

now = today()
top = max(max(levels(modules)[0].values()) for modules in (BEFORE, now))
height = 58 * top + 140
body = draw("0.1", BEFORE, 0, 360, top) + draw("now", now, 370, 640, top)
legend = "an arrow: uses; arrows that others imply are left out · yellow: the front door · dashed: a library of its own · not drawn: study, which uses all, and simd"
print(f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 1020 {height}" width="1020" height="{height}">')
print("\n".join([STYLE, *body, f'<text class="note" x="16" y="{height - 14}">{legend}</text>', "</svg>"]))
