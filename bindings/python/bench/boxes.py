#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""Bounding boxes beside Open3D's and VTK's, where these are installed, in one run; and what a call costs.

bindings/python/bench/boxes.py [MESH.obj …]     without meshes: points of a normal distribution
"""
import sys
import timeit

import numpy as np

import crofton


def vertices_of(path):
    with open(path) as file:
        return np.array([line.split()[1:4] for line in file if line.startswith("v ")], dtype="f8")


def least_over_hull(open3d, cloud):
    """Extent of the minimal box of Open3D 0.17 and later, by functions that earlier versions have: it tries the frame of
    each triangle of the hull on all corners of the hull."""
    hull, _ = cloud.compute_convex_hull()
    first, second, third = np.asarray(hull.vertices)[np.asarray(hull.triangles)].transpose(1, 0, 2)
    along, across = second - first, np.cross(second - first, third - first)
    frames = np.stack([along, np.cross(across, along), across], axis=1)
    frames /= np.linalg.norm(frames, axis=2, keepdims=True)
    corners, extents = hull.vertices, []
    for frame, place in zip(frames, first):
        turned = open3d.geometry.PointCloud(corners).rotate(frame, place)
        extents.append(turned.get_max_bound() - turned.get_min_bound())
    return min(extents, key=np.prod)


def open3d_ways(points):
    try:
        import open3d
    except ImportError:
        return {}
    vectors = open3d.utility.Vector3dVector(points)
    cloud = open3d.geometry.PointCloud(vectors)

    def sizes(extent):
        return extent.sum(), extent.prod()

    def minimal():
        if hasattr(cloud, "get_minimal_oriented_bounding_box"):
            return sizes(cloud.get_minimal_oriented_bounding_box().extent)
        return sizes(least_over_hull(open3d, cloud))

    return {"Open3D, minimal": minimal,
            "Open3D, axes of the hull": lambda: sizes(open3d.geometry.OrientedBoundingBox.create_from_points(vectors).extent),
            "Open3D, the hull alone": lambda: cloud.compute_convex_hull()}


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


def seconds_of(way):
    """The least of many short runs: other programs disturb some of them."""
    once = max(timeit.timeit(way, number=1), 1e-6)
    runs, repeats = max(1, int(1e-3 / once)), max(3, min(50, int(2 / once)))
    return min(timeit.repeat(way, number=runs, repeat=repeats)) / runs


def box_row(name, way, best, proof):
    sizes, seconds = way(), seconds_of(way)
    text = f"  {name:28} {1e3 * seconds:9.3f} ms {seconds / proof:8.2f} ×"
    if isinstance(sizes, tuple) and np.isscalar(sizes[0]):
        text += f"   edges {sizes[0] / best[0]:.4f} ×   volume {sizes[1] / best[1]:.4f} ×"
    print(text, flush=True)


def boxes(name, points):
    print(f"{name}: {len(points)} points; time beside that of the proof by volume, edges and volume beside the proved least of each")
    proved = {c: crofton.fit_exact(points, c) for c in ("perimeter", "volume")}
    best = proved["perimeter"].box.edge_sum, proved["volume"].box.volume

    def ours(quality, criterion):
        def fit():
            box = crofton.fit_obb(points, criterion, quality)
            return box.edge_sum, box.volume

        return fit

    ways = {f"crofton {q}, {c}": ours(q, c) for c in ("perimeter", "volume") for q in ("fast", "tight", "exact")}
    ways |= {**open3d_ways(points), **vtk_ways(points), "NumPy, sum of all numbers": points.sum}
    proof = seconds_of(ours("exact", "volume"))
    for name, way in ways.items():
        box_row(name, way, best, proof)


def calls():
    box = crofton.Box((0, 0, 0), (1, 1, 1))
    many = crofton.boxes(np.zeros((1, 3)), 1)
    world = crofton.World()
    world.add(box=box)
    world.update()
    print("a call, µs")
    for text in ("box.volume", "len(world)", "crofton.penetration(box, box)", "crofton.intersects(box, box)",
                 "crofton.intersects(many, many)", "crofton.classify(camera, many)", "box.contains((0, 0, 0))",
                 "world.raycast((5, 0, 0), (-1, 0, 0))", "world.overlap(box=box)", "world.view(camera)",
                 "world.view(request)"):
        names = {"box": box, "many": many, "world": world, "crofton": crofton, "camera": crofton.Camera(),
                 "request": crofton.ViewRequest(crofton.Camera())}
        print(f"  {text:40} {min(timeit.repeat(text, globals=names, number=5000, repeat=7)) / 5000 * 1e6:.2f}")


if __name__ == "__main__":
    calls()
    if len(sys.argv) == 1:
        boxes("normal distribution", np.random.default_rng(1).normal(size=(10000, 3)) * [3, 2, 1])
    for path in sys.argv[1:]:
        boxes(path.split("/")[-1], vertices_of(path))
