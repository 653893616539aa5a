# SPDX-License-Identifier: MIT
"""Scenes that are made to break what hides triangles, and cameras that make it worse. run.py --odd draws them.

odd_scenes.write(folder, name, far, size) writes NAME.gltf, moved by 10^6 m if `far`, and a path of cameras for a picture
of that size: cameras that turn fast, are cut from place to place, stand still, are inside of things, and are
orthographic or see infinitely far.
"""
import base64
import json
import math
import random
import struct

FAR_ORIGIN = (1e6, 2e5, -1e6)


class Scene:
    """Meshes and where they stand. `eyes` are places that cameras take; they look along −z first."""

    def __init__(self, name):
        self.random = random.Random(name)
        self.meshes, self.nodes = [], []
        self.eyes, self.reach, self.near = [(0.0, 0.3, 8.0)], 10.0, 0.01

    def mesh(self, positions, indices, material=0):
        self.meshes.append((positions, indices, material))
        return len(self.meshes) - 1

    def put(self, mesh, at=(0, 0, 0), x=(1, 0, 0), y=(0, 1, 0), z=(0, 0, 1)):
        self.nodes.append({"mesh": mesh, "matrix": [*x, 0, *y, 0, *z, 0, *at, 1]})

    def scaled(self, mesh, at, s):
        self.put(mesh, at, (s, 0, 0), (0, s, 0), (0, 0, s))

    def crowd(self, count, low, high):
        """Boxes and balls of a few triangles, for something to hide."""
        parts = [self.mesh(*box()), self.mesh(*ball(8, 12))]
        for _ in range(count):
            self.scaled(self.random.choice(parts), [self.random.uniform(a, b) for a, b in zip(low, high)],
                        self.random.uniform(0.05, 0.4))

    def gltf(self, origin):
        data, views, accessors, meshes = bytearray(), [], [], []
        for positions, indices, material in self.meshes:
            finite = [p for p in positions if all(map(math.isfinite, p))]
            for target, values, form, extra in (
                    (34962, [c for p in positions for c in p], "f",
                     {"componentType": 5126, "type": "VEC3", "count": len(positions),
                      "min": [min(rounded(p[k]) for p in finite) for k in range(3)],
                      "max": [max(rounded(p[k]) for p in finite) for k in range(3)]}),
                    (34963, indices, "I", {"componentType": 5125, "type": "SCALAR", "count": len(indices)})):
                packed = struct.pack(f"<{len(values)}{form}", *values)
                accessors.append({"bufferView": len(views), **extra})
                views.append({"buffer": 0, "byteOffset": len(data), "byteLength": len(packed), "target": target})
                data += packed
            meshes.append({"primitives": [{"attributes": {"POSITION": len(accessors) - 2},
                                           "indices": len(accessors) - 1, "material": material}]})
        uri = "data:application/octet-stream;base64," + base64.b64encode(bytes(data)).decode()
        root = {"translation": list(origin), "children": list(range(1, len(self.nodes) + 1))}
        return {"asset": {"version": "2.0"}, "scene": 0, "scenes": [{"nodes": [0]}], "nodes": [root, *self.nodes],
                "materials": [{}, {"doubleSided": True}, {"doubleSided": True, "alphaMode": "MASK"}],
                "meshes": meshes, "accessors": accessors, "bufferViews": views,
                "buffers": [{"uri": uri, "byteLength": len(data)}]}


ONE_SIDED, TWO_SIDED, MASKED = range(3)  # materials


def rounded(value):
    return struct.unpack("<f", struct.pack("<f", value))[0]


def grid(columns, rows, place):
    """Squares of two triangles; `place` tells where (u, v) of [0, 1]² is."""
    positions = [place(i / columns, j / rows) for j in range(rows + 1) for i in range(columns + 1)]
    indices = []
    for j in range(rows):
        for i in range(columns):
            p = j * (columns + 1) + i
            q = p + columns + 1
            indices += [p, p + 1, q + 1, p, q + 1, q]
    return positions, indices


def wall(columns, rows, width, height, z=0.0):
    return grid(columns, rows, lambda u, v: ((u - 0.5) * width, (v - 0.5) * height, z))


def box():
    positions = [(x, y, z) for x in (-1, 1) for y in (-1, 1) for z in (-1, 1)]
    return positions, [0, 1, 3, 0, 3, 2, 4, 6, 7, 4, 7, 5, 0, 4, 5, 0, 5, 1, 2, 3, 7, 2, 7, 6, 0, 2, 6, 0, 6, 4, 1, 5,
                       7, 1, 7, 3]


def ball(rows, columns):
    def place(u, v):
        a, b = 2 * math.pi * u, math.pi * (v - 0.5)
        return math.cos(b) * math.cos(a), math.sin(b), -math.cos(b) * math.sin(a)
    return grid(columns, rows, place)


def joined(parts):
    positions, indices = [], []
    for more, which in parts:
        indices += [i + len(positions) for i in which]
        positions += more
    return positions, indices


def coplanar(scene):
    """Walls of different grids in one plane, or up to a ten-thousandth from it, each an object."""
    for k in range(12):
        z = 0.0 if k % 2 == 0 else scene.random.choice((-1, 1)) * 10 ** scene.random.uniform(-8, -4)
        scene.put(scene.mesh(*wall(k % 5 + 1, 3 * k % 7 + 1, 12 - 0.3 * k, 6, z), material=k % 2))
    scene.crowd(200, (-5, -3, -15), (5, 3, -0.1))
    scene.eyes += [(0.0, 0.0, 1e-3), (6.0, 0.0, 0.0), (0.0, 0.0, -4.0)]


def fences(scene):
    """Slats at one depth, that touch or overlap, some of them twice; a second fence crosses the first."""
    slat, post = scene.mesh(*wall(1, 1, 0.25, 4), material=1), scene.mesh(*wall(1, 3, 0.2, 4), material=0)
    for i in range(60):
        for _ in range(1 + (i % 7 == 0)):
            scene.put(slat if i % 3 else post, (0.22 * i - 6.6, 0, 0))
        scene.put(slat, (0, 0.22 * i - 6.6, 0), (0, 3, 0), (1, 0, 0), (0, 0, -1))
    scene.crowd(200, (-5, -2, -15), (5, 2, -0.5))
    scene.eyes += [(0.1, 0.1, 1e-3), (-7.0, 0.0, 0.0)]


def t_junctions(scene):
    """Rows of a wall, each cut into another number of squares: in one mesh, and as objects."""
    rows = [grid(1 + 5 * r % 17, 1, lambda u, v, r=r: (10 * u - 5, 0.5 * (v + r) - 3, 0.0)) for r in range(12)]
    scene.put(scene.mesh(*joined(rows)))
    for row in rows:
        scene.put(scene.mesh(*row), (0, 0, -3))
    scene.crowd(250, (-5, -3, -15), (5, 3, -0.2))
    scene.eyes += [(0.0, 0.0, 1e-2), (1.0, 0.5, -2.99)]


def slivers(scene):
    """Fans of needles of down to a hundredth of a degree, some missing, some turned round, in each other's way."""
    for k in range(40):
        n, angle = scene.random.randint(3, 200), 10 ** scene.random.uniform(-3.7, -1.5)
        positions, indices = [(0, 0, 0)], []
        for i in range(n + 1):
            r = scene.random.uniform(0.7, 1.4)
            positions.append((r * math.cos(i * angle), r * math.sin(i * angle), scene.random.uniform(-0.01, 0.01)))
            if i and scene.random.random() > 0.1:
                indices += [0, i, i + 1] if scene.random.random() > 0.05 else [0, i + 1, i]
        fan = scene.mesh(positions, indices or [0, 1, 2], material=k % 2)
        for _ in range(4):
            scene.scaled(fan, [scene.random.uniform(-3, 3) for _ in range(3)], scene.random.uniform(0.5, 6))
    scene.crowd(150, (-5, -3, -15), (5, 3, -3))
    scene.eyes += [(0.0, 0.0, 0.5), (1.0, 0.0, 3.0)]


def degenerate(scene):
    """A wall with triangles of no area among the others: with equal corners, on a line, on a line nearly."""
    positions, indices = wall(20, 12, 12, 7)
    for i in range(0, len(indices), 9):
        a, b, c = indices[i:i + 3]
        middle = tuple(0.5 * (p + q) for p, q in zip(positions[a], positions[b]))
        nearly = tuple(m + scene.random.uniform(-1e-7, 1e-7) for m in middle)
        positions += [middle, nearly]
        m = len(positions) - 2
        indices += [a, a, b, c, c, c, a, b, m, a, m + 1, b, m, m + 1, c]
    for z in (0, -0.001, -4):
        scene.put(scene.mesh(positions, indices, material=int(z == 0)), (0, 0, z))
    scene.crowd(200, (-5, -3, -15), (5, 3, -0.2))
    scene.eyes += [(0.0, 0.0, 1e-3), (6.0, 0.0, 0.0)]


def dense(scene):
    """A million triangles in a pixel, before walls, in them and behind."""
    scene.put(scene.mesh(*wall(7, 5, 9, 5)))
    scene.scaled(scene.mesh(*ball(500, 1000)), (0.11, 0.07, 1.0), 0.002)
    small = scene.mesh(*ball(40, 60))
    for k in range(12):
        scene.scaled(small, (0.3 * k - 1.8, 0.2, (0.5, 0, -0.5)[k % 3]), 0.003)
    scene.crowd(100, (-4, -2, -10), (4, 2, -0.5))
    scene.eyes += [(0.11, 0.07, 1.0), (0.0, 0.0, -5.0)]


def sizes(scene):
    """Boxes and balls from a millionth to a million, each as far away as it is large, some about the eye."""
    parts = [scene.mesh(*box()), scene.mesh(*ball(20, 30))]
    for k in range(130):
        s = 10 ** (0.1 * k - 6.5)
        a = 2.4 * k
        scene.scaled(parts[k % 2], (3 * s * math.cos(a), 0.4 * s * math.sin(5 * a), 8 + 3 * s * math.sin(a)), s)
    scene.crowd(50, (-5, -3, -15), (5, 3, 5))
    scene.near = 1e-5
    scene.eyes += [(0.0, 0.0, 8.0), (1e4, 10.0, 0.0)]


def through_near(scene):
    """A ground of 100,352 triangles at the eye's height, so that the near plane cuts it; all else is below."""
    rise = scene.random.random()
    ground = grid(224, 224, lambda u, v: (20 * u - 10, 0.3 + 0.02 * math.sin(40 * u + rise) * math.sin(30 * v),
                                          20 * v - 10))
    scene.put(scene.mesh(*ground, material=1))
    scene.crowd(400, (-10, -6, -10), (10, -0.2, 8))
    scene.near = 0.05
    scene.eyes += [(0.0, 0.31, 0.0), (3.0, 0.3, -2.0)]


def inside(scene):
    """An eye within thirty closed meshes, each about the others, and a crowd outside of them."""
    for k in range(30):
        s = 1.0 + 0.05 * k
        scene.put(scene.mesh(*ball(4 + k % 12, 6 + k % 17), material=k % 2), (0.01 * k, 0, 0), (s, 0, 0), (0, s, 0),
                  (0, 0, s if k % 3 else -s))
    scene.crowd(150, (-5, -3, -10), (5, 3, -3))
    scene.eyes += [(0.0, 0.0, 0.0), (0.5, 0.2, 0.9), (1.2, 0.0, 0.0)]


def turned(scene):
    """Mirrored, sheared and flattened instances; in centimetres and far from their own origin."""
    far_mesh = scene.mesh([(100 * x + 5e4, 100 * y, 100 * z) for x, y, z in ball(12, 20)[0]], ball(12, 20)[1])
    parts = [scene.mesh(*box()), scene.mesh(*ball(12, 20)), scene.mesh(*ball(9, 9), material=1)]
    number = scene.random.uniform
    for k in range(300):
        at = [number(-6, 6), number(-3, 3), number(-15, 2)]
        axes = [[number(-0.6, 0.6) for _ in range(3)] for _ in range(3)]
        if k % 5 == 0:
            axes[2] = [1e-6 * c for c in axes[2]]
        if k % 7 == 0:
            axes = [(-0.5, 0, 0), (0, 0.5, 0), (0, 0, 0.5)]
        scene.put(parts[k % 3], at, *axes)
    for k in range(20):
        s = 0.003 * (-1) ** k
        scene.put(far_mesh, (0.4 * k - 4 - 5e4 * s, 0, -2), (s, 0, 0), (0, 0.003, 0), (0, 0, 0.003))
    scene.eyes += [(0.0, 0.0, -2.0), (2.0, 1.0, -7.0)]


def leaves(scene):
    """Leaves that may be transparent, before walls and in them: they hide nothing."""
    leaf = scene.mesh(*wall(1, 1, 0.5, 0.8), material=MASKED)
    scene.put(scene.mesh(*wall(9, 5, 10, 6)))
    number = scene.random.uniform
    for k in range(1500):
        a, z = number(0, 2 * math.pi), 0.0 if k % 4 == 0 else number(-6, 3)
        scene.put(leaf, (number(-5, 5), number(-3, 3), z), (math.cos(a), math.sin(a), 0),
                  (-math.sin(a), math.cos(a), 0.0 if k % 4 == 0 else number(-1, 1)))
    scene.crowd(150, (-5, -3, -15), (5, 3, -0.5))
    scene.eyes += [(0.0, 0.0, 0.5), (0.0, 0.0, -3.0)]


def needles(scene):
    """Needles of down to a hundred-thousandth of their length, through the near plane, over a vast ground."""
    scene.put(scene.mesh(*grid(1, 1, lambda u, v: (2e5 * (u - 0.5), -1.0, 2e5 * (0.5 - v)))))
    for k in range(300):
        width, length = 10 ** scene.random.uniform(-5, -1), 10 ** scene.random.uniform(0, 2.5)
        needle = scene.mesh(*wall(1, 1, length, length * width), material=k % 2)
        a, b = scene.random.uniform(0, 6.3), scene.random.uniform(-0.1, 0.1)
        scene.put(needle, [scene.random.uniform(-4, 4), scene.random.uniform(-1, 1), scene.random.uniform(-4, 8)],
                  (math.cos(a), b, math.sin(a)), (-math.sin(b), math.cos(b), 0), (-math.sin(a), 0, math.cos(a)))
    scene.crowd(200, (-8, -3, -30), (8, 2, 0))
    scene.eyes += [(0.0, 0.0, 0.0), (0.0, -0.99, 2.0)]


def lattice(scene):
    """Squares of half a pixel of the orthographic cameras, and multiples: corners and edges are at samples."""
    for k, step in enumerate((1 / 32, 1 / 8, 1 / 2, 5 / 16)):
        n = min(int(8 / step), 150)
        squares = grid(n, n, lambda u, v, s=n * step: (s * (u - 0.5), s * (v - 0.5), 0.0))
        scene.put(scene.mesh(*squares, material=k % 2), (0.5 * step, 0, -k * 0.5 - k // 3 * 1e-6))
    scene.crowd(200, (-5, -3, -15), (5, 3, -0.2))
    scene.eyes += [(0.0, 0.0, 0.02), (2.0, 0.0, -1.2)]


def no_numbers(scene):
    """A wall with corners that are NaN, infinite and beyond what can be placed, before a crowd."""
    positions, indices = wall(9, 5, 10, 6)
    positions[20], positions[33], positions[46] = (math.nan, 0, 0), (0, math.inf, 0), (3e38, 3e38, -3e38)
    scene.put(scene.mesh(positions, indices))
    scene.put(scene.mesh([(3e38 * x, y, z) for x, y, z in positions if abs(x) < 1], [0, 1, 2]), (0, 0, -1))
    scene.crowd(150, (-5, -3, -15), (5, 3, -0.5))
    scene.eyes += [(0.0, 0.0, 0.02)]


SCENES = {make.__name__: make for make in (coplanar, fences, t_junctions, slivers, degenerate, dense, sizes,
                                           through_near, inside, turned, leaves, needles, lattice,
                                           no_numbers)}


def cameras(scene, origin, size):
    width, height = map(int, size.split("x"))
    number = scene.random.uniform
    path = []

    def add(kind, eye, yaw=0.0, pitch=0.0, **more):
        forward = (math.cos(pitch) * math.sin(yaw), math.sin(pitch), -math.cos(pitch) * math.cos(yaw))
        path.append({"kind": kind, "position": [a + b for a, b in zip(eye, origin)], "forward": forward,
                     "aspect": width / height, "near": scene.near, "far": 100 * scene.reach, "scene_frame": 0, **more})

    for k in range(4):
        add("turning", scene.eyes[0], 2.4 * k, 0.3 * math.sin(k))
    for _ in range(5):
        add("cut", [scene.reach * number(-0.5, 0.5), number(-3, 3), scene.reach * number(-1, 1)], number(-4, 4),
            number(-1.5, 1.5))
    for k, eye in enumerate(scene.eyes[1:]):
        for yaw in (0.0, 1.6, 3.1):
            add("inside", eye, yaw + 0.01 * k)
    add("still", *[scene.eyes[0]])
    add("still", *[scene.eyes[0]])
    for k in range(3):
        add("infinite", scene.eyes[k % len(scene.eyes)], 0.2 * k, far="infinity", near=0.1 * scene.near)
    # A pixel is a sixteenth of a metre; the last one's samples are at its multiples.
    for k, eye in enumerate([scene.eyes[0], scene.eyes[-1], (1 / 32, 1 / 32, 9.0)]):
        add("orthographic", eye, 0.5 * (k == 1), height=height / 16 if k != 1 else 7.3)
    return path


def write(folder, name, far, size):
    """Writes scene and cameras, unless they are there. Returns both files."""
    place = "far" if far else "origin"
    file, path = folder / f"{name}_{place}.gltf", folder / f"{name}_{place}_{size}.json"
    if not file.exists() or not path.exists():
        scene, origin = Scene(name), FAR_ORIGIN if far else (0.0, 0.0, 0.0)
        SCENES[name](scene)
        file.write_text(json.dumps(scene.gltf(origin)))
        path.write_text(json.dumps(cameras(scene, origin, size)))
    return file, path
