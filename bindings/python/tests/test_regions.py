# SPDX-License-Identifier: MIT
"""Regions: parts of a world that are prepared on any thread."""
import pathlib
import shutil
import subprocess
import threading

import numpy as np
import pytest

import crofton


def at(x, y, z):
    matrix = np.eye(4)
    matrix[:3, 3] = (x, y, z)
    return matrix


def test_boxes_and_meshes_of_a_region_are_hit_where_its_origin_puts_them(cube):
    mesh = crofton.Mesh(*cube)
    boxes = crofton.boxes([(0, 0, 0), (5, 0, 0)], 0.5)
    region = crofton.Region.prepare(boxes, [(mesh, [at(10, 0, 0), at(15, 0, 0)])], users=[1, 2, 3, 4], occluders=True)
    assert len(region) == 4 and region.bytes > 0 and repr(region) == "Region(4 objects)"
    world = crofton.World()
    attached = world.attach(region, (1e6, 0, -10))
    world.update()
    assert attached in world and len(world) == 4
    for user, x, t in ((1, 0, 9.5), (2, 5, 9.5), (3, 10, 9), (4, 15, 9)):
        hit = world.raycast((1e6 + x, 0, 0), (0, 0, -1))
        assert (hit.user, hit.t) == (user, t)
        assert world.place_of(hit.object) == (attached, user - 1)
        assert world.object_in(attached, user - 1) == hit.object
    assert world.transform_of(world.object_in(attached, 2))[0, 3] == 1e6 + 10
    world.set_hidden(world.object_in(attached, 3), True)
    world.update()
    assert world.raycast((1e6 + 15, 0, 0), (0, 0, -1)) is None
    world.detach(attached)
    assert attached not in world
    with pytest.raises(crofton.Error) as raised:
        world.detach(attached)
    assert raised.value.code == "stale_handle"


def test_what_is_wrong_is_named_by_its_place(cube):
    boxes = crofton.boxes([(0, 0, 0), (np.nan, 0, 0)], 0.5)
    with pytest.raises(crofton.Error) as raised:
        crofton.Region.prepare(boxes)
    assert raised.value.item == 1
    with pytest.raises(crofton.Error):
        crofton.Region.prepare(boxes[:1], users=[1, 2])
    with pytest.raises(TypeError):
        crofton.Region.prepare(instances=[("cube", [np.eye(4)])])
    region = crofton.Region.prepare(instances=[(crofton.Mesh(*cube), [np.eye(4)])], max_origin=10)
    with pytest.raises(crofton.Error) as raised:
        crofton.World().attach(region, (11, 0, 0))
    assert raised.value.code == "out_of_range"


def test_regions_are_prepared_while_a_world_is_asked():
    boxes = crofton.boxes(np.random.default_rng(1).uniform(-50, 50, (2000, 3)), 0.5)
    prepared = []
    loader = threading.Thread(target=lambda: prepared.extend(crofton.Region.prepare(boxes) for _ in range(3)))
    world = crofton.World(pairs=False)
    world.add_boxes(boxes)
    loader.start()
    for _ in range(20):
        world.update()
        world.view(crofton.Camera())
    loader.join()
    for k, region in enumerate(prepared):
        world.attach(region, (200.0 * k, 0, 0))
    world.update()
    assert len(world) == 8000


def command(*arguments):
    """Runs the command line, where it has been built or is installed."""
    built = pathlib.Path(__file__).parents[3] / "build/release/bin/crofton"
    program = str(built) if built.exists() else shutil.which("crofton")
    if not program:
        pytest.skip("there is no command line")
    subprocess.run([program, *map(str, arguments)], check=True, stdout=subprocess.DEVNULL)


def test_a_folder_of_regions_is_opened(tmp_path):
    command("bake", "town", "--instances", 400, "--regions", "2x2", "--folder", tmp_path)
    files = crofton.region_files(tmp_path)
    assert len(files) == 4 and repr(files[0]).startswith(f"RegionFile({files[0].name}, ")
    world = crofton.World()
    for file in files:
        assert file.bytes == (tmp_path / file.name).stat().st_size
        region, same = file.open(), crofton.Region.open(tmp_path / file.name)
        assert len(region) == len(same) == file.objects
        np.testing.assert_array_equal(region.bounds, same.bounds)
        assert (file.bounds[0] <= file.bounds[1]).all()
        mesh = region.mesh_of(0)
        cut = region.clusters_of(mesh)
        assert len(cut) > 0 and cut.clusters["triangle_count"].sum() == len(cut.triangle_order)
        assert region.clusters_of(10**6) is None
        with pytest.raises(crofton.Error) as raised:
            region.mesh_of(len(region))
        assert (raised.value.code, raised.value.item) == ("out_of_range", len(region))
        world.attach(region, file.origin)
    world.update()
    assert len(world) == sum(file.objects for file in files)
    while waiting := world.statistics["occluders_waiting"]:
        world.update()
        assert world.statistics["occluders_waiting"] < waiting
    boxes_alone = files[0].open(triangles=False, occluders=False, collides_with=0, trust_contents=True)
    assert boxes_alone.bytes < files[0].open().bytes
    (tmp_path / files[0].name).write_bytes(b"no region")
    for call in (files[0].open, lambda: crofton.Region.open(tmp_path / files[0].name)):
        with pytest.raises(crofton.Error) as raised:
            call()
        assert raised.value.code == "parse" and files[0].name in str(raised.value)
    with pytest.raises(crofton.Error) as raised:
        crofton.region_files(tmp_path / "none")
    assert raised.value.code == "input/output"


def test_an_object_without_a_mesh_has_none():
    region = crofton.Region.prepare(crofton.boxes([(0, 0, 0)], 0.5))
    assert region.mesh_of(0) is None
    np.testing.assert_allclose(region.bounds, [[-0.5] * 3, [0.5] * 3])  # rounded outward
