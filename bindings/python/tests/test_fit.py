# SPDX-License-Identifier: MIT
import signal
import threading
import time

import numpy as np
import pytest

import crofton

qualities = ["fast", "tight", "exact"]
criteria = ["perimeter", "area", "volume"]


def turned(points, angle):
    c, s = np.cos(angle), np.sin(angle)
    return points @ np.array([[c, -s, 0], [s, c, 0], [0, 0, 1]]).T


def contains_all(box, points):
    return all(box.contains(p) for p in points)


@pytest.mark.parametrize("quality", qualities)
@pytest.mark.parametrize("criterion", criteria)
def test_a_turned_box_is_found(quality, criterion):
    corners = np.array([[x, y, z] for x in (-3, 3) for y in (-2, 2) for z in (-1, 1)], dtype="f8")
    box = crofton.fit_obb(turned(corners, 0.4), criterion, quality)
    assert sorted(box.half_extents) == pytest.approx([1, 2, 3], rel=1e-5)
    assert contains_all(box, turned(corners, 0.4))


@pytest.mark.parametrize("quality", qualities)
def test_every_point_is_inside(quality, random):
    points = random.normal(size=(300, 3))
    assert contains_all(crofton.fit_obb(points, quality=quality), points)


@pytest.mark.parametrize("criterion", criteria)
def test_exact_is_never_worse_and_proves_it(criterion, random):
    points = random.normal(size=(60, 3)) * [3, 2, 1]
    measure = {"perimeter": lambda b: b.edge_sum, "area": lambda b: b.surface_area, "volume": lambda b: b.volume}[criterion]
    exact = crofton.fit_exact(points, criterion)
    assert exact.complete
    assert exact.lower_bound <= exact.value
    assert exact.gap < 1e-6
    assert measure(exact.box) <= measure(crofton.fit_obb(points, criterion, "fast")) * (1 + 1e-6)


@pytest.mark.parametrize("criterion", ["girth", "", "Perimeter"])
def test_an_unknown_criterion_is_named(criterion):
    with pytest.raises(crofton.Error, match="perimeter"):
        crofton.fit_obb(np.eye(3), criterion)


def test_an_unknown_quality_is_named():
    with pytest.raises(crofton.Error, match="tight"):
        crofton.fit_obb(np.eye(3), quality="best")


def test_a_criterion_that_is_no_criterion_is_a_type_error():
    with pytest.raises(TypeError, match="criterion"):
        crofton.fit_obb(np.eye(3), 5)


def test_a_criterion_of_ones_own(random):
    points = random.normal(size=(50, 3))
    mixed = crofton.Criterion(volume=1.0, area=0.5, mean_curvature=0.1)
    best = crofton.fit_exact(points, mixed)
    assert best.value == pytest.approx(mixed(best.box), rel=1e-12)


def test_progress_can_end_the_search(random):
    points = random.normal(size=(4000, 3))
    points /= np.linalg.norm(points, axis=1)[:, None]
    calls = []

    def stop(value, lower_bound):
        calls.append((value, lower_bound))
        return False

    result = crofton.fit_exact(points, gap=1e-12, progress=stop)
    assert len(calls) == 1
    assert not result.complete
    assert result.lower_bound <= result.value
    assert contains_all(result.box, points)


def test_an_exception_in_progress_comes_out(random):
    def fail(value, lower_bound):
        raise KeyError("from progress")

    points = random.normal(size=(4000, 3))
    points /= np.linalg.norm(points, axis=1)[:, None]
    with pytest.raises(KeyError, match="from progress"):
        crofton.fit_exact(points, gap=1e-12, progress=fail)


def test_ctrl_c_ends_a_long_call(random):
    points = random.normal(size=(20000, 3))
    points /= np.linalg.norm(points, axis=1)[:, None]
    threading.Timer(0.3, signal.pthread_kill, [threading.main_thread().ident, signal.SIGINT]).start()
    start = time.monotonic()
    with pytest.raises(KeyboardInterrupt):
        crofton.fit_exact(points, gap=1e-12)
        time.sleep(30)  # where the search ends first, the interrupt comes here
    assert time.monotonic() - start < 20


def test_other_threads_go_on_meanwhile(random):
    points = random.normal(size=(3000, 3))
    points /= np.linalg.norm(points, axis=1)[:, None]
    steps = 0
    done = threading.Event()

    def count():
        nonlocal steps
        while not done.is_set():
            steps += 1
            time.sleep(0.001)

    counter = threading.Thread(target=count)
    counter.start()
    crofton.fit_exact(points, gap=1e-12, seconds=0.5)
    done.set()
    counter.join()
    assert steps > 20


@pytest.mark.parametrize("threads", [1, 2, 4])
def test_fit_many_is_fit_obb_of_each(threads, random):
    points = random.normal(size=(90, 3)).astype("f4")
    ends = [10, 30, 90]
    crofton.set_threads(threads)
    try:
        found = crofton.fit_many(points, ends, quality="tight")
    finally:
        crofton.set_threads(1)
    for i, (a, b) in enumerate(zip([0, 10, 30], ends)):
        box = crofton.fit_obb(points[a:b])
        assert (found[i]["center"] == box.center).all()
        assert (found[i]["half_extents"] == box.half_extents).all()


@pytest.mark.parametrize("ends", [[5, 4], [91], [10, 200]])
def test_ends_that_are_wrong_are_an_error(ends, random):
    with pytest.raises(crofton.Error, match="ends"):
        crofton.fit_many(random.normal(size=(90, 3)).astype("f4"), ends)


def test_an_index_out_of_range_is_an_error(random):
    with pytest.raises(crofton.Error):
        crofton.fit_many(random.normal(size=(9, 3)).astype("f4"), [3], indices=[0, 1, 9])


@pytest.mark.parametrize("criterion", ["perimeter", "area"])
def test_the_best_rectangle_around_a_turned_one(criterion):
    corners = turned(np.array([[-3.0, -1, 0], [3, -1, 0], [3, 1, 0], [-3, 1, 0]]), 0.3)[:, :2]
    center, axis, half_extents = crofton.minimal_rectangle(corners, criterion)
    assert center == pytest.approx((0, 0), abs=1e-12)
    assert sorted(half_extents) == pytest.approx([1, 3])


def test_the_best_triangle_is_the_triangle_itself():
    corners = np.array([[0.0, 0], [4, 0], [1, 3]])
    for criterion in ("area", "perimeter"):
        found = crofton.minimal_triangle(corners, criterion)
        assert sorted(map(tuple, found.round(9))) == sorted(map(tuple, corners))


def test_the_smallest_disc_and_sphere():
    center, radius = crofton.minimal_disc([[1, 0], [-1, 0], [0, 1], [0, 0.2]])
    assert center == pytest.approx((0, 0), abs=1e-12) and radius == pytest.approx(1)
    center, radius = crofton.minimal_sphere(np.vstack([np.eye(3), -np.eye(3)]))
    assert center == pytest.approx((0, 0, 0), abs=1e-12) and radius == pytest.approx(1)


def test_measures_of_known_bodies():
    v = crofton.IntrinsicVolumes.of_box(1, 2, 3)
    assert (v.volume, v.area, v.mean_curvature) == pytest.approx((6, 22, 6 * np.pi))
    v = crofton.IntrinsicVolumes.of_sphere(2)
    assert (v.volume, v.area, v.mean_curvature) == pytest.approx((32 / 3 * np.pi, 16 * np.pi, 8 * np.pi))
    v = crofton.IntrinsicVolumes.of_segment(5)
    assert (v.volume, v.area, v.mean_curvature) == pytest.approx((0, 0, 5 * np.pi))
    cube = crofton.IntrinsicVolumes.of_hull([[x, y, z] for x in (0, 2) for y in (0, 2) for z in (0, 2)])
    assert (cube.volume, cube.area, cube.mean_curvature) == pytest.approx((8, 24, 6 * np.pi))


def test_two_spheres_meet_by_the_kinematic_formula():
    a, b = crofton.IntrinsicVolumes.of_sphere(1), crofton.IntrinsicVolumes.of_sphere(2)
    assert crofton.kinematic_measure(a, b) == pytest.approx(4 / 3 * np.pi * 27)


@pytest.mark.parametrize("weights", [(-1, 0, 0), (0, 0, 0), (np.nan, 1, 0), (np.inf, 0, 0)])
def test_bad_weights_are_an_error(weights):
    with pytest.raises(crofton.Error):
        crofton.Criterion(*weights)
