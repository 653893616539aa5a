// SPDX-License-Identifier: MIT
// What calls take and return, in the library's memory: handles, numbers of 64 bits, transforms, bounds.
import { failure } from './error.js';
import { checkArray, checkGroups, handleOf, numbersOf } from './memory.js';
import { BOX, roundedUp } from './geometry.js';

export const ALL = 0xffffffff;

/** Layers as 32 bits; -1 is all of them, as ALL is. */
export function layersOf(layers) {
    if (!(Number.isInteger(layers) && layers >= -(2 ** 31) && layers < 2 ** 32)) throw failure(1, `layers: ${layers} is no whole number of 32 bits`);
    return layers >>> 0;
}

/** Calls `use` with the place of a filter, 0 for all objects: a layer mask, or `{ layers, ignored }` with objects that are not found. */
export function withFilter(memory, filter, use) {
    const { layers = ALL, ignored = [] } = filter !== null && typeof filter === 'object' ? filter : { layers: filter };
    const mask = layersOf(layers);
    if (!Array.isArray(ignored)) throw failure(1, 'ignored is an array of objects of a world');
    if (mask === ALL && ignored.length === 0) return use(0);
    const words = new Uint32Array(4 + 2 * ignored.length);
    words.set([16, mask, 0, ignored.length]);
    return memory.lend([words], (at) => {
        memory.words[at + 8 >> 2] = at + 16;
        ignored.forEach((object, i) => giveHandle(memory, object, 'object', at + 16 + 8 * i, i));
        return use(at);
    });
}

/** A user number's low and high half. */
export function halvesOf(number, name = 'user') {
    if (!(Number.isInteger(number) && number >= 0 && number < 2 ** 53)) throw failure(1, `${name} is a whole number below 2^53`);
    return [number % 2 ** 32, Math.floor(number / 2 ** 32)];
}
export const userAt = ({ words }, at) => words[at >> 2] + 2 ** 32 * words[(at >> 2) + 1];

/** Writes a handle. Objects, meshes, nodes and regions each count from 0; `kind` tells them apart. */
export function giveHandle(memory, handle, kind, at, item) {
    if (handle?.kind !== kind || !Number.isInteger(handle.index) || !Number.isInteger(handle.generation))
        throw failure(14, `this is no ${kind} of a world`, item);
    memory.words.set([handle.index, handle.generation], at >> 2);
    return at;
}
export function handleAt({ words }, at, kind) { return { kind, index: words[at >> 2], generation: words[(at >> 2) + 1] }; }
export const refAt = (memory, at) => ({ object: handleAt(memory, at, 'object'), user: userAt(memory, at + 8) });
export const vectorAt = ({ doubles }, at) => [...doubles.subarray(at >> 3, (at >> 3) + 3)];

export function writeTransform(memory, at, transform) {
    if (transform?.length !== 16) throw failure(1, 'a transform has 16 numbers, by columns');
    if (![3, 7, 11, 15].every((i) => transform[i] === (i === 15 ? 1 : 0)))
        throw failure(6, 'the last row of a transform is 0, 0, 0, 1: it has 16 numbers, by columns');
    const column = (c) => [transform[4 * c], transform[4 * c + 1], transform[4 * c + 2]];
    memory.doubles.set([0, 1, 2, 3].flatMap(column), at >> 3);
    return at;
}
export function writeRay({ doubles }, at, origin, direction, maxT) {
    doubles.set([...numbersOf(origin, 3, 'origin'), ...numbersOf(direction, 3, 'direction'), maxT], at >> 3);
    return at;
}
export const IDENTITY = [1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1];

export function writeBox({ doubles, floats }, at, { center, axes = [1, 0, 0, 0, 1, 0, 0, 0, 1], halfExtents }) {
    doubles.set(numbersOf(center, 3, 'center'), at >> 3);
    floats.set(numbersOf(axes, 9, 'axes'), at + 24 >> 2);
    floats.set(numbersOf(halfExtents, 3, 'halfExtents').map(roundedUp), at + BOX - 12 >> 2);
}
export function writeBound(memory, at, { box, sphere }) {
    const { words, doubles } = memory;
    words[at >> 2] = box ? 1 : 3;
    if (sphere) doubles.set([...numbersOf(sphere.center, 3, 'center'), sphere.radius], at + 128 >> 3);
    else writeBox(memory, at + 8, box);
}

/** The places and counts of a crofton_clusters, copied. */
export function clustersAt({ words }, at) {
    const [clusters, count, order, triangles] = words.subarray(at >> 2, at + 16 >> 2);
    return { triangleOrder: words.slice(order >> 2, (order >> 2) + triangles),
        clusters: Array.from({ length: count }, (_, i) => ({
            firstTriangle: words[(clusters >> 2) + 2 * i], triangleCount: words[(clusters >> 2) + 2 * i + 1] })) };
}
/** Triangles to draw, four words for each cluster: object, cluster, the low and the high half of the bits. */
export const trianglesIn = (words) => Array.from({ length: words.length / 4 }, (_, i) => {
    const [object, cluster, low, high] = words.subarray(4 * i, 4 * i + 4);
    return { object, cluster, triangles: BigInt(low) + (BigInt(high) << 32n) };
});

/** The arrays of a mesh, checked. */
export function meshArrays(positions, indices) {
    checkArray(positions, [Float32Array], 'positions');
    checkArray(indices, [Uint32Array, Uint16Array], 'indices');
    checkGroups(positions, 3, 'positions');
    if (indices.length === 0) throw failure(5, 'there are no indices, so there is no triangle');
    return [positions, indices];
}
/** Writes 48 bytes that describe a mesh whose arrays are at `places` and `corners`. */
export function writeMesh(memory, at, places, corners, positions, indices, { clusters = false, oneSided = false, triangles = true, precut } = {}) {
    memory.fill('default_mesh_data', at);
    memory.words.set([places, positions.length / 3, 0, corners, indices.length, 0, indices instanceof Uint16Array ? 1 : 0,
        triangles ? 1 : 0, clusters ? 1 : 0, oneSided ? 1 : 0, precut ? handleOf(memory, precut, 'ClusteredMesh') : 0], (at >> 2) + 1);
}
