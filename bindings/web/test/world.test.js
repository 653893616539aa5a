// SPDX-License-Identifier: MIT
// What a World does beyond one view and rays: nodes, regions, shapes, contacts, casts, many views, given occluders, clusters cut before.
import test from 'node:test';
import assert from 'node:assert/strict';
import { CroftonError } from '../js/crofton.js';
import { loadBuild } from './builds.js';

const BUILDS = (process.env.CROFTON_BUILDS ?? 'simd,plain').split(',');
const refused = (status, item) => (error) => error instanceof CroftonError && error.status === status && error.message.length > 8 &&
    (item === undefined || error.item === item);
const near = (actual, expected, tolerance = 1e-9) => assert.ok(Math.abs(actual - expected) <= tolerance, `${actual} is not ${expected}`);
const at = (x, y, z) => [1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, x, y, z, 1];
const CUBE = { positions: new Float32Array([-1, -1, -1, 1, -1, -1, -1, 1, -1, 1, 1, -1, -1, -1, 1, 1, -1, 1, -1, 1, 1, 1, 1, 1]),
    indices: new Uint32Array([0, 2, 1, 1, 2, 3, 4, 5, 6, 5, 7, 6, 0, 1, 4, 1, 5, 4, 2, 6, 3, 3, 6, 7, 0, 4, 2, 2, 4, 6, 1, 3, 5, 3, 7, 5]) };
const TETRAHEDRON = { positions: new Float32Array([0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1]), indices: new Uint32Array([0, 2, 1, 0, 1, 3, 0, 3, 2, 1, 2, 3]) };

for (const build of BUILDS) {
    const crofton = await loadBuild(build);
    const here = (name, run) => test(`${build}: ${name}`, run);
    // Spheres of radius 0.25 along x at 0, 1, 2, five units before the default camera.
    const row = () => {
        const world = new crofton.World(), objects = [0, 1, 2].map((x) => world.add({ sphere: { center: [x, 0, -5], radius: 0.25 }, user: x }));
        world.update();
        return { world, objects };
    };

    here('a shape that is no object is cast through all, and touches them', () => {
        const { world, objects } = row(), shape = new crofton.Shape({ capsule: { radius: 0.25, halfHeight: 1 } }), placed = (x) => ({ shape, transform: at(x, 0, -5) });
        const hits = world.castAll(placed(4), { velocity: [-1, 0, 0], duration: 9 });
        assert.deepEqual(hits.map((hit) => hit.object), [objects[2], objects[1], objects[0]]);
        hits.forEach((hit, i) => near(hit.time, 1.5 + i, 1e-5));
        assert.deepEqual([hits[0].triangle, hits[0].child, hits[0].unresolved], [-1, 0, false]);
        assert.deepEqual(hits[0], world.cast(placed(4), { velocity: [-1, 0, 0], duration: 9 }));
        assert.equal(world.castAll(placed(4), { velocity: [-1, 0, 0], duration: 9 }, { ignored: [objects[1]] }).length, 2);
        const [touch, ...others] = world.contactManifolds(placed(2.3));
        assert.deepEqual([touch.object, touch.user, others.length, touch.points.length], [objects[2], 2, 0, 1]);
        near(touch.depth, 0.2), near(touch.normal[0], -1), near(touch.points[0].position[0], 2.15), near(touch.points[0].depth, 0.2);
        assert.equal(world.contactManifolds(placed(1.5), { margin: 0.5 }).length, 2);
        assert.deepEqual(world.contactManifolds(placed(9)), []);
        assert.equal(world.closest({ sphere: { center: [9, 0, -5], radius: 1 } }).triangle, -1);
        assert.throws(() => world.contactManifolds(placed(0), { maxPoints: 9 }), CroftonError);
        assert.throws(() => world.contactManifolds(placed(0), { margin: NaN }), CroftonError);
    });
    here('many objects are added at once, or none of them', () => {
        const world = new crofton.World({ updatesToRest: 2, maxPairs: 3 });
        world.reserve(1000);
        assert.throws(() => world.reserve(2 ** 31), refused('out of range'));
        const shape = new crofton.Shape({ sphere: { radius: 1 } }), mesh = world.addMesh(CUBE.positions, CUBE.indices);
        const many = [...Array.from({ length: 998 }, (_, i) => ({ sphere: { center: [10 * i, 0, 0], radius: 1 }, user: i })),
            { mesh, transform: at(0, 50, 0), user: 998 }, { shape, transform: at(0, 60, 0), user: 999, layers: 2 }];
        const objects = world.addMany(many);
        world.update();
        assert.equal(world.count, 1000);
        objects.forEach((object, i) => assert.equal(world.userOf(object), i));
        assert.deepEqual(world.boxOf(objects[7]).center, [70, 0, 0]);
        for (const extent of world.boxOf(objects[998]).halfExtents) near(extent, 1, 1e-6);
        assert.deepEqual(world.transformOf(objects[998]), at(0, 50, 0));
        assert.throws(() => world.transformOf(objects[0]), refused('empty', objects[0].index));
        assert.ok(world.raycastAny([0, 60, 9], [0, 0, -1], 99, 2) && !world.raycastAny([0, 60, 9], [0, 0, -1], 99, 1));
        const bad = [many[0], { sphere: { center: [NaN, 0, 0], radius: 1 } }, many[1]];
        assert.throws(() => world.addMany(bad), refused('not finite', 1));
        assert.throws(() => world.addMany([many[0], {}]), refused('invalid argument', 1));
        assert.throws(() => world.addMany([many[0], 7]), refused('invalid argument', 1));
        assert.throws(() => world.addMany([many[0], { mesh: 3 }]), refused('bad handle', 1));
        assert.equal(world.count, 1000);
        assert.deepEqual(world.addMany([]), []);
        const added = world.add({ sphere: { center: [0, 0, 0], radius: 1 } });
        assert.throws(() => world.boxOf(added), refused('empty', added.index));
        world.addMany(Array.from({ length: 4 }, () => many[0]));
        assert.throws(() => world.update(), refused('budget exceeded'));
        world.remove(added);
        assert.throws(() => world.userOf(added), refused('stale handle'));
    });

    here('many objects and nodes move in one call', () => {
        const world = new crofton.World(), mesh = world.addMesh(CUBE.positions, CUBE.indices);
        const objects = world.addMany([{ mesh }, { mesh }, { mesh }]), nodes = [world.addNode(), world.addNode()];
        const below = world.add({ mesh, node: nodes[1] });
        const places = new Float64Array([at(10, 0, 0), at(20, 0, 0), at(30, 0, 0)].flat());
        world.setTransforms(objects, places);
        world.setNodeTransforms(nodes, places.subarray(0, 32));
        world.update();
        assert.deepEqual(objects.map((object) => world.boxOf(object).center[0]), [10, 20, 30]);
        assert.deepEqual(world.transformOf(below), at(20, 0, 0));
        places[0] = NaN, places[12] = 11, places[28] = 21;
        assert.throws(() => world.setTransforms(objects, places), refused('not finite', 0));
        world.update();
        assert.deepEqual(objects.map((object) => world.boxOf(object).center[0]), [10, 21, 30]);
        assert.throws(() => world.setTransforms(objects, places.subarray(16)), refused('invalid argument'));
        assert.throws(() => world.setTransforms(nodes, places.subarray(16)), refused('bad handle'));
        const bounds = world.addMany([{ sphere: { center: [0, 0, 0], radius: 1 } }, { sphere: { center: [0, 0, 0], radius: 1 } }]);
        const boxes = new crofton.Boxes(2);
        boxes.setAll(new Float64Array([1, 2, 3, 4, 5, 6]), new Float64Array([1, 1, 1, 2, 2, 2]));
        world.setBoxes(bounds, boxes);
        world.update();
        assert.deepEqual(bounds.map((object) => world.boxOf(object).center), [[1, 2, 3], [4, 5, 6]]);
        assert.throws(() => world.setBoxes(bounds.slice(1), boxes), refused('invalid argument'));
    });

    here('a region says what it holds, and what a view of it lists', () => {
        const region = new crofton.Region([{ mesh: 0, transform: at(0, 0, -9) }, { sphere: { center: [5, 0, 0], radius: 1 } }],
            { meshes: [{ ...CUBE, clusters: true }] });
        assert.equal(region.count, 2);
        const { min, max } = region.bounds;
        assert.ok(min[2] <= -10 && min[2] > -10.1 && max[0] >= 6 && max[0] < 6.1);
        assert.deepEqual([region.meshOf(0), region.meshOf(1)], [0, -1]);
        assert.throws(() => region.meshOf(2), refused('out of range', 2));
        assert.throws(() => region.clustersOf(1), refused('empty', 1));
        const world = new crofton.World(), attached = world.attach(region), clusters = region.clustersOf(0);
        world.update();
        assert.equal(clusters.triangleOrder.length, 12);
        const visible = world.view({ camera: {}, picture: { width: 320, height: 180 } }, new crofton.ViewResult());
        const [first] = visible.triangles;
        assert.equal(first.object, world.objectIn(attached, 0).index);
        assert.ok(first.cluster < clusters.clusters.length);
        const permuted = crofton.permuteTriangles(clusters, CUBE.indices);
        clusters.triangleOrder.forEach((triangle, i) =>
            assert.deepEqual(permuted.subarray(3 * i, 3 * i + 3), CUBE.indices.subarray(3 * triangle, 3 * triangle + 3)));
        assert.throws(() => crofton.permuteTriangles(clusters, CUBE.indices.subarray(3)), refused('invalid argument'));
    });

    here('limits of a camera leave out what is small in the picture', () => {
        const world = new crofton.World(), visible = new crofton.ViewResult();
        world.addMany(Array.from({ length: 100 }, (_, i) => ({ sphere: { center: [0, 0, -4 - 4 * i], radius: 1 } })));
        world.update();
        // A sphere around an object's box has radius sqrt(3). One pixel of 1000 is d * 2 tan(30 degrees) / 1000 wide at distance d.
        const limits = crofton.limitsOfCamera({}, 1000, 10), farthest = Math.sqrt(3) * 2 * 1000 / (10 * 2 * Math.tan(Math.PI / 6));
        assert.equal(world.view({ camera: {}, limits }, visible).length, Array.from({ length: 100 }, (_, i) => 4 + 4 * i).filter((d) => d <= farthest).length);
        assert.throws(() => crofton.limitsOfCamera({}, 1000, -1), CroftonError);
    });

    here('a node moves what is below it, and takes it along when it is removed', () => {
        const world = new crofton.World(), mesh = world.addMesh(CUBE.positions, CUBE.indices);
        const root = world.addNode({ transform: at(10, 0, 0) }), arm = world.addNode({ parent: root, transform: at(0, 5, 0) });
        const object = world.add({ mesh, node: arm, transform: at(0, 0, -5) });
        const seenAt = (x, y) => {
            world.update();
            return world.raycastAny([x, y, 0], [0, 0, -1]);
        };
        assert.ok(seenAt(10, 5) && !seenAt(0, 5));
        world.setNodeTransform(root, at(20, 0, 0));
        assert.ok(seenAt(20, 5) && !seenAt(10, 5));
        world.setParent(arm);
        assert.ok(seenAt(0, 5));
        world.setNodeLayers(arm, 2);
        world.update();
        assert.ok(world.raycastAny([0, 5, 0], [0, 0, -1], 9, 2) && !world.raycastAny([0, 5, 0], [0, 0, -1], 9, 1));
        world.setParent(arm, root);
        assert.throws(() => world.setParent(root, arm), refused('invalid argument'));
        assert.throws(() => world.setNodeTransform(root, [1, 2]), refused('invalid argument'));
        assert.throws(() => world.setNodeTransform(root, at(NaN, 0, 0)), refused('not finite'));
        assert.throws(() => world.setNodeTransform(object, at(0, 0, 0)), refused('bad handle'));
        world.removeNode(root);
        assert.ok(!world.contains(object));
        assert.throws(() => world.removeNode(arm), refused('stale handle'));
        assert.throws(() => world.add({ mesh, node: arm }), refused('stale handle'));
    });
    here('shapes of every kind are met where they are', () => {
        const { positions, indices } = CUBE, core = new crofton.Shape({ box: { halfExtents: [1, 1, 1] } });
        const tops = [[{ sphere: { radius: 2 } }, 2], [{ capsule: { radius: 1, halfHeight: 3 } }, 4], [{ cylinder: { radius: 2, halfHeight: 1.5 } }, 1.5],
            [{ cone: { radius: 2, halfHeight: 1.5 } }, 1.5], [{ box: { halfExtents: [1, 2, 3] } }, 2], [{ hull: { positions } }, 1],
            [{ triangle: [-1, 0, 1, 1, 0, 1, 0, 0, -1] }, 0], [{ halfSpace: { normal: [0, -2, 0], offset: 1 } }, 0.5], [{ mesh: { positions, indices } }, 1],
            [{ heightField: { columns: 2, heights: new Float32Array([3, 3, 3, 3]) } }, 3], [{ rounded: { core, radius: 0.5 } }, 1.5],
            [{ compound: [{ shape: core, transform: at(0, 6, 0) }, { shape: core }] }, 7]];
        for (const [description, top] of tops) {
            const world = new crofton.World(), shape = new crofton.Shape(description), object = world.add({ shape, user: 5 });
            shape.free();  // the world keeps what it needs
            world.update();
            const hit = world.raycast([1e-3, 50, 1e-3], [0, -1, 0]);
            assert.deepEqual([hit.object, hit.user], [object, 5]);
            near(hit.t, 50 - top, 0.01);
        }
        const field = (more) => ({ heightField: { columns: 3, heights: new Float32Array(6), ...more } });
        const world = new crofton.World();
        world.add({ shape: new crofton.Shape(field({ materials: new Uint8Array([255, 0]), spacing: [2, 2] })) });
        world.update();
        assert.ok(!world.raycastAny([1, 5, 1], [0, -1, 0]) && world.raycastAny([3, 5, 1], [0, -1, 0]));
        for (const [description, status, item] of [[{}, 'invalid argument'], [{ ball: 1 }, 'invalid argument'], [{ toString: 1 }, 'invalid argument'],
            [undefined, 'invalid argument'], [{ sphere: { radius: 1 }, cone: { radius: 1, halfHeight: 1 } }, 'invalid argument'],
            [{ sphere: { radius: -1 } }, 'invalid argument'], [{ sphere: {} }, 'not finite'], [{ hull: { positions: new Float32Array(7) } }, 'invalid argument'],
            [{ hull: { positions: new Float32Array([0, 0, 0, NaN, 0, 0, 1, 1, 1, 2, 2, 2]) } }, 'not finite', 1],
            [{ mesh: { positions, indices: [0, 2, 1, 0, 1, 99] } }, 'out of range', 5], [field({ columns: 4 }), 'invalid argument'],
            [field({ materials: new Uint8Array(3) }), 'invalid argument'], [{ compound: [] }, 'empty'], [{ compound: [{ shape: {} }] }, 'invalid argument'],
            [{ compound: [{ shape: core }, { shape: core, transform: at(NaN, 0, 0) }] }, 'not finite', 1], [{ halfSpace: { normal: [0, 0] } }, 'invalid argument']])
            assert.throws(() => new crofton.Shape(description), refused(status, item), JSON.stringify(description));
        core.free();
        assert.throws(() => new crofton.Shape({ rounded: { core, radius: 1 } }), refused('bad handle'));
        assert.throws(() => world.add({ shape: core }), refused('bad handle'));
        assert.throws(() => world.add({ shape: {} }), refused('invalid argument'));
        const detached = new Float32Array(12);
        structuredClone(detached.buffer, { transfer: [detached.buffer] });
        assert.throws(() => new crofton.Shape({ hull: { positions: detached } }), (error) => /detached/.test(error.message));
    });
    here('pairs and contacts of shapes, with numbers of yours that stay', () => {
        const world = new crofton.World({ contactMargin: 0.01 }), ball = new crofton.Shape({ sphere: { radius: 1 } });
        world.add({ shape: new crofton.Shape({ halfSpace: { normal: [0, -1, 0] } }), user: 1 });
        const high = world.add({ shape: ball, transform: at(0, 0.9, 0), user: 2 });
        world.update();
        assert.deepEqual(world.pairs().map(({ first, second }) => [first.user, second.user]), [[1, 2]]);
        let [contact] = world.contacts();
        assert.deepEqual([contact.first.user, contact.second.user, contact.phase, contact.inside], [1, 2, 'began', 'nothing']);
        near(contact.normal[1], 1, 1e-6);
        assert.deepEqual([contact.shapePoints.length, contact.shapePoints[0].began, [...contact.shapePoints[0].memory]], [1, true, [0, 0, 0, 0]]);
        near(contact.shapePoints[0].depth, 0.1, 1e-6);
        contact.shapePoints[0].memory[2] = 7;
        world.setTransform(high, at(0, 0.95, 0));
        world.update();
        [contact] = world.contacts();
        assert.deepEqual([contact.phase, contact.shapePoints[0].began, contact.shapePoints[0].memory[2]], ['stayed', false, 7]);
        world.setTransform(high, at(0, 5, 0));
        world.update();
        assert.deepEqual(world.contacts().map(({ phase }) => phase), ['ended']);
        assert.deepEqual(world.pairs(), []);
        assert.deepEqual(world.statistics.objects, 2);

        // Two boxes, and what lies inside a closed mesh.
        const solids = new crofton.World(), box = (x) => ({ box: { center: [x, 0, 0], halfExtents: [0.5, 0.5, 0.5] } });
        solids.add(box(0)), solids.add(box(0.75));
        const mesh = solids.addMesh(CUBE.positions, CUBE.indices);
        solids.add({ mesh, transform: at(50, 0, 0), collidesWith: 1, layers: 1 });
        const small = solids.add({ mesh, transform: [0.1, 0, 0, 0, 0, 0.1, 0, 0, 0, 0, 0.1, 0, 50, 0, 0, 1], collidesWith: 1, layers: 1 });
        solids.update();
        const [touching, within] = solids.contacts();
        near(touching.depth, 0.25, 1e-6);
        assert.equal(touching.points.length, 4);
        assert.equal(within.inside, 'second');
        solids.setTransform(small, at(51.5, 0, 0));
        solids.update();
        const crossing = solids.contacts().find(({ second }) => second.object.index === small.index);
        assert.ok(crossing.triangles.length > 0 && crossing.triangles.every(({ begin }) => Math.abs(begin[0] - 51) < 0.51));
        solids.setCollidesWith(small, 2);
        solids.update();
        assert.deepEqual(solids.contacts().map(({ phase }) => phase), ['stayed', 'ended']);
        const without = new crofton.World({ pairs: false });
        without.add(box(0)), without.add(box(0.1));
        without.update();
        assert.deepEqual([without.pairs(), without.contacts()], [[], []]);
        assert.throws(() => new crofton.World({ contactMargin: NaN }), CroftonError);
        solids.free();
        assert.throws(() => solids.contacts(), refused('bad handle'));
    });
    here('rays find all, shapes are cast, overlap and have a nearest object', () => {
        const { world, objects } = row(), shape = new crofton.Shape({ capsule: { radius: 0.25, halfHeight: 1 } });
        assert.deepEqual(world.raycastAll([-9, 0, -5], [1, 0, 0]).map(({ user, t }) => [user, t]), [[0, 8.75], [1, 9.75], [2, 10.75]]);
        assert.deepEqual(world.raycastAll([-9, 0, -5], [1, 0, 0], 10).length, 2);
        assert.throws(() => world.raycastAll([0, 0, 0], [0, 0, 0]), refused('degenerate'));
        const probe = (x) => ({ shape, transform: at(x, 0, -5) });
        assert.deepEqual(world.overlap(probe(0.5)).map(({ user }) => user), [0, 1]);
        near(world.closest(probe(4)).distance, 1.5);
        const back = { velocity: [-1, 0, 0], duration: 9 }, hit = world.cast(probe(4), back);
        assert.deepEqual([hit.object, hit.user, hit.unresolved, hit.triangle], [objects[2], 2, false, -1]);
        near(hit.time, 1.5, 1e-5);
        near(hit.normal[0], -1, 1e-6);
        assert.equal(world.cast(probe(4), { ...back, duration: 1.4 }), null);
        assert.equal(world.cast(probe(4), back, 0), null);
        assert.equal(world.cast(probe(4), { spin: [0, 1, 0] }), null);
        for (const [ask, status] of [[() => world.cast(probe(NaN), back), 'not finite'], [() => world.cast(probe(4), { velocity: [1, 2] }), 'invalid argument'],
            [() => world.cast(probe(4), { ...back, duration: -1 }), 'invalid argument'], [() => world.cast({}, back), 'invalid argument'],
            [() => world.overlap({ shape: new crofton.Shape({ halfSpace: { normal: [0, 1, 0] } }) }), 'unsupported'],
            [() => world.overlap({ shape, box: {} }), 'invalid argument']])
            assert.throws(ask, refused(status));
        // A sphere's shape is what rays meet, until it is removed.
        const aside = () => { world.update(); return world.raycastAny([0.1, 0, 0], [0, 0, -1]); };
        world.setShape(objects[0], new crofton.Shape({ box: { halfExtents: [0.01, 0.01, 0.01] } }));
        assert.equal(aside(), false);
        world.setShape(objects[0], null);
        assert.equal(aside(), true);
        assert.throws(() => world.setShape(objects[0]), refused('invalid argument'));
    });
    here('a region comes and goes', () => {
        const objects = [{ sphere: { center: [0, 0, -5], radius: 1 }, user: 3 }, { mesh: 0, transform: at(4, 0, -5), user: 4 },
            { shape: new crofton.Shape({ sphere: { radius: 1 } }), transform: at(-4, 0, -5), user: 5 }, { box: { center: [0, 4, -5], halfExtents: [1, 1, 1] }, layers: 2 }];
        const region = new crofton.Region(objects, { meshes: [{ ...CUBE, clusters: true }] }), world = new crofton.World();
        const own = world.add({ sphere: { center: [0, 0, 90], radius: 1 } });
        const attached = world.attach(region, [100, 0, 0]);
        region.free();  // the world keeps what it needs
        world.update();
        assert.deepEqual([99.999, 104, 96].map((x) => world.raycast([x, 0, 0], [0, 0, -1])?.user), [3, 4, 5]);
        assert.ok(world.raycastAny([100, 4, 0], [0, 0, -1], 9, 2) && !world.raycastAny([100, 4, 0], [0, 0, -1], 9, 1));
        const object = world.objectIn(attached, 2), visible = new crofton.ViewResult();
        assert.deepEqual(world.placeOf(object), { region: attached, place: 2 });
        world.view({ camera: { position: [104, 0, 0] }, picture: { width: 160, height: 90 } }, visible);
        assert.ok(visible.triangles.some((cluster) => cluster.object === world.objectIn(attached, 1).index));
        world.setHidden(object, true);
        assert.equal(world.count, 5);
        world.detach(attached);
        world.update();
        assert.deepEqual([world.count, world.contains(object), world.raycast([104, 0, 0], [0, 0, -1])], [1, false, null]);
        assert.throws(() => world.detach(attached), refused('stale handle'));
        assert.throws(() => world.detach(own), refused('bad handle'));
        assert.throws(() => world.placeOf(own), refused('invalid argument'));
        assert.throws(() => world.attach(region), refused('bad handle'));
        const [ball] = objects, bad = (list, more, status, item) => assert.throws(() => new crofton.Region(list, more), refused(status, item));
        bad([ball, { sphere: { center: [NaN, 0, 0], radius: 1 } }], {}, 'not finite', 1);
        bad([ball, {}], {}, 'invalid argument', 1);
        bad([{ mesh: 3 }], {}, 'invalid argument', 0);
        bad([{ shape: new crofton.Shape({ halfSpace: { normal: [0, 1, 0] } }) }], {}, 'unsupported', 0);
        bad([], { meshes: [{ positions: [0], indices: [0] }] }, 'invalid argument');
        const many = new crofton.Region([ball]);
        assert.throws(() => world.attach(many, [NaN, 0, 0]), refused('not finite'));
        assert.throws(() => world.attach(many, [1, 2]), refused('invalid argument'));
        assert.throws(() => world.objectIn(world.attach(many), 1), refused('out of range'));
    });
    here('many views are answered as each is alone', () => {
        const { world, objects } = row(), alone = new crofton.ViewResult(), many = new crofton.ViewResult();
        const mesh = world.addMesh(CUBE.positions, CUBE.indices, { clusters: true }), cube = world.add({ mesh, transform: at(0, 0, -9) });
        for (let i = 0; i < 40; ++i) world.update();
        const camera = {}, narrow = { fovY: 0.01, aspect: 1, position: [1, 0, 0] };
        const requests = [{ camera }, { camera: { forward: [0, 0, 1] } }, { camera, picture: { width: 160, height: 90 } }, { camera: narrow },
            { camera, candidates: new Uint32Array([4, 0]) }, { camera, limits: { eye: [0, 0, 0], leastRadius: 1 } }, { camera, occlusion: { listOccluded: true } }];
        world.view(requests, many);
        const masks = many.masks(world), ids = [...many.ids];
        requests.forEach((request, view) => {
            const expected = [...world.view(request, alone).ids];
            assert.deepEqual(ids.filter((_, i) => masks[i] >> view & 1), expected);
            assert.deepEqual([...many.triangleWordsOf(view)], [...alone.triangleWords]);
            assert.deepEqual([...many.occludedOf(view)], [...alone.occluded]);
        });
        assert.deepEqual(ids, [...objects.map(({ index }) => index), cube.index]);
        assert.equal(many.trianglesOf(2).length, many.triangleWordsOf(2).length / 4);
        assert.throws(() => many.triangleWordsOf(7), refused('out of range'));
        assert.equal(world.view([], many).length, 0);
        assert.throws(() => world.view([{ camera }, {}], many), refused('invalid argument', 1));
        assert.throws(() => world.view(Array(33).fill({ camera }), many), refused('out of range'));
        world.update();
        assert.throws(() => many.masks(world), refused('invalid argument'));
    });
    here('given occluders hide, and say what they hide', () => {
        const world = new crofton.World(), visible = new crofton.ViewResult(), { positions } = CUBE, indices = new Uint32Array([4, 5, 6, 5, 7, 6]);
        const mesh = world.addMesh(positions, indices), box = { center: [0, 0, 0], halfExtents: [1, 1, 1] };
        const wall = world.add({ mesh, transform: [4, 0, 0, 0, 0, 4, 0, 0, 0, 0, 1, 0, 0, 0, -5, 1], user: 1 });
        const behind = world.add({ sphere: { center: [0, 0, -20], radius: 0.5 } }), request = { camera: {}, occlusion: { listOccluded: true } };
        const occluded = (...occluders) => {
            world.setOccluders(mesh, occluders);
            world.update();
            return [...world.view(request, visible).occluded];
        };
        for (const occluder of [{ box }, { walled: box }, { convex: positions }, { patch: { positions, indices } }, { patch: { positions, indices, oneSided: true } }]) {
            assert.deepEqual(occluded(), []);
            assert.deepEqual(occluded(occluder), [behind.index]);
            assert.deepEqual(world.hiddenBy(visible, behind), [{ object: wall, user: 1, place: 0 }]);
            assert.deepEqual(world.hiddenBy(visible), [{ object: wall, user: 1, place: 0 }]);
            assert.deepEqual(world.hiddenBy(visible, wall), []);
            // The wall's front is 4 before the camera, in the middle of the picture; nothing is at its corner.
            const { width, height, nearness } = visible.depth;
            assert.deepEqual([width, height, nearness.length], [480, 270, 480 * 270]);
            near(nearness[135 * 480 + 240], 0.25, 0.01);
            assert.ok(nearness[0] < -1e38);
        }
        world.setOccludes(wall, false);
        world.update();
        assert.equal(world.view(request, visible).occluded.length, 0);
        const bad = (occluders, status, item) => assert.throws(() => world.setOccluders(mesh, occluders), refused(status, item));
        bad([{ box }, { convex: new Float32Array(12).fill(NaN) }], 'not finite', 1);
        bad([{}], 'invalid argument', 0);
        bad([{ convex: [1] }], 'invalid argument');
        world.add({ mesh, transform: at(0, 0, -3), onlyOccludes: true }), world.add({ mesh, transform: at(0, 0, -3), hidden: true });
        world.update();
        assert.deepEqual([...world.view({ camera: {} }, visible).ids], [wall.index, behind.index]);
        assert.throws(() => visible.depth, refused('empty'));
    });
    here('clusters that were cut before are taken as they are, also from their bytes', () => {
        const cut = new crofton.ClusteredMesh(CUBE.positions, CUBE.indices, { maxTriangles: 4 }), { bytes } = cut;
        const stored = new crofton.ClusteredMesh(bytes), world = new crofton.World();
        assert.deepEqual(stored.bytes, bytes);
        const add = (precut) => world.addMesh(CUBE.positions, CUBE.indices, { clusters: true, precut });
        const meshes = [add(cut), add(stored)];
        cut.free(), stored.free();
        world.update();
        const [first, second] = meshes.map((mesh) => world.clustersOf(mesh));
        assert.deepEqual(first, second);
        assert.ok(first.clusters.length >= 3 && first.clusters.every(({ triangleCount }) => triangleCount <= 4));
        assert.throws(() => add(cut), refused('bad handle'));
        assert.throws(() => new crofton.ClusteredMesh(bytes.subarray(1)), refused('parse'));
        assert.throws(() => new crofton.ClusteredMesh(CUBE.positions, [0, 1, 99]), refused('out of range', 2));
        assert.throws(() => new crofton.ClusteredMesh(CUBE.positions), refused('empty'));
        assert.throws(() => new crofton.ClusteredMesh([1, 2]), refused('invalid argument'));
        assert.throws(() => world.addMesh(CUBE.positions, CUBE.indices.subarray(3), { clusters: true, precut: new crofton.ClusteredMesh(bytes) }),
            refused('invalid argument'));
    });
    here('meshes deform, objects change their mesh, and without triangles the box is met', () => {
        const world = new crofton.World(), mesh = world.addMesh(TETRAHEDRON.positions, TETRAHEDRON.indices);
        const box = world.addMesh(TETRAHEDRON.positions, TETRAHEDRON.indices, { triangles: false }), object = world.add({ mesh });
        const hit = (x) => { world.update(); return world.raycastAny([x, x, 5], [0, 0, -1]); };
        assert.ok(hit(0.2) && !hit(0.7) && !hit(1.2));
        world.setMesh(object, box);
        assert.ok(hit(0.2) && hit(0.7));
        world.setMesh(object, mesh);
        world.setVertices(mesh, TETRAHEDRON.positions.map((x) => 3 * x));
        assert.ok(hit(1.2));
        assert.throws(() => world.setVertices(mesh, new Float32Array(6)), CroftonError);
        assert.throws(() => world.setVertices(mesh, new Float32Array(7)), refused('invalid argument'));
        assert.throws(() => world.setMesh(object, object), refused('bad handle'));
    });
}
