// SPDX-License-Identifier: MIT
import { failure } from './error.js';
import { checkArray, checkGroups } from './memory.js';

const QUALITY = { __proto__: null, fast: 0, tight: 1, exact: 2 };

/** Returns a box around points, x y z each, the best by the criterion: weights of volume, area and mean curvature. */
export function fitBox(memory, points, { quality = 'tight', criterion } = {}) {
    checkArray(points, [Float32Array, Float64Array], 'points');
    if (!(quality in QUALITY)) throw failure(1, `quality is one of ${Object.keys(QUALITY).join(', ')}`);
    checkGroups(points, 3, 'points');
    return memory.lend([points, new Uint8Array(128)], (place, at) => {
        memory.fill('default_fit_options', at);
        memory.words[(at >> 2) + 1] = QUALITY[quality];
        if (criterion) {
            const { volume = 0, area = 0, meanCurvature = 0 } = criterion;
            memory.doubles.set([volume, area, meanCurvature], (at >> 3) + 1);
        }
        memory.call('fit_points', place, points.length / 3, points instanceof Float64Array ? 1 : 0, at, at + 32);
        const box = at + 32;
        return { center: [...memory.doubles.subarray(box >> 3, (box >> 3) + 3)],
            axes: [...memory.floats.subarray((box >> 2) + 6, (box >> 2) + 15)],
            halfExtents: [...memory.floats.subarray((box >> 2) + 15, (box >> 2) + 18)] };
    });
}
