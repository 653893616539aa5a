// SPDX-License-Identifier: MIT
import { failure } from './error.js';
import { Owned, checkRecords, handleOf } from './memory.js';
import { ALL, clustersAt, halvesOf, layersOf, meshArrays, vectorAt, writeBound, writeMesh, writeTransform } from './records.js';

/**
 * Many objects that do not move, relative to an origin: `World.attach`, which takes microseconds. An object is that of `World.add`, but its
 * `mesh` is a place in `meshes`: `[{ positions, indices, clusters, oneSided, precut }]`. With meshes or shapes no
 * coordinate of an origin may be larger than `maxOrigin`.
 */
export class Region extends Owned {
    constructor(memory, objects, { meshes = [], findOccluders = false, maxOrigin = 1e9 } = {}) {
        checkRecords(objects, 'objects');
        const arrays = checkRecords(meshes, 'meshes').flatMap(({ positions, indices }) => meshArrays(positions, indices));
        const records = new Float64Array(25 * objects.length), transforms = new Float64Array(12 * objects.length);
        const handle = memory.lend([records, transforms, new Uint8Array(48 * meshes.length), new Float64Array(6), ...arrays],
            (first, poses, described, options, ...places) => {
                objects.forEach(({ box, sphere, shape, mesh, transform, user = 0, layers = ALL, collidesWith = ALL, occludes = true, onlyOccludes = false }, i) => {
                    const at = first + 200 * i, { words } = memory;
                    if (!box && !sphere && !shape && mesh === undefined) throw failure(1, 'an object has a box, a sphere, a shape or a mesh', i);
                    memory.fill('default_region_object', at);
                    if (box || sphere) writeBound(memory, at, { box, sphere });
                    words.set(halvesOf(user), at + 160 >> 2);
                    words.set([layersOf(layers), layersOf(collidesWith), mesh ?? ALL, occludes ? 1 : 0, onlyOccludes ? 1 : 0], at + 168 >> 2);
                    if (transform) words[at + 188 >> 2] = writeTransform(memory, poses + 96 * i, transform);
                    if (shape) words[at + 192 >> 2] = handleOf(memory, shape, 'Shape', i);
                });
                meshes.forEach(({ positions, indices, ...how }, i) => writeMesh(memory, described + 48 * i, places[2 * i], places[2 * i + 1], positions, indices, how));
                memory.fill('default_region_options', options);
                memory.words.set([described, meshes.length, findOccluders ? 1 : 0], options + 24 >> 2);
                memory.doubles[options + 40 >> 3] = maxOrigin;
                const slot = memory.allocate(8, 'region');
                try {
                    memory.call('region_prepare', first, objects.length, options, 0, slot);
                    return memory.words[slot >> 2];
                } finally {
                    memory.free(slot);
                }
            });
        super(memory, 'Region', handle, '_crofton_region_destroy');
    }
    #info() {
        const { memory } = this, at = memory.scratch(72);
        memory.words[at >> 2] = 72;
        memory.call('region_get_info', this.handle, at);
        return at;
    }
    /** The number of objects. */
    get count() { return this.memory.words[this.#info() + 8 >> 2]; }
    /** The box along the axes around all objects, relative to the origin, `{ min, max }`; infinite the wrong way round without objects. */
    get bounds() {
        const at = this.#info();
        return { min: vectorAt(this.memory, at + 24), max: vectorAt(this.memory, at + 48) };
    }
    /** The mesh of the object at a place, as its place in `meshes`; -1: it has none. */
    meshOf(place) {
        const { memory } = this, at = memory.scratch(8);
        memory.call('region_mesh_of', this.handle, place, at);
        return memory.words[at >> 2] | 0;
    }
    /** The clusters of a mesh, to which a view's `triangles` refer, as `World.clustersOf`. Error: there is no such mesh, or it has none. */
    clustersOf(mesh) {
        const { memory } = this, at = memory.scratch(16);
        memory.call('region_clusters_of', this.handle, mesh, at);
        return clustersAt(memory, at);
    }
}
