# SPDX-License-Identifier: MIT
"""What World.view is asked for is obeyed, alone and in a list, or refused by name."""

import gc

import numpy as np
import pytest

import crofton


def at(x, y, z):
    matrix = np.eye(4)
    matrix[:3, 3] = (x, y, z)
    return matrix


def to_clip(near=0.1, far=1000.0, aspect=16 / 9):
    """60 degrees, along -z, reversed depth: a Camera() as a matrix."""
    f = 1 / np.tan(np.pi / 6)
    a, b = near / (far - near), far * near / (far - near)
    return np.array([[f / aspect, 0, 0, 0], [0, f, 0, 0], [0, 0, a, b], [0, 0, -1, 0]])


@pytest.fixture
def town(cube):
    """A wall of one mesh; behind and before it cubes in a row; boxes of three sizes beside it."""
    world = crofton.World(pairs=False)
    wall = world.add_mesh(cube[0] * [4, 4, 0.1], cube[1], occluders=True, clusters=True)
    block = world.add_mesh(*cube, clusters=True)
    things = {"wall": world.add(mesh=wall, transform=at(0, 0, -10), layers=1)}
    for name, z in (("front", -6), ("hidden", -20), ("far", -300)):
        things[name] = world.add(mesh=block, transform=at(0, 0, z), layers=2)
    for name, half in (("small", 0.01), ("middle", 0.5), ("large", 2.0)):
        things[name] = world.add(box=crofton.Box((-15, 0, -30), (half,) * 3), layers=4)
    things["behind the eye"] = world.add(box=crofton.Box((0, 0, 50), (1, 1, 1)))
    # So many come at once that all count as resting: candidates never leave out what may move.
    world.add_boxes(crofton.boxes(np.full((100, 3), 1e5), 1))
    world.update()
    return world, {name: handle.index for name, handle in things.items()}, {"wall": wall, "block": block}


def names(town, ids):
    return {name for name, index in town[1].items() if index in set(np.asarray(ids).tolist())}


EVERYTHING = {"wall", "front", "hidden", "far", "small", "middle", "large"}


def limits(**more):
    return crofton.DrawLimits((0, 0, 0), **more)


def only(town, *wanted):
    mask = np.zeros(len(town[1]), dtype=bool)
    mask[[town[1][name] for name in wanted]] = True
    return mask


# What is asked beside the camera, and what is seen then.
CASES = {
    "nothing": (lambda t: {}, EVERYTHING),
    "layers": (lambda t: {"layers": 3}, {"wall", "front", "hidden", "far"}),
    "occlusion": (lambda t: {"occlusion": True}, EVERYTHING - {"hidden", "far"}),
    "occlusion and layers": (lambda t: {"occlusion": True, "layers": 6}, EVERYTHING - {"wall"}),
    "occlusion and limits": (
        lambda t: {"occlusion": True, "limits": limits(least_radius=0.1)}, {"wall", "front", "middle", "large"}),
    "list of what is occluded": (
        lambda t: {"occlusion": crofton.OcclusionOptions(list_occluded=True)}, EVERYTHING - {"hidden", "far"}),
    "no occluders": (lambda t: {"occlusion": crofton.OcclusionOptions(max_occluders=0)}, EVERYTHING),
    "cover": (lambda t: {"occlusion": crofton.OcclusionOptions(least_cover=0.9)}, EVERYTHING),
    "no occlusion": (lambda t: {"occlusion": False}, EVERYTHING),
    "picture": (lambda t: {"picture": crofton.PictureView(160, 90)}, EVERYTHING - {"hidden", "far", "small"}),
    "picture and limits": (
        lambda t: {"picture": crofton.PictureView(160, 90), "limits": limits(least_radius=2.0)}, {"wall", "large"}),
    "least radius": (lambda t: {"limits": limits(least_radius=1.0)}, EVERYTHING - {"small", "middle"}),
    "distance in radii": (lambda t: {"limits": limits(max_distance_in_radii=30.0)}, {"wall", "front", "hidden", "large"}),
    "layers' distances": (
        lambda t: {"limits": limits(layer_distances=[np.inf, 100.0, np.inf] + [np.inf] * 29)}, EVERYTHING - {"far"}),
    "objects' distances": (
        lambda t: {"limits": limits(item_distances=np.where(only(t, "front"), 1.0, np.inf))}, EVERYTHING - {"front"}),
    "hysteresis": (
        lambda t: {"limits": limits(least_radius=1.0, drawn_before=only(t, "middle"), hysteresis=3.0)},
        EVERYTHING - {"small"}),
    "candidates": (lambda t: {"candidates": only(t, "far", "small", "behind the eye")}, {"far", "small"}),
    "candidates and occlusion": (
        lambda t: {"candidates": only(t, "far", "small", "front"), "occlusion": True}, {"small", "front"}),
    "few candidates": (lambda t: {"candidates": np.zeros(2, dtype=bool)}, None),
    "conservative": (lambda t: {"conservative": True}, EVERYTHING),
}


@pytest.mark.parametrize("order", [None, "ascending", "tree"])
@pytest.mark.parametrize("case", CASES)
@pytest.mark.parametrize("eye", ["camera", "matrix", "float matrix", "matrix with an origin"])
def test_what_is_asked_is_obeyed_in_every_form(town, case, order, eye):
    make, expected = CASES[case]
    options = make(town)
    if expected is None:  # beyond the array's end everything may be seen
        expected = {name for name in EVERYTHING if town[1][name] >= 2}
    if order:
        options["order"] = order
    if eye == "camera":
        options["camera"] = crofton.Camera()
    elif eye == "matrix with an origin":
        options["matrix"] = crofton.ViewMatrix(to_clip() @ at(5, 6, 7), origin=(5, 6, 7))
    else:
        options["matrix"] = to_clip().astype("f4" if eye == "float matrix" else "f8")
    seen = town[0].view(**options)
    assert names(town, seen.ids) == expected
    assert names(town, seen.occluded_ids) == ({"hidden", "far"} if "list" in case else set())
    request = crofton.ViewRequest(**options)
    assert (town[0].view(request).ids == seen.ids).all()
    assert (town[0].view(request).verdicts == seen.verdicts).all()
    if order == "tree":
        assert len(seen.verdicts) == 0
    else:
        assert (np.diff(seen.ids.astype("i8")) > 0).all()
        assert seen.inside_count == (seen.verdicts == crofton.INSIDE).sum()
    other = crofton.ViewRequest(crofton.Camera(forward=(0, 0, 1)), order=order)
    for requests in ([request], [request, other], [other, request], (request, request)):
        many = town[0].view(requests)
        assert many.view_count == len(requests) and len(many) == len(many.ids) == len(many.view_masks)
        for v, one in enumerate(requests):
            ids = many.ids[many.view_masks >> v & 1 == 1]
            assert names(town, ids) == (expected if one is request else {"behind the eye"})
            triangles = many.triangles(v)
            assert (triangles == seen.triangles).all() if one is request else len(triangles) == 0
            assert many.occluders_drawn(v) == (seen.statistics["occluders_drawn"] if one is request else 0)
            assert (many.depth(v) is None) == (one is other or seen.depth is None)
            assert (many.occluded_ids(v) == (seen.occluded_ids if one is request else [])).all()
        assert (many.handles["index"] == many.ids).all() and (many.users == 0).all()


def test_a_volume_is_seen_and_may_go_beside_an_eye_with_occlusion(town):
    shadow = crofton.Camera().frustum.shadow_volume((0, 0, 1))
    assert names(town, town[0].view(volume=shadow).ids) == EVERYTHING | {"behind the eye"}
    assert names(town, town[0].view(shadow).ids) == EVERYTHING | {"behind the eye"}
    narrow = crofton.Camera(fov_y=0.1, aspect=1).frustum
    assert names(town, town[0].view(volume=narrow).ids) == {"wall", "front", "hidden", "far"}
    for options in ({"camera": crofton.Camera()}, {"matrix": to_clip()}):
        request = crofton.ViewRequest(volume=narrow, occlusion=True, **options)
        assert names(town, town[0].view(request).ids) == names(town, town[0].view([request]).ids) == {"wall", "front"}


def test_a_picture_lists_the_triangles_that_the_depth_culler_lists(town, cube):
    world, indices, meshes = town
    camera = crofton.Camera()
    seen = world.view(camera, picture=crofton.PictureView(160, 90), layers=3)
    clip = to_clip()
    wall, block = world.clusters_of(meshes["wall"]), world.clusters_of(meshes["block"])
    objects = [crofton.DepthObject(wall, clip @ at(0, 0, -10))]
    objects += [crofton.DepthObject(block, clip @ at(0, 0, z)) for z in (-6, -20, -300)]
    index = [indices[name] for name in ("wall", "front", "hidden", "far")]
    which, cluster, bits = crofton.DepthCuller().find_visible(objects, 160, 90)
    assert seen.triangles["object"].tolist() == [index[w] for w in which]
    assert (seen.triangles["cluster"] == cluster).all() and (seen.triangles["triangles"] == bits).all()
    assert seen.statistics["triangles_listed"] == sum(bin(int(b)).count("1") for b in bits)
    assert seen.depth is None and len(seen.occluded_ids) == 0
    assert len(world.view(camera).triangles) == 0
    # One-sided: of a cube that is seen face to face two triangles.
    one_sided = world.add_mesh(*cube, clusters=True, one_sided=True)
    world.add(mesh=one_sided, transform=at(0, 0, -3))
    world.update()
    in_front = world.view(camera, picture=crofton.PictureView(160, 90)).triangles
    added = 100 + len(indices)
    assert in_front["object"].max() == added
    assert sum(bin(int(b)).count("1") for b in in_front["triangles"][in_front["object"] == added]) == 2


def test_a_light_lists_what_throws_a_shadow_on_what_the_camera_sees(town, cube):
    world, indices, meshes = town
    picture, lamp = crofton.PictureView(160, 90), crofton.Camera(position=(0, 9, -8), forward=(0, -1, -0.2))
    seen = world.view(crofton.Camera(), picture=picture)
    shadows = {"picture": crofton.PictureView(128, 128), "receivers": crofton.ShadowReceivers(seen, radius=2)}
    everything = world.view(lamp, picture=crofton.PictureView(128, 128))
    casters = world.view(lamp, **shadows)
    assert 0 < casters.statistics["triangles_listed"] <= everything.statistics["triangles_listed"]
    assert names(town, casters.ids) <= names(town, everything.ids)
    request = crofton.ViewRequest(lamp, **shadows)
    assert "receivers" in repr(request) and "radius=2" in repr(shadows["receivers"])
    assert (world.view(request).triangles == casters.triangles).all()
    assert (world.view([request, crofton.Camera()]).triangles(0) == casters.triangles).all()
    # The request holds the camera's result.
    del seen, shadows
    gc.collect()
    assert (world.view(request).triangles == casters.triangles).all()
    # A camera that looks away from all of it.
    away = world.view(crofton.Camera(forward=(0, 1, 0.01)), picture=picture)
    nothing = world.view(lamp, picture=picture, receivers=crofton.ShadowReceivers(away))
    assert len(nothing) == len(nothing.triangles) == 0
    for receivers, says in [(crofton.ShadowReceivers(away, radius=0), "radius"),
                            (crofton.ShadowReceivers(world.view(crofton.Camera())), "receivers")]:
        with pytest.raises(crofton.Error, match=says):
            world.view(lamp, picture=picture, receivers=receivers)
    with pytest.raises(crofton.Error, match="receivers.*picture"):
        world.view(lamp, receivers=crofton.ShadowReceivers(away))
    with pytest.raises(TypeError, match="^seen: "):
        crofton.ShadowReceivers(lamp)
    world.add(mesh=world.add_mesh(*cube, clusters=True), transform=at(0, 3, -8))
    world.update()
    with pytest.raises(crofton.Error, match="changed since"):
        world.view(request)


def test_meshes_without_clusters_have_none(town, cube):
    world = town[0]
    plain = world.add_mesh(*cube)
    world.update()
    assert world.clusters_of(plain) is None
    world.remove(plain)
    with pytest.raises(crofton.Error, match="mesh.*stale") as stale:
        world.clusters_of(plain)
    assert stale.value.code == "stale_handle"
    with pytest.raises(crofton.Error, match="mesh.*stale"):
        crofton.World().clusters_of(town[2]["block"])
    assert sorted(world.clusters_of(town[2]["block"]).triangle_order) == list(range(12))


@pytest.mark.parametrize("options, says", [
    ({}, "camera"),
    ({"camera": crofton.Camera(), "matrix": np.eye(4)}, "camera.*matrix"),
    ({"camera": crofton.Camera(), "volume": crofton.Camera().frustum}, "volume"),
    ({"volume": crofton.Camera().frustum, "occlusion": True}, "occlusion"),
    ({"volume": crofton.Camera().frustum, "picture": crofton.PictureView()}, "picture"),
    ({"camera": crofton.Camera(), "occlusion": True, "picture": crofton.PictureView()}, "occlusion.*picture"),
    ({"matrix": to_clip(), "picture": crofton.PictureView(depth="zero_to_one")}, "depth range"),
    ({"camera": crofton.Camera(), "picture": crofton.PictureView(0, 9)}, "pixels"),
    ({"camera": crofton.Camera(), "occlusion": crofton.OcclusionOptions(size=(0, 9))}, "buffer"),
    ({"matrix": np.zeros((4, 4))}, "."),
    ({"camera": crofton.Camera(), "order": "descending"}, "^order: .*'tree'"),
], ids=lambda o: "-".join(o) if isinstance(o, dict) else None)
def test_what_cannot_be_obeyed_is_refused_by_name(town, options, says):
    with pytest.raises(crofton.Error, match=says):
        town[0].view(**options)
    if "order" in options:
        return
    with pytest.raises(crofton.Error, match=says) as raised:
        town[0].view([crofton.ViewRequest(crofton.Camera()), crofton.ViewRequest(**options)])
    assert raised.value.item == 1


def test_views_of_one_call_have_one_order_and_are_at_most_32(town):
    camera = crofton.Camera()
    with pytest.raises(crofton.Error, match="one order"):
        town[0].view([crofton.ViewRequest(camera), crofton.ViewRequest(camera, order="tree")])
    assert town[0].view([camera] * 32).view_count == 32 and len(town[0].view([])) == 0
    with pytest.raises(crofton.Error, match="32"):
        town[0].view([camera] * 33)
    for call in ("depth", "triangles", "occluded_ids", "occluders_drawn"):
        with pytest.raises(crofton.Error, match="fewer views"):
            getattr(town[0].view([camera]), call)(1)


@pytest.mark.parametrize("options, says", [
    ({"camera": 5}, "^camera: "), ({"camera": [5]}, "^camera: "), ({"matrix": np.eye(3)}, "^matrix: "),
    ({"volume": crofton.Camera()}, "^volume: "), ({"layers": -1}, "^layers: "), ({"layers": 2**32}, "^layers: "),
    ({"occlusion": 1}, "^occlusion: "), ({"picture": (160, 90)}, "^picture: "), ({"receivers": 1}, "^receivers: "), ({"limits": 5.0}, "^limits: "),
    ({"candidates": [1, 2]}, "^candidates: "), ({"candidates": np.ones((2, 2), bool)}, "^candidates: "),
    ({"order": 5}, "^order: "), ({"conservative": 1}, "^conservative: "),
    ({"camera": crofton.ViewRequest(crofton.Camera()), "layers": 1}, "^layers: "),
    ({"camera": [crofton.Camera()], "order": "tree"}, "^order: "),
], ids=str)
def test_what_is_of_another_type_is_a_type_error(town, options, says):
    with pytest.raises(TypeError, match=says):
        town[0].view(**{"camera": crofton.Camera(), **options})


@pytest.mark.parametrize("call, error, says", [
    (lambda: limits(layer_distances=[1.0]), crofton.Error, "^layer_distances: "),
    (lambda: limits(hysteresis=0.5), crofton.Error, "^hysteresis: "),
    (lambda: limits(hysteresis=np.nan), crofton.Error, "^hysteresis: "),
    (lambda: limits(item_distances="far"), TypeError, "^item_distances: "),
    (lambda: limits(drawn_before=[3]), TypeError, "^drawn_before: "),
    (lambda: crofton.DrawLimits(5), TypeError, "^eye: "),
    (lambda: crofton.DrawLimits.of_camera(crofton.Camera(), 0, 1), crofton.Error, "."),
    (lambda: crofton.OcclusionOptions(size=5), TypeError, "^size: "),
    (lambda: crofton.PictureView(depth="reversed"), crofton.Error, "^depth: "),
    (lambda: crofton.ViewMatrix(np.eye(3)), TypeError, "^to_clip: "),
])
def test_parts_of_a_request_are_checked_when_they_are_made(call, error, says):
    with pytest.raises(error, match=says):
        call()


def test_limits_of_a_camera_leave_out_what_is_smaller_than_a_pixel(town):
    camera = crofton.Camera()
    # 720 pixels for 2 tan 30° = 1.1547 at distance 1: "small" at 33.5 has radius 0.0173 and 0.64 pixels.
    for pixels, seen in ((0.5, True), (0.9, False)):
        limited = town[0].view(camera, limits=crofton.DrawLimits.of_camera(camera, 720, pixels))
        assert ("small" in names(town, limited.ids)) == seen


def test_answers_stay_when_later_views_reuse_the_memory_of_others(town):
    camera, back = crofton.Camera(), crofton.Camera(forward=(0, 0, 1))
    kept = [town[0].view(camera) for _ in range(20)]
    ids = kept[0].ids
    del kept[1:10]
    for _ in range(30):
        town[0].view(back)
    kept.clear()
    for _ in range(30):
        assert town[0].view(back).ids.tolist() == [town[1]["behind the eye"]]
    assert names(town, ids) == EVERYTHING


def test_objects_that_moved_may_be_seen_whatever_the_candidates_say(town):
    world, indices, _ = town
    nothing = crofton.ViewRequest(crofton.Camera(), candidates=np.zeros(len(indices), dtype=bool))
    assert len(world.view(nothing)) == 0 and len(world.view([nothing])) == 0
    moved = world.view(crofton.Camera(), layers=4).handles[:1]
    world.set_boxes(moved, crofton.Box((0, 2, -5), (0.1, 0.1, 0.1)))
    world.update()
    assert world.view(nothing).ids.tolist() == world.view([nothing]).ids.tolist() == moved["index"].tolist()


def test_requests_keep_copies_of_arrays(town):
    mask = only(town, "far")
    request = crofton.ViewRequest(crofton.Camera(), candidates=mask)
    mask[:] = True
    assert names(town, town[0].view(request).ids) == {"far"}


def test_random_views_see_what_the_exact_test_of_boxes_says(random):
    boxes = crofton.boxes(random.uniform(-60, 60, (700, 3)), random.uniform(0.1, 3, (700, 3)))
    world = crofton.World(pairs=False)
    world.add_boxes(boxes)
    world.update()
    cameras = [crofton.Camera(random.uniform(-30, 30, 3), random.normal(size=3), near=0.1, far=80) for _ in range(32)]
    many = world.view(cameras)
    for v, camera in enumerate(cameras):
        exact = np.flatnonzero(crofton.classify(camera, boxes) != crofton.OUTSIDE)
        seen = world.view(camera)
        assert (seen.ids == exact).all()
        assert (seen.verdicts == crofton.classify(camera, boxes)[exact]).all()
        assert (many.ids[many.view_masks >> v & 1 == 1] == exact).all()
