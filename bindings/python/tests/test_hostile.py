# SPDX-License-Identifier: MIT
"""A random walk over everything that is public: each call with arguments of any kind answers or raises an error with a text."""
import inspect
import itertools
import random

import numpy as np
import pytest

import crofton

ERRORS = (crofton.Error, TypeError, ValueError, OSError, OverflowError, MemoryError)
CLASSES = {name: thing for name, thing in vars(crofton).items() if inspect.isclass(thing) and not name.startswith("_")}
FUNCTIONS = {name: thing for name, thing in vars(crofton).items() if callable(thing) and not inspect.isclass(thing) and not name.startswith("_")}
KEYWORDS = ["mesh", "box", "sphere", "shape", "transform", "user", "users", "layers", "camera", "volume", "occlusion", "picture", "limits", "candidates",
            "order", "pose", "max_t", "ignored", "seconds", "quality", "criterion", "method", "ring_ends", "clusters", "radius", "samples", "hidden"]
PLAIN = ("__len__", "__iter__", "__eq__", "__hash__", "__repr__", "__getitem__", "__contains__")
CUBE = np.array(list(itertools.product([-1.0, 1.0], repeat=3)), "f4")
FACES = np.array([0, 1, 3, 0, 3, 2, 4, 6, 7, 4, 7, 5, 0, 4, 5, 0, 5, 1, 2, 3, 7, 2, 7, 6, 0, 2, 6, 0, 6, 4, 1, 5, 7, 1, 7, 3], "u4")


class Failing:
    def __array__(self, *_, **__):
        raise ValueError("no array")

    def __index__(self):
        raise ValueError("no index")


class Endless:
    def __len__(self):
        return 2**62

    def __getitem__(self, _):
        return 0.0


def hostile(dice):
    endless = []
    endless.append(endless)
    kinds = ["f4", "f8", ">f8", "f2", "g", "i8", "u4", "u2", "c16", "O", "S3", "M8[s]", "?"]
    return dice.choice([
        None, float("nan"), float("inf"), -1, 0, 1, 2, 0.5, 2**31, 2**32, 2**63, 2**64, -(2**63), 10**400, 1e308, 5e-324, True, 1j, "x", "", "\0", "\ud800", b"\0\1", [], (), {},
        endless, object(), Failing(), Endless(), iter(()), range(5), (0, 0, 0), (0, 0, -1), (float("nan"), 0, 0), (1e308,) * 3, [[0, 0, 0]], slice(None), "/nonexistent", "/", crofton.World,
        np.zeros(dice.choice([0, 1, 3, 4, 16])), np.eye(dice.choice([2, 3, 4])), np.zeros((dice.choice([0, 1, 5]), dice.choice([0, 2, 3, 4])), dice.choice(kinds)), np.full((4, 3), np.nan),
        np.array(5.0), np.zeros((3, 3, 3)), np.zeros(3, [("a", "f8"), ("b", "u4")]), CUBE[::-2], CUBE, FACES, FACES + 2**31, np.zeros((0, 3)), memoryview(b"abc"), np.asfortranarray(CUBE)])


def things():
    world = crofton.World()
    mesh = world.add_mesh(CUBE, FACES, clusters=True)
    region = crofton.Region.prepare(crofton.boxes([(0, 0, -9)], 1))
    made = [world, mesh, world.add(mesh=mesh), world.add_node(), world.attach(region)]
    world.update()
    return made + [region, world.view(crofton.Camera()), crofton.Camera(), crofton.Box((0, 0, 0), (1, 1, 1)), crofton.Mesh(CUBE, FACES), crofton.Shape.sphere(1.0),
                   crofton.BoxList([crofton.Box((0, 0, 0), (1, 1, 1))] * 2), crofton.ClusteredMesh(CUBE, FACES), crofton.DepthCuller()]


@pytest.mark.parametrize("seed", range(4))
def test_no_call_ends_without_an_answer_or_a_named_error(seed):
    dice, pool = random.Random(seed), things()
    for step in range(3000):
        which = dice.random()
        if which < 0.3:
            name, call = dice.choice(sorted(FUNCTIONS.items()))
        elif which < 0.5:
            name, call = dice.choice(sorted(CLASSES.items()))
        else:
            thing = dice.choice(pool)
            name = dice.choice([n for n in dir(type(thing)) if n in PLAIN or not n.startswith("__")])
            call = getattr(thing, name)
        if not callable(call) or name == "set_threads" and dice.random() < 0.9:
            continue
        value = lambda: dice.choice(pool) if dice.random() < 0.35 else hostile(dice)
        positional = [value() for _ in range(dice.choice([0, 1, 1, 2, 2, 3]))]
        named = {key: value() for key in dice.sample(KEYWORDS, dice.choice([0, 0, 1, 2]))}
        if name == "bake":
            named["seconds"] = 0.1
        try:
            answer = call(*positional, **named)
        except ERRORS as error:
            assert str(error) or isinstance(error, MemoryError), (step, name)
            continue
        if type(answer).__module__.startswith("crofton") and len(pool) < 60:
            pool.append(answer)
    crofton.set_threads(1)
