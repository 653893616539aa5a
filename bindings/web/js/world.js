// SPDX-License-Identifier: MIT
import { failure } from './error.js';
import { Owned, checkArray, checkGroups, create, numbersOf } from './memory.js';
import { BOX, roundedUp, writeCamera } from './geometry.js';

const ALL = 0xffffffff;

/** What one view of a world sees, in memory that is kept; views of it are valid until its next view or growth of memory. */
export class ViewResult extends Owned {
    constructor(memory) {
        super(memory, 'ViewResult', create(memory, 'view_result'), '_crofton_view_result_destroy');
    }
    #list() {
        const at = this.memory.scratch(16);
        this.memory.call('view_result_ids', this.handle, at, at + 4, at + 8, 0);
        return this.memory.words.subarray(at >> 2, (at >> 2) + 3);
    }
    get length() { return this.#list()[1]; }
    /** Indices of objects: `object.index`. */
    get ids() {
        const [ids, count] = this.#list();
        return this.memory.words.subarray(ids >> 2, (ids >> 2) + count);
    }
    /** 1: straddling, 2: inside, for each of `ids`. */
    get verdicts() {
        const [, count, verdicts] = this.#list();
        return this.memory.bytes.subarray(verdicts, verdicts + count);
    }
    /** Indices of what is in the frustum and hidden, where `listOccluded` asked for it. */
    get occluded() {
        const at = this.memory.scratch(16);
        this.memory.call('view_result_occluded_ids', this.handle, at, at + 4);
        const [ids, count] = this.memory.words.subarray(at >> 2, (at >> 2) + 2);
        return this.memory.words.subarray(ids >> 2, (ids >> 2) + count);
    }
}

/** Objects, what they are and where; changes take effect in `update`. An object is `{ index, generation }`. */
export class World extends Owned {
    constructor(memory) {
        const at = memory.scratch(56);
        memory.fill('default_world_options', at);
        memory.words[(at >> 2) + 1] = 0;  // pairs, which this build does not look for
        super(memory, 'World', create(memory, 'world', at), '_crofton_world_destroy');
    }

    /** `positions`: Float32Array, x y z; `indices`: Uint32Array or Uint16Array, three a triangle. Both are copied. */
    addMesh(positions, indices) {
        checkArray(positions, [Float32Array], 'positions');
        checkArray(indices, [Uint32Array, Uint16Array], 'indices');
        checkGroups(positions, 3, 'positions');
        if (indices.length === 0) throw failure(5, 'there are no indices, so there is no triangle');
        const { memory } = this, { handle } = this;
        return memory.lend([positions, indices, new Uint8Array(48)], (places, corners, at) => {
            const isShort = indices instanceof Uint16Array ? 1 : 0;
            memory.fill('default_mesh_data', at);
            memory.words.set([places, positions.length / 3, 0, corners, indices.length, 0, isShort], (at >> 2) + 1);
            memory.call('world_add_mesh', handle, at, at + 40);
            return this.#handleAt(at + 40, 'mesh');
        });
    }
    /** Takes boxes of `mesh` that hide what is behind them, where it is closed; needed before objects occlude. */
    findOccluders(mesh) {
        this.memory.call('world_find_occluders', this.handle, this.#give(mesh, 'mesh', this.memory.scratch(16)), 0);
    }
    /** One convex occluder of a mesh: the hull of `positions`, within what is drawn. */
    setConvexOccluder(mesh, positions) {
        checkArray(positions, [Float32Array], 'positions');
        checkGroups(positions, 3, 'positions');
        const { memory } = this, { handle } = this;
        memory.lend([positions, new Uint8Array(248)], (places, at) => {
            memory.words.set([232, 2, 0, places, positions.length / 3], at >> 2);
            memory.call('world_set_occluders', handle, this.#give(mesh, 'mesh', at + 232), at, 1);
        });
    }

    /** `{ box: { center, halfExtents, axes } }`, `{ sphere: { center, radius } }` or `{ mesh, transform }`; `user`: a number. */
    add({ box, sphere, mesh, transform, user = 0, layers = ALL, occludes = true }) {
        if ([box, sphere, mesh].filter(Boolean).length !== 1) throw failure(1, 'an object has one of box, sphere and mesh');
        if (!(Number.isInteger(user) && user >= 0 && user < 2 ** 53)) throw failure(1, 'user is a whole number below 2^53');
        const { memory } = this, at = memory.scratch(80 + 160 + 96 + 16), { words } = memory, first = at >> 2;
        memory.fill('default_object_description', at);
        words.set([user % 2 ** 32, Math.floor(user / 2 ** 32)], first + 2);
        if (box || sphere) this.#writeBound(at + 80, box, sphere), words[first + 4] = at + 80;
        if (transform) this.#writeTransform(at + 240, transform), words[first + 5] = at + 240;
        if (mesh) {
            words[first + 6] = 1;
            this.#give(mesh, 'mesh', at + 32);
        }
        words[first + 12] = layers;
        words[first + 14] = occludes ? 1 : 0;
        memory.call('world_add', this.handle, at, at + 336);
        return this.#handleAt(at + 336, 'object');
    }
    remove(object) { this.memory.call('world_remove', this.handle, this.#give(object, 'object', this.memory.scratch(16))); }
    setHidden(object, hidden) {
        this.memory.call('world_set_hidden', this.handle, this.#give(object, 'object', this.memory.scratch(16)), hidden ? 1 : 0);
    }
    setBox(object, box) {
        const at = this.memory.scratch(176);
        this.#writeBound(at, box);
        this.memory.call('world_set_bound', this.handle, this.#give(object, 'object', at + 160), at);
    }
    setTransform(object, transform) {
        const at = this.memory.scratch(112);
        this.#writeTransform(at, transform);
        this.memory.call('world_set_transforms', this.handle, this.#give(object, 'object', at + 96), 0, at, 0, 1);
    }
    contains(object) {
        const at = this.memory.scratch(16);
        this.memory.call('world_contains', this.handle, this.#give(object, 'object', at), at + 8);
        return this.memory.words[at + 8 >> 2] === 1;
    }
    get count() {
        const at = this.memory.scratch(8);
        this.memory.call('world_object_count', this.handle, at);
        return this.memory.words[at >> 2];
    }
    /** Once a frame; then ask. */
    update() { this.memory.call('world_update', this.handle, 0); }

    /**
     * What a view sees: `{ camera }` or `{ volume }`, a Frustum, or both; `layers`; `occlusion`: leaves out what others hide,
     * `{ listOccluded, width, height, maxOccluders }` with these options.
     */
    view({ camera, volume, layers = ALL, occlusion }, visible) {
        const { memory } = this, at = camera ? writeCamera(memory, camera) : memory.scratch(256);
        const request = at + 128, options = at + 192, first = request >> 2, { words } = memory;
        memory.fill('default_view_request', request);
        if (camera) words[first + 1] = at;
        if (volume) words[first + 3] = volume.handle + 8;
        words[first + 4] = layers;
        if (occlusion) {
            memory.fill('default_occlusion_options', options);
            for (const [name, place] of [['width', 1], ['height', 2], ['maxOccluders', 3]])
                if (occlusion[name]) words[(options >> 2) + place] = occlusion[name];
            words[(options >> 2) + 4] = occlusion.listOccluded ? 1 : 0;
            words[first + 5] = options;
        }
        memory.call('world_view', this.handle, request, 0, visible.handle);
        return visible;
    }
    /** The nearest hit of a ray, `{ object, user, t, point, triangle, normal, startedInside }`, or null. */
    raycast(origin, direction, maxT = Infinity, layers = ALL) {
        const { memory } = this, at = memory.scratch(144), hit = at + 56 >> 2;
        memory.doubles.set([...numbersOf(origin, 3, 'origin'), ...numbersOf(direction, 3, 'direction'), maxT], at >> 3);
        memory.call('world_raycast', this.handle, at, 1, layers, at + 56);
        const { doubles, words } = memory;  // the call may have made the memory grow
        if (words[hit] === ALL) return null;
        return { object: this.#handleAt(at + 56, 'object'), user: words[hit + 2] + 2 ** 32 * words[hit + 3], t: doubles[at + 72 >> 3],
            point: [...doubles.subarray(at + 80 >> 3, at + 104 >> 3)], triangle: words[hit + 12] === ALL ? -1 : words[hit + 12],
            normal: [...doubles.subarray(at + 112 >> 3, at + 136 >> 3)], startedInside: (words[hit + 20] & 255) !== 0 };
    }

    // Objects and meshes count from 0 each: `kind` tells a mesh from the object of the same number.
    #give(handle, kind, at) {
        if (handle?.kind !== kind || !Number.isInteger(handle.index) || !Number.isInteger(handle.generation))
            throw failure(14, `this is no ${kind} of a world`);
        this.memory.words.set([handle.index, handle.generation], at >> 2);
        return at;
    }
    #handleAt(at, kind) {
        const [index, generation] = this.memory.words.subarray(at >> 2, (at >> 2) + 2);
        return { kind, index, generation };
    }
    #writeTransform(at, transform) {
        if (transform.length !== 16) throw failure(1, 'a transform has 16 numbers, by columns');
        if (![3, 7, 11, 15].every((i) => transform[i] === (i === 15 ? 1 : 0)))
            throw failure(6, 'the last row of a transform is 0, 0, 0, 1: it has 16 numbers, by columns');
        const column = (c) => [transform[4 * c], transform[4 * c + 1], transform[4 * c + 2]];
        this.memory.doubles.set([0, 1, 2, 3].flatMap(column), at >> 3);
    }
    #writeBound(at, box, sphere) {
        const { words, doubles, floats } = this.memory;
        words[at >> 2] = box ? 1 : 3;
        if (sphere) return doubles.set([...numbersOf(sphere.center, 3, 'center'), sphere.radius], at + 128 >> 3);
        doubles.set(numbersOf(box.center, 3, 'center'), at + 8 >> 3);
        floats.set(numbersOf(box.axes ?? [1, 0, 0, 0, 1, 0, 0, 0, 1], 9, 'axes'), at + 32 >> 2);
        floats.set(numbersOf(box.halfExtents, 3, 'halfExtents').map(roundedUp), at + 8 + BOX - 12 >> 2);
    }
}
