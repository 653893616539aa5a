// SPDX-License-Identifier: MIT
import { failure } from './error.js';
import { Owned, checkArray, checkGroups, checkRecords, create, handleOf, numbersOf } from './memory.js';
import { IDENTITY, clustersAt, meshArrays, vectorAt, writeTransform } from './records.js';

const points = (array, what) => {
    checkArray(array, [Float32Array], what);
    checkGroups(array, 3, what);
    return array;
};
// Of each kind: its number, the arrays that it lends, and what it writes with their places. A description has 144 bytes; from 144 on
// there is room for a mesh or a height field.
const KINDS = {
    __proto__: null,
    sphere: { kind: 0, write: ({ radius }, { floats }, at) => { floats[at + 8 >> 2] = radius; } },
    capsule: { kind: 1, write: writeRound }, cylinder: { kind: 2, write: writeRound }, cone: { kind: 3, write: writeRound },
    box: { kind: 4, write: ({ halfExtents }, { floats }, at) => floats.set(numbersOf(halfExtents, 3, 'halfExtents'), at + 16 >> 2) },
    triangle: { kind: 5, write: (corners, { floats }, at) => floats.set(numbersOf(corners, 9, 'triangle'), at + 28 >> 2) },
    hull: { kind: 6, lend: ({ positions }) => [points(positions, 'positions')], write: ({ positions, maxVertices = 0 }, { words }, at, [place]) =>
        words.set([place, positions.length / 3, maxVertices], at + 96 >> 2) },
    halfSpace: { kind: 7, write: ({ normal, offset = 0 }, { doubles }, at) => doubles.set([...numbersOf(normal, 3, 'normal'), offset], at + 64 >> 3) },
    mesh: { kind: 8, lend: ({ positions, indices }) => meshArrays(positions, Uint32Array.from(indices)),
        write: ({ positions, indices, frontOnly }, { words }, at, [place, corners]) => {
            words.set([24, place, positions.length / 3, corners, indices.length], at + 144 >> 2);
            [words[at + 112 >> 2], words[at + 120 >> 2]] = [at + 144, frontOnly ? 1 : 0];
        } },
    heightField: { kind: 9,
        lend: ({ heights, materials }) => [checkArray(heights, [Float32Array], 'heights'), ...materials ? [checkArray(materials, [Uint8Array], 'materials')] : []],
        write: ({ columns, heights, materials, spacing = [1, 1], frontOnly }, { words, doubles }, at, [place, cells = 0]) => {
            const rows = heights.length / columns;
            if (!Number.isInteger(rows) || materials && materials.length !== (columns - 1) * (rows - 1))
                throw failure(1, 'heightField: `heights` has whole rows of `columns`, and `materials` one number for each cell');
            words.set([40, columns, rows, place, cells], at + 144 >> 2);
            doubles.set(numbersOf(spacing, 2, 'spacing'), at + 168 >> 3);
            [words[at + 116 >> 2], words[at + 120 >> 2]] = [at + 144, frontOnly ? 1 : 0];
        } },
    compound: { kind: 10, lend: (children) => [new Uint32Array(checkRecords(children, 'compound').length), new Float64Array(12 * children.length)],
        write: (children, memory, at, [shapes, poses]) => {
            children.forEach(({ shape, transform = IDENTITY }, i) => {
                memory.words[(shapes >> 2) + i] = handleOf(memory, shape, 'Shape', i);
                writeTransform(memory, poses + 96 * i, transform);
            });
            memory.words.set([shapes, poses, children.length], at + 128 >> 2);
        } },
    rounded: { kind: 11, write: ({ core, radius }, memory, at) => {
        memory.words[at + 124 >> 2] = handleOf(memory, core, 'Shape');
        memory.floats[at + 8 >> 2] = radius;
    } },
};
function writeRound({ radius, halfHeight }, { floats }, at) { floats.set([radius, halfHeight], at + 8 >> 2); }

/** A solid or a surface: `{ KIND: what it is made of }`. It never changes; what uses it keeps what it needs of it. */
export class Shape extends Owned {
    constructor(memory, description = {}) {
        const [name, ...more] = Object.keys(description ?? {}), kind = KINDS[name], given = description?.[name];
        if (!kind || more.length || !given) throw failure(1, `a shape is one of ${Object.keys(KINDS).join(', ')}`);
        const handle = memory.lend([...kind.lend?.(given) ?? [], new Float64Array(24)], (...places) => {
            const at = places.pop();
            memory.fill('default_shape_description', at);
            memory.words[(at >> 2) + 1] = kind.kind;
            kind.write(given, memory, at, places);
            return create(memory, 'shape', at);
        });
        super(memory, 'Shape', handle, '_crofton_shape_destroy');
    }
    /** The box along the axes that contains it in its frame, `{ min, max }`; infinite for half-spaces. */
    get bounds() {
        const { memory } = this, at = memory.scratch(96);
        memory.words[at >> 2] = 96;
        memory.call('shape_get_info', this.handle, at);
        return { min: vectorAt(memory, at + 24), max: vectorAt(memory, at + 48) };
    }
    /** `{ volume, center, inertia }` for density 1, in its frame; nine numbers of inertia about the center. Error: surfaces have none. */
    get mass() {
        const { memory } = this, at = memory.scratch(112);
        memory.words[at >> 2] = 112;
        memory.call('shape_get_mass', this.handle, at);
        return { volume: memory.doubles[at + 8 >> 3], center: vectorAt(memory, at + 16), inertia: [...memory.doubles.subarray(at + 40 >> 3, at + 112 >> 3)] };
    }
}

/** Writes a shape at a pose, 104 bytes. */
export function writePlaced(memory, at, shape, transform = IDENTITY) {
    memory.words.set([handleOf(memory, shape, 'Shape'), writeTransform(memory, at + 8, transform)], at >> 2);
    return at;
}

/** Writes a motion, 72 bytes, and the options of its cast, 32 bytes. */
export function writeCast({ words, doubles }, { velocity = [0, 0, 0], spin = [0, 0, 0], pivot = [0, 0, 0], duration = 1, tolerance = 0,
    maxSteps = 0, ignoreInitialOverlaps = false } = {}, motion, options) {
    doubles.set([...numbersOf(velocity, 3, 'velocity'), ...numbersOf(spin, 3, 'spin'), ...numbersOf(pivot, 3, 'pivot')], motion >> 3);
    words[options >> 2] = 32;
    doubles.set([duration, tolerance], (options >> 3) + 1);
    words.set([maxSteps, ignoreInitialOverlaps ? 1 : 0], options + 24 >> 2);
}

/** A mesh cut into clusters; it never changes. Made of `positions` and `indices`, or of the bytes that `bytes` gave. */
export class ClusteredMesh extends Owned {
    constructor(memory, positions, indices, { maxTriangles = 0 } = {}) {
        let handle;
        if (positions instanceof Uint8Array)
            handle = memory.lend([checkArray(positions, [Uint8Array], 'bytes'), new Uint8Array(4)], (place, at) => {
                memory.call('clustered_mesh_deserialise', place, positions.length, at);
                return memory.words[at >> 2];
            });
        else
            handle = memory.lend([...meshArrays(positions, Uint32Array.from(indices ?? [])), new Uint8Array(32)], (place, corners, at) => {
                memory.words.set([24, place, positions.length / 3, corners, indices.length], at >> 2);
                return create(memory, 'clustered_mesh', at, maxTriangles);
            });
        super(memory, 'ClusteredMesh', handle, '_crofton_clustered_mesh_destroy');
    }
    /** A copy: `{ clusters: [{ firstTriangle, triangleCount }], triangleOrder }`, as `World.clustersOf`. */
    get clusters() {
        const at = this.memory.scratch(16);
        this.memory.call('clustered_mesh_get', this.handle, at);
        return clustersAt(this.memory, at);
    }
    /** A copy, to store: `new ClusteredMesh(bytes)` makes an equal one without cutting again. */
    get bytes() {
        const { memory } = this, at = memory.scratch(8);
        memory.call('clustered_mesh_serialise', this.handle, 0, 0, at);
        const count = memory.words[at >> 2], place = memory.allocate(count, 'bytes');
        try {
            memory.call('clustered_mesh_serialise', this.handle, place, count, at);
            return memory.bytes.slice(place, place + count);
        } finally {
            memory.free(place);
        }
    }
}

/** Returns a mesh's indices in the order of its clusters, so that each cluster is one range of an index buffer. */
export function permuteTriangles({ triangleOrder }, indices) {
    checkArray(indices, [Uint32Array, Uint16Array], 'indices');
    if (indices.length !== 3 * triangleOrder.length) throw failure(1, `the clusters have ${triangleOrder.length} triangles, and there are ${indices.length} indices`);
    const permuted = new indices.constructor(indices.length);
    triangleOrder.forEach((triangle, i) => permuted.set(indices.subarray(3 * triangle, 3 * triangle + 3), 3 * i));
    return permuted;
}
