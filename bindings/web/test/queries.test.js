// SPDX-License-Identifier: MIT
// Shapes, rays and pictures without a World; many rays in a World; meshes that replace others.
import test from 'node:test';
import assert from 'node:assert/strict';
import { CroftonError } from '../js/crofton.js';
import { loadBuild } from './builds.js';
import { random, rotation } from './oracle.js';

const BUILDS = (process.env.CROFTON_BUILDS ?? 'simd,plain').split(',');
const refused = (status, item) => (error) => error instanceof CroftonError && error.status === status && error.message.length > 8 &&
    (item === undefined || error.item === item);
const near = (actual, expected, tolerance = 1e-9) => assert.ok(Math.abs(actual - expected) <= tolerance, `${actual} is not ${expected}`);
const allNear = (actual, expected, tolerance) => {
    assert.equal(actual.length, expected.length);
    actual.forEach((value, i) => near(value, expected[i], tolerance));
};
const at = (x, y, z) => [1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, x, y, z, 1];
const SQUARE = { positions: new Float32Array([-3, -3, 0, 3, -3, 0, 3, 3, 0, -3, 3, 0]), indices: new Uint32Array([0, 1, 2, 0, 2, 3]) };
// Reversed depth to infinity: w = -z, near plane 1.
const place = (x, z) => [1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 0, -1, x, 0, 1, -z];
const SMALL = { width: 160, height: 90 };

for (const build of BUILDS) {
    const crofton = await loadBuild(build);
    const here = (name, run) => test(`${build}: ${name}`, run);
    const ball = new crofton.Shape({ sphere: { radius: 1 } }), box = new crofton.Shape({ box: { halfExtents: [1, 2, 3] } });
    const floor = new crofton.Shape({ halfSpace: { normal: [0, -1, 0] } });

    here('two spheres: distance, depth and touch are those of the formula', () => {
        const next = random(7);
        for (let i = 0; i < 200; ++i) {
            const [r, q] = [0.5 + next(), 0.5 + next()], center = [0, 0, 0].map(() => 4 * next() - 2);
            const a = new crofton.Shape({ sphere: { radius: r } }), b = { shape: new crofton.Shape({ sphere: { radius: q } }), transform: at(...center) };
            const gap = Math.hypot(...center) - Math.fround(r) - Math.fround(q);
            assert.equal(crofton.touches(a, b), gap <= 0);
            const d = crofton.distance(a, b), p = crofton.penetration(a, b);
            near(d.distance, Math.max(gap, 0), 1e-6);
            assert.ok(d.lower <= d.distance && d.distance <= d.upper);
            assert.equal(p !== null, gap <= 0);
            if (p) near(p.depth, -gap, 1e-6);
            a.free(), b.shape.free();
        }
    });
    here('a box at a pose: nearest points, closest point, ray', () => {
        const placed = { shape: box, transform: at(10, 0, 0) };
        const d = crofton.distance(ball, placed);
        near(d.distance, 8);
        allNear(d.onA, [1, 0, 0], 1e-6), allNear(d.normal, [1, 0, 0], 1e-9);
        near(d.onB[0], 9, 1e-6);
        const c = crofton.closestPoint(placed, [10, 5, 4]);
        near(c.distance, Math.sqrt(9 + 1));
        allNear(c.point, [10, 2, 3], 1e-6);
        assert.equal(crofton.closestPoint(placed, [10, 1, 1]).distance, 0);
        const hit = crofton.raycast(placed, [0, 0, 0], [2, 0, 0]);
        near(hit.t, 4.5);
        allNear(hit.point, [9, 0, 0]), allNear(hit.normal, [-1, 0, 0]);
        assert.equal(hit.startedInside, false);
        assert.equal(crofton.raycast(placed, [0, 0, 0], [2, 0, 0], 4), null);
        assert.equal(crofton.raycast(placed, [0, 0, 0], [-1, 0, 0]), null);
        assert.deepEqual([crofton.raycast(placed, [10, 0, 0], [1, 0, 0])].map((h) => [h.t, h.startedInside]), [[0, true]]);
        assert.deepEqual(crofton.raycast(new crofton.Shape({ mesh: SQUARE }), [-1, 1, 5], [0, 0, -1]).part, { child: 0, triangle: 1 });
    });
    here('a box on a floor has four contact points, or as many as are asked for', () => {
        const standing = { shape: box, transform: at(0, 1.75, 0) };
        const contact = crofton.contacts(floor, standing);
        allNear(contact.normal, [0, 1, 0]), near(contact.depth, 0.25);
        assert.equal(contact.points.length, 4);
        for (const point of contact.points) {
            near(point.depth, 0.25, 1e-9);
            near(Math.abs(point.position[0]), 1, 1e-6), near(point.position[1], -0.125, 1e-6), near(Math.abs(point.position[2]), 3, 1e-6);
        }
        assert.equal(crofton.contacts(floor, standing, { maxPoints: 1 }).points.length, 1);
        const above = { shape: box, transform: at(0, 2.5, 0) };
        assert.deepEqual(crofton.contacts(floor, above).points, []);
        assert.equal(crofton.contacts(floor, above, { margin: 1 }).points.length, 4);
        near(crofton.contacts(floor, above, { margin: 1 }).depth, -0.5);
        assert.throws(() => crofton.contacts(floor, above, { margin: -1 }), refused('invalid argument'));
        assert.throws(() => crofton.contacts(floor, above, { maxPoints: 9 }), refused('out of range'));
    });
    here('a cast says when two moving shapes meet', () => {
        const from = { shape: ball, transform: at(0, 5, 0) };
        const hit = crofton.cast(from, { velocity: [0, -2, 0], duration: 9 }, floor);
        near(hit.time, 2, 1e-5);
        allNear(hit.normal, [0, -1, 0]);
        assert.equal(hit.unresolved, false);
        assert.equal(crofton.cast(from, { velocity: [0, -2, 0] }, floor), null); // 1 by default
        near(crofton.cast(from, { velocity: [0, -1, 0], duration: 9 }, floor, { velocity: [0, 1, 0] }).time, 2, 1e-5);
        assert.equal(crofton.cast(from, { velocity: [0, -1, 0], duration: 9 }, floor, { velocity: [0, -1, 0] }), null);
        assert.throws(() => crofton.cast(from, { velocity: [0, NaN, 0] }, floor), refused('not finite'));
        assert.throws(() => crofton.cast(from, { velocity: [0, 1, 0], duration: -1 }, floor), refused('invalid argument'));
    });
    here('a shape says how large and how heavy it is', () => {
        allNear(box.bounds.min, [-1, -2, -3]), allNear(box.bounds.max, [1, 2, 3]);
        assert.equal(floor.bounds.min[0], -Infinity);
        const { volume, center, inertia } = box.mass;
        near(volume, 48), allNear(center, [0, 0, 0]);
        allNear(inertia, [16 * (4 + 9), 0, 0, 0, 16 * (1 + 9), 0, 0, 0, 16 * (1 + 4)], 1e-9);
        assert.throws(() => floor.mass, refused('unsupported'));
    });
    here('what is no shape is named, and so is a freed one', () => {
        const freed = new crofton.Shape({ sphere: { radius: 1 } });
        freed.free();
        for (const ask of ['touches', 'distance', 'penetration', 'contacts']) {
            for (const wrong of [undefined, null, {}, 3, { shape: box, transform: 'here' }])
                assert.throws(() => crofton[ask](ball, wrong), refused('invalid argument'), ask);
            assert.throws(() => crofton[ask](ball, freed), refused('bad handle'));
            assert.throws(() => crofton[ask]({ shape: ball, transform: at(NaN, 0, 0) }, box), refused('not finite'));
            assert.throws(() => crofton[ask](ball, { shape: box, transform: [2, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1] }), CroftonError);
        }
        assert.throws(() => crofton.closestPoint(ball, [0, 0]), refused('invalid argument'));
        assert.throws(() => crofton.closestPoint(ball, [0, NaN, 0]), refused('not finite'));
        assert.throws(() => crofton.raycast(ball, [0, 0, 0], [0, 0, 0]), CroftonError);
        assert.ok(crofton.touches(ball, box)); // nothing is spoilt
    });

    here('many rays in one call are those of raycast', () => {
        const world = new crofton.World(), next = random(3), mesh = world.addMesh(SQUARE.positions, SQUARE.indices);
        for (let i = 0; i < 200; ++i) {
            const center = [0, 0, 0].map(() => 40 * next() - 20);
            if (i % 3) world.add({ box: { center, halfExtents: [1, 1, 1], axes: rotation(next) } });
            else world.add({ mesh, transform: at(...center) });
        }
        world.update();
        const origins = Float64Array.from({ length: 3000 }, () => 40 * next() - 20), directions = Float64Array.from({ length: 3000 }, () => next() - 0.5);
        const many = world.raycastMany(origins, directions, 30);
        let hits = 0;
        for (let i = 0; i < 1000; ++i) {
            const hit = world.raycast(origins.slice(3 * i, 3 * i + 3), directions.slice(3 * i, 3 * i + 3), 30);
            hits += hit !== null;
            assert.deepEqual([many.t[i], many.objects[i], many.triangles[i], ...many.normals.slice(3 * i, 3 * i + 3)],
                hit ? [hit.t, hit.object.index, hit.triangle, ...hit.normal] : [Infinity, -1, -1, 0, 0, 0]);
        }
        assert.ok(hits > 100 && hits < 1000);
        assert.deepEqual(world.raycastMany(new Float64Array(0), new Float64Array(0)).t.length, 0);
        assert.throws(() => world.raycastMany(origins, directions.slice(3)), refused('invalid argument'));
        assert.throws(() => world.raycastMany([0, 0, 0], [0, 0, 1]), refused('invalid argument'));
        origins[7] = NaN;
        assert.throws(() => world.raycastMany(origins, directions), refused('not finite', 2));
        structuredClone(origins, { transfer: [origins.buffer] });
        assert.throws(() => world.raycastMany(origins, directions), (error) => refused('invalid argument')(error) && /detached/.test(error.message));
    });
    here('a mesh that replaces another is what its objects are', () => {
        const world = new crofton.World(), mesh = world.addMesh(SQUARE.positions, SQUARE.indices, { clusters: true });
        const object = world.add({ mesh, transform: at(0, 0, -5) });
        world.update();
        assert.ok(world.raycastAny([2, 2, 0], [0, 0, -1]));
        world.replaceMesh(mesh, SQUARE.positions.map((x) => x / 3), SQUARE.indices.subarray(0, 3), { clusters: true });
        world.update();
        assert.ok(!world.raycastAny([2, 2, 0], [0, 0, -1]));
        assert.deepEqual(world.raycast([0.5, -0.5, 0], [0, 0, -1]).object, object);
        assert.equal(world.clustersOf(mesh).triangleOrder.length, 1);
        assert.throws(() => world.replaceMesh(mesh, SQUARE.positions, new Uint32Array([0, 1, 9])), refused('out of range'));
        assert.throws(() => world.replaceMesh(object, SQUARE.positions, SQUARE.indices), refused('bad handle'));
        world.update();
        assert.equal(world.clustersOf(mesh).triangleOrder.length, 1);
    });

    here('a culler of its own lists what a picture needs', () => {
        const mesh = new crofton.ClusteredMesh(SQUARE.positions, SQUARE.indices), culler = new crofton.DepthCuller();
        assert.deepEqual(mesh.clusters.clusters, [{ firstTriangle: 0, triangleCount: 2 }]);
        assert.deepEqual([...mesh.clusters.triangleOrder].sort(), [0, 1]);
        const wall = (x, z, more) => ({ mesh, toClip: place(x, z), ...more });
        assert.throws(() => culler.nearness(0, 0), refused('out of range'));
        assert.deepEqual(culler.triangles, []);
        // Of three walls the second is hidden.
        const walls = [wall(0, -10), wall(0, -40), wall(20, -40)];
        assert.equal(culler.findVisible(walls, SMALL), culler);
        assert.deepEqual(culler.triangles, [{ object: 0, cluster: 0, triangles: 3n }, { object: 2, cluster: 0, triangles: 3n }]);
        assert.deepEqual([...culler.triangleWords], [0, 0, 3, 0, 2, 0, 3, 0]);
        assert.deepEqual([culler.statistics.objectsListed, culler.statistics.trianglesListed], [2, 4]);
        near(culler.nearness(80, 45), 0.1, 1e-6);
        assert.equal(culler.nearness(0, 0), -Infinity);
        assert.throws(() => culler.nearness(160, 0), refused('out of range'));
        const count = (list) => culler.findVisible(list, SMALL).triangles.length;
        assert.equal(count([wall(0, -10, { hides: false }), ...walls.slice(1)]), 3);
        assert.equal(count([walls[0], wall(0, -40, { positionError: -1 }), walls[2]]), 3); // unknown: listed
        const mirrored = { mesh, toClip: place(20, -40).map((x, i) => i ? x : -x), oneSided: true };
        assert.equal(count([...walls.slice(0, 2), mirrored]), 1);
        assert.equal(count([]), 0);

        assert.equal(count(walls), 2);
        assert.throws(() => culler.findVisible(walls, { width: 0 }), refused('out of range'));
        assert.throws(() => culler.findVisible([wall(0, -9), { toClip: place(0, -9) }], SMALL), refused('invalid argument', 1));
        assert.throws(() => culler.findVisible([{ mesh, toClip: [1, 2] }], SMALL), refused('invalid argument'));
        assert.throws(() => culler.findVisible(walls, { depth: 'deep' }), refused('invalid argument'));
        assert.equal(culler.triangles.length, 2); // the last answer stays
        mesh.free();
        assert.throws(() => culler.findVisible(walls, SMALL), refused('bad handle'));
        culler.free();
        assert.throws(() => culler.triangles, refused('bad handle'));
    });
    here('a shadow map needs what throws shadows on what is seen', () => {
        const mesh = new crofton.ClusteredMesh(SQUARE.positions, SQUARE.indices), [camera, light] = [new crofton.DepthCuller(), new crofton.DepthCuller()];
        // The light is where the camera is: of two casters, one is before the wall that the camera sees, and one beside it.
        camera.findVisible([{ mesh, toClip: place(0, -20) }], SMALL);
        const casters = [{ mesh, toClip: place(0, -10) }, { mesh, toClip: place(30, -35) }], map = { width: 256, height: 256 };
        assert.equal(light.findVisible(casters, map).triangles.length, 2);
        const objects = [{ mesh, toMap: place(0, -20) }];
        assert.deepEqual(light.findCasters(casters, map, { seen: camera, objects }).triangles, [{ object: 0, cluster: 0, triangles: 3n }]);
        const other = new crofton.ClusteredMesh(SQUARE.positions, SQUARE.indices);
        const fails = (receivers, status, item) => assert.throws(() => light.findCasters(casters, map, receivers), refused(status, item));
        fails({ seen: camera, objects: [{ mesh: other, toMap: place(0, -20) }] }, 'invalid argument', 0);
        fails({ seen: camera, objects: [] }, 'invalid argument');
        fails({ seen: camera, objects, radius: 0 }, 'out of range');
        fails({ objects }, 'invalid argument');
        fails({ seen: camera, objects: [{ mesh }] }, 'invalid argument');
        fails(undefined, 'invalid argument');
        assert.equal(light.triangles.length, 1);
        camera.free();
        fails({ seen: camera, objects }, 'bad handle');
    });
    here('limits of work, of origins and of rebuilding are obeyed, and named', () => {
        const world = new crofton.World({ rebuildBudget: 0 }), visible = new crofton.ViewResult(), mesh = world.addMesh(SQUARE.positions, SQUARE.indices, { clusters: true });
        for (let z = -10; z > -50; z -= 2) world.add({ mesh, transform: [1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, z, 1] });
        world.update();
        const listed = (workLimit) => world.view({ camera: {}, picture: { workLimit } }, visible).triangles.length;
        assert.ok(listed(0) === 1 && listed(2 ** 40) === 1, `${listed(0)}, ${listed(2 ** 40)}`);
        assert.throws(() => listed(-1), (error) => refused('invalid argument')(error) && /workLimit/.test(error.message));
        assert.throws(() => new crofton.World({ rebuildBudget: 0.5 }), /rebuildBudget/);
        const region = new crofton.Region([{ shape: new crofton.Shape({ sphere: { radius: 1 } }) }], { maxOrigin: 100 });
        world.attach(region, [100, 0, 0]);
        assert.throws(() => world.attach(region, [101, 0, 0]), (error) => error.status !== undefined);
    });
    here('arguments of another kind, of another library, or detached, are named', async () => {
        const other = await loadBuild(build), world = new crofton.World(), visible = new crofton.ViewResult(), frustum = new crofton.Frustum(), boxes = new crofton.Boxes(2);
        world.add({ sphere: { center: [0, 0, -5], radius: 1 } });
        world.update();
        const tree = new crofton.Tree(boxes), wrong = [undefined, null, 7, {}, { handle: 16 }, new crofton.Triangulator(), new other.ViewResult(),
            new other.Frustum(), new other.Boxes(1), new other.Shape({ sphere: { radius: 1 } }), new other.World(), new other.Region([])];
        const mesh = new crofton.ClusteredMesh(SQUARE.positions, SQUARE.indices), foreign = new other.ClusteredMesh(SQUARE.positions, SQUARE.indices);
        for (const thing of wrong) {
            const calls = [() => tree.cull(thing, visible), () => tree.cull(frustum, thing), () => tree.move([0, 1], thing), () => new crofton.Tree(thing),
                () => crofton.cullBoxes(thing, frustum, visible), () => crofton.cullBoxes(boxes, thing, visible), () => crofton.cullBoxes(boxes, frustum, thing),
                () => crofton.classify(thing, frustum), () => crofton.classify(boxes, thing), () => world.view({ camera: {} }, thing),
                () => world.attach(thing), () => world.hiddenBy(thing), () => visible.masks(thing), () => world.cast({ shape: thing }, {}),
                () => world.overlap({ shape: thing }), () => new crofton.Shape({ rounded: { core: thing, radius: 1 } }),
                () => new crofton.Shape({ compound: [{ shape: thing }] }), () => crofton.touches(thing, ball),
                () => world.view({ camera: {}, picture: {}, receivers: { seen: thing } }, visible)];
            for (const [i, call] of calls.entries()) assert.throws(call, refused('invalid argument'), `call ${i}`);
        }
        assert.throws(() => world.view({ volume: new other.Frustum() }, visible), (error) => refused('invalid argument')(error) && /another call of load/.test(error.message));
        assert.throws(() => new crofton.DepthCuller().findVisible([{ mesh, toClip: place(0, -9) }, { mesh: foreign, toClip: place(0, -9) }], SMALL), refused('invalid argument', 1));
        assert.throws(() => new crofton.Region([{ sphere: { center: [0, 0, 0], radius: 1 } }, { shape: wrong[9] }]), refused('invalid argument', 1));
        for (const list of [undefined, null, 3, {}, 'abc', [null], [1], new Float32Array(2)]) {
            assert.throws(() => new crofton.Region(list), refused('invalid argument'));
            assert.throws(() => new crofton.DepthCuller().findVisible(list, SMALL), refused('invalid argument'));
            assert.throws(() => new crofton.Shape({ compound: list }), refused('invalid argument'));
        }
        assert.throws(() => world.setOccluders({ kind: 'mesh', index: 0, generation: 0 }, [null]), refused('invalid argument', 0));
        assert.throws(() => world.view(undefined, visible), refused('invalid argument'));
        assert.throws(() => world.add(), refused('invalid argument'));
        assert.throws(() => visible.trianglesOf(10n), refused('invalid argument'));
        const gone = new Float64Array(3);
        structuredClone(gone, { transfer: [gone.buffer] });
        assert.throws(() => world.raycast(gone, [0, 0, -1]), (error) => refused('invalid argument')(error) && /detached/.test(error.message));
        assert.throws(() => new crofton.Triangulator().triangulate(), refused('invalid argument'));
        assert.deepEqual([...world.view({ camera: {} }, visible).ids], [0]);
    });
}
