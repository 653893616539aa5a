# SPDX-License-Identifier: MIT
"""Two rooms, parted by a wall, with a box in each: what is seen from where can be said by hand."""
import _thread
import threading
import time
import xml.etree.ElementTree as ElementTree

import numpy as np
import pytest

import crofton

QUADS = np.array([0, 2, 3, 0, 3, 1, 4, 5, 7, 4, 7, 6, 0, 1, 5, 0, 5, 4, 2, 6, 7, 2, 7, 3, 0, 4, 6, 0, 6, 2, 1, 3, 7, 1, 7, 5])
LEFT, WALL, RIGHT = 1, 2, 3
LEFT_EYE, RIGHT_EYE = (-1, 1, 1), (3, 1, 1)


def level(dtype="f8", shift=0.0):
    """Object 0 is a hall [-4, 4] × [0, 2] × [0, 4]; 1 and 3 are boxes in its halves, which wall 2 parts."""
    spans = [((-4, 0, 0), (4, 2, 4)), ((-3, 0.5, 2), (-2, 1, 3)), ((-0.1, 0, 0), (0.1, 2, 4)), ((2, 0.5, 2), (3, 1, 3))]
    positions, indices, object_of = [], [], []
    for i, (low, high) in enumerate(spans):
        ends = np.array([low, high], dtype="f8") + shift
        corners = [[ends[x, 0], ends[y, 1], ends[z, 2]] for z in (0, 1) for y in (0, 1) for x in (0, 1)]
        positions += corners
        # The hall is seen from within: its triangles are turned.
        indices += list((QUADS[::-1] if i == 0 else QUADS) + 8 * i)
        object_of += [i] * 12
    return np.array(positions, dtype=dtype), np.array(indices, dtype="u4"), np.array(object_of, dtype="u4")


def bake(**more):
    return crofton.Pvs.bake(*level(), **{"cells": (4, 1, 2), "epsilon": 1e-3, **more})


@pytest.fixture(scope="module")
def sets():
    return bake()


def test_each_half_sees_its_own_box_alone(sets):
    assert (sets.cell_count, sets.object_count) == (8, 4)
    assert sets.visible(LEFT_EYE, "statistical").tolist() == [True, True, True, False]
    assert sets.visible(RIGHT_EYE, "statistical").tolist() == [True, False, True, True]


def test_an_eye_has_the_set_of_its_cell(sets):
    cell = sets.find_cell(LEFT_EYE)
    low, high = sets.cell_boxes[cell]
    assert (low <= LEFT_EYE).all() and (LEFT_EYE <= high).all()
    for mode in ("conservative", "statistical"):
        assert (sets.visible(cell, mode) == sets.visible(LEFT_EYE, mode)).all()
    assert (sets.visible(np.int64(cell)) == sets.visible(cell)).all()


def test_without_proofs_nothing_is_hidden_and_with_them_the_other_half_is(sets):
    assert sets.counts["hidden"] == 0 and sets.visible(LEFT_EYE).all()
    proved = bake(surface_steps=400, near_radius=0.01)
    assert proved.counts["hidden"] > 0
    assert proved.states[proved.find_cell(LEFT_EYE), RIGHT] == crofton.HIDDEN
    assert proved.visible(LEFT_EYE).tolist() == [True, True, True, False]


def test_a_flat_object_is_hidden_and_seen_like_any_other():
    # A square at a coordinate that no float has, on either side of the wall; only its own half of the hall sees it.
    positions, indices, object_of = level()
    for x, own, other in ((-0.4, LEFT_EYE, RIGHT_EYE), (0.4, RIGHT_EYE, LEFT_EYE)):
        square = [(x / 3 * 3.1, y, z) for z in (1, 2) for y in (0.5, 1.5)]
        sets = crofton.Pvs.bake(np.vstack([positions, square]), np.concatenate([indices, [32, 33, 35, 32, 35, 34]]),
                                np.concatenate([object_of, [4, 4]]), cells=(4, 1, 2), epsilon=1e-3, surface_steps=400,
                                near_radius=0.01)
        assert sets.visible(own)[4] and sets.visible(own, "statistical")[4]
        assert not sets.visible(other)[4] and sets.states[sets.find_cell(other), 4] == crofton.HIDDEN


def test_the_counts_are_those_of_the_states(sets):
    assert sets.states.shape == (8, 4)
    for name, state in (("hidden", crofton.HIDDEN), ("unseen", crofton.UNSEEN), ("seen", crofton.SEEN)):
        assert sets.counts[name] == (sets.states[sets.kinds != 1] == state).sum()


def test_outside_of_all_cells_everything_may_be_seen(sets):
    assert sets.find_cell((100, 1, 1)) is None
    assert sets.visible((100, 1, 1)).all() and sets.visible((100, 1, 1), "statistical").all()


def test_the_lines_promise_what_was_asked_for(sets):
    assert 0 < sets.epsilon <= 1e-3 and sets.confidence == 0.999


def test_cells_are_a_grid_or_boxes_or_convex(sets):
    low, high = sets.cell_boxes[:, 0], sets.cell_boxes[:, 1]
    boxes = bake(cells=sets.cell_boxes)
    corners = np.array([np.where([(k >> a) & 1 for a in range(3)], high, low) for k in range(8)]).transpose(1, 0, 2)
    convex = bake(cells=corners)
    for other in (boxes, convex):
        assert other.cell_count == 8
        assert (other.visible(LEFT_EYE, "statistical") == sets.visible(LEFT_EYE, "statistical")).all()
        assert (other.visible(RIGHT_EYE, "statistical") == sets.visible(RIGHT_EYE, "statistical")).all()


def test_any_number_of_threads_gives_the_same_bytes():
    # So few lines, and each triangle an object, that another seed sees other things.
    positions, indices, _ = level()

    def bake(seed=1):
        return crofton.Pvs.bake(positions, indices, np.arange(48), cells=(16, 2, 8), epsilon=0.5, seed=seed)

    alone = bake().to_bytes()
    crofton.set_threads(3)
    try:
        assert bake().to_bytes() == alone
    finally:
        crofton.set_threads(1)
    assert bake(seed=2).to_bytes() != alone


def test_floats_and_doubles_and_far_levels_see_the_same(sets):
    for dtype, shift in (("f4", 0.0), ("f8", 1e6), (">f8", 0.0)):
        other = crofton.Pvs.bake(*level(dtype, shift), cells=(4, 1, 2), epsilon=1e-3)
        eye = np.array(LEFT_EYE) + shift
        assert (other.visible(eye, "statistical") == sets.visible(LEFT_EYE, "statistical")).all()


def test_a_path_is_a_str_bytes_or_a_path_of_pathlib(sets, tmp_path):
    path = tmp_path / "level.crofton"
    path.write_bytes(sets.to_bytes())
    for same in (path, str(path), bytes(path)):
        assert crofton.Pvs.open(same).cell_count == sets.cell_count
    for wrong in (None, 3, [str(path)]):
        with pytest.raises(TypeError):
            crofton.Pvs.open(wrong)


def test_a_path_with_a_zero_byte_is_refused_by_name(sets, tmp_path):
    path = tmp_path / "level.crofton"
    path.write_bytes(sets.to_bytes())
    for cut in (str(path) + "\0", str(path) + "\0.other", bytes(path) + b"\0"):
        with pytest.raises(crofton.Error, match="zero byte") as error:
            crofton.Pvs.open(cut)
        assert error.value.code == "invalid_argument"


def test_a_path_that_is_no_utf_8_is_told_all_the_same(tmp_path):
    for path in (bytes(tmp_path) + b"/\xff.crofton", str(tmp_path) + "/\udcff.crofton"):
        with pytest.raises(crofton.Error, match=r"/\\xff\.crofton"):
            crofton.Pvs.open(path)


def test_a_file_gives_the_sets_back(sets, tmp_path):
    path = tmp_path / "level.crofton"
    path.write_bytes(sets.to_bytes())
    for again in (crofton.Pvs.open(str(path)), crofton.Pvs.from_bytes(sets.to_bytes())):
        assert (again.states == sets.states).all() and (again.kinds == sets.kinds).all()
        assert (again.epsilon, again.confidence) == (sets.epsilon, sets.confidence)


@pytest.mark.parametrize("cut", [0, 1, 64, 500, -1])
def test_a_damaged_file_is_an_error(sets, cut):
    with pytest.raises(crofton.Error) as raised:
        crofton.Pvs.from_bytes(sets.to_bytes()[:cut])
    assert raised.value.code == "parse"


def test_no_file_is_an_error():
    with pytest.raises(crofton.Error) as raised:
        crofton.Pvs.open("/no/such/file.crofton")
    assert raised.value.code == "input/output"


@pytest.mark.parametrize(
    "change, kind, match",
    [
        ({"epsilon": 0.0}, crofton.Error, "epsilon"),
        ({"confidence": 1.0}, crofton.Error, "confidence"),
        ({"sides": "back"}, crofton.Error, "front"),
        ({"cells": (0, 1, 1)}, crofton.Error, "."),
        ({"cells": (1, 2)}, TypeError, "three counts"),
        ({"cells": np.zeros((2, 3, 3))}, TypeError, "three counts"),
        ({"cells": "many"}, TypeError, "."),
        ({"cells": np.full((1, 2, 3), np.nan)}, crofton.Error, "."),
        ({"bounds": np.zeros((3, 3))}, TypeError, "two corners"),
        ({"bounds": np.zeros((2, 3))}, crofton.Error, "."),
    ],
)
def test_wrong_arguments_are_named(change, kind, match):
    with pytest.raises(kind, match=match):
        bake(**change)


@pytest.mark.parametrize(
    "place, value, kind",
    [
        (0, np.zeros((0, 3)), crofton.Error),
        (0, np.full((32, 3), np.inf), crofton.Error),
        (0, np.zeros((32, 2)), TypeError),
        (1, [0, 1, 77], crofton.Error),
        (1, [0, 1], crofton.Error),
        (2, [0, 1], TypeError),
        (2, [0.5] * 48, TypeError),
        (2, [2**31] * 48, crofton.Error),
    ],
)
def test_wrong_meshes_are_errors(place, value, kind):
    given = list(level())
    given[place] = value
    with pytest.raises(kind):
        crofton.Pvs.bake(*given, cells=(2, 1, 1), epsilon=1e-2)


@pytest.mark.parametrize("cell", [8, -1, 2**70])
def test_a_cell_that_is_not_there_is_an_error(sets, cell):
    with pytest.raises(crofton.Error) as raised:
        sets.visible(cell)
    assert raised.value.code == "out_of_range"


def test_an_unknown_mode_is_named(sets):
    with pytest.raises(crofton.Error, match="statistical"):
        sets.visible(LEFT_EYE, "guess")


def test_progress_ends_a_bake_and_what_was_found_counts():
    shares = []

    def progress(share, whole):
        shares.append(share / whole)
        return len(shares) < 3

    sets = bake(epsilon=1e-7, progress=progress)
    assert 0 <= shares[0] <= shares[-1] < 1
    assert sets.epsilon > 1e-7


def test_what_progress_raises_comes_out():
    with pytest.raises(ZeroDivisionError):
        bake(epsilon=1e-7, progress=lambda share, whole: 1 / 0)


def test_control_c_ends_a_bake():
    timer = threading.Timer(0.3, _thread.interrupt_main)
    start = time.monotonic()
    timer.start()
    with pytest.raises(KeyboardInterrupt):
        bake(epsilon=1e-7)
    assert time.monotonic() - start < 20


def test_other_threads_run_meanwhile():
    done = threading.Event()
    worker = threading.Thread(target=lambda: (bake(epsilon=1e-7, seconds=0.5), done.set()))
    worker.start()
    ticks = 0
    while not done.is_set():
        ticks += 1
        time.sleep(0.01)
    worker.join()
    assert ticks > 5


def test_a_notebook_shows_a_chart(sets):
    root = ElementTree.fromstring(sets._repr_svg_())
    lines = [part for part in root.iter() if part.get("class") == "line"]
    assert len(lines) == 2
    assert all(line.get("d").count("L") == (sets.kinds > 1).sum() - 1 for line in lines)


def test_the_chart_of_sets_has_the_shares_of_their_states():
    sets = bake(surface_steps=400, near_radius=0.01)
    states = sets.states[sets.kinds > 1]
    shares = sets.chart().series
    assert sorted(shares) == ["conservative", "statistical"]
    assert shares["conservative"] == pytest.approx(sorted(100 * (states != crofton.HIDDEN).mean(axis=1)))
    assert shares["statistical"] == pytest.approx(sorted(100 * (states == crofton.SEEN).mean(axis=1)))
    assert (shares["conservative"] < 100).any()


def test_a_chart_places_its_ends_where_they_belong():
    root = ElementTree.fromstring(crofton.Chart([0, 10], {"a & b": [0, 1]}, "x", "y").to_svg(500))
    (line,) = [part for part in root.iter() if part.get("class") == "line"]
    start, end = (tuple(map(float, point.split())) for point in line.get("d")[1:].split("L"))
    assert start == pytest.approx((64, 256)) and end == pytest.approx((488, 30))
    assert "a & b" in [part.text for part in root.iter()]


@pytest.mark.parametrize("values, pieces", [([1, 2, 3, 4], 1), ([1, np.nan, 3, 4], 2), ([np.inf] * 4, 0), ([5] * 4, 1)])
def test_a_chart_leaves_gaps(values, pieces):
    root = ElementTree.fromstring(crofton.Chart(range(4), {"v": values})._repr_svg_())
    (line,) = [part for part in root.iter() if part.get("class") == "line"]
    assert line.get("d").count("M") == pieces


@pytest.mark.parametrize("x, series", [([[1]], {}), ([1, 2], {"a": [1]}), ([1, 2], {"a": ["?", "!"]})])
def test_a_chart_of_unequal_lengths_is_an_error(x, series):
    with pytest.raises((TypeError, ValueError)):
        crofton.Chart(x, series)
