// SPDX-License-Identifier: MIT
// Queries of two shapes, or of a shape and a ray or a point, without a World.
import { Shape, writeCast, writePlaced } from './shape.js';
import { numbersOf } from './memory.js';
import { vectorAt, writeRay } from './records.js';

// In the scratch memory: two shapes where they stand, 104 bytes each, then 104 for options, motions, a point or a ray; the answer from 512 on.
const A = 0, B = 104, GIVEN = 208, ANSWER = 512, BYTES = 1024;

const place = (memory, at, given) => {
    const { shape, transform } = given instanceof Shape ? { shape: given } : given ?? {};
    return writePlaced(memory, at, shape, transform);
};
const partAt = ({ words }, at) => ({ child: words[at >> 2], triangle: words[at + 4 >> 2] });

// Calls a function of two shapes, whose answer begins with its size and ends with what `read` reads.
function ask(memory, name, a, b, size, ...between) {
    const at = memory.scratch(BYTES);
    if (size) memory.words[at + ANSWER >> 2] = size;
    memory.call(name, place(memory, at + A, a), place(memory, at + B, b), ...between, at + ANSWER);
    return at + ANSWER;
}
const pairAt = (memory, at) => ({ lower: memory.doubles[(at >> 3) + 2], upper: memory.doubles[(at >> 3) + 3], onA: vectorAt(memory, at + 32),
    onB: vectorAt(memory, at + 56), normal: vectorAt(memory, at + 80), partA: partAt(memory, at + 104), partB: partAt(memory, at + 112) });

export function touches(memory, a, b) { return memory.words[ask(memory, 'shapes_meet', a, b, 0, 0) >> 2] !== 0; }

export function distance(memory, a, b) {
    const at = ask(memory, 'shapes_distance', a, b, 120, 0);
    return { distance: memory.doubles[(at >> 3) + 1], ...pairAt(memory, at) };
}

export function penetration(memory, a, b) {
    const at = ask(memory, 'shapes_penetration', a, b, 128, 0);
    return memory.words[at + 120 >> 2] ? { depth: memory.doubles[(at >> 3) + 1], ...pairAt(memory, at) } : null;
}

export function contacts(memory, a, b, { margin = 0, maxPoints = 0 } = {}) {
    const at = memory.scratch(BYTES), options = at + GIVEN, answer = at + ANSWER;
    [memory.words[options >> 2], memory.words[options + 16 >> 2], memory.words[answer >> 2]] = [24, maxPoints, 496];
    memory.doubles[options + 8 >> 3] = margin;
    memory.call('shapes_manifold', place(memory, at + A, a), place(memory, at + B, b), options, 0, answer);
    const { words, doubles } = memory;
    return { normal: vectorAt(memory, answer + 8), depth: doubles[answer + 32 >> 3],
        points: pointsAt(memory, answer + 48, words[answer + 40 >> 2]) };
}
/** The points of a manifold. */
export const pointsAt = (memory, at, count) => Array.from({ length: count }, (_, i) => {
    const point = at + 56 * i;
    return { position: vectorAt(memory, point), depth: memory.doubles[point + 24 >> 3], partA: partAt(memory, point + 40),
        partB: partAt(memory, point + 48) };
});

export function cast(memory, a, motion, b, motionOfB = {}) {
    const at = memory.scratch(BYTES), answer = at + ANSWER, options = at + GIVEN + 144;
    writeCast(memory, motionOfB, at + GIVEN + 72, options);
    writeCast(memory, motion, at + GIVEN, options);
    memory.words[answer >> 2] = 120;
    memory.call('shapes_cast', place(memory, at + A, a), at + GIVEN, place(memory, at + B, b), at + GIVEN + 72, options, answer);
    const { words, doubles } = memory, result = words[answer + 112 >> 2];
    return result === 0 ? null : { time: doubles[answer + 8 >> 3], distance: doubles[answer + 16 >> 3], onA: vectorAt(memory, answer + 24),
        onB: vectorAt(memory, answer + 48), normal: vectorAt(memory, answer + 72), partA: partAt(memory, answer + 96),
        partB: partAt(memory, answer + 104), unresolved: result === 2 };
}

export function closestPoint(memory, shape, point) {
    const at = memory.scratch(BYTES), answer = at + ANSWER;
    memory.doubles.set(numbersOf(point, 3, 'point'), at + GIVEN >> 3);
    memory.words[answer >> 2] = 120;
    memory.call('shape_closest_point', place(memory, at + A, shape), at + GIVEN, answer);
    const { onB, normal, partB } = pairAt(memory, answer);  // a is the point
    return { distance: memory.doubles[answer + 8 >> 3], point: onB, normal, part: partB };
}

export function raycast(memory, shape, origin, direction, maxT = Infinity) {
    const at = memory.scratch(BYTES), answer = at + ANSWER;
    memory.words[answer >> 2] = 80;
    memory.call('shape_raycast', place(memory, at + A, shape), writeRay(memory, at + GIVEN, origin, direction, maxT), answer);
    const { words, doubles } = memory, t = doubles[answer + 8 >> 3];
    return t === Infinity ? null : { t, point: vectorAt(memory, answer + 16), normal: vectorAt(memory, answer + 40),
        part: partAt(memory, answer + 64), startedInside: words[answer + 72 >> 2] !== 0 };
}
