// SPDX-License-Identifier: MIT
// Views: their requests, and their answers.
import { failure } from './error.js';
import { Owned, checkArray, checkRecords, create, handleOf, numbersOf } from './memory.js';
import { DEPTH, writeCamera } from './geometry.js';
import { ALL, halvesOf, layersOf, trianglesIn, vectorAt } from './records.js';

/**
 * The answer of a view of a world, a tree or a list of boxes. Its arrays are valid until its next view or growth of memory. After a view of
 * several requests, `ids` are what any of them sees, and the functions `…Of(view)` answer for each.
 */
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
    /** A copy: for each of `ids`, bit v says whether view v sees the object. `world` is that of the view. */
    masks(world) {
        const { memory, length } = this, of = handleOf(memory, world, 'World');
        return memory.lend([new Float64Array(2 * length), new Uint32Array(length)], (objects, masks) => {
            memory.call('view_result_list', this.handle, of, 0, objects, masks, length);
            return memory.words.slice(masks >> 2, (masks >> 2) + length);
        });
    }
    /** Data of a view: a struct of 192 bytes, in words. */
    #info(view = 0) {
        const at = this.memory.scratch(192);
        this.memory.words[at >> 2] = 192;
        this.memory.call('view_result_get_view', this.handle, view, at);
        return this.memory.words.subarray(at >> 2, (at >> 2) + 48);
    }
    /** Indices of objects in the frustum that are hidden, with `listOccluded`. */
    occludedOf(view) {
        const info = this.#info(view);
        return this.memory.words.subarray(info[30] >> 2, (info[30] >> 2) + info[31]);
    }
    get occluded() { return this.occludedOf(0); }
    /** For a view with a picture: object, cluster, and the low and the high half of the bits of its triangles, for each cluster to draw. */
    triangleWordsOf(view) {
        const info = this.#info(view);
        return this.memory.words.subarray(info[34] >> 2, (info[34] >> 2) + 4 * info[35]);
    }
    get triangleWords() { return this.triangleWordsOf(0); }
    /** The same as `{ object, cluster, triangles }`; bit k of the BigInt stands for triangle k of the cluster. */
    trianglesOf(view) {
        return trianglesIn(this.triangleWordsOf(view));
    }
    get triangles() { return this.trianglesOf(0); }
    /**
     * A copy of the depth buffer of a view with occlusion: `{ width, height, nearness }`, row by row from the bottom: 1 / w of the occluders
     * (orthographic: minus the distance), or below -1e38 where nothing is drawn.
     */
    depthOf(view) {
        const [width, height] = this.#info(view).slice(32, 34), { memory } = this;
        return memory.lend([new Float32Array(width * height)], (place) => {
            memory.call('view_result_depth', this.handle, view, place, width * height);
            return { width, height, nearness: memory.floats.slice(place >> 2, (place >> 2) + width * height) };
        });
    }
    get depth() { return this.depthOf(0); }
    statisticsOf(view) {
        const info = this.#info(view);
        const names = ['nodesTested', 'boxesTested', 'acceptedWhole', 'straddling', 'exactTests', 'falsePositives', 'occludersDrawn'];
        return Object.fromEntries(names.map((name, i) => [name, info[2 + 2 * i]]));
    }
    get statistics() { return this.statisticsOf(0); }
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

/** Limits of a view that leave out what is less than `pixels` wide in a picture `pictureHeight` pixels high. */
export function limitsOfCamera(memory, camera, pictureHeight, pixels) {
    const at = memory.scratch(256), limits = at + 128, first = limits >> 3;
    memory.fill('default_draw_limits', limits);
    memory.call('draw_limits_of_camera', writeCamera(memory, camera, at), pictureHeight, pixels, limits);
    return { eye: vectorAt(memory, limits + 8), maxDistanceInRadii: memory.doubles[first + 4], leastRadius: memory.doubles[first + 5] };
}

const REQUEST = 52, PARTS = 512;

/** Calls `ask` with the place of the requests' structs, 52 bytes each, in memory that lasts as long as the call. */
export function withRequests(memory, requests, ask) {
    const arrays = checkRecords(requests, 'requests').map(arraysOf);
    return memory.lend(arrays.flat().map(({ array }) => array), (...places) => {
        const parts = REQUEST * requests.length + 7 & ~7, at = memory.scratch(parts + PARTS * requests.length);
        requests.forEach((request, i) =>
            writeRequest(memory, request, at + REQUEST * i, at + parts + PARTS * i, arrays[i], places.splice(0, arrays[i].length)));
        return ask(at);
    });
}

function depthOf(name) {
    if (!(name in DEPTH)) throw failure(1, `depth is one of ${Object.keys(DEPTH).join(', ')}`);
    return DEPTH[name];
}
/** Writes 32 bytes. */
export function writePicture(memory, at, { width = 1280, height = 720, depth = 'reversed', samples = 1, workLimit = 0 } = {}) {
    memory.fill('default_picture_view', at);
    memory.words.set([width, height, depthOf(depth), samples], (at >> 2) + 1);
    memory.words.set(halvesOf(workLimit, 'workLimit'), (at >> 2) + 6);
    return at;
}

// From `at` on: the camera, 128 limits, 256 the matrix, 432 occlusion, 464 the picture, 496 the receivers.
function writeRequest(memory, { camera, matrix, depth = 'minusOneToOne', origin, volume, layers = ALL, occlusion, picture, receivers, limits, treeOrder,
    conservative }, request, at, arrays, places) {
    const { words, doubles, floats } = memory, first = request >> 2;
    const structs = { request, limits: at + 128 };
    memory.fill('default_view_request', request);
    if (camera) words[first + 1] = writeCamera(memory, camera, at);
    if (matrix) {
        if (matrix.length !== 16) throw failure(1, 'matrix must have 16 numbers');
        const place = at + 256;
        memory.fill('default_view_matrix', place);
        words[(place >> 2) + 1] = place + 48;
        words[(place >> 2) + 4] = depthOf(depth);
        if (origin) doubles.set(numbersOf(origin, 3, 'origin'), (place >> 3) + 3);
        doubles.set(matrix, (place >> 3) + 6);
        words[first + 2] = place;
    }
    if (volume) words[first + 3] = handleOf(memory, volume, 'Frustum') + 8;
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
    if (picture) words[first + 11] = writePicture(memory, at + 464, picture);
    if (receivers) {
        const { seen, radius = 1 } = receivers, place = at + 496;
        memory.fill('default_shadow_receivers', place);
        words[(place >> 2) + 1] = handleOf(memory, seen, 'ViewResult');
        doubles[(place >> 3) + 1] = radius;
        words[first + 12] = place;
    }
    words[first + 9] = conservative ? 1 : 0;
    words[first + 10] = treeOrder ? 1 : 0;
    arrays.forEach(({ array, of, place, count, unit }, i) => {
        words[(structs[of] >> 2) + place] = places[i];
        if (count) words[(structs[of] >> 2) + count] = array.byteLength / unit;
    });
}
