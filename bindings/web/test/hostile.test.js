// SPDX-License-Identifier: MIT
// A random walk over everything that is public: each call with arguments of any kind answers, or throws a CroftonError.
import { test } from 'node:test';
import assert from 'node:assert/strict';
import { loadBuild } from './builds.js';
import { CroftonError } from '../js/crofton.js';

const BUILDS = (process.env.CROFTON_BUILDS ?? 'simd,plain').split(',');
/** What a thing of the library has, by name. */
const members = (thing) => {
    const names = [];
    for (let owner = Object.getPrototypeOf(thing); owner !== Object.prototype; owner = Object.getPrototypeOf(owner)) names.push(...Object.getOwnPropertyNames(owner));
    return names;
};
/** The same numbers for the same seed, from 0 to `most` - 1. */
const dice = (seed) => (most) => (seed = Math.imul(seed, 1664525) + 1013904223 >>> 0) % 65521 % most;
const detached = () => { const array = new Float64Array(3); structuredClone(array, { transfer: [array.buffer] }); return array; };
const CORNERS = new Float32Array([-1, -1, 0, 1, -1, 0, 1, 1, 0, -1, 1, 0]), FACES = new Uint32Array([0, 1, 2, 0, 2, 3]);

function things(crofton) {
    const world = new crofton.World(), mesh = world.addMesh(CORNERS, FACES, { clusters: true }), object = world.add({ mesh });
    const region = new crofton.Region([{ sphere: { center: [0, 0, -9], radius: 1 } }]), attached = world.attach(region), node = world.addNode();
    world.update();
    const gone = new crofton.World();
    gone.free();
    return [world, mesh, object, node, attached, region, gone, new crofton.ViewResult(), new crofton.Frustum(), new crofton.Boxes(2), new crofton.Tree(new crofton.Boxes(2)),
        new crofton.Triangulator(), new crofton.Shape({ sphere: { radius: 1 } }), new crofton.ClusteredMesh(CORNERS, FACES), new crofton.DepthCuller()];
}

for (const build of BUILDS)
    test(`${build}: no call ends without an answer or a CroftonError`, async () => {
        const crofton = await loadBuild(build);
        for (let seed = 1; seed <= 4; ++seed) {
            const roll = dice(seed), made = things(crofton), any = (list) => list[roll(list.length)];
            const plain = [undefined, null, NaN, Infinity, -1, 0, 1, 2, 0.5, 2 ** 31, 2 ** 32, 2 ** 53, 1e308, 5e-324, true, 10n, 'x', '', Symbol('x'), [], {}, [[]], () => 0, [0, 0, 0], [0, 0, -1],
                [NaN, 0, 0], ['a', 'b', 'c'], new Array(16).fill(0), [null], new Float32Array(3), new Float64Array(16), new Float32Array(0), new Uint32Array([0, 1, 9]), new BigUint64Array(2),
                CORNERS, FACES, new Uint8Array(7), new ArrayBuffer(8), new Map(), new Proxy({}, {}), detached(), Object.create(null)];
            const keys = ['box', 'sphere', 'shape', 'mesh', 'transform', 'node', 'user', 'layers', 'camera', 'volume', 'occlusion', 'picture', 'limits', 'receivers', 'seen', 'candidates', 'center',
                'radius', 'halfExtents', 'positions', 'indices', 'velocity', 'ignored', 'meshes', 'toClip', 'objects', 'hull', 'compound', 'heightField', 'quality', 'begin', 'end', 'position'];
            const value = (depth = 0) => {
                const which = roll(10);
                if (which < 3) return any(made);
                if (which > 7 && depth < 3) return Object.fromEntries(Array.from({ length: 1 + roll(3) }, () => [any(keys), value(depth + 1)]));
                return any(plain);
            };
            for (let step = 0; step < 1500; ++step) {
                const type = any(Object.keys(crofton)), thing = any(made), given = Array.from({ length: roll(5) }, () => value());
                let name = type, call;
                if (roll(3) === 0) {
                    const named = crofton[type];
                    if (typeof named !== 'function' || type === 'log') continue;
                    call = /^[A-Z]/.test(type) ? () => new named(...given) : () => crofton[type](...given);
                } else {
                    name = any([...members(thing), 'constructor']);
                    if (['constructor', 'memory', 'handle'].includes(name) || name === 'free' && roll(20)) continue;
                    call = () => { const member = thing[name]; return typeof member === 'function' ? member.apply(thing, given) : member; };
                }
                try {
                    const answer = call();
                    if (answer?.free && made.length < 60) made.push(answer);
                } catch (error) {
                    assert.ok(error instanceof CroftonError && error.message, `seed ${seed}, step ${step}, ${thing.constructor?.name} ${name}: ${error?.stack}`);
                }
            }
            crofton.setLogger(null);
        }
    });
