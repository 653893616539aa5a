#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""Bounding boxes beside Open3D's and VTK's, where these are installed, in one run; and what a call costs.

python/bench/boxes.py [MESH.obj …]     without meshes: points of a normal distribution
"""
import sys
import timeit

import numpy as np

import crofton


def vertices_of(path):
    with open(path) as file:
        return np.array([line.split()[1:4] for line in file if line.startswith("v ")], dtype="f8")


def open3d_ways(points):
    try:
        import open3d
    except ImportError:
        return {}
    cloud = open3d.utility.Vector3dVector(points)
    box = open3d.geometry.OrientedBoundingBox

    def edges(b):
        return b.extent.sum(), b.extent.prod()

    ways = {"Open3D, principal axes": lambda: edges(box.create_from_points(cloud))}
    if hasattr(open3d.geometry.PointCloud, "get_minimal_oriented_bounding_box"):
        ways["Open3D, minimal"] = lambda: edges(open3d.geometry.PointCloud(cloud).get_minimal_oriented_bounding_box())
    return ways


def vtk_ways(points):
    try:
        from vtkmodules.util.numpy_support import numpy_to_vtk
        from vtkmodules.vtkCommonCore import vtkPoints
        from vtkmodules.vtkFiltersGeneral import vtkOBBTree
    except ImportError:
        return {}
    cloud = vtkPoints()
    cloud.SetData(numpy_to_vtk(points, deep=True))

    def fit():
        corner, long, middle, short, size = ([0.0] * 3 for _ in range(5))
        vtkOBBTree.ComputeOBB(cloud, corner, long, middle, short, size)
        lengths = np.linalg.norm([long, middle, short], axis=1)
        return lengths.sum(), lengths.prod()

    return {"VTK, principal axes": fit}


def box_row(name, way, best):
    edges, volume = way()
    runs = max(1, int(0.3 / max(timeit.timeit(way, number=1), 1e-6)))
    seconds = min(timeit.repeat(way, number=runs, repeat=5)) / runs
    print(f"  {name:28} {1e6 * seconds:10.1f} µs   edges {edges / best[0]:.4f} ×   volume {volume / best[1]:.4f} ×")


def boxes(name, points):
    print(f"{name}: {len(points)} points; edges and volume beside the proved optimum of each")
    proved = {c: crofton.fit_exact(points, c) for c in ("perimeter", "volume")}
    best = proved["perimeter"].box.edge_sum, proved["volume"].box.volume

    def ours(quality, criterion):
        def fit():
            box = crofton.fit_obb(points, criterion, quality)
            return box.edge_sum, box.volume

        return fit

    for quality in ("fast", "tight", "exact"):
        box_row(f"crofton {quality}, perimeter", ours(quality, "perimeter"), best)
    box_row("crofton exact, volume", ours("exact", "volume"), best)
    for other, way in {**open3d_ways(points), **vtk_ways(points)}.items():
        box_row(other, way, best)


def calls():
    box = crofton.Box((0, 0, 0), (1, 1, 1))
    many = crofton.boxes(np.zeros((1, 3)), 1)
    world = crofton.World()
    world.add(box=box)
    world.update()
    print("a call, µs")
    for text in ("box.volume", "len(world)", "crofton.penetration(box, box)", "crofton.intersects(box, box)",
                 "crofton.intersects(many, many)", "crofton.classify(camera, many)", "box.contains((0, 0, 0))",
                 "world.raycast((5, 0, 0), (-1, 0, 0))", "world.overlap(box=box)", "world.view(camera)"):
        names = {"box": box, "many": many, "world": world, "crofton": crofton, "camera": crofton.Camera()}
        print(f"  {text:40} {min(timeit.repeat(text, globals=names, number=5000, repeat=7)) / 5000 * 1e6:.2f}")


if __name__ == "__main__":
    calls()
    if len(sys.argv) == 1:
        boxes("normal distribution", np.random.default_rng(1).normal(size=(10000, 3)) * [3, 2, 1])
    for path in sys.argv[1:]:
        boxes(path.split("/")[-1], vertices_of(path))
