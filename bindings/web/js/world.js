// SPDX-License-Identifier: MIT
import { failure } from './error.js';
import { Owned, checkArray, checkGroups, create, numbersOf } from './memory.js';
import { BOX, DEPTH, roundedUp, writeCamera } from './geometry.js';

const ALL = 0xffffffff;

/** The answer of a view of a world, a tree or a list of boxes. Its arrays are valid until its next view or growth of memory. */
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
    /** Data of the view: a struct of 192 bytes, in words. */
    #info() {
        const at = this.memory.scratch(192);
        this.memory.words[at >> 2] = 192;
        this.memory.call('view_result_get_view', this.handle, 0, at);
        return this.memory.words.subarray(at >> 2, (at >> 2) + 48);
    }
    /** Indices of objects in the frustum that are hidden, with `listOccluded`. */
    get occluded() {
        const info = this.#info();
        return this.memory.words.subarray(info[30] >> 2, (info[30] >> 2) + info[31]);
    }
    /** For a view with a picture: `{ object, cluster, triangles }`; bit k of the BigInt stands for triangle k of the cluster. */
    get triangles() {
        const info = this.#info(), { words } = this.memory;
        return Array.from({ length: info[35] }, (_, i) => {
            const [object, cluster, low, high] = words.subarray((info[34] >> 2) + 4 * i, (info[34] >> 2) + 4 * i + 4);
            return { object, cluster, triangles: BigInt(low) + (BigInt(high) << 32n) };
        });
    }
    /** The same as numbers, nothing is copied: object, cluster, and the low and the high half of the bits, for each. */
    get triangleWords() {
        const info = this.#info();
        return this.memory.words.subarray(info[34] >> 2, (info[34] >> 2) + 4 * info[35]);
    }
    get statistics() {
        const info = this.#info();
        const names = ['nodesTested', 'boxesTested', 'acceptedWhole', 'straddling', 'exactTests', 'falsePositives', 'occludersDrawn'];
        return Object.fromEntries(names.map((name, i) => [name, info[2 + 2 * i]]));
    }
}

/** Copies bits by object index for the library. */
function bitsOf(words, what) {
    checkArray(words, [BigUint64Array, Uint32Array], what);
    if (words.byteLength % 8) throw failure(1, `${what}: an even number of 32-bit words is expected`);
    return words;
}

/** Arrays that a request points to, and the places of their pointers and counts in its struct or in that of its limits. */
function arraysOf({ candidates, limits = {} }) {
    const arrays = [];
    if (candidates) arrays.push({ array: bitsOf(candidates, 'candidates'), of: 'request', place: 7, count: 8, unit: 8 });
    const { layerDistances, itemDistances, drawnBefore } = limits;
    if (layerDistances) {
        checkArray(layerDistances, [Float32Array], 'layerDistances');
        if (layerDistances.length !== 32) throw failure(1, 'layerDistances: 32 numbers are expected');
        arrays.push({ array: layerDistances, of: 'limits', place: 12 });
    }
    if (itemDistances)
        arrays.push({ array: checkArray(itemDistances, [Float32Array], 'itemDistances'), of: 'limits', place: 13, count: 14, unit: 4 });
    if (drawnBefore) arrays.push({ array: bitsOf(drawnBefore, 'drawnBefore'), of: 'limits', place: 15, count: 16, unit: 8 });
    return arrays;
}

/** Layers as 32 bits; -1 is all of them, as ALL is. */
function layersOf(layers) {
    if (!(Number.isInteger(layers) && layers >= -(2 ** 31) && layers < 2 ** 32)) throw failure(1, `layers: ${layers} is no whole number of 32 bits`);
    return layers >>> 0;
}

/** A user number's low and high half. */
function halvesOf(user) {
    if (!(Number.isInteger(user) && user >= 0 && user < 2 ** 53)) throw failure(1, 'user is a whole number below 2^53');
    return [user % 2 ** 32, Math.floor(user / 2 ** 32)];
}

/** Holds objects and answers queries about them. Changes take effect in `update`. An object is `{ index, generation }`. */
export class World extends Owned {
    constructor(memory) {
        const at = memory.scratch(56);
        memory.fill('default_world_options', at);
        memory.words[(at >> 2) + 1] = 0;  // pairs, which this build does not look for
        super(memory, 'World', create(memory, 'world', at), '_crofton_world_destroy');
    }

    /**
     * `positions`: Float32Array, x y z; `indices`: Uint32Array or Uint16Array, three a triangle. Both are copied. With `clusters`
     * views with a picture list its triangles; `oneSided`: back faces are not drawn.
     */
    addMesh(positions, indices, { clusters = false, oneSided = false } = {}) {
        checkArray(positions, [Float32Array], 'positions');
        checkArray(indices, [Uint32Array, Uint16Array], 'indices');
        checkGroups(positions, 3, 'positions');
        if (indices.length === 0) throw failure(5, 'there are no indices, so there is no triangle');
        const { memory } = this, { handle } = this;
        return memory.lend([positions, indices, new Uint8Array(56)], (places, corners, at) => {
            const isShort = indices instanceof Uint16Array ? 1 : 0;
            memory.fill('default_mesh_data', at);
            memory.words.set([places, positions.length / 3, 0, corners, indices.length, 0, isShort], (at >> 2) + 1);
            memory.words.set([clusters ? 1 : 0, oneSided ? 1 : 0], (at >> 2) + 9);
            memory.call('world_add_mesh', handle, at, at + 48);
            return this.#handleAt(at + 48, 'mesh');
        });
    }
    /** Error: objects use the mesh. */
    removeMesh(mesh) { this.memory.call('world_remove_mesh', this.handle, this.#give(mesh, 'mesh', this.memory.scratch(16))); }
    /** Returns the clusters of a mesh, as of the last update: `{ clusters: [{ firstTriangle, triangleCount }], triangleOrder }`. */
    clustersOf(mesh) {
        const { memory } = this, at = this.#give(mesh, 'mesh', memory.scratch(32));
        memory.words[at + 8 >> 2] = 24;
        memory.call('world_get_mesh', this.handle, at, at + 8);
        const { words } = memory, [clusters, count, order, triangles] = words.subarray(at + 16 >> 2, at + 32 >> 2);
        return { triangleOrder: words.slice(order >> 2, (order >> 2) + triangles),
            clusters: Array.from({ length: count }, (_, i) => ({
                firstTriangle: words[(clusters >> 2) + 2 * i], triangleCount: words[(clusters >> 2) + 2 * i + 1] })) };
    }
    /** Finds boxes inside `mesh`, if it is closed, that hide what is behind them. Objects hide nothing before this call. */
    findOccluders(mesh) {
        this.memory.call('world_find_occluders', this.handle, this.#give(mesh, 'mesh', this.memory.scratch(16)), 0);
    }
    /** Sets one convex occluder of a mesh: the hull of `positions`, within the drawn mesh. */
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
        const { memory } = this, at = memory.scratch(72 + 160 + 96 + 16), { words } = memory, first = at >> 2;
        memory.fill('default_object_description', at);
        words.set(halvesOf(user), first + 2);
        if (box || sphere) this.#writeBound(at + 72, box, sphere), words[first + 4] = at + 72;
        if (transform) this.#writeTransform(at + 232, transform), words[first + 5] = at + 232;
        if (mesh) {
            words[first + 6] = 1;
            this.#give(mesh, 'mesh', at + 32);
        }
        words[first + 12] = layersOf(layers);
        words[first + 14] = occludes ? 1 : 0;
        memory.call('world_add', this.handle, at, at + 328);
        return this.#handleAt(at + 328, 'object');
    }
    remove(object) { this.memory.call('world_remove', this.handle, this.#give(object, 'object', this.memory.scratch(16))); }
    setHidden(object, hidden) {
        this.#set(object, 8, (words, first) => { words[first + 17] = hidden ? 1 : 0; });
    }
    setUser(object, user) {
        const halves = halvesOf(user);
        this.#set(object, 1, (words, first) => words.set(halves, first + 2));
    }
    setLayers(object, layers) {
        this.#set(object, 2, (words, first) => { words[first + 12] = layersOf(layers); });
    }
    setBox(object, box) {
        this.#set(object, 64, (words, first) => {
            this.#writeBound(4 * first + 72, box);
            words[first + 4] = 4 * first + 72;
        });
    }
    // Sets one member of an object, by its description.
    #set(object, member, fill) {
        const { memory } = this, at = memory.scratch(72 + 160 + 16);
        this.#give(object, 'object', at + 232);
        memory.fill('default_object_description', at);
        fill(memory.words, at >> 2);
        memory.call('world_set', this.handle, at + 232, member, at);
    }
    setTransform(object, transform) {
        const at = this.memory.scratch(112);
        this.#writeTransform(at, transform);
        this.memory.call('world_set_transforms', this.handle, this.#give(object, 'object', at + 96), 0, at, 0, 1);
    }
    contains(object) {
        const at = this.memory.scratch(208);
        this.#give(object, 'object', at);
        this.memory.words[at + 8 >> 2] = 192;
        try {
            this.memory.call('world_get_object', this.handle, at, at + 8);
            return true;
        } catch (error) {
            if (error.status === 'stale handle') return false;
            throw error;
        }
    }
    get count() {
        const at = this.memory.scratch(80);
        this.memory.words[at >> 2] = 80;
        this.memory.call('world_get_statistics', this.handle, at);
        return this.memory.words[at + 64 >> 2];
    }
    /** Applies the changes. Call it once a frame, before queries. */
    update() { this.memory.call('world_update', this.handle, 0); }

    /**
     * Lists what a view sees. Set `camera`, `matrix` (with `depth` and `origin`, as in Frustum) or `volume`, a Frustum; with
     * occlusion also a camera or matrix beside a volume. `layers`; `occlusion`: leaves out what others hide, `{ listOccluded, width, height,
     * maxOccluders, leastCover }`; `picture`: `{ width, height, depth, samples }`, lists the triangles that it needs, instead of
     * occlusion; `receivers`: `{ seen, radius }`, with a picture that is a light's shadow map lists only the triangles whose shadows the
     * camera could see, whose view with a picture `seen` answered; `limits`: leaves out what is small or far; `candidates`: bits by object index, BigUint64Array or
     * Uint32Array; `treeOrder`, `conservative`.
     */
    view(request, visible) {
        const { memory } = this, arrays = arraysOf(request);
        memory.lend(arrays.map(({ array }) => array), (...places) => this.#view(request, visible, arrays, places));
        return visible;
    }
    #view({ camera, matrix, depth = 'minusOneToOne', origin, volume, layers = ALL, occlusion, picture, receivers, limits, treeOrder,
        conservative }, visible, arrays, places) {
        // From `at` on: the camera, 128 limits, 256 the matrix, 432 occlusion, 464 the picture, 496 the request, 552 the receivers.
        const { memory } = this, at = memory.scratch(568), { words, doubles, floats } = memory;
        const request = at + 496, first = request >> 2, word = (name) => {
            if (!(name in DEPTH)) throw failure(1, `depth is one of ${Object.keys(DEPTH).join(', ')}`);
            return DEPTH[name];
        };
        const structs = { request, limits: at + 128 };
        memory.fill('default_view_request', request);
        if (camera) words[first + 1] = writeCamera(memory, camera, at);
        if (matrix) {
            if (matrix.length !== 16) throw failure(1, 'matrix must have 16 numbers');
            const place = at + 256;
            memory.fill('default_view_matrix', place);
            words[(place >> 2) + 1] = place + 48;
            words[(place >> 2) + 4] = word(depth);
            if (origin) doubles.set(numbersOf(origin, 3, 'origin'), (place >> 3) + 3);
            doubles.set(matrix, (place >> 3) + 6);
            words[first + 2] = place;
        }
        if (volume) words[first + 3] = volume.handle + 8;
        words[first + 4] = layersOf(layers);
        if (occlusion) {
            const options = at + 432;
            memory.fill('default_occlusion_options', options);
            for (const [name, place] of [['width', 1], ['height', 2], ['maxOccluders', 3]])
                if (occlusion[name]) words[(options >> 2) + place] = occlusion[name];
            words[(options >> 2) + 4] = occlusion.listOccluded ? 1 : 0;
            if (occlusion.leastCover) floats[(options >> 2) + 5] = occlusion.leastCover;
            words[first + 5] = options;
        }
        if (limits) {
            const { eye, maxDistanceInRadii = Infinity, leastRadius = 0, hysteresis = 1 } = limits, place = structs.limits >> 3;
            memory.fill('default_draw_limits', structs.limits);
            doubles.set(numbersOf(eye, 3, 'eye'), place + 1);
            doubles.set([maxDistanceInRadii === Infinity ? 0 : maxDistanceInRadii, leastRadius], place + 4);
            doubles[place + 9] = hysteresis;
            words[first + 6] = structs.limits;
        }
        if (picture) {
            const { width = 1280, height = 720, depth: range = 'reversed', samples = 1 } = picture, place = at + 464;
            memory.fill('default_picture_view', place);
            words.set([width, height, word(range), samples], (place >> 2) + 1);
            words[first + 11] = place;
        }
        if (receivers) {
            const { seen, radius = 1 } = receivers, place = at + 552;
            if (!(seen instanceof ViewResult)) throw failure(1, 'receivers: `seen` is a ViewResult');
            memory.fill('default_shadow_receivers', place);
            words[(place >> 2) + 1] = seen.handle;
            doubles[(place >> 3) + 1] = radius;
            words[first + 12] = place;
        }
        words[first + 9] = conservative ? 1 : 0;
        words[first + 10] = treeOrder ? 1 : 0;
        arrays.forEach(({ array, of, place, count, unit }, i) => {
            words[(structs[of] >> 2) + place] = places[i];
            if (count) words[(structs[of] >> 2) + count] = array.byteLength / unit;
        });
        memory.call('world_view', this.handle, request, 1, 0, visible.handle);
    }
    /** Returns the nearest hit of a ray, `{ object, user, t, point, triangle, normal, startedInside }`, or null. */
    raycast(origin, direction, maxT = Infinity, layers = ALL) {
        const { memory } = this, at = memory.scratch(144), hit = at + 56 >> 2;
        memory.doubles.set([...numbersOf(origin, 3, 'origin'), ...numbersOf(direction, 3, 'direction'), maxT], at >> 3);
        memory.call('world_raycast', this.handle, at, 1, layersOf(layers), at + 56);
        const { doubles, words } = memory;  // the call may have made the memory grow
        if (words[hit] === ALL) return null;
        return { object: this.#handleAt(at + 56, 'object'), user: this.#userAt(at + 64), t: doubles[at + 72 >> 3],
            point: [...doubles.subarray(at + 80 >> 3, at + 104 >> 3)], triangle: words[hit + 12] === ALL ? -1 : words[hit + 12],
            normal: [...doubles.subarray(at + 112 >> 3, at + 136 >> 3)], startedInside: (words[hit + 20] & 255) !== 0 };
    }

    /** Tells whether a ray hits anything; faster than `raycast`. */
    raycastAny(origin, direction, maxT = Infinity, layers = ALL) {
        const { memory } = this, at = memory.scratch(64);
        memory.doubles.set([...numbersOf(origin, 3, 'origin'), ...numbersOf(direction, 3, 'direction'), maxT], at >> 3);
        memory.call('world_raycast_any', this.handle, at, layersOf(layers), at + 56);
        return memory.words[at + 56 >> 2] !== 0;
    }
    /**
     * Returns the objects that overlap `{ box }`, `{ sphere }` or `{ capsule: { begin, end, radius } }`, as `{ object, user }`, by index:
     * triangles of meshes, boxes and spheres.
     */
    overlap(shape, layers = ALL) {
        const { memory } = this, found = create(memory, 'found');
        try {
            const at = memory.scratch(152);
            memory.call('world_overlap', this.handle, this.#writeShape(at, shape), layersOf(layers), found);
            memory.call('found_objects', found, at + 144, at + 148);
            const [first, count] = memory.words.subarray(at + 144 >> 2, at + 152 >> 2);
            return Array.from({ length: count }, (_, i) => this.#refAt(first + 16 * i));
        } finally {
            memory.module._crofton_found_destroy(found);
        }
    }
    /** Returns the object nearest to a shape, `{ object, user, distance, onShape, onObject }`, no farther than `maxDistance`; or null. */
    closest(shape, maxDistance = Infinity, layers = ALL) {
        const { memory } = this, at = memory.scratch(224), answer = at + 144;
        memory.words[answer >> 2] = 80;
        memory.call('world_closest', this.handle, this.#writeShape(at, shape), maxDistance, layersOf(layers), answer);
        const { doubles, words } = memory, first = answer + 24 >> 3;
        if (words[answer + 4 >> 2] === ALL) return null;
        return { object: this.#handleAt(answer + 4, 'object'), user: this.#userAt(answer + 16), distance: doubles[first],
            onShape: [...doubles.subarray(first + 1, first + 4)], onObject: [...doubles.subarray(first + 4, first + 7)] };
    }
    #writeShape(at, { box, sphere, capsule } = {}) {
        if ([box, sphere, capsule].filter(Boolean).length !== 1) throw failure(1, 'a query has one of box, sphere and capsule');
        const { words, doubles } = this.memory, { begin, end = begin, radius } = capsule ?? { begin: sphere?.center, radius: sphere?.radius };
        words[at >> 2] = box ? 0 : sphere ? 1 : 2;
        if (box) this.#writeBox(at + 8, box);
        else doubles.set([...numbersOf(begin, 3, sphere ? 'center' : 'begin'), ...numbersOf(end, 3, 'end'), radius], at + 80 >> 3);
        return at;
    }
    #refAt(at) { return { object: this.#handleAt(at, 'object'), user: this.#userAt(at + 8) }; }
    #userAt(at) { return this.memory.words[at >> 2] + 2 ** 32 * this.memory.words[(at >> 2) + 1]; }

    // Objects and meshes each count from 0; `kind` tells a mesh from the object of the same number.
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
        const { words, doubles } = this.memory;
        words[at >> 2] = box ? 1 : 3;
        if (sphere) return doubles.set([...numbersOf(sphere.center, 3, 'center'), sphere.radius], at + 128 >> 3);
        this.#writeBox(at + 8, box);
    }
    #writeBox(at, { center, axes = [1, 0, 0, 0, 1, 0, 0, 0, 1], halfExtents }) {
        const { doubles, floats } = this.memory;
        doubles.set(numbersOf(center, 3, 'center'), at >> 3);
        floats.set(numbersOf(axes, 9, 'axes'), at + 24 >> 2);
        floats.set(numbersOf(halfExtents, 3, 'halfExtents').map(roundedUp), at + BOX - 12 >> 2);
    }
}
