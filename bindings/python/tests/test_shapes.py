# SPDX-License-Identifier: MIT
import gc
import math

import numpy as np
import pytest

import crofton
from crofton import Shape


def at(x, y, z):
    matrix = np.eye(4)
    matrix[:3, 3] = x, y, z
    return matrix


def test_what_shapes_are(cube):
    shapes = {
        "sphere": Shape.sphere(2), "capsule": Shape.capsule(1, 0.5), "cylinder": Shape.cylinder(1, 0.5),
        "cone": Shape.cone(1, 0.5), "box": Shape.box((1, 2, 3)), "hull": Shape.hull(cube[0]),
        "half_space": Shape.half_space((0, -1, 0)), "mesh": Shape.mesh(crofton.Mesh(*cube)),
        "height_field": Shape.height_field(np.zeros((3, 4))),
        "compound": Shape.compound([Shape.sphere(1), (Shape.box((1, 1, 1)), at(5, 0, 0))]),
    }
    for kind, shape in shapes.items():
        assert shape.kind == kind
    assert np.array_equal(shapes["box"].bounds, [[-1, -2, -3], [1, 2, 3]])
    assert shapes["compound"].bounds == pytest.approx(np.array([[-1, -1, -1], [6, 1, 1]]), rel=1e-4)
    assert np.array_equal(shapes["height_field"].bounds[1], [3, 0, 2])


def test_mass_by_formula():
    mass = Shape.box((1, 2, 3)).mass
    assert mass.volume == 48 and mass.center == (0, 0, 0)
    assert np.diag(mass.inertia) == pytest.approx([48 / 3 * (4 + 9), 48 / 3 * (1 + 9), 48 / 3 * (1 + 4)])
    assert Shape.sphere(2).mass.volume == pytest.approx(4 / 3 * math.pi * 8)
    with pytest.raises(crofton.Error) as error:
        Shape.half_space((0, 1, 0)).mass
    assert error.value.code == "unsupported"


@pytest.mark.parametrize("gap", [-0.5, -0.1, 0.1, 4.0])
def test_a_sphere_and_a_box(gap):
    sphere, box, pose = Shape.sphere(1), Shape.box((1, 1, 1)), at(0.2, 2 + gap, 0.1)
    assert sphere.touches(box, pose) == (gap < 0)
    assert sphere.distance(box, pose).distance == pytest.approx(max(gap, 0))
    depth, normal = sphere.penetration(box, pose)
    assert depth == pytest.approx(max(-gap, 0))
    # Where each shape stands is relative: both may be moved.
    assert sphere.distance(box, at(0.2, 2 + gap, 0.1) @ at(3, 4, 5), at(3, 4, 5)).distance == pytest.approx(max(gap, 0))
    if gap < 0:
        assert normal == pytest.approx((0, 1, 0))
        (contact,) = sphere.contacts(box, pose)
        assert contact["depth"] == pytest.approx(-gap) and contact["normal"] == pytest.approx([0, 1, 0])
    else:
        assert len(sphere.contacts(box, pose)) == 0


def test_a_rounded_box_is_as_far_as_its_core_less_the_radius():
    core, other = Shape.box((1, 1, 1)), Shape.sphere(1)
    assert Shape.rounded(core, 0.25).distance(other, at(5, 0, 0)).distance == pytest.approx(5 - 1 - 1 - 0.25)


def test_a_cast_meets_a_wall_when_the_formula_says():
    ball, wall = Shape.sphere(0.5), Shape.box((1, 10, 10))
    impact = ball.cast((4, 0, 0), wall, at(6, 0, 0))
    assert impact is None  # in one second it comes to 4 + 0.5
    impact = ball.cast((4, 0, 0), wall, at(6, 0, 0), duration=2)
    assert impact.time == pytest.approx((5 - 0.5) / 4, abs=1e-5) and impact.normal == pytest.approx((1, 0, 0))
    assert impact.resolved and impact.on_b[0] == pytest.approx(5)
    assert ball.cast((-4, 0, 0), wall, at(6, 0, 0), duration=2) is None
    # A rod that turns about its middle: its end comes to the wall's height after the angle of asin.
    rod = Shape.box((2, 0.01, 0.01))
    floor = Shape.half_space((0, -1, 0), -1.0)  # below y = -1
    impact = rod.cast((0, 0, 0), floor, spin=(0, 0, 1), duration=3)
    assert impact is None or impact.time == pytest.approx(math.asin(0.5), abs=0.02)


def test_a_ray_and_a_shape():
    hit = Shape.sphere(1).raycast((0, 0, 5), (0, 0, -1))
    assert hit.t == pytest.approx(4) and hit.normal == pytest.approx((0, 0, 1)) and not hit.started_inside
    assert Shape.sphere(1).raycast((0, 0, 5), (0, 0, -1), pose=at(3, 0, 0)) is None
    assert Shape.sphere(1).raycast((0, 0, 0), (0, 0, -1)).started_inside


def test_shapes_in_a_world(cube):
    world = crofton.World()
    floor = world.add(shape=Shape.box((10, 1, 10)), transform=at(0, -1, 0), user=1)
    ball = world.add(shape=Shape.sphere(1), transform=at(0, 0.75, 0), user=2)
    far = world.add(shape=Shape.hull(cube[0]), transform=at(0, 50, 0), user=3)
    gc.collect()  # the world keeps what it refers to
    world.update()
    (contact,) = world.contacts
    assert (contact.first.object, contact.second.object, contact.phase) == (floor, ball, "began")
    assert contact.depth == pytest.approx(0.25) and contact.normal == pytest.approx((0, 1, 0))
    assert contact.points.shape == (1, 3) and contact.depths == pytest.approx([0.25])

    hit = world.cast(Shape.sphere(0.5), (0, -100, 0), at(5, 20, 0))
    assert hit.object == floor and hit.user == 1 and hit.time == pytest.approx((20 - 0.5) / 100, abs=1e-5)
    assert world.cast(Shape.sphere(0.5), (0, 0, 1), at(0, 30, 0)) is None
    assert list(world.overlap(shape=Shape.sphere(0.1), pose=at(0, 1.5, 0))["index"]) == [ball.index]
    assert world.closest(100, shape=Shape.sphere(1), pose=at(0, 40, 0)).distance == pytest.approx(8)

    world.set_shape(ball, Shape.sphere(0.5))
    world.update()
    assert [c.phase for c in world.contacts] == ["ended"]
    world.remove(far)
    world.update()
    assert world.raycast((0, 90, 0), (0, -1, 0)).user == 2


def test_many_shapes_that_come_and_go_leave_the_world_whole(random):
    world, held = crofton.World(), []
    for _ in range(12):
        held += [world.add(shape=Shape.hull(random.normal(size=(12, 3))), transform=at(*random.uniform(-9, 9, 3)))
                 for _ in range(20)]
        for k in sorted(random.choice(len(held), 10, replace=False), reverse=True):
            world.remove(held.pop(k))
        gc.collect()
        world.update()
        assert all(c.depth >= 0 for c in world.contacts if c.phase != "ended")
    assert len(world) == len(held) == 120


@pytest.mark.parametrize(
    "make, code",
    [
        (lambda: Shape.sphere(-1), "invalid_argument"),
        (lambda: Shape.sphere(math.nan), "not_finite"),
        (lambda: Shape.box((1, math.inf, 1)), "not_finite"),
        (lambda: Shape.hull(np.zeros((9, 3))), "degenerate"),
        (lambda: Shape.half_space((0, 0, 0)), "degenerate"),
        (lambda: Shape.compound([]), "empty"),
        (lambda: Shape.compound([(Shape.sphere(1), np.diag([2, 2, 2, 1]))]), "invalid_argument"),
        (lambda: Shape.height_field(np.full((2, 2), math.nan)), "not_finite"),
        (lambda: Shape.sphere(1).cast((math.nan, 0, 0), Shape.sphere(1)), "not_finite"),
        (lambda: Shape.sphere(1).raycast((0, 0, 0), (0, 0, 0)), None),
    ],
)
def test_a_shape_that_is_none_is_refused(make, code):
    with pytest.raises(crofton.Error) as error:
        make()
    assert code is None or error.value.code == code


def test_other_things_than_shapes_are_refused():
    for make in (lambda: Shape.compound([7]), lambda: Shape.box(7), lambda: Shape.sphere("x"), lambda: Shape.sphere(1).touches(7),
                 lambda: Shape.height_field([1, 2]), lambda: Shape.height_field(np.zeros((2, 2)), spacing=1)):
        with pytest.raises(TypeError):
            make()
    world = crofton.World()
    with pytest.raises(TypeError, match="pose"):
        world.overlap(sphere=((0, 0, 0), 1), pose=np.eye(4))
    with pytest.raises(crofton.Error, match="half-space"):
        world.overlap(shape=Shape.half_space((0, 1, 0)))
