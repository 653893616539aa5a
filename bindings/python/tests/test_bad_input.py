# SPDX-License-Identifier: MIT
"""What a World says of rays, shapes, numbers and indices that are none."""
import copy
import pickle
import signal
import threading
import time

import numpy as np
import pytest

import crofton


@pytest.fixture
def world():
    return crofton.World()


@pytest.mark.parametrize(
    "origin, direction, max_t",
    [((np.nan, 0, 0), (0, 0, -1), np.inf), ((0, 0, 0), (0, 0, 0), np.inf), ((0, 0, 0), (0, np.inf, -1), np.inf)],
)
def test_a_bad_ray_among_many_is_named(world, origin, direction, max_t):
    world.add(sphere=((0, 0, -5), 1.0))
    world.update()
    with pytest.raises(crofton.Error) as raised:
        world.raycast_many([(0.0, 0, 0), origin], [(0.0, 0, -1), direction], max_t)
    assert raised.value.item == 1


@pytest.mark.parametrize("max_t", [-1.0, np.nan])
def test_a_bad_length_of_rays_is_an_error(world, max_t):
    with pytest.raises(crofton.Error):
        world.raycast_many([(0.0, 0, 0)], [(0.0, 0, -1)], max_t)


bad_shapes = [
    {"sphere": ((np.nan, 0, 0), 1.0)}, {"sphere": ((0, 0, 0), -10.0)}, {"sphere": ((0, 0, 0), np.inf)},
    {"capsule": ((0, 0, 0), (0, np.inf, 0), 1.0)}, {"capsule": ((0, 0, 0), (0, 0, -9), -1.0)},
]


@pytest.mark.parametrize("shape", bad_shapes, ids=str)
def test_a_bad_shape_is_an_error_and_not_an_empty_answer(world, shape):
    world.add(sphere=((0, 0, -5), 1.0))
    world.update()
    with pytest.raises(crofton.Error):
        world.overlap(**shape)
    with pytest.raises(crofton.Error):
        world.closest(100.0, **shape)


@pytest.mark.parametrize("limit", [np.nan, -1.0])
def test_a_bad_limit_of_distance_is_an_error(world, limit):
    with pytest.raises(crofton.Error):
        world.closest(limit, sphere=((0, 0, 0), 1.0))


@pytest.mark.parametrize("call", [
    lambda w: w.add(sphere=5), lambda w: w.add(sphere=((0, 0, 0),)), lambda w: w.add(sphere=((0, 0, 0), "far")),
    lambda w: w.add(aligned=3), lambda w: w.add(aligned="no"), lambda w: w.overlap(capsule=((0, 0, 0), 1.0)),
    lambda w: crofton.Camera(height="high"), lambda w: crofton.fit_exact(np.eye(3), seconds="many"),
    lambda w: crofton.triangulate([[0, 0], [1, 0], [0, 1]], work=-1),
    lambda w: crofton.triangulate([[0, 0], [1, 0], [0, 1]], seconds=[]),
])
def test_what_is_no_number_and_no_shape_is_a_type_error(world, call):
    with pytest.raises(TypeError, match="expected"):
        call(world)


def test_of_two_shapes_none_is_dropped_silently(world):
    box, sphere = crofton.Box((0, 0, 0), (1, 1, 1)), ((9, 0, 0), 1.0)
    for call in (world.add, world.overlap, lambda **shapes: world.closest(1.0, **shapes)):
        with pytest.raises(TypeError, match="one of"):
            call(box=box, sphere=sphere)
    assert len(world) == 0


@pytest.mark.parametrize("users", [[1, 2**63], (2**64 - 1, 0), [2**63, 2**63 + 1], [3, 4]], ids=str)
def test_user_numbers_in_a_list_are_given_back(world, users):
    handles = world.add_boxes(crofton.boxes(np.zeros((2, 3)), 1), users=users)
    assert [world.user_of(crofton.ObjectHandle(*map(int, h))) for h in handles] == list(users)


@pytest.mark.parametrize("users, error", [([-1, 2**63], crofton.Error), ([1.5, 2], TypeError), ([2**63, 0.5], TypeError)])
def test_user_numbers_that_are_none_add_nothing(world, users, error):
    with pytest.raises(error):
        world.add_boxes(crofton.boxes(np.zeros((2, 3)), 1), users=users)
    assert len(world) == 0


@pytest.mark.parametrize("indices", [[], np.zeros((0, 3), "u4"), np.zeros(0, "u2")], ids=repr)
def test_no_indices_are_no_triangles(world, cube, indices):
    with pytest.raises(crofton.Error) as raised:
        world.add_mesh(cube[0][:6], indices)
    assert raised.value.code == "empty"


def test_errors_name_what_python_has(world, cube):
    positions, indices = cube
    mesh = world.add_mesh(positions, indices)
    with pytest.raises(crofton.Error) as error:
        world.set_vertices(mesh, [(0, 0, 0)])
    assert "add another mesh" in str(error.value) and "replace_mesh" not in str(error.value)
    with pytest.raises(crofton.Error) as error:
        crofton.IntrinsicVolumes.of_hull([(float("nan"), 0, 0)])
    assert str(error.value).startswith("hull: point 0")


def test_a_list_of_views_that_is_emptied_while_it_is_read(world):
    requests = []

    class Emptying:
        def __array__(self, *_):
            requests.clear()
            return np.eye(4)

    requests += [Emptying(), crofton.Camera()]
    with pytest.raises((TypeError, crofton.Error)):
        world.view(requests)


@pytest.mark.parametrize("protocol", range(pickle.HIGHEST_PROTOCOL + 1))
def test_pickle_and_copy_refuse_by_name(protocol):
    for thing in (crofton.Shape.sphere(1.0), crofton.World(), crofton.Camera(), crofton.Box((0, 0, 0), (1, 1, 1))):
        with pytest.raises(TypeError, match="pickle"):
            pickle.dumps(thing, protocol)
        with pytest.raises(TypeError, match="pickle"):
            copy.copy(thing)


def library_types():
    return [value for value in vars(crofton._crofton).values()
            if isinstance(value, type) and not issubclass(value, BaseException)]


@pytest.mark.parametrize("type_", library_types(), ids=lambda type_: type_.__name__)
def test_an_object_that_was_never_initialised_is_a_type_error(type_):
    with pytest.raises(TypeError):
        type_.__new__(type_).__reduce__()
    try:
        thing = type_.__new__(type_)
    except TypeError:
        return  # it has no constructor
    for name, member in vars(type_).items():
        if isinstance(member, property):
            with pytest.raises(TypeError, match="__init__ was not called"):
                getattr(thing, name)
        elif not name.startswith("__") and not isinstance(member, staticmethod) and callable(member):
            with pytest.raises(TypeError):
                getattr(thing, name)()


def test_no_call_reads_an_object_that_was_never_initialised():
    world, mesh = crofton.World.__new__(crofton.World), crofton.Mesh.__new__(crofton.Mesh)
    for call in (world.update, lambda: len(world), lambda: world.view(crofton.Camera()),
                 lambda: crofton.Shape.mesh(mesh), lambda: world.remove(world), lambda: 3 in world,
                 lambda: crofton.World().view(crofton.Camera.__new__(crofton.Camera))):
        with pytest.raises(TypeError):
            call()


@pytest.mark.parametrize("answer", [crofton.ShapeHit, crofton.ObjectManifold, crofton.ObjectHit, crofton.Contact, crofton.ViewResult])
def test_answers_are_made_by_calls_alone(answer):
    for make in (answer, lambda: answer.__new__(answer)):
        with pytest.raises(TypeError, match="constructor"):
            make()


def interrupted(call):
    """Presses Ctrl-C 0.2 s after the start of a call, and returns how long it took to stop."""
    press = threading.Timer(0.2, signal.pthread_kill, [threading.main_thread().ident, signal.SIGINT])
    start = time.monotonic()
    press.start()
    try:
        with pytest.raises(KeyboardInterrupt):
            call()
        return time.monotonic() - start
    finally:
        press.join()


def many_rays(random, count):
    return random.uniform(-1, 1, (count, 3)), random.uniform(-1, 1, (count, 3)) + (0, 0, 2)


def test_ctrl_c_ends_many_rays_and_loses_nothing(world, cube, random):
    world.add_boxes(crofton.boxes(random.uniform(-50, 50, (20_000, 3)), 0.5))
    world.update()
    origins, directions = many_rays(random, 4_000_000)
    whole = world.raycast_many(origins[:1000], directions[:1000])
    assert interrupted(lambda: world.raycast_many(origins, directions)) < 2
    assert (world.raycast_many(origins[:1000], directions[:1000]) == whole).all()
    mesh = crofton.Mesh(*cube)
    assert interrupted(lambda: [mesh.raycast_many(origins, directions) for _ in range(100)]) < 10
    assert mesh.raycast_many(origins[:9], directions[:9])["hit"].all()


def test_a_handler_of_ctrl_c_may_use_the_world_that_is_asked(world, random):
    world.add_boxes(crofton.boxes(random.uniform(-50, 50, (20_000, 3)), 0.5))
    world.update()
    origins, directions = many_rays(random, 1_000_000)
    called = []
    signal.signal(signal.SIGINT, lambda *_: called.append(world.update()))
    try:
        threading.Timer(0.1, signal.pthread_kill, [threading.main_thread().ident, signal.SIGINT]).start()
        found = world.raycast_many(origins, directions)
    finally:
        signal.signal(signal.SIGINT, signal.default_int_handler)
    assert called == [None]
    assert (found[-1000:] == world.raycast_many(origins[-1000:], directions[-1000:])).all()


def test_ctrl_c_during_a_change_leaves_all_or_nothing(world, random):
    boxes = crofton.boxes(random.uniform(-50, 50, (1000, 3)), 0.5)

    def change_for_ever():
        while True:
            world.remove(world.add_boxes(boxes))

    for _ in range(3):
        before = len(world)
        assert interrupted(change_for_ever) < 2
        assert len(world) - before in (0, 1000)
    world.update()
    assert world.statistics["objects"] == len(world)


class Fresh:
    """A sequence whose items live only as long as someone holds them, like those of an array."""

    def __init__(self, make, count):
        self.make, self.count = make, count

    def __len__(self):
        return self.count

    def __getitem__(self, i):
        if i >= self.count:
            raise IndexError(i)
        return self.make(i)


def at(x):
    matrix = np.eye(4)
    matrix[0, 3] = x
    return matrix


def test_items_that_a_sequence_makes_anew_are_held(world):
    ball = crofton.Shape.sphere(1)
    row = crofton.Shape.compound(Fresh(lambda i: (crofton.Shape.box((1, 1, 1)), at(3.0 * i)), 100))
    assert abs(row.bounds - [[-1, -1, -1], [298, 1, 1]]).max() < 1e-9
    assert row.touches(ball, at(299)) and not row.touches(ball, at(1.5 + 300))
    assert crofton.Shape.compound(Fresh(lambda i: (crofton.Shape.sphere(1.0), None), 3)).touches(ball)
    for wrong in ("\ud800\u4e2d", b"ab", np.zeros(3), np.zeros(3, complex), Fresh(lambda i: [0.0] * 1000, 20)):
        with pytest.raises(TypeError):
            crofton.Shape.compound(wrong)
    world.add(sphere=((0, 0, -5), 1.0))
    world.update()
    requests = Fresh(lambda i: crofton.ViewRequest(crofton.Camera((0, 0, 0), (0, 0, -1 if i % 2 else 1))), 30)
    try:
        seen = world.view(requests)
    except TypeError:
        seen = world.view(list(requests))
    assert seen.view_count == 30 and seen.view_masks.tolist() == [0xAAAAAAAA & (1 << 30) - 1]


@pytest.mark.parametrize("call", [
    lambda w, m: crofton.Shape.mesh(None), lambda w, m: crofton.Shape.rounded(None, 1), lambda w, m: crofton.Shape.compound([None]),
    lambda w, m: crofton.Shape.sphere(1).touches(None), lambda w, m: w.set_occluders(m, [None]), lambda w, m: w.attach(None, (0, 0, 0)),
    lambda w, m: crofton.DepthObject(None, np.eye(4)), lambda w, m: crofton.DepthCuller().find_visible([None], 9, 9),
    lambda w, m: w.view([None]), lambda w, m: w.cast(None, (0, 0, 1)), lambda w, m: crofton.ShadowReceivers(None), lambda w, m: w.hidden_by(None),
    lambda w, m: crofton.distance(None, None), lambda w, m: crofton.merge([None]), lambda w, m: crofton.Region.prepare(instances=[(None, np.eye(4))]), lambda w, m: w.set_mesh(None, m),
], ids=range(16))
def test_none_in_place_of_a_thing_is_refused(world, cube, call):
    mesh = world.add_mesh(*cube)
    with pytest.raises((TypeError, crofton.Error)):
        call(world, mesh)
