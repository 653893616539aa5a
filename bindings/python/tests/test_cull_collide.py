# SPDX-License-Identifier: MIT
import numpy as np
import pytest

import crofton


def planes_say(frustum, boxes):
    """The plain test of boxes against planes: a lower bound for what is outside."""
    planes = frustum.planes
    outside = np.zeros(len(boxes), dtype=bool)
    for n, d in zip(planes[:, :3], planes[:, 3]):
        projected_radii = np.abs(boxes["axes"].astype("f8") @ n) * boxes["half_extents"]
        outside |= (boxes["center"] - frustum.origin) @ n + d + projected_radii.sum(axis=1) < -1e-9
    return outside


@pytest.fixture
def crowd(random):
    return crofton.boxes(random.uniform(-60, 60, (2000, 3)), random.uniform(0.1, 3, (2000, 3)))


cameras = {
    "perspective": crofton.Camera(),
    "narrow": crofton.Camera((5, 1, 2), (1, 0, -1), fov_y=0.1),
    "orthographic": crofton.Camera((0, 0, 50), height=30.0, far=100),
    "infinite": crofton.Camera(far=np.inf),
}


@pytest.mark.parametrize("name", cameras)
@pytest.mark.parametrize("conservative", [False, True])
def test_verdicts_agree_with_planes(name, conservative, crowd):
    camera = cameras[name]
    verdicts = crofton.classify(camera, crowd, conservative=conservative)
    outside = planes_say(camera.frustum, crowd)
    assert (verdicts[outside] == crofton.OUTSIDE).all()
    if conservative:
        assert (outside == (verdicts == crofton.OUTSIDE)).all()
    assert set(np.unique(verdicts)) <= {crofton.OUTSIDE, crofton.STRADDLING, crofton.INSIDE}


@pytest.mark.parametrize("name", cameras)
@pytest.mark.parametrize("threads", [1, 3])
def test_lists_classify_and_worlds_agree(name, threads, crowd):
    camera = cameras[name]
    crofton.set_threads(threads)
    try:
        expected = np.flatnonzero(crofton.classify(camera, crowd) != crofton.OUTSIDE)
        assert (crofton.find_visible(camera, crowd) == expected).all()
        assert (crofton.find_visible(camera.frustum, crowd) == expected).all()
        assert (crofton.BoxList(crowd).find_visible(camera) == expected).all()
        world = crofton.World(pairs=False)
        world.add_boxes(crowd)
        world.update()
        assert (world.view(camera).ids == expected).all()
    finally:
        crofton.set_threads(1)


def test_layers_choose(crowd):
    layers = np.arange(2000) % 4
    seen = crofton.find_visible(crofton.Camera(), crowd, layers=1 << layers, layer_mask=2)
    everything = crofton.find_visible(crofton.Camera(), crowd)
    assert (seen == everything[layers[everything] == 1]).all()
    with pytest.raises(crofton.Error):
        crofton.find_visible(crofton.Camera(), crowd, layers=[1, 2])


def test_a_list_keeps_its_own_boxes(crowd):
    boxes = crowd.copy()
    laid_out = crofton.BoxList(boxes)
    boxes["center"] = np.nan
    assert len(laid_out) == 2000
    assert (laid_out.find_visible(crofton.Camera()) == crofton.find_visible(crofton.Camera(), crowd)).all()


def test_a_matrix_gives_the_same_frustum(crowd):
    f, aspect, near, far = 1 / np.tan(np.pi / 6), 16 / 9, 0.1, 1000.0
    matrix = np.zeros((4, 4))
    matrix[0, 0], matrix[1, 1] = f / aspect, f
    matrix[2, 2], matrix[2, 3], matrix[3, 2] = near / (far - near), far * near / (far - near), -1
    frustum = crofton.Frustum.from_matrix(matrix)
    assert (crofton.find_visible(frustum, crowd) == crofton.find_visible(crofton.Camera(), crowd)).all()


@pytest.mark.parametrize("matrix", [np.zeros((4, 4)), np.full((4, 4), np.nan)])
def test_a_singular_matrix_is_an_error(matrix):
    with pytest.raises(crofton.Error):
        crofton.Frustum.from_matrix(matrix)


@pytest.mark.parametrize("bad", [np.eye(3), None, "matrix", np.zeros(16)], ids=str)
def test_what_is_no_matrix_is_a_type_error(bad):
    with pytest.raises(TypeError):
        crofton.Frustum.from_matrix(bad)


@pytest.mark.parametrize(
    "arguments",
    [{"fov_y": 0.0}, {"fov_y": 4.0}, {"aspect": -1.0}, {"near": 0.0}, {"near": 5.0, "far": 1.0}, {"height": 0.0},
     {"fov_y": np.nan}, {"up": (0, 0, 1)}, {"forward": (0, 0, 0)}, {"position": (np.inf, 0, 0)}],
    ids=str,
)
def test_a_camera_that_is_none_is_an_error(arguments):
    with pytest.raises(crofton.Error):
        crofton.Camera(**arguments)


@pytest.mark.parametrize("bad", [None, 5, "camera", np.eye(4)], ids=str)
def test_what_is_no_view_is_a_type_error(bad, crowd):
    with pytest.raises(TypeError, match="view"):
        crofton.classify(bad, crowd)


def test_shadow_volumes_hold_the_view(crowd):
    frustum = crofton.Camera().frustum
    casters = crofton.find_visible(frustum.shadow_volume((0.3, 1, 0.2)), crowd)
    assert set(crofton.find_visible(frustum, crowd)) <= set(casters)


def test_boxes_that_meet_by_their_gap(random):
    a = crofton.boxes(np.zeros((100, 3)), 1)
    shift = random.uniform(-3, 3, (100, 3))
    b = crofton.boxes(shift, 1)
    gap = np.linalg.norm(np.maximum(np.abs(shift) - 2, 0), axis=1)
    assert (crofton.intersects(a, b) == (gap == 0)).all()
    assert crofton.distance(a, b) == pytest.approx(gap, abs=1e-12)
    one = crofton.Box((0, 0, 0), (1, 1, 1))
    assert (crofton.intersects(one, b) == crofton.intersects(a, b)).all()
    assert (crofton.distance(b, one) == crofton.distance(a, b)).all()


def test_touching_counts():
    a = crofton.Box((0, 0, 0), (1, 1, 1))
    assert crofton.intersects(a, crofton.Box((2, 0, 0), (1, 1, 1))).tolist() == [True]
    assert crofton.intersects(a, crofton.Box((np.nextafter(2, 3), 0, 0), (1, 1, 1))).tolist() == [False]


def test_sides_of_other_lengths_are_an_error():
    with pytest.raises(crofton.Error):
        crofton.intersects(crofton.boxes(np.zeros((2, 3)), 1), crofton.boxes(np.zeros((3, 3)), 1))


def test_depth_and_manifold_of_a_stack():
    a, b = crofton.Box((0, 0, 0), (1, 1, 1)), crofton.Box((0.5, 1.75, 0), (1, 1, 1))
    depth, axis = crofton.penetration(a, b)
    assert depth == pytest.approx(0.25) and axis == pytest.approx((0, 1, 0))
    manifold = crofton.contact_manifold(a, b)
    assert manifold["points"].shape == (4, 3)
    assert manifold["depths"] == pytest.approx([0.25] * 4)
    assert manifold["normal"] == pytest.approx((0, 1, 0))
    assert crofton.contact_manifold(a, crofton.Box((9, 0, 0), (1, 1, 1)))["points"].shape == (0, 3)


@pytest.mark.parametrize("threads", [1, 2])
def test_all_pairs_are_found(threads, random):
    boxes = crofton.boxes(random.uniform(-10, 10, (200, 3)), random.uniform(0.2, 1.5, (200, 3)))
    i, j = np.triu_indices(200, 1)
    hits = crofton.intersects(boxes[i], boxes[j])
    expected = np.column_stack([i[hits], j[hits]])
    crofton.set_threads(threads)
    try:
        broadphase = crofton.Broadphase()
        broadphase.update(boxes)
        assert (broadphase.pairs == expected).all()
        boxes["center"][:5] += 0.5
        broadphase.update(boxes, moved=np.arange(5))
        fresh = crofton.Broadphase()
        fresh.update(boxes)
        assert (broadphase.pairs == fresh.pairs).all()
        assert len(broadphase.began) + len(broadphase.stayed) == len(broadphase.pairs)
    finally:
        crofton.set_threads(1)


def test_an_item_that_is_not_there_is_an_error(random):
    boxes = crofton.boxes(random.uniform(-10, 10, (20, 3)), 1)
    broadphase = crofton.Broadphase()
    broadphase.update(boxes)
    with pytest.raises(crofton.Error):
        broadphase.update(boxes, moved=[20])


def test_a_box_shows_itself():
    box = crofton.Box((1, 2, 3), (4, 5, 6))
    assert "4, 5, 6" in repr(box)
    assert box.corners.shape == (8, 3) and box.corners[7] == pytest.approx((5, 7, 9))
    assert (box.volume, box.surface_area, box.edge_sum) == (960, 592, 30)
    assert box.contains((5, 7, 9)) and not box.contains((5.001, 7, 9))
    assert box != 5


@pytest.mark.parametrize("arguments", [((0, 0), (1, 1, 1)), ((0, 0, 0), "abc"), (None, (1, 1, 1))], ids=str)
def test_what_is_no_box_is_a_type_error(arguments):
    with pytest.raises(TypeError):
        crofton.Box(*arguments)


@pytest.mark.parametrize("half_extents", [(-1, 1, 1), (np.nan, 1, 1), (np.inf, 1, 1)])
def test_bad_extents_are_an_error(half_extents):
    with pytest.raises(crofton.Error):
        crofton.Box((0, 0, 0), half_extents)


def test_skew_axes_are_an_error():
    with pytest.raises(crofton.Error):
        crofton.Box((0, 0, 0), (1, 1, 1), [[1, 0, 0], [0.5, 1, 0], [0, 0, 1]])


@pytest.mark.parametrize("side", ["a", "b"])
def test_a_box_that_is_none_has_no_distance(side):
    good, bad = crofton.boxes(np.zeros((3, 3)), 1), crofton.boxes(np.zeros((3, 3)), 1)
    bad["center"][1] = np.nan
    with pytest.raises(crofton.Error, match=f"^{side}: ") as raised:
        crofton.distance(*((bad, good) if side == "a" else (good, bad)))
    assert raised.value.item == 1
