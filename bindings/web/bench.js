// SPDX-License-Identifier: MIT
// Times the package's culling of the boxes and views in a file that bindings/web/native/digests.cpp writes.
//   node bindings/web/bench.js FILE [simd|plain]
import { readFileSync } from 'node:fs';
import { loadBuild } from './test/builds.js';

const BOXES = 100000, VIEWS = 20, NUMBERS = 52, REPETITIONS = 40;
const file = readFileSync(process.argv[2]), crofton = await loadBuild(process.argv[3] ?? 'simd');
const boxes = new crofton.Boxes(BOXES);
boxes.bytes.set(file.subarray(0, 72 * BOXES));
const numbers = new Float64Array(file.buffer.slice(file.byteOffset + 72 * BOXES, file.byteOffset + file.length));
const views = Array.from({ length: VIEWS }, (_, v) => {
    const frustum = new crofton.Frustum(), { memory, handle } = frustum, own = numbers.subarray(NUMBERS * v, NUMBERS * (v + 1));
    memory.words[handle + 12 >> 2] = own[0];
    memory.doubles.set(own.subarray(1), handle + 16 >> 3);
    return frustum;
});
const tree = new crofton.Tree(boxes), visible = new crofton.ViewResult();
const kinds = { tree: (view) => tree.cull(view, visible), list: (view) => crofton.cullBoxes(boxes, view, visible) };
const least = { tree: Infinity, list: Infinity }, first = {};
let seen;
for (let repeat = 0; repeat < REPETITIONS; ++repeat)
    for (const [kind, ask] of Object.entries(kinds)) {
        seen = 0;
        const from = performance.now();
        for (const view of views) {
            seen += ask(view).length;
            first[kind] ??= performance.now() - from;
        }
        least[kind] = Math.min(least[kind], (performance.now() - from) / VIEWS);
    }
const text = (kind) => `${kind} ${(1000 * least[kind]).toFixed(1)} us`;
console.log(`${text('tree')}, ${text('list')} a view, ${seen} seen; the first view ${(1000 * first.tree).toFixed(0)} and ` +
    `${(1000 * first.list).toFixed(0)} us`);
