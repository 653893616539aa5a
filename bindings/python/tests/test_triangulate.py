# SPDX-License-Identifier: MIT
import xml.etree.ElementTree as ElementTree

import numpy as np
import pytest

import crofton

square = np.array([[0.0, 0], [4, 0], [4, 4], [0, 4]])
hole = np.array([[1.0, 1], [3, 1], [3, 3], [1, 3]])
methods = ["minimum_weight", "delaunay", "ear"]


def area(t):
    a, b, c = (t.points[t.triangles[:, k]] for k in range(3))
    return 0.5 * ((b[:, 0] - a[:, 0]) * (c[:, 1] - a[:, 1]) - (b[:, 1] - a[:, 1]) * (c[:, 0] - a[:, 0]))


@pytest.mark.parametrize("method", methods)
@pytest.mark.parametrize("shape", ["ring", "list of rings", "tuple of rings", "nested lists"])
def test_triangles_cover_the_polygon(method, shape):
    polygon, expected = {
        "ring": (square, 16),
        "list of rings": ([square, hole], 12),
        "tuple of rings": ((square, hole), 12),
        "nested lists": (square.tolist(), 16),
    }[shape]
    t = crofton.triangulate(polygon, method)
    assert (area(t) > 0).all()
    assert area(t).sum() == pytest.approx(expected)


def test_the_least_weight_of_a_kite_is_its_short_diagonal():
    t = crofton.triangulate([[0, 0], [5, -1], [10, 0], [5, 1]])
    assert t.weight == 2.0 and t.optimal and t.gap == 0.0


@pytest.mark.parametrize("n", [3, 4, 7, 20, 40])
def test_minimum_weight_is_the_least_of_all(n, random):
    angle = np.sort(random.uniform(0, 2 * np.pi, n))
    ring = np.column_stack([np.cos(angle), np.sin(angle)]) * random.uniform(0.5, 1.5, (n, 1))
    weights = [crofton.triangulate(ring, m).weight for m in methods]
    assert weights[0] <= min(weights) * (1 + 1e-12)


@pytest.mark.parametrize(
    "polygon, match",
    [
        ([[0, 0], [1, 0]], "point"),
        ([[0, 0], [2, 2], [2, 0], [0, 2]], "cross"),
        ([[0, 0], [1, 0], [np.nan, 1]], "."),
        ([square, square + 100], "."),
        ([], "."),
    ],
)
def test_what_is_no_polygon_is_an_error(polygon, match):
    with pytest.raises(crofton.Error, match=match):
        crofton.triangulate(polygon)


def test_an_unknown_method_is_named():
    with pytest.raises(crofton.Error, match="delaunay"):
        crofton.triangulate(square, "fan")


def test_progress_cancels(random):
    angle = np.linspace(0, 2 * np.pi, 3000, endpoint=False)
    ring = np.column_stack([np.cos(angle), np.sin(angle)])
    with pytest.raises(crofton.Error) as raised:
        crofton.triangulate(ring, progress=lambda share, whole: False)
    assert raised.value.code == "cancelled"


def test_a_limit_of_work_gives_a_gap():
    angle = np.linspace(0, 2 * np.pi, 400, endpoint=False)
    ring = np.column_stack([np.cos(angle), np.sin(angle)])
    t = crofton.triangulate(ring, work=1000)
    assert not t.optimal and t.gap > 0
    assert len(t.triangles) == 398


@pytest.mark.parametrize("size", [50, 400])
def test_the_picture_is_well_formed(size):
    root = ElementTree.fromstring(crofton.triangulate([square, hole]).to_svg(size))
    assert root.tag.endswith("svg")
    assert float(root.get("width")) == pytest.approx(size, abs=1)
    paths = [child.get("d") for child in root]
    assert paths[0].count("M") == 8 and paths[1].count("M") == 2


def test_notebooks_show_it():
    assert crofton.triangulate(square)._repr_svg_().startswith("<svg")


def test_patches_of_a_mesh_become_lighter():
    positions = np.array([[0, 0, 0], [5, -1, 0], [10, 0, 0], [5, 1, 0]], dtype="f4")
    indices, summary = crofton.retriangulate_planar_patches(positions, [[0, 1, 2], [0, 2, 3]])
    assert summary["improved"] == 1
    assert (summary["weight_before"], summary["weight_after"]) == (10.0, 2.0)
    assert {frozenset(t) for t in indices.tolist()} == {frozenset({0, 1, 3}), frozenset({1, 2, 3})}


def test_a_mesh_with_a_bad_index_is_an_error():
    with pytest.raises(crofton.Error):
        crofton.retriangulate_planar_patches(np.eye(3), [0, 1, 7])
