// SPDX-License-Identifier: MIT
import { failure } from './error.js';
import { Owned, checkArray, checkGroups, create, indicesOf } from './memory.js';

const METHOD = { __proto__: null, ear: 0, delaunay: 1, minimumWeight: 2 };

/** Triangulates polygons with holes; keeps its memory from one polygon to the next. */
export class Triangulator extends Owned {
    constructor(memory) { super(memory, 'Triangulator', create(memory, 'triangulator'), '_crofton_triangulator_destroy'); }
    /** `points`: x y each; `ringEnds`: the end of each ring, the outer one first. `indices` is a copy, three per triangle. */
    triangulate(points, ringEnds, method = 'minimumWeight') {
        checkArray(points, [Float64Array], 'points');
        ringEnds ??= [points.length / 2];
        checkGroups(points, 2, 'points');
        if (!(method in METHOD)) throw failure(1, `method is one of ${Object.keys(METHOD).join(', ')}`);
        const { memory } = this, { handle } = this;
        return memory.lend([points, indicesOf(ringEnds, 'ringEnds'), new Uint8Array(64)], (corners, ends, at) => {
            const first = at >> 2;
            memory.words.set([20, corners, points.length >> 1, ends, ringEnds.length], first);
            memory.words[first + 6] = 40;
            memory.call('triangulate', handle, at, METHOD[method], at + 24);
            const { words, doubles } = memory;
            const indices = words.slice(words[first + 7] >> 2, (words[first + 7] >> 2) + 3 * words[first + 8]);
            return { indices, weight: doubles[at + 40 >> 3], gap: doubles[at + 48 >> 3], optimal: words[at + 56 >> 2] === 1 };
        });
    }
}
