# SPDX-License-Identifier: MIT
import itertools

import numpy as np
import pytest

import crofton

FAR = {"reversed_zero_to_one": 0.0, "zero_to_one": 1.0, "minus_one_to_one": 1.0}
NEAR = {"reversed_zero_to_one": 1.0, "zero_to_one": 0.0, "minus_one_to_one": -1.0}


def projection(depth="reversed_zero_to_one", near=0.1, far=100.0, aspect=16 / 9):
    """60 degrees, along -z: z / w is NEAR at `near` and FAR at `far`."""
    f = 1 / np.tan(np.pi / 6)
    a = (FAR[depth] * far - NEAR[depth] * near) / (near - far)
    b = near * NEAR[depth] + near * a
    return np.array([[f / aspect, 0, 0, 0], [0, f, 0, 0], [0, 0, a, b], [0, 0, -1, 0]])


def at(x, y, z):
    place = np.eye(4)
    place[:3, 3] = x, y, z
    return place


def wall(n, half):
    """n × n squares over [-half, half]² of the plane z = 0, seen from +z."""
    side = np.linspace(-half, half, n + 1)
    positions = np.array([(x, y, 0.0) for y in side for x in side])
    corner = np.add.outer(np.arange(n) * (n + 1), np.arange(n)).ravel()
    indices = np.stack([corner, corner + 1, corner + n + 2, corner, corner + n + 2, corner + n + 1], axis=1)
    return positions, indices.reshape(-1, 3)


def listed(found, objects):
    """The triangles of each object that are listed, ascending."""
    result = [[] for _ in objects]
    for which, cluster, bits in zip(*found):
        mesh = objects[which].mesh
        first = mesh.clusters[cluster]["first_triangle"]
        result[which] += [int(mesh.triangle_order[first + k]) for k in range(64) if int(bits) >> k & 1]
    return [sorted(triangles) for triangles in result]


@pytest.mark.parametrize("most", [0, 1, 7, 64])
def test_clusters_share_out_the_triangles_and_hold_them(most):
    positions, indices = wall(20, 3.0)
    mesh = crofton.ClusteredMesh(positions, indices, max_triangles=most)
    assert sorted(mesh.triangle_order) == list(range(800))
    assert len(mesh) == len(mesh.clusters)
    ends = np.cumsum(mesh.clusters["triangle_count"])
    assert (mesh.clusters["first_triangle"] == ends - mesh.clusters["triangle_count"]).all() and ends[-1] == 800
    assert mesh.clusters["triangle_count"].max() <= (most or 16)
    permuted = indices[mesh.triangle_order]
    for cluster in mesh.clusters:
        first, count = int(cluster["first_triangle"]), int(cluster["triangle_count"])
        points = positions[permuted[first:first + count]].reshape(-1, 3).astype("f4")
        assert (abs(points - cluster["center"].astype("f8")) <= abs(cluster["half_edges"].astype("f8")).sum(axis=0)).all()


def test_arrays_that_are_lent_are_read_in_place():
    positions, indices = wall(20, 3.0)
    positions, indices = positions.astype("f4"), indices.astype("u4")
    mesh, original = crofton.ClusteredMesh(positions, indices), crofton.ClusteredMesh(positions, indices)
    permuted = indices[mesh.triangle_order]
    with pytest.raises(ValueError, match="positions must be .* cannot be written"):
        mesh.lend(positions, permuted)
    for array in (positions, indices, permuted):
        array.flags.writeable = False
    with pytest.raises(ValueError, match="indices must be"):
        mesh.lend(positions, permuted.astype("i8"))
    with pytest.raises(crofton.Error, match="corner elsewhere"):
        mesh.lend(positions, indices)
    expected = [crofton.ClusteredMesh(positions, indices).clusters[name].tolist() for name in ("first_triangle", "center")]
    order = list(mesh.triangle_order)
    mesh.lend(positions, permuted)
    original.lend(positions, indices, permuted=False)
    assert len(mesh.triangle_order) == 0 and list(original.triangle_order) == order
    to_clip = np.diag([0.2, 0.2, 0.1, 1.0])
    del positions, indices, permuted
    found = []
    for lent in (mesh, original):
        assert [lent.clusters[name].tolist() for name in ("first_triangle", "center")] == expected
        culler = crofton.DepthCuller()
        found.append(culler.find_visible([crofton.DepthObject(lent, to_clip)], 320, 180))
    assert all(np.array_equal(of_mesh, of_original) for of_mesh, of_original in zip(*found))


def test_flat_indices_and_floats_give_the_same_clusters():
    positions, indices = wall(9, 1.0)
    expected = crofton.ClusteredMesh(positions, indices)
    for points, corners in itertools.product([positions.astype("f4"), positions.tolist()], [indices.ravel(), indices.tolist()]):
        if isinstance(corners, list):
            corners = [corner for triangle in corners for corner in triangle]
        mesh = crofton.ClusteredMesh(points, corners)
        assert (mesh.triangle_order == expected.triangle_order).all()
        assert (mesh.clusters == expected.clusters).all()


@pytest.mark.parametrize("depth", FAR)
def test_a_wall_hides_what_is_behind_it(depth):
    front, behind = crofton.ClusteredMesh(*wall(10, 4.0)), crofton.ClusteredMesh(*wall(4, 1.0))
    view = projection(depth)
    objects = [crofton.DepthObject(front, view @ at(0, 0, -5)), crofton.DepthObject(behind, view @ at(0, 0, -10))]
    culler = crofton.DepthCuller()
    found = culler.find_visible(objects, 320, 180, depth=depth)
    assert [array.dtype for array in found] == [np.uint32, np.uint32, np.uint64]
    in_front, hidden = listed(found, objects)
    assert in_front and not hidden
    assert culler.statistics["objects_asked"] == 2 and culler.statistics["objects_listed"] == 1
    assert culler.statistics["triangles_listed"] == len(in_front)

    def nearness_at(z):
        clip = view @ (0, 0, z, 1)
        return clip[2] / clip[3] * (1 if depth.startswith("reversed") else -1)

    assert culler.nearness.shape == (180, 320) and culler.nearness.dtype == np.float32
    assert nearness_at(-5.05) <= culler.nearness[90, 160] <= nearness_at(-5) + 1e-6

    objects[0].hides = False
    assert len(listed(culler.find_visible(objects, 320, 180, depth=depth), objects)[1]) == 32
    objects[0].hides, objects[0].position_error = True, 100.0
    assert len(listed(culler.find_visible(objects, 320, 180, depth=depth), objects)[1]) == 32
    objects[0].position_error = 0.0
    objects[0].to_clip = view @ at(0, 0, -5) @ np.diag([-1.0, 1, -1, 1])  # turned
    assert not listed(culler.find_visible(objects, 320, 180, depth=depth), objects)[1]
    objects[0].one_sided = True
    in_front, hidden = listed(culler.find_visible(iter(objects), 320, 180, depth=depth), objects)
    assert not in_front and len(hidden) == 32


@pytest.mark.parametrize("seed", range(4))
def test_triangles_whose_pixel_centres_they_own_are_listed(seed):
    """Rays through pixel centres against all triangles, in doubles: who is nearest by a margin must be listed."""
    random = np.random.default_rng(seed)
    width, height = 48, 27
    view = projection()
    cube = np.array([[x, y, z] for z in (-1, 1) for y in (-1, 1) for x in (-1, 1)], "f4")
    faces = np.array([0, 2, 3, 0, 3, 1, 4, 5, 7, 4, 7, 6, 0, 1, 5, 0, 5, 4, 2, 6, 7, 2, 7, 3, 0, 4, 6, 0, 6, 2, 1, 3, 7, 1, 7, 5])
    mesh = crofton.ClusteredMesh(cube, faces, 5)
    objects, corners = [], []
    for _ in range(40):
        z = random.uniform(-25, -4)
        matrix = view @ at(random.uniform(-0.8, 0.8) * z, random.uniform(-0.5, 0.5) * z, z) @ np.diag([*random.uniform(0.2, 2, 3), 1])
        objects.append(crofton.DepthObject(mesh, matrix, one_sided=bool(random.integers(2))))
        clip = np.column_stack([cube, np.ones(8)]) @ objects[-1].to_clip.astype("f8").T
        corners.append((clip[:, :3] / clip[:, 3:])[faces.reshape(-1, 3)])
    found = listed(crofton.DepthCuller().find_visible(objects, width, height), objects)
    x, y = np.meshgrid((np.arange(width) + 0.5) / width * 2 - 1, (np.arange(height) + 0.5) / height * 2 - 1)
    nearest, second, owner = np.zeros((height, width)), np.zeros((height, width)), np.full((height, width, 2), -1)
    for which, triangles in enumerate(corners):
        for number, (a, b, c) in enumerate(triangles):
            area = (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])
            if abs(area) < 1e-12 or (area < 0 and objects[which].one_sided):
                continue
            u = ((x - a[0]) * (c[1] - a[1]) - (y - a[1]) * (c[0] - a[0])) / area
            v = ((b[0] - a[0]) * (y - a[1]) - (b[1] - a[1]) * (x - a[0])) / area
            inside = (u > 1e-2) & (v > 1e-2) & (u + v < 1 - 1e-2)
            depth = np.where(inside, a[2] + u * (b[2] - a[2]) + v * (c[2] - a[2]), 0.0)
            touches = (u > -1e-2) & (v > -1e-2) & (u + v < 1 + 1e-2)
            outer = np.where(touches, a[2] + u * (b[2] - a[2]) + v * (c[2] - a[2]), 0.0)
            wins = depth > nearest
            second = np.where(wins, np.maximum(second, nearest), np.maximum(second, outer))
            owner[wins] = which, number
            nearest = np.maximum(nearest, depth)
    sure = nearest > second + 1e-4
    assert sure.sum() > 100
    assert all(triangle in found[which] for which, triangle in {tuple(o) for o in owner[sure]})
    assert sum(map(len, found)) < 40 * 12


def test_no_objects_list_nothing():
    culler = crofton.DepthCuller()
    assert culler.nearness.shape == (0, 0)
    assert [len(array) for array in culler.find_visible([], 4, 3)] == [0, 0, 0]
    assert (culler.nearness == -np.inf).all() and culler.nearness.shape == (3, 4)


def test_a_matrix_that_is_not_finite_lists_its_object_whole():
    mesh = crofton.ClusteredMesh(*wall(4, 1.0))
    matrix = projection() @ at(0, 0, -5)
    matrix[1, 1] = np.nan
    objects = [crofton.DepthObject(mesh, matrix)]
    assert len(listed(crofton.DepthCuller().find_visible(objects, 64, 36), objects)[0]) == 32


def test_an_object_keeps_its_mesh_and_its_matrix():
    matrix = projection() @ at(0, 0, -5)
    thing = crofton.DepthObject(crofton.ClusteredMesh(*wall(4, 1.0)), matrix)
    matrix[:] = 0
    assert thing.to_clip.dtype == np.float32 and thing.to_clip[3, 2] == -1
    assert len(crofton.DepthCuller().find_visible([thing], 64, 36)[0]) > 0
    assert thing.mesh is thing.mesh and (thing.one_sided, thing.hides, thing.position_error) == (False, True, 0.0)


@pytest.mark.parametrize(
    "change, code, item, says",
    [(lambda p, i: p.__setitem__((3, 1), np.nan), "not_finite", 3, "^positions: "),
     (lambda p, i: p.__setitem__((4, 0), 1e300), "not_finite", 4, "^positions: "),
     (lambda p, i: i.__setitem__((2, 1), 25), "out_of_range", 7, "^indices: ")],
)
def test_a_bad_mesh_names_its_row(change, code, item, says):
    positions, indices = wall(4, 1.0)
    change(positions, indices)
    with pytest.raises(crofton.Error, match=says) as raised:
        crofton.ClusteredMesh(positions, indices)
    assert (raised.value.code, raised.value.item) == (code, item)


@pytest.mark.parametrize(
    "indices, most, code, says",
    [([], 0, "empty", "^indices: "), ([0, 1, 2, 3], 0, "invalid_argument", "^indices: "),
     ([0, 1, 2], 65, "invalid_argument", "^max_triangles is 65")],
)
def test_bad_counts_are_an_error(indices, most, code, says):
    with pytest.raises(crofton.Error, match=says) as raised:
        crofton.ClusteredMesh(wall(4, 1.0)[0], indices, most)
    assert raised.value.code == code


@pytest.mark.parametrize("width, height", [(0, 9), (9, 0), (16385, 9), (9, 2**32 - 1)])
def test_a_picture_without_pixels_or_with_too_many_is_an_error(width, height):
    with pytest.raises(crofton.Error, match="^picture: ") as raised:
        crofton.DepthCuller().find_visible([], width, height)
    assert raised.value.code == "out_of_range"


def test_a_depth_range_that_is_none_is_an_error():
    with pytest.raises(crofton.Error, match="^depth: .*'zero_to_one'"):
        crofton.DepthCuller().find_visible([], 9, 9, depth="reversed")


@pytest.mark.parametrize("call, says", [
    (lambda m: crofton.ClusteredMesh(np.zeros((4, 2)), [0, 1, 2]), "^positions: "),
    (lambda m: crofton.ClusteredMesh(np.zeros((4, 3)), [0.5, 1, 2]), "^indices: "),
    (lambda m: crofton.ClusteredMesh(np.zeros((4, 3)), [0, 1, 2], -1), "^max_triangles: "),
    (lambda m: crofton.DepthObject(None, np.eye(4)), "^mesh: "),
    (lambda m: crofton.DepthObject(m, np.eye(3)), "^to_clip: "),
    (lambda m: crofton.DepthObject(m, np.eye(4), position_error="far"), "^position_error: "),
    (lambda m: setattr(crofton.DepthObject(m, np.eye(4)), "to_clip", 5), "^to_clip: "),
    (lambda m: crofton.DepthCuller().find_visible(5, 9, 9), "^objects: "),
    (lambda m: crofton.DepthCuller().find_visible([m], 9, 9), "^objects: "),
    (lambda m: crofton.DepthCuller().find_visible([], 9.5, 9), "^width: "),
    (lambda m: crofton.DepthCuller().find_visible([], 9, -9), "^height: "),
])
def test_what_is_no_mesh_object_or_size_is_a_type_error(call, says):
    with pytest.raises(TypeError, match=says):
        call(crofton.ClusteredMesh(*wall(4, 1.0)))


def square_at(x, z, mesh):
    """A square of 6 by 6 at (x, 0, z), seen at 90 degrees with reversed depth to infinity."""
    return crofton.DepthObject(mesh, [[1, 0, 0, x], [0, 1, 0, 0], [0, 0, 0, 1], [0, 0, -1, -z]])


def test_a_shadow_map_needs_what_throws_shadows_on_what_is_seen():
    mesh = crofton.ClusteredMesh(*wall(1, 3.0))
    camera, light = crofton.DepthCuller(), crofton.DepthCuller()
    # The light is where the camera is: of two casters, one is before the wall that the camera sees, and one beside it.
    seen = square_at(0, -20, mesh)
    assert len(camera.find_visible([seen], 160, 90)[0]) == 1
    casters = [square_at(0, -10, mesh), square_at(30, -35, mesh)]
    assert light.find_visible(casters, 256, 256)[0].tolist() == [0, 1]
    receivers = [crofton.DepthReceiver(mesh, seen.to_clip)]
    assert repr(receivers) == "[DepthReceiver(2 triangles)]"
    found = light.find_casters(casters, 256, 256, camera, receivers)
    assert listed(found, casters) == [[0, 1], []]
    assert light.statistics["objects_listed"] == 1 and light.nearness.shape == (256, 256)

    def refused(item=None, **given):
        how = {"objects": casters, "width": 256, "height": 256, "seen": camera, "receivers": receivers, **given}
        with pytest.raises(crofton.Error) as error:
            light.find_casters(**how)
        assert error.value.code in ("invalid_argument", "out_of_range") and error.value.item == item
        return str(error.value)

    other = crofton.ClusteredMesh(*wall(1, 3.0))
    refused(receivers=[crofton.DepthReceiver(other, seen.to_clip)], item=0)
    refused(receivers=[crofton.DepthReceiver(None, seen.to_clip)], item=0)
    refused(receivers=[])
    assert "radius" in refused(radius=0.0)
    assert "another DepthCuller" in refused(seen=light)
    refused(width=0)
    for wrong in ({"receivers": [seen]}, {"receivers": 3}, {"seen": None}, {"objects": receivers}):
        with pytest.raises(TypeError):
            light.find_casters(**{"objects": casters, "width": 9, "height": 9, "seen": camera, "receivers": receivers, **wrong})
    with pytest.raises(TypeError):
        crofton.DepthReceiver(mesh, np.eye(3))
    assert listed(light.find_casters(casters, 256, 256, camera, receivers), casters) == [[0, 1], []]


def test_pixels_have_one_sample_or_several():
    mesh, culler = crofton.ClusteredMesh(*wall(1, 3.0)), crofton.DepthCuller()
    for samples in (1, 2, 4, 8):
        assert len(culler.find_visible([square_at(0, -9, mesh)], 160, 90, samples=samples)[0]) == 1
    with pytest.raises(crofton.Error, match="samples"):
        culler.find_visible([], 160, 90, samples=3)


def test_clusters_are_stored_and_read_again():
    mesh = crofton.ClusteredMesh(*wall(20, 3.0))
    stored = crofton.ClusteredMesh.from_bytes(mesh.to_bytes())
    assert (stored.clusters == mesh.clusters).all() and (stored.triangle_order == mesh.triangle_order).all()
    for wrong in (b"", mesh.to_bytes()[:-1], mesh.to_bytes()[4:]):
        with pytest.raises(crofton.Error) as error:
            crofton.ClusteredMesh.from_bytes(wrong)
        assert error.value.code == "parse"
    with pytest.raises(TypeError):
        crofton.ClusteredMesh.from_bytes("text")
