// SPDX-License-Identifier: MIT
// Triangles that a picture needs, of meshes that no World holds.
import { Owned, checkRecords, create, handleOf, numbersOf } from './memory.js';
import { trianglesIn } from './records.js';
import { writePicture } from './views.js';

const OBJECT = 84, RECEIVER = 72;
const writeMatrix = ({ floats }, at, matrix, what) => floats.set(numbersOf(matrix, 16, what), at >> 2);

/** Finds the triangles of pictures, and of shadow maps. Keeps its buffers from one to the next. */
export class DepthCuller extends Owned {
    #answer = [0, 0]; #statistics = {};
    constructor(memory) {
        super(memory, 'DepthCuller', create(memory, 'depth_culler'), '_crofton_depth_culler_destroy');
    }
    /**
     * Lists the triangles that a picture `{ width, height, depth, samples, workLimit }` needs. `objects`: `{ mesh, toClip, oneSided, hides, positionError }`,
     * where `mesh` is a ClusteredMesh and `toClip` takes its positions to clip space, sixteen numbers by columns.
     */
    findVisible(objects, picture) {
        return this.#find('find_visible', objects, picture);
    }
    /**
     * Lists the triangles of casters without which a shadow on what a camera sees would change. `toClip` leads to the clip space of `map`, the
     * light's shadow map. `receivers`: `{ seen, objects, radius }`, where `seen` is the DepthCuller that last answered for the camera's picture, and
     * `objects` are those of that call, each `{ mesh, toMap, solid }`.
     */
    findCasters(objects, map, { seen, objects: receivers = [], radius = 1 } = {}) {
        const { memory } = this, camera = handleOf(memory, seen, 'DepthCuller');
        checkRecords(receivers, 'objects');
        return memory.lend([new Float64Array(3 + 9 * receivers.length)], (at) => {
            receivers.forEach(({ mesh, toMap, solid = false }, i) => {
                const place = at + 24 + RECEIVER * i;
                memory.words[place >> 2] = mesh ? handleOf(memory, mesh, 'ClusteredMesh', i) : 0;
                writeMatrix(memory, place + 4, toMap, 'toMap');
                memory.words[place + 68 >> 2] = solid ? 1 : 0;
            });
            memory.fill('default_depth_receivers', at);
            memory.words.set([camera, at + 24, receivers.length], (at >> 2) + 1);
            memory.doubles[(at >> 3) + 2] = radius;
            return this.#find('find_casters', objects, map, at);
        });
    }
    #find(name, objects, picture, ...receivers) {
        const { memory, handle } = this;
        checkRecords(objects, 'objects');
        return memory.lend([new Float64Array(12), new Uint8Array(OBJECT * objects.length)], (at, first) => {
            objects.forEach(({ mesh, toClip, oneSided = false, hides = true, positionError = 0 }, i) => {
                const place = first + OBJECT * i;
                memory.fill('default_depth_object', place);
                memory.words[place + 4 >> 2] = handleOf(memory, mesh, 'ClusteredMesh', i);
                writeMatrix(memory, place + 8, toClip, 'toClip');
                memory.words.set([oneSided ? 1 : 0, hides ? 1 : 0], place + 72 >> 2);
                memory.floats[place + 80 >> 2] = positionError;
            });
            writePicture(memory, at, picture);
            memory.words[at + 40 >> 2] = 56;
            memory.call(`depth_culler_${name}`, handle, first, objects.length, at, ...receivers, 0, at + 32, at + 36, at + 40);
            const { words } = memory, names = ['objectsListed', 'objectsAsked', 'clustersAsked', 'clustersDrawn', 'trianglesDrawn', 'trianglesListed'];
            this.#answer = [...words.slice(at + 32 >> 2, at + 40 >> 2)];
            this.#statistics = Object.fromEntries(names.map((key, i) => [key, words[(at + 48 >> 2) + 2 * i]]));
            return this;
        });
    }
    /** Object, cluster, and the low and the high half of the bits of its triangles, for each cluster to draw. A view, until the next call. */
    get triangleWords() {
        const [place, count] = (this.handle, this.#answer);
        return this.memory.words.subarray(place >> 2, (place >> 2) + 4 * count);
    }
    /** The same as `{ object, cluster, triangles }`; bit k of the BigInt stands for triangle k of the cluster. */
    get triangles() { return trianglesIn(this.triangleWords); }
    get statistics() { return this.#statistics; }
    /**
     * A lower bound of the nearness of the listed triangles at a pixel of the last picture: the depth, negated unless reversed, or minus
     * infinity. Row 0 is at the bottom.
     */
    nearness(x, y) {
        const { memory } = this, at = memory.scratch(8);
        memory.call('depth_culler_nearness', this.handle, x, y, at);
        return memory.floats[at >> 2];
    }
}
