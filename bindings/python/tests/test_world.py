# SPDX-License-Identifier: MIT
import gc
import threading

import numpy as np
import pytest

import crofton


def at(x, y, z):
    matrix = np.eye(4)
    matrix[:3, 3] = (x, y, z)
    return matrix


@pytest.fixture
def world():
    return crofton.World()


def test_a_mesh_is_seen_hit_and_touched(world, cube):
    mesh = world.add_mesh(*cube)
    near = world.add(mesh=mesh, transform=at(0, 0, -5), user=7)
    far = world.add(mesh=mesh, transform=at(0.5, 0, -6.5), user=8)
    world.update()
    seen = world.view(crofton.Camera())
    assert seen.users.tolist() == [7, 8] and len(seen) == 2
    hit = world.raycast((0, 0, 0), (0, 0, -1))
    assert hit.object == near and hit.user == 7 and hit.t == 4 and hit.point == (0, 0, -4)
    assert hit.triangle in range(12)
    assert [h.user for h in world.raycast_all((0, 0, 0), (0, 0, -1))] == [7, 8]
    (contact,) = world.contacts
    assert (contact.first.object, contact.second.object) == (near, far)
    assert contact.phase == "began"
    assert repr(contact).startswith("Contact(7 and 8, began, depth=0.5")
    assert repr(hit) == "ObjectHit(user=7, t=4, point=(0, 0, -4))"
    assert repr(seen) == "ViewResult(2 objects)"
    world.update()
    assert world.contacts[0].phase == "stayed"
    world.remove(far)
    world.update()
    assert world.contacts[0].phase == "ended"
    world.update()
    assert world.contacts == []


@pytest.mark.parametrize("dtype", ["u2", "u4", "i8"])
@pytest.mark.parametrize("points", ["f4", "f8"])
def test_meshes_of_any_number_type(world, cube, dtype, points):
    mesh = world.add_mesh(cube[0].astype(points), cube[1].astype(dtype).reshape(-1, 3))
    world.add(mesh=mesh)
    world.update()
    assert world.raycast((0.2, 0.1, 9), (0, 0, -1)).t == pytest.approx(8)


def test_a_mesh_without_indices(world, cube):
    world.add(mesh=world.add_mesh(cube[0][cube[1]]))
    world.update()
    assert world.raycast((0.2, 0.1, 9), (0, 0, -1)).t == pytest.approx(8)


def test_vertices_can_move(world, cube):
    mesh = world.add_mesh(*cube)
    world.add(mesh=mesh)
    world.set_vertices(mesh, 2 * cube[0])
    world.update()
    assert world.raycast((0.2, 0.1, 9), (0, 0, -1)).t == pytest.approx(7)
    with pytest.raises(crofton.Error):
        world.set_vertices(mesh, cube[0][:3])


@pytest.mark.parametrize("index", [8, 2**20])
def test_an_index_out_of_range_is_an_error(world, cube, index):
    bad = cube[1].copy()
    bad[5] = index
    with pytest.raises(crofton.Error):
        world.add_mesh(cube[0], bad)


def test_bounds_of_three_kinds(world):
    world.add(box=crofton.Box((0, 0, -5), (1, 1, 1)), user=1)
    world.add(sphere=((0, 0, -10), 1.0), user=2)
    world.add(aligned=((-1, -1, -16), (1, 1, -14)), user=3)
    world.update()
    hits = world.raycast_all((0, 0, 0), (0, 0, -1))
    assert [h.user for h in hits] == [1, 2, 3]
    assert [h.t for h in hits] == pytest.approx([4, 9, 14])
    assert hits[1].triangle is None


@pytest.mark.parametrize("bound", [{"sphere": ((0, 0, 0), -1.0)}, {"aligned": ((1, 0, 0), (0, 1, 1))}, {}], ids=str)
def test_bounds_that_are_none_are_an_error(world, bound):
    with pytest.raises(crofton.Error):
        world.add(**bound)
    assert len(world) == 0


def test_nodes_carry_what_is_below(world, cube):
    mesh = world.add_mesh(*cube)
    parent = world.add_node(transform=at(10, 0, 0))
    child = world.add_node(parent, at(0, 5, 0))
    thing = world.add(mesh=mesh, node=child, transform=at(0, 0, 1))
    world.update()
    assert (world.transform_of(thing) == at(10, 5, 1)).all()
    world.set_transform(parent, at(-1, 0, 0))
    world.set_node_transforms([child], at(0, 0, 0)[None])
    world.update()
    assert (world.box_of(thing).center == (-1, 0, 1)).all()
    world.remove(parent)
    world.update()
    assert thing not in world and child not in world and mesh in world


def test_moves_in_arrays(world, random):
    boxes = crofton.boxes(random.uniform(-50, 50, (500, 3)), 1)
    handles = world.add_boxes(boxes, users=np.arange(500) + 1000)
    world.update()
    boxes["center"] += 3
    world.set_boxes(handles, boxes)
    world.update()
    seen = world.view(crofton.Camera())
    assert (seen.ids == crofton.find_visible(crofton.Camera(), boxes)).all()
    assert (seen.users == seen.ids + 1000).all()
    assert (seen.handles == handles[seen.ids]).all()
    assert world.user_of(crofton.ObjectHandle(int(handles[3]["index"]), int(handles[3]["generation"]))) == 1003


def test_many_boxes_are_added_all_or_none(world, random):
    boxes = crofton.boxes(random.uniform(-50, 50, (3000, 3)), 1)
    world.reserve(6000)
    boxes["center"][2500, 1] = np.nan
    with pytest.raises(crofton.Error) as raised:
        world.add_boxes(boxes)
    assert raised.value.item == 2500 and len(world) == 0
    boxes["center"][2500, 1] = 0
    handles = world.add_boxes(boxes)
    world.update()
    assert len(world) == 3000 and len(set(handles["index"])) == 3000
    with pytest.raises(crofton.Error):
        world.reserve(2**31)


def test_instances_in_arrays(world, cube):
    transforms = np.array([at(0, 0, -5 * i) for i in range(1, 6)])
    handles = world.add_instances(world.add_mesh(*cube), transforms)
    world.update()
    assert len(world.view(crofton.Camera())) == 5
    world.set_transforms(handles, transforms[::-1, :3])
    world.update()
    assert world.raycast((0, 0, 0), (0, 0, -1)).object.index == handles[4]["index"]


def test_one_bad_box_adds_none(world):
    boxes = crofton.boxes(np.zeros((5, 3)), 1)
    boxes["center"][3] = np.nan
    with pytest.raises(crofton.Error) as raised:
        world.add_boxes(boxes)
    assert raised.value.item == 3
    assert len(world) == 0


@pytest.mark.parametrize(
    "call",
    [
        lambda w, h: w.set_transform(h, at(0, 0, 0)),
        lambda w, h: w.box_of(h),
        lambda w, h: w.user_of(h),
        lambda w, h: w.remove(h),
        lambda w, h: w.set_hidden(h, True),
        lambda w, h: w.set_layers(h, 1),
        lambda w, h: w.set_boxes(h, crofton.Box((0, 0, 0), (1, 1, 1))),
    ],
)
def test_a_stale_handle_is_named(world, call):
    handle = world.add(box=crofton.Box((0, 0, 0), (1, 1, 1)))
    world.remove(handle)
    world.update()
    assert handle not in world
    with pytest.raises(crofton.Error) as raised:
        call(world, handle)
    assert raised.value.code == "stale_handle"


@pytest.mark.parametrize("bad", [None, 5, "object", [1, 2], np.zeros(3)], ids=str)
def test_what_is_no_handle_is_a_type_error(world, bad):
    with pytest.raises(TypeError):
        world.remove(bad)


def test_a_node_is_no_mesh(world):
    with pytest.raises(TypeError, match="mesh"):
        world.add(mesh=world.add_node())


def test_handles_are_values():
    a = crofton.ObjectHandle(3, 1)
    assert a == crofton.ObjectHandle(3, 1) and a != crofton.ObjectHandle(3, 2)
    assert a != crofton.NodeHandle(3, 1)
    assert len({a, crofton.ObjectHandle(3, 1)}) == 1
    assert repr(a) == "ObjectHandle(index=3, generation=1)"


def test_hidden_and_layered_objects(world):
    box = crofton.Box((0, 0, -5), (1, 1, 1))
    first, second = world.add(box=box, layers=1), world.add(box=box, layers=2)
    world.update()
    assert len(world.view(crofton.Camera())) == 2
    assert world.view(crofton.Camera(), layers=2).ids.tolist() == [second.index]
    world.set_hidden(second, True)
    world.set_layers([first], 4)
    late = world.add(box=box, layers=2, hidden=True)
    world.update()
    assert world.view(crofton.Camera()).ids.tolist() == [first.index]
    world.set_hidden(late, False)
    world.update()
    assert world.view(crofton.Camera()).ids.tolist() == [first.index, late.index]
    assert len(world.view(crofton.Camera(), layers=1)) == 0


def test_a_list_of_boxes_is_an_array_of_them(world):
    near, far = crofton.Box((0, 0, -5), (1, 1, 1)), crofton.Box((0, 0, -9), (1, 1, 1))
    assert len(world.add_boxes([near, far])) == len(world.add_boxes((near, far))) == len(crofton.BoxList([near, far])) == 2
    world.attach(crofton.Region.prepare([near, far, near]))
    world.update()
    assert len(world.view(crofton.Camera())) == 7
    with pytest.raises(TypeError, match="not all are a Box"):
        world.add_boxes([near, 5])


def test_what_hides_behind_a_wall_is_left_out(world, cube):
    wall = world.add_mesh(cube[0] * [20, 20, 0.1], cube[1], occluders=True)
    front = world.add(mesh=wall, transform=at(0, 0, -10))
    behind = world.add(box=crofton.Box((0, 0, -20), (1, 1, 1)))
    beside = world.add(box=crofton.Box((-3, 0, -5), (1, 1, 1)))
    world.update()
    seen = world.view(crofton.Camera(), occlusion=crofton.OcclusionOptions(size=(320, 180), list_occluded=True))
    assert seen.ids.tolist() == sorted([front.index, beside.index])
    assert seen.occluded_ids.tolist() == [behind.index]
    assert seen.depth.shape == (180, 320) and (seen.depth > 0).any()
    assert seen.statistics["occluders_drawn"] >= 1
    assert world.view(crofton.Camera()).depth is None


def test_many_rays_are_as_one(world, random):
    world.add_boxes(crofton.boxes(random.uniform(-20, 20, (300, 3)), 0.8), users=np.arange(300))
    world.update()
    directions = random.normal(size=(100, 3))
    many = world.raycast_many(np.zeros((1, 3)), directions)
    for record, direction in zip(many, directions):
        one = world.raycast((0, 0, 0), direction)
        assert bool(record["hit"]) == (one is not None)
        if one:
            assert (record["t"], record["user"], record["index"]) == (one.t, one.user, one.object.index)
        else:
            assert np.isinf(record["t"])


@pytest.mark.parametrize("ray", [((0, 0, 0), (0, 0, 0)), ((np.nan, 0, 0), (1, 0, 0)), ((0, 0, 0), (1, 0, 0), -1.0)], ids=str)
def test_a_ray_that_is_none_is_an_error(world, ray):
    with pytest.raises(crofton.Error):
        world.raycast(*ray)


def test_overlap_and_closest(world):
    handle = world.add(box=crofton.Box((5, 0, 0), (1, 1, 1)))
    world.update()
    for shape in ({"box": crofton.Box((3.5, 0, 0), (1, 1, 1))}, {"sphere": ((3, 0, 0), 1.0)},
                  {"capsule": ((0, 0, 0), (3.5, 0, 0), 0.6)}):
        assert world.overlap(**shape)["index"].tolist() == [handle.index]
    assert len(world.overlap(sphere=((0, 0, 0), 1.0))) == 0
    nearest = world.closest(100.0, sphere=((0, 0, 0), 1.0))
    assert nearest.object == handle and nearest.distance == pytest.approx(3)
    assert nearest.on_object == pytest.approx((4, 0, 0))
    assert world.closest(2.0, sphere=((0, 0, 0), 1.0)) is None
    with pytest.raises(TypeError):
        world.overlap()


def test_pairs_are_those_of_the_broadphase(random):
    boxes = crofton.boxes(random.uniform(-10, 10, (200, 3)), 1)
    world = crofton.World(contacts=False)
    world.add_boxes(boxes)
    world.update()
    broadphase = crofton.Broadphase()
    broadphase.update(boxes)
    assert (world.pairs == broadphase.pairs).all()


def test_answers_outlive_the_world(cube):
    world = crofton.World()
    world.add(mesh=world.add_mesh(*cube), transform=at(0, 0, -5), user=9)
    world.update()
    seen, contacts = world.view(crofton.Camera()), world.contacts
    del world
    gc.collect()
    assert seen.users.tolist() == [9] and contacts == []


def test_threads_ask_while_one_changes(random):
    boxes = crofton.boxes(random.uniform(-50, 50, (2000, 3)), 1)
    world = crofton.World(pairs=False)
    handles = world.add_boxes(boxes)
    world.update()
    stop, wrong = threading.Event(), []

    def ask():
        while not stop.is_set():
            seen = world.view(crofton.Camera())
            if len(seen) != len(set(seen.ids.tolist())):
                wrong.append(len(seen))

    threads = [threading.Thread(target=ask) for _ in range(3)]
    for thread in threads:
        thread.start()
    for step in range(60):
        boxes["center"] += random.normal(size=(2000, 3))
        world.set_boxes(handles, boxes)
        world.update()
        if step % 10 == 9:
            gc.collect()
    stop.set()
    for thread in threads:
        thread.join()
    assert not wrong
    assert (world.view(crofton.Camera()).ids == crofton.find_visible(crofton.Camera(), boxes)).all()


def test_more_pairs_than_allowed_is_an_error():
    world = crofton.World(max_pairs=10)
    world.add_boxes(crofton.boxes(np.zeros((30, 3)), 1))
    with pytest.raises(crofton.Error):
        world.update()
    assert len(world.pairs) == 0


def test_kinds_of_trees():
    for tree in ("aligned", "oriented", "automatic"):
        crofton.World(tree=tree).update()
    with pytest.raises(crofton.Error):
        crofton.World(tree="round")


@pytest.mark.parametrize("matrix", [np.eye(3), np.zeros((2, 4)), None, "matrix"], ids=str)
def test_what_is_no_matrix_is_a_type_error(world, matrix):
    with pytest.raises(TypeError):
        world.add_node(transform=5 if matrix is None else matrix)


@pytest.mark.parametrize("entry", [np.nan, np.inf, 1e300])
def test_a_matrix_with_a_bad_number_is_an_error(world, entry):
    matrix = np.eye(4)
    matrix[0, 1] = entry
    with pytest.raises(crofton.Error):
        world.add_node(transform=matrix)


def test_a_projective_matrix_is_an_error(world):
    matrix = np.eye(4)
    matrix[3, 0] = 1
    with pytest.raises(crofton.Error):
        world.add_node(transform=matrix)


def cube_of(world, cube, size=1.0, **how):
    return world.add_mesh(size * cube[0], cube[1], **how)


DOWN = ((0.2, 0.1, 9), (0, 0, -1))


def test_a_mesh_is_replaced_in_all_objects_that_have_it(world, cube):
    mesh = cube_of(world, cube)
    objects = [world.add(mesh=mesh, transform=at(x, 0, 0)) for x in (0, 10)]
    world.update()
    world.replace_mesh(mesh, 2 * cube[0], cube[1])
    world.update()
    assert [world.box_of(o).half_extents[0] for o in objects] == pytest.approx([2, 2], rel=1e-6)
    cut = crofton.ClusteredMesh(*cube, max_triangles=1)
    world.replace_mesh(mesh, *cube, clusters=True, precut=cut)
    world.update()
    assert len(world.clusters_of(mesh)) == len(cut) == 12
    with pytest.raises(crofton.Error) as other:
        world.replace_mesh(mesh, cube[0], cube[1][:6], clusters=True, precut=cut)
    assert other.value.code == "invalid_argument"
    with pytest.raises(crofton.Error, match="another World"):
        crofton.World().replace_mesh(mesh, *cube)
    with pytest.raises(TypeError):
        world.replace_mesh(mesh, *cube, precut="cut")


def test_an_object_takes_another_mesh(world, cube):
    small, large = cube_of(world, cube), cube_of(world, cube, 2)
    objects = [world.add(mesh=small, transform=at(x, 0, 0)) for x in (0, 10)]
    world.set_mesh(objects, large)
    world.update()
    assert [world.box_of(o).half_extents[0] for o in objects] == pytest.approx([2, 2], rel=1e-6)
    with pytest.raises(crofton.Error):
        world.set_mesh(objects[0], crofton.MeshHandle(99, 1))


def test_a_bound_becomes_another(world):
    thing = world.add(box=crofton.Box((0, 0, 0), (1, 1, 1)))
    for how, t in (({"sphere": ((0, 0, 0), 2)}, 7), ({"aligned": ((-1, -1, -1), (1, 1, 3))}, 6), ({"box": crofton.Box((0, 0, 4), (1, 1, 1))}, 4)):
        world.set_bound(thing, **how)
        world.update()
        assert world.raycast((0, 0, 9), (0, 0, -1)).t == pytest.approx(t)
    with pytest.raises(crofton.Error):
        world.set_bound(thing)
    with pytest.raises(TypeError):
        world.set_bound(thing, box=crofton.Box((0, 0, 4), (1, 1, 1)), sphere=((0, 0, 0), 2))


def test_user_numbers_and_collisions_change(world):
    first, second = (world.add(box=crofton.Box((0, 0, 0), (1, 1, 1))) for _ in range(2))
    world.set_user(first, 2**64 - 1)
    world.update()
    assert world.user_of(first) == 2**64 - 1 and len(world.contacts) == 1
    world.set_collides_with([first, second], 0)
    world.update()
    assert [c.phase for c in world.contacts] == ["ended"]
    with pytest.raises(TypeError):
        world.set_user(first, -1)


def test_nodes_move_below_others_and_have_layers(world, cube):
    mesh = cube_of(world, cube)
    left, right = (world.add_node(transform=at(x, 0, 0)) for x in (-10, 10))
    thing = world.add(mesh=mesh, node=left)
    world.update()
    assert world.box_of(thing).center[0] == -10
    world.set_parent(left, right)
    world.update()
    assert world.box_of(thing).center[0] == 0
    with pytest.raises(crofton.Error):
        world.set_parent(right, left)
    with pytest.raises(TypeError):
        world.set_parent(left, thing)
    world.set_layers(right, 2)
    world.update()
    assert world.raycast(*DOWN, layers=1) is None and world.raycast(*DOWN, layers=2)
    world.set_parent(left, None)
    world.update()
    assert world.box_of(thing).center[0] == -10


def test_any_hit_of_a_ray(world, cube):
    world.add(mesh=cube_of(world, cube), layers=2)
    world.update()
    assert world.raycast_any(*DOWN) is True and world.raycast_any(*DOWN, layers=1) is False
    assert world.raycast_any(*DOWN, max_t=7.5) is False
    with pytest.raises(crofton.Error):
        world.raycast_any((0, 0, np.nan), (0, 0, -1))


def test_who_hides_whom(world, cube):
    wall = world.add_mesh(cube[0] * [4, 4, 0.1], cube[1], occluders=True)
    hider = world.add(mesh=wall, transform=at(0, 0, -10), user=1, only_occludes=True)
    hidden = world.add(mesh=cube_of(world, cube), transform=at(0, 0, -20), user=2)
    beside = world.add(mesh=cube_of(world, cube), transform=at(-15, 0, -30), user=3)
    world.update()
    seen = world.view(crofton.Camera(), occlusion=True)
    assert seen.users.tolist() == [3]
    (by,) = world.hidden_by(seen, hidden)
    assert (by.object, by.user, by.place) == (hider, 1, 0) and repr(by) == "OccluderRef(user=1, place=0)"
    assert [o.user for o in world.hidden_by(seen)] == [1]
    assert world.hidden_by(seen, beside) == []
    with pytest.raises(crofton.Error):
        crofton.World().hidden_by(seen, hidden)
    world.set_occludes(hider, False)
    world.update()
    assert world.view(crofton.Camera(), occlusion=True).users.tolist() == [2, 3]
    with pytest.raises(crofton.Error):
        world.hidden_by(seen, hidden)  # changed since


def test_contacts_of_meshes_name_their_triangles(cube):
    world = crofton.World(mesh_depth=True)
    mesh = crofton.Mesh(*cube)
    handle = world.add_mesh(mesh)
    first, second = (world.add(mesh=handle, transform=at(x, 0, 0)) for x in (0, 1.5))
    world.update()
    (contact,) = world.contacts
    assert contact.inside == "nothing" and 0.5 <= contact.depth < 0.50001  # enough to end the contact
    expected = mesh.contacts(mesh, at(1.5, 0, 0))
    assert len(expected) > 0
    # The first object's frame is the world's, so that Mesh.contacts gives the same.
    assert [tuple(c) for c in contact.triangles[["first", "second"]]] == [tuple(c) for c in expected[["first", "second"]]]
    for name in ("begin", "end", "normal"):
        assert abs(contact.triangles[name] - expected[name]).max() < 1e-6
    world.set_transform(second, at(0, 0, 0) @ np.diag([0.5, 0.5, 0.5, 1]))
    world.update()
    (contact,) = world.contacts
    assert contact.inside == "second" and len(contact.triangles) == 0


def test_gaps_within_the_margin_are_contacts_of_shapes():
    ball = crofton.Shape.sphere(1)
    for margin, count in ((0, 0), (0.5, 1)):
        world = crofton.World(contact_margin=margin)
        world.add(shape=ball)
        world.add(shape=ball, transform=at(2.25, 0, 0))
        world.update()
        assert len(world.contacts) == count
    assert abs(world.contacts[0].depth + 0.25) < 1e-6
    for wrong in (-1, np.nan, np.inf):
        with pytest.raises(crofton.Error, match="contact_margin"):
            crofton.World(contact_margin=wrong)


def test_occluders_that_are_given_hide_what_is_behind(cube):
    positions, indices = cube
    box = crofton.Box((0, 0, 0), (1, 1, 1))
    plane = np.array([(-1, -1, 0), (1, -1, 0), (1, 1, 0), (-1, 1, 0)], dtype="f4"), np.array([0, 1, 2, 0, 2, 3], dtype="u4")
    kinds = {"box": crofton.Occluder.box(box), "walled": crofton.Occluder.walled(box), "convex": crofton.Occluder.convex(positions),
             "patch": crofton.Occluder.patch(*plane)}
    world = crofton.World()
    mesh = world.add_mesh(positions, indices)
    wall = world.add(mesh=mesh, transform=at(0, 0, -5))
    hidden = world.add(sphere=((0, 0, -9), 0.25))
    world.update()

    def seen():
        world.update()
        return hidden.index in world.view(crofton.Camera(), occlusion=True).ids

    assert seen()
    for name, occluder in kinds.items():
        assert repr(occluder) == f"Occluder({name})"
        world.set_occluders(mesh, [occluder])
        assert not seen(), name
        world.set_occluders(mesh, [])
        assert seen()
    world.set_occluders(mesh, [crofton.Occluder.patch(crofton.Mesh(*plane), one_sided=True)])
    assert not seen()
    world.set_transform(wall, at(0, 0, -5) @ np.diag([-1.0, 1, -1, 1]))  # its back: it hides nothing
    assert seen()
    world.set_occluders(mesh, list(kinds.values()))
    world.set_vertices(mesh, positions)
    assert seen()

    world.set_occluders(mesh, [kinds["box"]])
    assert not seen()
    for wrong in ([kinds["box"], crofton.Occluder.patch(plane[0], [0, 1, 9])],
                  [kinds["box"], crofton.Occluder.convex(plane[0] * np.nan)]):
        with pytest.raises(crofton.Error) as error:
            world.set_occluders(mesh, wrong)
        assert error.value.item == 1
    with pytest.raises(TypeError):
        world.set_occluders(mesh, [box])
    world.remove(wall)
    world.update()
    world.remove(mesh)
    with pytest.raises(crofton.Error) as error:
        world.set_occluders(mesh, [])
    assert error.value.code == "stale_handle"


def test_queries_ignore_objects(world):
    first = world.add(sphere=((0, 0, -5), 1.0))
    second = world.add(sphere=((0, 0, -9), 1.0), layers=2)
    world.update()
    ray, ball = ((0, 0, 0), (0, 0, -1)), ((0, 0, -5), 3.5)
    assert world.raycast(*ray).object == first
    both = world.overlap(sphere=ball)
    for ignored in (first, [first], (first, first), both[:1]):
        assert world.raycast(*ray, ignored=ignored).object == second
    assert world.raycast(*ray, layers=1, ignored=first) is None
    assert world.raycast(*ray, ignored=both) is None and not world.raycast_any(*ray, ignored=both)
    assert world.raycast(*ray, ignored=None).object == world.raycast(*ray, ignored=[]).object == first
    assert [hit.object for hit in world.raycast_all(*ray, ignored=second)] == [first]
    assert list(world.raycast_many([ray[0]], [ray[1]], ignored=first)["index"]) == [second.index]
    assert list(world.overlap(sphere=ball, ignored=first)["index"]) == [second.index]
    assert world.closest(9.0, sphere=ball, ignored=first).object == second
    shape = crofton.Shape.sphere(0.5)
    assert world.cast(shape, (0, 0, -20), ignored=first).object == second
    for wrong in (7, "a", [1], world):
        with pytest.raises(TypeError):
            world.raycast(*ray, ignored=wrong)
    world.remove(first)
    world.update()
    assert world.raycast(*ray, ignored=first).object == second  # stale: without effect


def test_a_shape_that_is_no_object_is_cast_through_all_and_touches(world, cube):
    mesh = world.add_mesh(*cube)
    near = world.add(mesh=mesh, transform=at(0, 0, -5), user=7)
    world.add(mesh=mesh, transform=at(0, 0, -10), user=8)
    world.add(sphere=((0, 0, -15), 1), user=9)
    world.update()
    ball = crofton.Shape.sphere(0.5)
    hits = world.cast_all(ball, (0, 0, -20))
    assert [h.user for h in hits] == [7, 8, 9]
    assert [h.time for h in hits] == pytest.approx([3.5 / 20, 8.5 / 20, 13.5 / 20], abs=1e-6)
    assert hits[0].triangle in range(12) and hits[2].triangle is None and hits[0].child == 0
    assert [h.user for h in world.cast_all(ball, (0, 0, -20), ignored=[near])] == [8, 9]
    assert world.cast_all(ball, (0, 20, 0)) == []

    touched = world.contact_manifolds(ball, at(0, 0, -15.0 + 1.3))
    (manifold,) = touched
    assert manifold.user == 9 and manifold.depth == pytest.approx(0.2)
    assert manifold.normal == pytest.approx((0, 0, -1))
    assert manifold.points[0] == pytest.approx((0, 0, -14.1)) and manifold.depths == pytest.approx([0.2])
    assert repr(manifold) == "ObjectManifold(user=9, depth=0.2, 1 points)"
    assert world.contact_manifolds(ball, at(0, 0, 5)) == []
    assert len(world.contact_manifolds(ball, at(0, 0, -3.3), margin=0.5)) == 1
    closest = world.closest(100, sphere=((0, 0, -3), 0.1))
    assert closest.triangle in range(12) and closest.child == 0
    with pytest.raises(ValueError, match="margin"):
        world.contact_manifolds(ball, margin=-1)
    with pytest.raises(ValueError, match="points"):
        world.contact_manifolds(ball, max_points=9)


def test_points_of_shapes_name_their_features_and_parts(world):
    floor = crofton.Shape.compound([(crofton.Shape.box((9, 1, 9)), at(0, -1, 0)), (crofton.Shape.sphere(1), at(0, 0, 50))])
    cube = world.add(shape=crofton.Shape.box((1, 1, 1)), transform=at(0, 0.99, 0), user=1)
    world.add(shape=floor, user=2)
    world.update()
    (contact,) = world.contacts
    points = contact.shape_points
    assert len(points) == 4 and points["began"].all()
    np.testing.assert_array_equal(points["position"], contact.points)
    np.testing.assert_array_equal(points["depth"], contact.depths)
    np.testing.assert_allclose(points["normal"], [(0, -1, 0)] * 4, atol=1e-9)
    # Corners of the cube, of which each has a number, on the floor's first child.
    assert (points["kind_a"] == 0).all() and len(set(points["feature_a"])) == 4
    assert (points["kind_b"] == 2).all() and (points["child_b"] == 0).all()
    world.set_transform(cube, at(0.01, 0.99, 0))
    world.update()
    (later,) = world.contacts
    assert not later.shape_points["began"].any()
    assert set(later.shape_points["feature_a"]) == set(points["feature_a"])
    world.set_transform(cube, at(0, 9, 0))
    world.update()
    assert len(world.contacts[0].shape_points) == 0
