// SPDX-License-Identifier: MIT
import { failure } from './error.js';
import { Owned, checkArray, numbersOf } from './memory.js';

export const BOX = 72;

const float = new Float32Array(1), bits = new Int32Array(float.buffer);
/** Returns the least float that is not below a number. Half extents are stored as floats, and a box must not lose points. */
export function roundedUp(value) {
    float[0] = value;
    if (float[0] < value) bits[0] += float[0] < 0 ? -1 : 1;
    return float[0];
}

/** Boxes in the library's memory: no call copies them. Box i is 72 bytes: center (3 doubles), axes (9 floats), half extents. */
export class Boxes extends Owned {
    constructor(memory, count) {
        if (!Number.isInteger(count) || count < 0) throw failure(1, `Boxes: ${count} is no number of boxes`);
        super(memory, 'Boxes', memory.allocate(count * BOX, `${count} boxes`), '_free');
        this.length = count;
        memory.bytes.fill(0, this.handle, this.handle + count * BOX);
        const { floats } = memory;
        for (let at = (this.handle >> 2) + 6, i = 0; i < count; ++i, at += 18) floats[at] = floats[at + 4] = floats[at + 8] = 1;
    }
    #at(i) {
        if (!(Number.isInteger(i) && i >= 0 && i < this.length)) throw failure(3, `Boxes: there is no box ${i} of ${this.length}`);
        return this.handle + i * BOX;
    }
    /**
     * `axes`: nine numbers, three unit vectors one after another; left out: the world's. They are rounded to the nearest
     * floats, half extents to the next above.
     */
    set(i, center, halfExtents, axes) {
        const at = this.#at(i), { doubles, floats } = this.memory;
        for (let k = 0; k < 3; ++k) {
            doubles[(at >> 3) + k] = center[k];
            floats[(at >> 2) + 15 + k] = roundedUp(halfExtents[k]);
        }
        for (let k = 0; k < 9; ++k) floats[(at >> 2) + 6 + k] = axes ? axes[k] : k % 4 === 0 ? 1 : 0;
    }
    get(i) {
        const at = this.#at(i), { doubles, floats } = this.memory;
        return { center: [...doubles.subarray(at >> 3, (at >> 3) + 3)], axes: [...floats.subarray((at >> 2) + 6, (at >> 2) + 15)],
            halfExtents: [...floats.subarray((at >> 2) + 15, (at >> 2) + 18)] };
    }
    /** Copies packed arrays: 3 centers a box, 3 halfExtents, 9 axes or none. Does not check the numbers. */
    setAll(centers, halfExtents, axes) {
        checkArray(centers, [Float64Array, Float32Array], 'centers');
        checkArray(halfExtents, [Float64Array, Float32Array], 'halfExtents');
        if (axes) checkArray(axes, [Float64Array, Float32Array], 'axes');
        if (centers.length !== 3 * this.length || halfExtents.length !== 3 * this.length ||
            axes && axes.length !== 9 * this.length)
            throw failure(3, `Boxes: ${this.length} boxes take 3 numbers each of centers and halfExtents, and 9 of axes`);
        const { doubles, floats } = this.memory;
        let at = this.handle;
        for (let i = 0; i < this.length; ++i, at += BOX) {
            for (let k = 0; k < 3; ++k) {
                doubles[(at >> 3) + k] = centers[3 * i + k];
                floats[(at >> 2) + 15 + k] = roundedUp(halfExtents[3 * i + k]);
            }
            if (axes) for (let k = 0; k < 9; ++k) floats[(at >> 2) + 6 + k] = axes[9 * i + k];
        }
    }
    /** Throws for the first invalid box: not finite, not orthogonal, or with negative extents. */
    validate() { this.memory.call('boxes_validate', this.handle, this.length); }
    /** The bytes of the boxes, for a loader; detached when the memory grows. */
    get bytes() { return this.memory.bytes.subarray(this.handle, this.handle + this.length * BOX); }
}

export const DEPTH = { __proto__: null, reversed: 0, zeroToOne: 1, minusOneToOne: 2 };

/** The volume of a view, from a camera, or from a matrix and its depth range. */
export class Frustum extends Owned {
    constructor(memory, { camera, matrix, depth = 'minusOneToOne', origin, layers = 0xffffffff } = {}) {
        super(memory, 'Frustum', memory.allocate(424, 'a frustum'), '_free');
        try {
            memory.bytes.fill(0, this.handle, this.handle + 424);
            memory.words[this.handle >> 2] = 424;
            memory.words[(this.handle >> 2) + 1] = layers;
            memory.words[(this.handle >> 2) + 2] = 416;
            if (matrix) this.setMatrix(matrix, depth, origin);
            else this.setCamera(camera ?? {});
        } catch (error) {
            this.free();
            throw error;
        }
    }
    /** Members that are left out have their defaults: at the origin, along -z, 60 degrees, 16:9, from 0.1 to 1000. */
    setCamera(camera = {}) {
        this.memory.call('frustum_from_camera', writeCamera(this.memory, camera), this.handle + 8);
        return this;
    }
    /** `matrix`: sixteen numbers by columns, world to clip, as in three.js and WebGL. */
    setMatrix(matrix, depth = 'minusOneToOne', origin) {
        if (!(depth in DEPTH)) throw failure(1, `depth is one of ${Object.keys(DEPTH).join(', ')}`);
        if (matrix?.length !== 16) throw failure(1, 'matrix must have 16 numbers');
        const at = this.memory.scratch(160);
        this.memory.doubles.set(matrix, at >> 3);
        if (origin) this.memory.doubles.set(numbersOf(origin, 3, 'origin'), (at >> 3) + 16);
        this.memory.call('frustum_from_matrix', at, DEPTH[depth], origin ? at + 128 : 0, this.handle + 8);
        return this;
    }
    /** `{ origin, planes: [{ normal, offset }] }`; the volume is dot(normal, x - origin) + offset >= 0. */
    get planes() {
        const { words, doubles } = this.memory, first = this.handle + 40 >> 3;
        return { origin: [...doubles.subarray(this.handle + 16 >> 3, first)],
            planes: Array.from({ length: words[(this.handle >> 2) + 3] }, (_, i) => ({
                normal: [...doubles.subarray(first + 4 * i, first + 4 * i + 3)], offset: doubles[first + 4 * i + 3] })) };
    }
}

/** Writes a camera to `at`, by default in the scratch memory, and returns where. */
export function writeCamera(memory, camera, at = memory.scratch(256)) {
    const { words, doubles } = memory, first = at >> 3;
    memory.fill('default_camera', at);
    for (const [name, place] of [['position', 1], ['forward', 4], ['up', 7]])
        if (camera[name]) for (let k = 0; k < 3; ++k) doubles[first + place + k] = camera[name][k];
    if (camera.height !== undefined) words[(at >> 2) + 20] = 1;
    for (const [name, place] of [['fovY', 11], ['height', 12], ['aspect', 13], ['near', 14], ['far', 15]])
        if (camera[name] !== undefined) doubles[first + place] = camera[name];
    return at;
}
