# SPDX-License-Identifier: MIT
"""What arrays calls take, and what they say of others."""
import numpy as np
import pytest

import crofton


def rows(dtype="f8"):
    return (np.arange(30).reshape(10, 3) ** 2 % 17).astype(dtype)


layouts = {
    "contiguous": lambda a: np.ascontiguousarray(a),
    "fortran": lambda a: np.asfortranarray(a),
    "every second of twice as many": lambda a: np.repeat(a, 2, axis=0)[::2],
    "columns of a wider array": lambda a: np.hstack([a, a])[:, :3],
    "backwards twice": lambda a: a[::-1][::-1],
    "reversed in memory": lambda a: a[::-1].copy()[::-1],
    "byte-swapped": lambda a: a.astype(a.dtype.newbyteorder()),
    "read-only": lambda a: (a.setflags(write=False), a)[1],
    "unaligned": lambda a: np.frombuffer(b"x" + a.tobytes(), dtype=a.dtype, offset=1).reshape(a.shape),
    "a list": lambda a: a.tolist(),
    "a memory view": lambda a: memoryview(np.ascontiguousarray(a)),
}
number_types = ["f8", "f4", "f2", "i8", "i4", "i2", "i1", "u8", "u4", "u2", "u1"]


@pytest.mark.parametrize("layout", layouts)
@pytest.mark.parametrize("dtype", ["f8", "f4"])
def test_any_layout_gives_the_same_box(layout, dtype):
    expected = crofton.fit_obb(rows(dtype).copy())
    assert crofton.fit_obb(layouts[layout](rows(dtype))) == expected


@pytest.mark.parametrize("dtype", number_types)
def test_any_type_of_number_is_taken(dtype):
    assert crofton.fit_obb(rows(dtype)) == crofton.fit_obb(rows("f8"))


@pytest.mark.parametrize(
    "bad",
    [None, "text", 3.0, object(), {}, [["a", "b", "c"]], np.zeros((4, 2)), np.zeros((4, 4)), np.zeros(3),
     np.zeros((2, 2, 3)), np.zeros((4, 3), dtype=complex), np.zeros((4, 3), dtype=bool), np.zeros((4, 3), dtype="M8[s]"),
     np.zeros((4, 3), dtype=object)],
    ids=str,
)
def test_other_things_are_a_type_error(bad):
    with pytest.raises(TypeError, match="points"):
        crofton.fit_obb(bad)


@pytest.mark.parametrize("value", [np.nan, np.inf, -np.inf, 1e31])
@pytest.mark.parametrize("place", [0, 3, 9])
def test_a_bad_number_names_its_row(value, place):
    points = rows()
    points[place, 1] = value
    with pytest.raises(crofton.Error) as raised:
        crofton.fit_obb(points)
    assert raised.value.item == place
    assert isinstance(raised.value, ValueError)


def test_an_error_has_a_code_and_a_message():
    with pytest.raises(crofton.Error) as raised:
        crofton.fit_obb(np.zeros((0, 3)))
    assert raised.value.code == "empty"
    assert raised.value.item is None
    assert str(raised.value)


def test_input_is_not_changed_and_not_kept():
    points = rows()
    before = points.copy()
    box = crofton.fit_obb(points)
    points[:] = 0
    assert box == crofton.fit_obb(before)


vectors = [(1, 2, 3), (0.1, -2, 3e29), (2**53 + 1, 2**60 + 129, -(2**62) - 1), (2**63, 1, 2), (2**63 - 1, 0.5, -(2**63)),
           (True, 0.5, 2), (np.float32(0.1), np.float64(0.1), np.int8(-3))]


@pytest.mark.parametrize("given", vectors)
def test_a_vector_is_the_same_three_numbers_in_a_tuple_a_list_or_an_array(given):
    expected = tuple(float(number) for number in given)
    array = np.array(expected)
    for way in (given, list(given), array, np.repeat(array, 2)[::2], array.astype(">f8"),
                np.frombuffer(b"x" + array.tobytes(), dtype="f8", offset=1)):
        assert tuple(crofton.Box(way, (1, 1, 1)).center) == expected


@pytest.mark.parametrize("bad", [(1, 2), (1, 2, 3, 4), [1, 2], [1.0, "2", 3], (1, 2, None), (1j, 2, 3), (1, 2, 10**30),
                                 (True, False, True), (2**63, 0.5, 2**70), np.zeros((3, 1)), np.zeros(2),
                                 np.zeros(3, bool), "abc", None, 7])
def test_what_is_no_vector_is_a_type_error(bad):
    with pytest.raises(TypeError, match="center: "):
        crofton.Box(bad, (1, 1, 1))


def test_boxes_have_the_layout_of_the_library():
    assert crofton.box_dtype.itemsize == 72
    assert crofton.box_dtype.names == ("center", "axes", "half_extents")
    assert [crofton.box_dtype.fields[n][1] for n in crofton.box_dtype.names] == [0, 24, 60]


def test_boxes_fills_axes_and_extents():
    array = crofton.boxes([[1, 2, 3], [4, 5, 6]], [1, 2, 3])
    assert array["center"].tolist() == [[1, 2, 3], [4, 5, 6]]
    assert (array["axes"] == np.eye(3)).all()
    assert array["half_extents"].tolist() == [[1, 2, 3]] * 2


def test_boxes_rounds_half_extents_up():
    given = np.concatenate([[0, 0.7, 1e-50, 16777217, 3e38], np.random.default_rng(5).random(1001) * 10.0]).reshape(-1, 2)
    half = np.column_stack([given, given[:, 0]])
    stored = crofton.boxes(np.zeros((len(half), 3)), half)["half_extents"]
    nearest = half.astype("f4")
    assert (stored >= half).all() and (stored[nearest >= half] == nearest[nearest >= half]).all()
    assert (stored <= np.nextafter(nearest, np.float32(np.inf))).all() and (nearest < half).sum() > 100
    assert np.isnan(crofton.boxes([[0, 0, 0]], [np.nan, 1, 1])["half_extents"][0, 0])
    with pytest.raises(ValueError):
        crofton.boxes([[0, 0, 0]], [1, 2])


@pytest.mark.parametrize("bad", [[1, 2, 3], [[1, 2]], 5])
def test_boxes_wants_rows_of_three(bad):
    with pytest.raises((TypeError, ValueError)):
        crofton.boxes(bad, 1)


@pytest.mark.parametrize("bad", [np.zeros((4, 3)), None, [1, 2], np.zeros(2, dtype=[("center", "f8", 3)]), "boxes"], ids=str)
def test_what_is_no_array_of_boxes_is_a_type_error(bad):
    with pytest.raises(TypeError, match="boxes"):
        crofton.classify(crofton.Camera(), bad)


def test_strided_and_swapped_boxes_are_taken():
    array = crofton.boxes(np.arange(60.0).reshape(20, 3) - 30, 1)
    camera = crofton.Camera()
    expected = crofton.classify(camera, array)
    assert (crofton.classify(camera, array[::2]) == expected[::2]).all()
    swapped = array.astype(array.dtype.newbyteorder())
    assert (crofton.classify(camera, swapped) == expected).all()
    array.setflags(write=False)
    assert (crofton.classify(camera, array) == expected).all()


@pytest.mark.parametrize("dtype", ["u8", "i8", "i4", "u2"])
def test_integers_of_other_types_are_converted(dtype):
    points = rows("f4")
    expected = crofton.fit_many(points, np.array([4, 10], dtype="u4"))
    assert (crofton.fit_many(points, np.array([4, 10], dtype=dtype)) == expected).all()


@pytest.mark.parametrize("bad", [[-1], [2**32], [2**40]])
def test_integers_that_do_not_fit_are_an_error(bad):
    with pytest.raises(crofton.Error) as raised:
        crofton.fit_many(rows("f4"), np.array(bad, dtype="i8"))
    assert raised.value.code == "out_of_range"


def test_real_numbers_are_no_indices():
    with pytest.raises(TypeError, match="ends"):
        crofton.fit_many(rows("f4"), [4.5])


def test_the_code_that_the_readme_names_is_one():
    with pytest.raises(crofton.Error) as raised:
        crofton.fit_obb(np.full((4, 3), np.nan))
    assert raised.value.code == "not_finite"
    assert repr(raised.value.code) in crofton.Error.__doc__


@pytest.mark.parametrize("half", [0.7, 0.1, 0.3, 1e-50, 16777217.0])
def test_a_box_holds_the_points_at_its_half_extents(half):
    box = crofton.Box((0, 0, 0), (half, half, half))
    assert box.contains((half, -half, half))
    assert (box.half_extents == crofton.boxes([[0, 0, 0]], half)["half_extents"][0]).all()
