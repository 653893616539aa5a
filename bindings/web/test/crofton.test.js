// SPDX-License-Identifier: MIT
import test from 'node:test';
import assert from 'node:assert/strict';
import { readFile } from 'node:fs/promises';
import { load, CroftonError } from '../js/crofton.js';
import { loadBuild } from './builds.js';
import { failure } from '../js/error.js';
import { random, rotation, verdict } from './oracle.js';

const BUILDS = (process.env.CROFTON_BUILDS ?? 'simd,plain').split(',');
const refused = (status) => (error) => error instanceof CroftonError && error.status === status && error.message.length > 8;
const CUBE = { positions: new Float32Array([-1, -1, -1, 1, -1, -1, -1, 1, -1, 1, 1, -1, -1, -1, 1, 1, -1, 1, -1, 1, 1, 1, 1, 1]),
    indices: new Uint32Array([0, 2, 1, 1, 2, 3, 4, 5, 6, 5, 7, 6, 0, 1, 4, 1, 5, 4, 2, 6, 3, 3, 6, 7, 0, 4, 2, 2, 4, 6, 1, 3, 5, 3, 7, 5]) };

function crowd(crofton, count, seed, spread = 60) {
    const next = random(seed), boxes = new crofton.Boxes(count), list = [];
    for (let i = 0; i < count; ++i) {
        const box = { center: [0, 0, 0].map(() => spread * (2 * next() - 1)), halfExtents: [0, 0, 0].map(() => Math.fround(3 * next())),
            axes: rotation(next).map(Math.fround) };
        boxes.set(i, box.center, box.halfExtents, box.axes);
        list.push(box);
    }
    return { boxes, list, next };
}
const translation = (x, y, z) => [1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, x, y, z, 1];

test('statuses have the same names in the types as in the code', async () => {
    const types = await readFile(new URL('../crofton.d.ts', import.meta.url), 'utf8');
    const names = [...types.match(/type Status = ([^;]*);/)[1].matchAll(/'([^']*)'/g)].map(([, name]) => name);
    names.forEach((name, i) => assert.equal(failure(i + 1, 'a message').status, name));
    assert.equal(failure(names.length + 1, 'a message').status, 'unknown status');
});
test('a damaged binary is a clear error', () => assert.rejects(load({ wasmBinary: new Uint8Array(8) }), refused('unavailable')));
test('without WebAssembly there is a clear error', async () => {
    const { WebAssembly } = globalThis;
    try {
        globalThis.WebAssembly = undefined;
        await assert.rejects(load(), refused('unavailable'));
    } finally {
        globalThis.WebAssembly = WebAssembly;
    }
});
test('without SIMD there is a clear error that says who has it', async () => {
    const { validate } = WebAssembly;
    try {
        WebAssembly.validate = () => false;
        await assert.rejects(load(), (error) => refused('unavailable')(error) && /SIMD.*Safari 16\.4/.test(error.message));
    } finally {
        WebAssembly.validate = validate;
    }
});

for (const build of BUILDS) {
    const crofton = await loadBuild(build);
    const here = (name, run) => test(`${build}: ${name}`, run);
    const one = (center = [0, 0, -5]) => { const b = new crofton.Boxes(1); b.set(0, center, [1, 1, 1]); return b; };

    here('the version is the library\'s', () => assert.match(crofton.version, /^\d+\.\d+\.\d+$/));

    here('a box in front is inside', () => assert.deepEqual([...crofton.classify(one(), new crofton.Frustum())], [2]));
    here('a box behind is outside', () => assert.deepEqual([...crofton.classify(one([0, 0, 5]), new crofton.Frustum())], [0]));
    here('a box at the eye straddles', () => assert.deepEqual([...crofton.classify(one([0, 0, 0]), new crofton.Frustum())], [1]));
    here('a matrix of WebGL gives the view of its camera', () => {
        const f = 1 / Math.tan(Math.PI / 6), matrix = [f, 0, 0, 0, 0, f, 0, 0, 0, 0, -1.002, -1, 0, 0, -0.2002, 0];
        const { boxes, list } = crowd(crofton, 500, 3), frustum = new crofton.Frustum({ matrix });
        const verdicts = crofton.classify(boxes, frustum);
        list.forEach((box, i) => {
            const expected = verdict(frustum.planes, box);
            if (expected === 'out') assert.equal(verdicts[i], 0);
            else if (expected === 'in') assert.equal(verdicts[i], 2);
        });
        assert.ok(verdicts.includes(2));
        assert.ok(frustum.planes.planes.length >= 5);
    });

    here('list, tree and classify agree with plain JavaScript on 20,000 boxes', () => {
        const counts = { out: 0, in: 0, seen: 0, unsure: 0 };
        for (let trial = 0; trial < 10; ++trial) {
            const { boxes, list, next } = crowd(crofton, 2000, 100 + trial);
            const frustum = new crofton.Frustum({ camera: { position: [20 * next(), 0, 0], forward: [next() - 0.5, next() - 0.5, next() - 0.5],
                fovY: 0.4 + next(), far: 80 } });
            const tree = new crofton.Tree(boxes), visible = new crofton.ViewResult(), verdicts = crofton.classify(boxes, frustum);
            const byTree = [...tree.cull(frustum, visible).ids], treeVerdicts = [...visible.verdicts];
            const byList = [...crofton.cullBoxes(boxes, frustum, visible).ids];
            assert.deepEqual(byTree, byList);
            assert.deepEqual(byTree, [...verdicts.keys()].filter((i) => verdicts[i] > 0));
            byTree.forEach((id, i) => assert.equal(treeVerdicts[i], verdicts[id]));
            const { planes } = frustum.planes;
            list.forEach((box, i) => {
                const expected = verdict(frustum.planes, box);
                ++counts[expected];
                if (expected === 'out') assert.equal(verdicts[i], 0);
                if (expected === 'in') assert.equal(verdicts[i], 2);
                if (expected === 'seen') assert.equal(verdicts[i] > 0, true);
            });
            assert.ok(planes.length <= 12);
            for (const owned of [boxes, frustum, tree, visible]) owned.free();
        }
        assert.ok(counts.out > 5000 && counts.in > 300 && counts.seen > 100 && counts.unsure < 400, JSON.stringify(counts));
    });
    here('conservative culling keeps at least what exact culling keeps', () => {
        const { boxes } = crowd(crofton, 3000, 7), frustum = new crofton.Frustum({ camera: { far: 90 } }), visible = new crofton.ViewResult();
        const exact = [...crofton.cullBoxes(boxes, frustum, visible).ids];
        const more = new Set(crofton.cullBoxes(boxes, frustum, visible, { conservative: true }).ids);
        assert.ok(exact.every((id) => more.has(id)));
    });
    here('tree order gives the same items', () => {
        const { boxes } = crowd(crofton, 3000, 8), frustum = new crofton.Frustum(), visible = new crofton.ViewResult();
        const tree = new crofton.Tree(boxes), sorted = [...tree.cull(frustum, visible).ids];
        assert.deepEqual([...tree.cull(frustum, visible, { treeOrder: true }).ids].sort((a, b) => a - b), sorted);
    });
    here('moved and removed items are where they were put', () => {
        const { boxes } = crowd(crofton, 100, 9), tree = new crofton.Tree(boxes), visible = new crofton.ViewResult();
        const frustum = new crofton.Frustum({ camera: { far: 10 } });
        tree.move([7], one());
        tree.refit();
        assert.ok(tree.cull(frustum, visible).ids.includes(7));
        tree.remove(7);
        tree.refit();
        assert.ok(!tree.cull(frustum, visible).ids.includes(7));
    });
    here('statistics count what was tested', () => {
        const { boxes } = crowd(crofton, 1000, 10), visible = new crofton.ViewResult();
        new crofton.Tree(boxes).cull(new crofton.Frustum(), visible);
        assert.ok(visible.statistics.nodesTested > 0);
    });
    here('no boxes give no answer', () => assert.equal(crofton.classify(new crofton.Boxes(0), new crofton.Frustum()).length, 0));
    here('boxes come back as they were set', () => {
        const boxes = new crofton.Boxes(2);
        boxes.set(1, [1, 2, 3], [4, 5, 6]);
        assert.deepEqual(boxes.get(1), { center: [1, 2, 3], halfExtents: [4, 5, 6], axes: [1, 0, 0, 0, 1, 0, 0, 0, 1] });
    });
    here('setAll is set for each', () => {
        const boxes = new crofton.Boxes(2);
        boxes.setAll(new Float64Array([1, 2, 3, 4, 5, 6]), new Float32Array([1, 1, 1, 2, 2, 2]));
        assert.deepEqual(boxes.get(1).center, [4, 5, 6]);
        assert.deepEqual(boxes.get(1).halfExtents, [2, 2, 2]);
    });
    here('half extents are rounded up to floats, so that a box loses nothing', () => {
        const boxes = new crofton.Boxes(1), next = random(77);
        const numbers = [0, 0.1, 0.7, 1e-50, 1e-40, 0.1 + 2 ** -30, Math.fround(0.1), 16777217, 3e38, Infinity];
        for (let i = 0; i < 1000; ++i) numbers.push(next() * 2 ** (80 * next() - 40));
        for (const h of numbers) {
            boxes.set(0, [0, 0, 0], [h, h, h]);
            const [up] = boxes.get(0).halfExtents;
            assert.ok(up >= h && (h === 0 ? up === 0 : Math.fround(h) < h || up === Math.fround(h)), `${h} became ${up}`);
            assert.ok(up === h || up - h <= Math.max(h * 2 ** -23, 2 ** -149), `${h} became ${up}`);
            boxes.setAll(new Float64Array(3), new Float64Array([h, h, h]));
            assert.deepEqual(boxes.get(0).halfExtents, [up, up, up]);
        }
        boxes.set(0, [0, 0, 0], [-0.1, NaN, -Infinity]);
        const [negative, none, least] = boxes.get(0).halfExtents;
        assert.ok(negative < 0 && Number.isNaN(none) && least === -Infinity);
    });
    here('a box of a world is rounded up as well', () => {
        const world = new crofton.World();
        world.add({ box: { center: [0, 0, -5], halfExtents: [0.7, 0.7, 1] } });
        world.update();
        assert.ok(Math.fround(0.7) < 0.7);
        assert.ok(world.raycast([0.7, 0, 0], [0, 0, -1]));
    });
    here('validate names the box that is none', () => {
        const boxes = new crofton.Boxes(3);
        boxes.set(2, [NaN, 0, 0], [1, 1, 1]);
        assert.throws(() => boxes.validate(), (error) => refused('not finite')(error) && error.item === 2);
    });
    here('a box that is not there is refused', () => assert.throws(() => new crofton.Boxes(2).set(2, [0, 0, 0], [1, 1, 1]), refused('out of range')));
    here('arrays of the wrong length are refused', () => assert.throws(() => new crofton.Boxes(2).setAll(new Float64Array(5), new Float32Array(6)), refused('out of range')));
    here('a number of boxes that is none is refused', () => assert.throws(() => new crofton.Boxes(-1), refused('invalid argument')));
    here('too many boxes are a clear error, and the library goes on', () => {
        assert.throws(() => new crofton.Boxes(60_000_000), refused('out of memory'));
        assert.deepEqual([...crofton.classify(one(), new crofton.Frustum())], [2]);
    });
    here('a matrix without 16 numbers is refused', () => assert.throws(() => new crofton.Frustum({ matrix: [1] }), refused('invalid argument')));
    here('a depth that is none is refused', () => assert.throws(() => new crofton.Frustum({ matrix: translation(0, 0, 0), depth: 'x' }), refused('invalid argument')));
    here('a camera without a direction is refused', () => assert.throws(() => new crofton.Frustum({ camera: { forward: [0, 0, 0] } }), CroftonError));

    here('every freed handle is a clear error', () => {
        const owned = [new crofton.Boxes(1), new crofton.Frustum(), new crofton.ViewResult(), new crofton.Triangulator(),
            new crofton.World(), new crofton.Tree(one()), new crofton.Shape({ sphere: { radius: 1 } }),
            new crofton.Region([]), new crofton.ClusteredMesh(CUBE.positions, CUBE.indices)];
        for (const each of owned) each.free(), each.free();
        const [boxes, frustum, visible, triangulator, world, tree, shape, region, clustered] = owned;
        for (const use of [() => boxes.get(0), () => frustum.planes, () => visible.ids, () => triangulator.triangulate(new Float64Array(6)),
            () => world.update(), () => tree.refit(), () => new crofton.Shape({ rounded: { core: shape, radius: 1 } }),
            () => new crofton.World().attach(region), () => clustered.bytes])
            assert.throws(use, refused('bad handle'));
    });
    here('growth of memory detaches old views and no others', () => {
        const boxes = one(), visible = crofton.cullBoxes(boxes, new crofton.Frustum(), new crofton.ViewResult());
        const before = visible.ids, bytes = crofton.memoryBytes;
        const big = new crofton.Boxes(Math.ceil(bytes / 72) + 1000);
        assert.ok(crofton.memoryBytes > bytes);
        assert.equal(before.length, 0);
        assert.deepEqual([...visible.ids], [0]);
        assert.deepEqual(boxes.get(0).center, [0, 0, -5]);
        big.free();
    });
    here('a detached ArrayBuffer is a clear error', () => {
        const points = new Float64Array(30);
        structuredClone(points.buffer, { transfer: [points.buffer] });
        assert.throws(() => crofton.fitBox(points), (error) => refused('invalid argument')(error) && /detached/.test(error.message));
    });
    here('a logger hears what is logged', () => {
        const heard = [];
        crofton.setLogger((level, message) => heard.push([level, message]));
        crofton.log(2, 'grün');
        crofton.setLogger(null);
        assert.deepEqual(heard, [[2, 'grün']]);
    });
    here('what a logger throws comes out of the call, and the next call works', () => {
        crofton.setLogger(() => { throw new TypeError('mine'); });
        assert.throws(() => crofton.log(2, 'x'), /mine/);
        crofton.setLogger(null);
        assert.deepEqual([...crofton.classify(one(), new crofton.Frustum())], [2]);
    });

    for (const quality of ['fast', 'tight', 'exact'])
        here(`a box of quality ${quality} contains its points`, () => {
            const next = random(5), points = Float32Array.from({ length: 300 }, () => next());
            const { center, axes, halfExtents } = crofton.fitBox(points, { quality });
            for (let i = 0; i < points.length; i += 3)
                for (let k = 0; k < 3; ++k) {
                    const along = [0, 1, 2].reduce((sum, c) => sum + axes[3 * k + c] * (points[i + c] - center[c]), 0);
                    assert.ok(Math.abs(along) <= halfExtents[k] + 1e-6);
                }
        });
    here('the exact box of a turned box is that box', () => {
        const axes = rotation(random(6)), points = [];
        for (let c = 0; c < 8; ++c)
            for (let i = 0; i < 3; ++i) points.push([4, 2, 1].reduce((sum, h, k) => sum + (c >> k & 1 ? h : -h) * axes[3 * k + i], 0));
        const box = crofton.fitBox(new Float64Array(points), { quality: 'exact' });
        box.halfExtents.sort().forEach((h, k) => assert.ok(Math.abs(h - [1, 2, 4][k]) < 1e-5));
    });
    here('a criterion chooses the box', () => {
        const next = random(8), points = Float64Array.from({ length: 90 }, () => next());
        const volume = (box) => box.halfExtents.reduce((a, b) => a * b);
        assert.ok(volume(crofton.fitBox(points, { quality: 'exact', criterion: { volume: 1 } })) <= volume(crofton.fitBox(points, { quality: 'exact' })) * (1 + 1e-5));
    });
    here('no points are refused', () => assert.throws(() => crofton.fitBox(new Float32Array(0)), refused('empty')));
    here('points that are not finite are refused by their item', () => assert.throws(() => crofton.fitBox(new Float32Array([0, 0, 0, NaN, 0, 0])), refused('not finite')));
    here('a list instead of an array is refused', () => assert.throws(() => crofton.fitBox([1, 2, 3]), refused('invalid argument')));

    for (const method of ['ear', 'delaunay', 'minimumWeight'])
        here(`${method}: a square with a hole is covered`, () => {
            const points = new Float64Array([0, 0, 4, 0, 4, 4, 0, 4, 1, 1, 1, 3, 3, 3, 3, 1]);
            const { indices, weight } = new crofton.Triangulator().triangulate(points, [4, 8], method);
            let area = 0;
            for (let t = 0; t < indices.length; t += 3) {
                const [a, b, c] = [...indices.subarray(t, t + 3)].map((i) => [points[2 * i], points[2 * i + 1]]);
                area += ((b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])) / 2;
            }
            assert.equal(indices.length, 24);
            assert.equal(area, 12);
            assert.ok(weight > 0);
        });
    here('the lightest triangulation is proved so', () => {
        const { optimal, gap } = new crofton.Triangulator().triangulate(new Float64Array([0, 0, 2, 0, 2, 1, 0, 1]));
        assert.ok(optimal && gap === 0);
    });
    here('an outline that crosses itself is refused', () => assert.throws(
        () => new crofton.Triangulator().triangulate(new Float64Array([0, 0, 1, 1, 1, 0, 0, 1])), CroftonError));

    here('a world sees what is in front, and gives user data back', () => {
        const world = new crofton.World(), visible = new crofton.ViewResult();
        const sphere = world.add({ sphere: { center: [0, 0, -5], radius: 1 }, user: 2 ** 40 + 7 });
        world.add({ box: { center: [0, 0, 5], halfExtents: [1, 1, 1] } });
        world.update();
        assert.deepEqual([...world.view({ camera: {} }, visible).ids], [sphere.index]);
        const hit = world.raycast([0, 0, 0], [0, 0, -1]);
        assert.deepEqual([hit.user, hit.t, hit.object], [2 ** 40 + 7, 4, sphere]);
        assert.equal(world.raycast([0, 0, 0], [0, 1, 0]), null);
    });
    here('objects move, hide and go', () => {
        const world = new crofton.World(), visible = new crofton.ViewResult(), frustum = new crofton.Frustum();
        const seen = () => { world.update(); return world.view({ volume: frustum }, visible).length; };
        const box = world.add({ box: { center: [0, 0, 5], halfExtents: [1, 1, 1] } });
        assert.equal(seen(), 0);
        world.setBox(box, { center: [0, 0, -5], halfExtents: [1, 1, 1] });
        assert.equal(seen(), 1);
        world.setHidden(box, true);
        assert.equal(seen(), 0);
        world.setHidden(box, false);
        assert.equal(seen(), 1);
        const late = world.add({ sphere: { center: [0, 0, -5], radius: 1 }, hidden: true });
        assert.equal(seen(), 1);
        world.setHidden(late, false);
        assert.equal(seen(), 2);
        world.remove(late);
        world.remove(box);
        assert.deepEqual([seen(), world.count, world.contains(box)], [0, 0, false]);
        assert.throws(() => world.remove(box), refused('stale handle'));
    });
    here('a wall hides what is behind it', () => {
        const world = new crofton.World(), visible = new crofton.ViewResult();
        const cube = world.addMesh(CUBE.positions, CUBE.indices), scaled = [5, 0, 0, 0, 0, 5, 0, 0, 0, 0, 0.5, 0, 0, 0, -5, 1];
        world.setOccluders(cube, [{ convex: CUBE.positions }]);
        const wall = world.add({ mesh: cube, transform: scaled });
        const behind = world.add({ mesh: cube, transform: translation(0, 0, -12) });
        world.update();
        assert.deepEqual([...world.view({ camera: {}, occlusion: { listOccluded: true } }, visible).ids], [wall.index]);
        assert.deepEqual([...visible.occluded], [behind.index]);
        assert.equal(world.view({ camera: {} }, visible).length, 2);
        world.setTransform(wall, translation(50, 0, -5));
        world.update();
        assert.deepEqual([...world.view({ camera: {}, occlusion: {} }, visible).ids], [behind.index]);
    });
    here('each part of a request is obeyed, or refused by name', () => {
        const world = new crofton.World(), visible = new crofton.ViewResult();
        const cube = world.addMesh(CUBE.positions, CUBE.indices, { clusters: true });
        const wall = world.add({ mesh: cube, transform: [5, 0, 0, 0, 0, 5, 0, 0, 0, 0, 0.5, 0, 0, 0, -10, 1] });
        const behind = world.add({ mesh: cube, transform: translation(0, 0, -40) });
        const beside = world.add({ mesh: cube, transform: translation(30, 0, -40), layers: 2 });
        for (let i = 0; i < 40; ++i) world.update();  // candidates say nothing about what may have moved since
        const f = 1 / Math.tan(Math.PI / 6), near = 0.1, far = 1000, camera = {};
        const matrix = [f * 9 / 16, 0, 0, 0, 0, f, 0, 0, 0, 0, near / (far - near), -1, 0, 0, far * near / (far - near), 0];
        const names = { [wall.index]: 'w', [behind.index]: 'b', [beside.index]: 's' };
        const seen = (request) => [...world.view(request, visible).ids].map((id) => names[id]).sort().join('');
        const bits = (...objects) => new Uint32Array([objects.reduce((sum, { index }) => sum | 1 << index, 0), 0]);
        for (const [request, expected] of [
            [{ camera }, 'bsw'], [{ matrix, depth: 'reversed' }, 'bsw'], [{ matrix, depth: 'reversed', origin: [0, 0, -50] }, ''],
            [{ camera, layers: 2 }, 'bsw'], [{ camera, layers: 1 }, 'bw'], [{ camera, candidates: bits(behind, beside) }, 'bs'],
            [{ camera, candidates: new BigUint64Array([1n << BigInt(wall.index)]) }, 'w'], [{ camera, conservative: true }, 'bsw'],
            [{ camera, limits: { eye: [0, 0, 0], leastRadius: 3 } }, 'w'], [{ camera, limits: { eye: [0, 0, 0], maxDistanceInRadii: 10 } }, 'w'],
            [{ camera, limits: { eye: [0, 0, 0], itemDistances: new Float32Array([20, 20, 20]) } }, 'w'],
            [{ camera, limits: { eye: [0, 0, 0], layerDistances: new Float32Array(32).fill(20) } }, 'w'],
            [{ camera, limits: { eye: [0, 0, 0], leastRadius: 3, drawnBefore: bits(beside), hysteresis: 2 } }, 'sw'],
            [{ camera, picture: { width: 160, height: 90 } }, 'sw'], [{ matrix, depth: 'reversed', picture: {} }, 'sw']]) {
            assert.equal(seen(request), expected);
            assert.equal(seen({ ...request, treeOrder: true }), expected);
            assert.equal(visible.triangles.length > 0, 'picture' in request);
        }
        world.view({ camera, picture: { width: 160, height: 90 } }, visible);
        const { clusters, triangleOrder } = world.clustersOf(cube);
        assert.deepEqual([...triangleOrder].sort((a, b) => a - b), [...Array(12).keys()]);
        for (const { object, cluster, triangles } of visible.triangles) {
            assert.ok(object === wall.index || object === beside.index);
            assert.ok(triangles > 0n && triangles >> BigInt(clusters[cluster].triangleCount) === 0n);
        }
        assert.deepEqual([...visible.triangleWords], visible.triangles.flatMap(({ object, cluster, triangles }) =>
            [object, cluster, Number(triangles & 0xffffffffn), Number(triangles >> 32n)]));
        assert.equal(world.clustersOf(world.addMesh(CUBE.positions, CUBE.indices)).clusters.length, 0);
        const bad = (request, status) => assert.throws(() => world.view(request, visible), refused(status));
        bad({}, 'invalid argument');
        bad({ camera, matrix }, 'invalid argument');
        bad({ camera, picture: {}, occlusion: {} }, 'invalid argument');
        bad({ camera, picture: { width: 0 } }, 'out of range');
        bad({ camera, picture: { depth: 'none' } }, 'invalid argument');
        bad({ matrix: [1, 2] }, 'invalid argument');
        bad({ camera, candidates: new Uint32Array(3) }, 'invalid argument');
        bad({ camera, candidates: [true] }, 'invalid argument');
        bad({ camera, limits: { eye: [0, 0] } }, 'invalid argument');
        bad({ camera, limits: { eye: [0, 0, 0], hysteresis: 0.5 } }, 'out of range');
    });
    here('what overlaps a shape and what is nearest to it, with layers and user numbers', () => {
        const world = new crofton.World(), visible = new crofton.ViewResult();
        const cube = world.addMesh(CUBE.positions, CUBE.indices);
        const box = world.add({ box: { center: [0, 0, 0], halfExtents: [1, 1, 1] }, user: 2 ** 40 + 7 });
        const sphere = world.add({ sphere: { center: [5, 0, 0], radius: 1 }, layers: 2 });
        const mesh = world.add({ mesh: cube, transform: translation(0, 10, 0) });
        world.update();
        const met = (...query) => world.overlap(...query).map(({ object }) => object);
        assert.deepEqual(world.overlap({ sphere: { center: [2, 0, 0], radius: 1 } }), [{ object: box, user: 2 ** 40 + 7 }]);  // they touch
        assert.deepEqual(met({ sphere: { center: [2.001, 0, 0], radius: 1 } }), []);
        assert.deepEqual(met({ capsule: { begin: [0, 0, 0], end: [5, 0, 0], radius: 0 } }), [box, sphere]);
        assert.deepEqual(met({ capsule: { begin: [0, 0, 0], end: [5, 0, 0], radius: 0 } }, 2), [box, sphere]);
        assert.deepEqual(met({ capsule: { begin: [0, 0, 0], end: [5, 0, 0], radius: 0 } }, 1), [box]);
        assert.deepEqual(met({ box: { center: [0, 10, 0], halfExtents: [9, 2, 9] } }), [mesh]);
        const near = world.closest({ sphere: { center: [2.5, 0, 0], radius: 0.25 } });
        assert.deepEqual(near, { object: box, user: 2 ** 40 + 7, distance: 1.25, onShape: [2.25, 0, 0], onObject: [1, 0, 0], triangle: -1, child: 0 });
        assert.equal(world.closest({ sphere: { center: [2.5, 0, 0], radius: 0.25 } }, 1), null);
        assert.equal(world.closest({ sphere: { center: [2.5, 0, 0], radius: 0.25 } }, 9, 2).distance, 1.25);
        assert.equal(world.raycastAny([0, 0, 9], [0, 0, -1]), true);
        assert.equal(world.raycastAny([0, 0, 9], [0, 0, -1], 7.5), false);
        world.setUser(box, 3);
        world.setLayers(box, 4);
        world.update();
        assert.deepEqual(world.overlap({ box: { center: [0, 0, 0], halfExtents: [9, 1, 1] } }, 4), [{ object: box, user: 3 }]);
        assert.throws(() => world.removeMesh(cube), refused('invalid argument'));
        world.remove(mesh);
        world.removeMesh(cube);
        assert.throws(() => world.add({ mesh: cube }), refused('stale handle'));
        world.update();
        for (const [ask, status] of [[() => world.overlap({}), 'invalid argument'],
            [() => world.overlap({ sphere: { center: [0, 0, 0], radius: -1 } }), 'invalid argument'], [() => world.overlap(), 'invalid argument'],
            [() => world.overlap({ sphere: { center: [0, 0, 0] } }), 'not finite'], [() => world.raycast([0, 0, 0], [0, 0, 1], 1, 'all'), 'invalid argument'],
            [() => world.overlap({ sphere: { center: [NaN, 0, 0], radius: 1 } }), 'not finite'],
            [() => world.overlap({ capsule: { begin: [0, 0, 0], radius: 1, end: [0] } }), 'invalid argument'],
            [() => world.closest({ box: { center: [0, 0], halfExtents: [1, 1, 1] } }), 'invalid argument'],
            [() => world.closest({ sphere: { center: [0, 0, 0], radius: 1 } }, -1), 'invalid argument'],
            [() => world.raycastAny([0, 0, 0], [0, 0, 0]), 'degenerate'],
            [() => world.setUser(box, -1), 'invalid argument'], [() => world.setLayers(box, 'x'), 'invalid argument'], [() => world.setLayers(mesh, 1), 'stale handle']])
            assert.throws(ask, refused(status));
    });
    here('a light lists what throws a shadow on what the camera sees', () => {
        const world = new crofton.World(), seen = new crofton.ViewResult(), casters = new crofton.ViewResult();
        const cube = world.addMesh(CUBE.positions, CUBE.indices, { clusters: true });
        const wall = world.add({ mesh: cube, transform: [5, 0, 0, 0, 0, 5, 0, 0, 0, 0, 0.5, 0, 0, 0, -10, 1] });
        const front = world.add({ mesh: cube, transform: translation(0, 0, -6) }), behind = world.add({ mesh: cube, transform: translation(0, 0, -20) });
        world.update();
        const picture = { width: 160, height: 90 }, camera = {}, lamp = { position: [2, 0, 1] };
        world.view({ camera, picture }, seen);
        const request = { camera: lamp, picture, receivers: { seen, radius: 2 } };
        assert.deepEqual([...world.view(request, casters).ids], [wall.index, front.index]);
        assert.ok(casters.triangles.length > 0);
        const bad = (asked, status, to = casters) => assert.throws(() => world.view(asked, to), refused(status));
        bad(request, 'invalid argument', seen);
        bad({ ...request, picture: undefined }, 'invalid argument');
        bad({ ...request, receivers: { seen, radius: 0 } }, 'out of range');
        bad({ ...request, receivers: {} }, 'invalid argument');
        world.remove(behind);
        bad(request, 'invalid argument');
        world.update();
        world.view({ camera, picture }, seen);
        assert.deepEqual([...world.view(request, casters).ids], [wall.index, front.index]);
    });
    here('occluders are found in a closed mesh', () => {
        const world = new crofton.World(), visible = new crofton.ViewResult(), cube = world.addMesh(CUBE.positions, CUBE.indices);
        world.findOccluders(cube);
        world.add({ mesh: cube, transform: [5, 0, 0, 0, 0, 5, 0, 0, 0, 0, 0.5, 0, 0, 0, -5, 1] });
        world.add({ mesh: cube, transform: translation(0, 0, -12) });
        world.update();
        assert.equal(world.view({ camera: {}, occlusion: {} }, visible).length, 1);
    });
    here('an object without a shape is refused', () => assert.throws(() => new crofton.World().add({}), refused('invalid argument')));
    here('a mesh with a missing corner is refused', () => assert.throws(
        () => new crofton.World().addMesh(new Float32Array(9), new Uint32Array([0, 1, 3])), CroftonError));

    const sphere = { center: [0, 0, -5], radius: 1 }, cube = { center: [0, 0, 0], halfExtents: [1, 1, 1] };
    const oneSphere = () => { const world = new crofton.World(), object = world.add({ sphere }); world.update(); return { world, object }; };
    for (const [what, wrong] of Object.entries({
        'a ray of four numbers': (world) => world.raycast([0, 0, 0], [0, 0, -1, 0]),
        'an origin of two numbers': (world) => world.raycast([0, 0], [0, 0, -1]),
        'a center of two numbers': (world) => world.add({ sphere: { center: [3, 0], radius: 1 } }),
        'a center of four numbers': (world) => world.add({ sphere: { center: [3, 0, 0, 1], radius: 1 } }),
        'half extents of two numbers': (world) => world.add({ box: { ...cube, halfExtents: [1, 1] } }),
        'half extents that are one number': (world) => world.add({ box: { ...cube, halfExtents: 1 } }),
        'a center of a box of two numbers': (world) => world.add({ box: { ...cube, center: [0, 0] } }),
        'twelve numbers as axes': (world) => world.add({ box: { ...cube, axes: [1, 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0] } }),
        'a handle without a generation': (world) => world.remove({ kind: 'object', index: 0 }),
        'a mesh in the place of an object': (world) => world.remove(world.addMesh(CUBE.positions, CUBE.indices)),
        'an object in the place of a mesh': (world) => world.findOccluders(world.raycast([0, 0, 0], [0, 0, -1]).object),
        'positions that are no threes': (world) => world.addMesh(new Float32Array(10), new Uint32Array([0, 1, 2])),
        'no indices': (world) => world.addMesh(new Float32Array(9), new Uint32Array(0)),
        'a matrix by rows': (world) => world.add({ mesh: world.addMesh(CUBE.positions, CUBE.indices),
            transform: [1, 0, 0, 7, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1] }),
        'an origin of a matrix of two numbers': () => new crofton.Frustum({ matrix: translation(0, 0, 0), origin: [1, 2] }),
        'a place between two boxes': () => new crofton.Boxes(3).set(1.5, [0, 0, 0], [1, 1, 1]),
        'the removal of no item': () => new crofton.Tree(new crofton.Boxes(3)).remove(undefined),
        'the move of item 2^32': () => new crofton.Tree(new crofton.Boxes(3)).move([2 ** 32], new crofton.Boxes(1)),
        'an odd number of coordinates': () => new crofton.Triangulator().triangulate(new Float64Array([0, 0, 1, 0, 1, 1, 5])),
        'a ring that ends within a point': () => new crofton.Triangulator().triangulate(new Float64Array([0, 0, 1, 0, 1, 1]), [2.5]),
        'a method that all objects have': () => new crofton.Triangulator().triangulate(new Float64Array([0, 0, 1, 0, 1, 1]), [3], 'toString'),
        'a logger that is no function': () => crofton.setLogger('console'),
    })) {
        here(`${what}: an error, and the world is as it was`, () => {
            const { world, object } = oneSphere();
            assert.throws(() => wrong(world), CroftonError);
            assert.ok(world.contains(object) && world.count === 1);
        });
    }
    here('queries ignore objects', () => {
        const world = new crofton.World(), ball = { sphere: { center: [0, 0, -5], radius: 3.5 } };
        const first = world.add({ sphere: { center: [0, 0, -5], radius: 1 }, layers: 1 }), second = world.add({ sphere: { center: [0, 0, -9], radius: 1 }, layers: 2 });
        world.update();
        const ray = [[0, 0, 0], [0, 0, -1], Infinity], ignored = [first], all = { ignored: [first, second] };
        assert.deepEqual(world.raycast(...ray).object, first);
        assert.deepEqual(world.raycast(...ray, { ignored }).object, second);
        assert.equal(world.raycast(...ray, { layers: 1, ignored }), null);
        assert.deepEqual(world.raycast(...ray, 2).object, second);
        assert.equal(world.raycastAny(...ray, all), false);
        assert.deepEqual(world.raycastAll(...ray, { ignored }).map((hit) => hit.object), [second]);
        assert.deepEqual([...world.raycastMany(new Float64Array(3), Float64Array.of(0, 0, -1), Infinity, { ignored }).objects], [second.index]);
        assert.deepEqual(world.overlap(ball, { ignored }).map((ref) => ref.object), [second]);
        assert.deepEqual(world.closest(ball, Infinity, { ignored }).object, second);
        const shape = new crofton.Shape({ sphere: { radius: 0.5 } }), transform = [1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1];
        assert.deepEqual(world.cast({ shape, transform }, { velocity: [0, 0, -20] }, { ignored }).object, second);
        for (const wrong of [{ ignored: first }, { ignored: [1] }, { ignored: [null] }, { layers: 0.5 }, 'all', null])
            assert.throws(() => world.raycast(...ray, wrong), CroftonError);
    });
    here('a bad item is named by its place', () => assert.throws(
        () => new crofton.Tree(new crofton.Boxes(3)).move([1, -1], new crofton.Boxes(2)), (error) => error.item === 1));
    here('vectors may be any array-like', () =>
        assert.equal(oneSphere().world.raycast({ length: 3, 0: 0, 1: 0, 2: 0 }, new Float32Array([0, 0, -1])).t, 4));
    here('a ray is answered where the memory grows during the call', () => {
        const { world } = oneSphere(), { memory } = world, { module } = memory, ask = module._crofton_world_raycast;
        try {
            module._crofton_world_raycast = (...given) => {
                const before = memory.bytes.length, places = [];
                while (memory.bytes.length === before) places.push(memory.allocate(1 << 22, 'memory'));
                places.forEach((place) => memory.free(place));
                return ask(...given);
            };
            assert.deepEqual(world.raycast([0, 0, 0], [0, 0, -1]).point, [0, 0, -4]);
        } finally {
            module._crofton_world_raycast = ask;
        }
    });
}
