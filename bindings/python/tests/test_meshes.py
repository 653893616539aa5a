# SPDX-License-Identifier: MIT
import json
import math
import struct
import warnings

import numpy as np
import pytest

import crofton


@pytest.fixture
def cube_mesh(cube):
    return crofton.Mesh(*cube, name="cube")


def at(x, y, z):
    matrix = np.eye(4)
    matrix[:3, 3] = x, y, z
    return matrix


def turned(angle):
    c, s = math.cos(angle), math.sin(angle)
    return np.array([[c, -s, 0, 0], [s, c, 0, 0], [0, 0, 1, 0], [0, 0, 0, 1.0]])


def write_obj(path, corners, indices, name="cube"):
    lines = [f"o {name}"] + [f"v {x} {y} {z}" for x, y, z in corners]
    lines += [f"f {a + 1} {b + 1} {c + 1}" for a, b, c in np.reshape(indices, (-1, 3))]
    path.write_text("\n".join(lines) + "\n")
    return path


def test_a_mesh_gives_back_its_arrays_which_cannot_be_written(cube, cube_mesh):
    assert np.array_equal(cube_mesh.positions, cube[0])
    assert np.array_equal(cube_mesh.indices, cube[1].reshape(-1, 3))
    assert cube_mesh.colors is None and cube_mesh.name == "cube"
    with pytest.raises(ValueError):
        cube_mesh.positions[0] = 7
    positions = cube_mesh.positions
    del cube_mesh
    assert np.array_equal(positions, cube[0])


def test_what_a_cube_measures(cube_mesh):
    assert np.array_equal(cube_mesh.bounds, [[-1, -1, -1], [1, 1, 1]])
    assert cube_mesh.area == 24 and cube_mesh.is_closed
    assert not crofton.Mesh([[0, 0, 0], [1, 0, 0], [0, 1, 0]]).is_closed


def test_the_box_of_a_turned_cube_is_placed_by_its_matrix(cube_mesh):
    placed = cube_mesh.transformed(at(5, 6, 7) @ turned(0.3) @ np.diag([3, 2, 1, 1]))
    box = placed.fit_box()
    assert sorted(box.extents) == pytest.approx([2, 4, 6], rel=1e-5)
    assert box.matrix[:3, 3] == pytest.approx([5, 6, 7])
    assert box.matrix[:3, :3] @ box.matrix[:3, :3].T == pytest.approx(np.eye(3), abs=1e-6)
    signs = np.array([[x, y, z, 1] for x in (-1, 1) for y in (-1, 1) for z in (-1, 1)])
    corners = (box.matrix @ (signs * [*(box.extents / 2), 1]).T).T[:, :3]
    for corner in corners:
        assert np.min(np.linalg.norm(placed.positions - corner, axis=1)) < 1e-4
    assert all(box.contains(p) for p in placed.positions)


def test_the_hull_of_a_cube_with_points_inside_is_the_cube(cube, random):
    corners = np.concatenate([random.uniform(-0.9, 0.9, (100, 3)), cube[0]])
    hull = crofton.Mesh(corners, cube[1] + 100).hull()
    assert len(hull.positions) == 8 and len(hull.indices) == 12
    assert hull.area == pytest.approx(24) and hull.is_closed


@pytest.mark.parametrize("gap", [-0.5, 0.0, 0.25, 3.0])
def test_two_cubes_touch_iff_their_gap_is_not_positive(cube_mesh, gap):
    pose = at(2 + gap, 0.3, -0.2)
    assert cube_mesh.touches(cube_mesh, pose) == (gap <= 0)
    found = cube_mesh.distance(cube_mesh, pose)
    assert float(found) == found.distance == pytest.approx(max(gap, 0.0))
    assert math.dist(found.on_a, found.on_b) == pytest.approx(found.distance)
    assert (len(cube_mesh.contacts(cube_mesh, pose)) > 0) == (gap <= 0)


def test_a_cube_within_another_touches_it_though_their_surfaces_are_apart(cube_mesh):
    small = cube_mesh.transformed(np.diag([0.5, 0.5, 0.5, 1]))
    assert cube_mesh.touches(small) and small.touches(cube_mesh)
    assert cube_mesh.distance(small).distance == pytest.approx(0.5)
    assert len(cube_mesh.contacts(small)) == 0


def test_contacts_lie_on_both_surfaces(cube_mesh):
    for contact in cube_mesh.contacts(cube_mesh, at(1.5, 0.5, 0.25)):
        for end in ("begin", "end"):
            assert max(abs(contact[end])) == pytest.approx(1)
            assert max(abs(contact[end] - [1.5, 0.5, 0.25])) == pytest.approx(1)
        assert np.linalg.norm(contact["normal"]) == pytest.approx(1)


def test_which_points_lie_within_a_cube(cube_mesh, random):
    points = random.uniform(-2, 2, (1000, 3))
    assert np.array_equal(cube_mesh.contains(points), np.max(np.abs(points), axis=1) <= 1)
    assert cube_mesh.contains([0, 0, 0])[0] and not cube_mesh.contains((0, 0, 1.5))[0]


def test_rays_meet_a_cube_where_the_formula_says(cube_mesh):
    hit = cube_mesh.raycast((0.2, 0.3, 5), (0, 0, -2))
    assert hit.t == 2 and hit.point == (0.2, 0.3, 1) and hit.normal == (0, 0, 1)
    assert cube_mesh.raycast((0.2, 0.3, 5), (0, 0, 1)) is None
    assert cube_mesh.raycast((0.2, 0.3, 5), (0, 0, -2), 1.9) is None
    many = cube_mesh.raycast_many([[0.2, 0.3, 5], [9, 9, 9]], [[0, 0, -2], [0, 0, -2]])
    assert list(many["hit"]) == [1, 0] and many["t"][0] == 2 and math.isinf(many["t"][1])
    assert many["triangle"][0] == hit.triangle


def test_a_mirror_keeps_the_outside_outside(cube_mesh):
    mirrored = cube_mesh.transformed(np.diag([-1, 1, 1, 1]))
    p = mirrored.positions[mirrored.indices].astype("f8")
    assert np.sum(np.cross(p[:, 0], p[:, 1]) * p[:, 2]) / 6 == pytest.approx(8)  # the signed volume


def test_a_world_takes_a_mesh(cube_mesh):
    world = crofton.World()
    world.add(mesh=world.add_mesh(cube_mesh), transform=np.eye(4))
    world.update()
    assert world.raycast((0, 0, 5), (0, 0, -1)).t == 4


@pytest.mark.parametrize(
    "arguments, code",
    [
        (([[0, 0, 0], [1, 0, 0]],), "invalid_argument"),
        (([[0, 0, 0], [1, 0, 0], [0, 1, 0]], [0, 1, 3]), "out_of_range"),
        (([[0, 0, 0], [1, 0, 0], [0, 1, 0]], [0, 1]), "invalid_argument"),
        (([[0, 0, 0], [1, 0, 0], [0, math.nan, 0]], [0, 1, 2]), "not_finite"),
        (([[0, 0, 0], [1, 0, 0], [0, 1, 0]], np.zeros((0, 3), "u4")), "empty"),
    ],
)
def test_a_mesh_that_is_none_is_refused(arguments, code):
    with pytest.raises(crofton.Error) as error:
        crofton.Mesh(*arguments)
    assert error.value.code == code


def test_a_pose_that_scales_is_refused_by_name(cube_mesh):
    with pytest.raises(crofton.Error, match="^pose: .*scale"):
        cube_mesh.touches(cube_mesh, np.diag([2, 1, 1, 1]))
    with pytest.raises(crofton.Error, match="^pose: "):
        cube_mesh.distance(cube_mesh, np.diag([-1, 1, 1, 1]))
    with pytest.raises(TypeError, match="pose"):
        cube_mesh.touches(cube_mesh, [1, 2, 3])
    with pytest.raises(crofton.Error, match="plane") as error:
        crofton.Mesh([[0, 0, 0], [1, 0, 0], [0, 1, 0]]).hull()
    assert error.value.code == "degenerate"


# Files.


def test_an_obj_file(tmp_path, cube):
    path = write_obj(tmp_path / "cube.obj", *cube)
    for source in (path, str(path), bytes(path)):
        mesh = crofton.load(source)
        assert mesh.area == 24 and mesh.is_closed
    assert len(crofton.load_all(path)) == 1


def gltf_of(corners, indices, translations):
    data = corners.astype("<f4").tobytes() + indices.astype("<u4").tobytes()
    return data, {
        "asset": {"version": "2.0"},
        "scene": 0,
        "scenes": [{"nodes": list(range(len(translations)))}],
        "nodes": [{"mesh": 0, "name": f"part {i}", "translation": t} for i, t in enumerate(translations)],
        "meshes": [{"primitives": [{"attributes": {"POSITION": 0}, "indices": 1}]}],
        "accessors": [
            {"bufferView": 0, "componentType": 5126, "count": len(corners), "type": "VEC3",
             "min": corners.min(axis=0).tolist(), "max": corners.max(axis=0).tolist()},
            {"bufferView": 1, "componentType": 5125, "count": len(indices), "type": "SCALAR"},
        ],
        "bufferViews": [{"buffer": 0, "byteLength": corners.size * 4},
                        {"buffer": 0, "byteOffset": corners.size * 4, "byteLength": indices.size * 4}],
        "buffers": [{"byteLength": len(data)}],
    }


def test_a_glb_file_has_its_objects_placed_and_named(tmp_path, cube):
    data, document = gltf_of(*cube, [[0, 0, 0], [10, 0, 0]])
    text = json.dumps(document).encode()
    text += b" " * (-len(text) % 4)
    chunks = struct.pack("<II", len(text), 0x4E4F534A) + text + struct.pack("<II", len(data), 0x004E4942) + data
    path = tmp_path / "two.glb"
    path.write_bytes(struct.pack("<III", 0x46546C67, 2, 12 + len(chunks)) + chunks)
    meshes = crofton.load_all(path)
    assert [m.name for m in meshes] == ["part 0", "part 1"]
    assert np.array_equal(meshes[1].bounds, [[9, -1, -1], [11, 1, 1]])
    whole = crofton.load(path)
    assert whole.area == 48 and np.array_equal(whole.bounds, [[-1, -1, -1], [11, 1, 1]])


def test_geojson_as_a_dict_and_as_a_file(tmp_path):
    square = [[0, 0], [4, 0], [4, 4], [0, 4], [0, 0]]
    hole = [[1, 1], [2, 1], [2, 2], [1, 2], [1, 1]]
    data = {
        "type": "FeatureCollection",
        "features": [
            {"type": "Feature", "properties": {"name": "lake"}, "geometry": {"type": "Polygon", "coordinates": [square, hole]}},
            {"type": "Feature", "properties": None,
             "geometry": {"type": "MultiPolygon", "coordinates": [[square], [[[p[0] + 9, p[1]] for p in square]]]}},
            {"type": "Feature", "properties": {}, "geometry": {"type": "Point", "coordinates": [1, 2]}},
            {"type": "Feature", "properties": {}, "geometry": None},
        ],
    }
    meshes = crofton.load_all(data)
    assert [m.name for m in meshes] == ["lake", "", ""]
    assert [m.area for m in meshes] == [15, 16, 16]
    path = tmp_path / "map.geojson"
    path.write_text(json.dumps(data))
    assert crofton.load(path).area == 47


def test_a_mesh_too_far_out_for_floats_is_told_of(tmp_path):
    path = tmp_path / "survey.obj"
    path.write_text("v 500000 5400000 0\nv 500002 5400000 0\nv 500000 5400002 1\nf 1 2 3\n")
    with pytest.warns(UserWarning, match=r"survey.obj: mesh 0 .* rounded to 0.5; move"):
        crofton.load(path)
    ring = [[500000, 5400000], [500002, 5400000], [500000, 5400002], [500000, 5400000]]
    with pytest.warns(UserWarning, match="GeoJSON: mesh 0 .* rounded to 0.5"):
        crofton.load({"type": "Polygon", "coordinates": [ring]})
    path.write_text("v 500000 5400000 0\nv 900000 5400000 0\nv 500000 5800000 1\nf 1 2 3\n")
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        crofton.load(path)



@pytest.mark.parametrize(
    "data, text",
    [
        ({}, "type"),
        ({"type": "Polygon"}, "coordinates"),
        ({"type": "Polygon", "coordinates": []}, "rings"),
        ({"type": "Polygon", "coordinates": [[[0, 0], [1, 1], [0, 0]]]}, "four positions"),
        ({"type": "Polygon", "coordinates": [[[0, 0], [1, 0], "x", [0, 0]]]}, "two or three numbers"),
        ({"type": "Polygon", "coordinates": [[[0, 0], [1, 0], [1, "x"], [0, 0]]]}, "polygon 0"),
        ({"type": "Polygon", "coordinates": [[[0, 0], [1, 0], [1, math.nan], [0, 0]]]}, "polygon 0"),
        ({"type": "FeatureCollection", "features": {}}, "features"),
        ({"type": "Sphere"}, "Sphere"),
        ({"type": "Point", "coordinates": [0, 0]}, "no Polygon"),
    ],
)
def test_geojson_that_is_none_is_refused_by_name(data, text):
    with pytest.raises(crofton.Error, match=text):
        crofton.load(data)


@pytest.mark.parametrize(
    "name, content, text",
    [
        ("gone.obj", None, "gone.obj"),
        ("empty.obj", b"", "empty"),
        ("points.obj", b"v 0 0 0\nv 1 0 0\n", "points.obj"),
        ("bad.glb", b"glTF" + bytes(20), "bad.glb"),
        ("bad.gltf", b"{", "bad.gltf"),
        ("bad.geojson", b"[1,", "no JSON"),
        ("list.json", b"[1]", "GeoJSON object"),
        ("bytes.json", b"\xff\xfe", "bytes.json"),
        ("mesh.stl", b"solid", "stl"),
    ],
)
def test_a_file_that_cannot_be_read_is_named(tmp_path, name, content, text):
    if content is not None:
        (tmp_path / name).write_bytes(content)
    with pytest.raises(crofton.Error, match=text) as error:
        crofton.load(tmp_path / name)
    assert error.value.code
    with pytest.raises(TypeError):
        crofton.load(7.5)


# Pictures.


def test_a_picture_is_a_page_of_its_own(tmp_path, cube_mesh):
    picture = cube_mesh.show(cube_mesh.fit_box())
    assert "<iframe" in picture._repr_html_() and repr(picture) == "Picture(cube)"
    picture.save(tmp_path / "cube.html")
    text = (tmp_path / "cube.html").read_text()
    assert text.count("</script>") == 1 and "http" not in text
    assert "</script><b>" not in crofton.Picture(cube_mesh, title="</script><b>").to_html()
    with pytest.raises(TypeError, match="things"):
        crofton.Picture(7)
    with pytest.raises(ValueError, match="nothing"):
        crofton.Picture([])
