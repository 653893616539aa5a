// SPDX-License-Identifier: MIT
import { failure } from './error.js';
import { Owned, checkArray, checkGroups, checkRecords, create, handleOf, numbersOf } from './memory.js';
import { ALL, IDENTITY, clustersAt, giveHandle, halvesOf, handleAt, layersOf, meshArrays, refAt, userAt, vectorAt, withFilter, writeBound, writeBox, writeMesh,
    writeRay, writeTransform } from './records.js';
import { pointsAt } from './queries.js';
import { writeCast, writePlaced } from './shape.js';
import { withRequests } from './views.js';

const DESCRIPTION = 72, PARTS = 160 + 96;
/** Which triangle and child of an object; -1 where there is no triangle. */
const placeAt = ({ words }, triangle, child) => ({ triangle: words[triangle >> 2] === ALL ? -1 : words[triangle >> 2], child: words[child >> 2] });
const PHASES = ['began', 'stayed', 'ended'], INSIDE = ['nothing', 'first', 'second', 'partly'];

/**
 * Holds objects and answers queries about them. Changes take effect in `update`. Objects, meshes, nodes and attached regions are
 * `{ kind, index, generation }`. `pairs`, `contacts`: whether updates find them; with more than `maxPairs` an update fails. An object that did not
 * move for `updatesToRest` updates rests. `rebuildBudget`: items' worth of background work on the tree in each update, as many as are good unless told.
 */
export class World extends Owned {
    constructor(memory, { pairs = true, contacts = true, containment = true, meshDepth = false, contactMargin = 0, maxPairs = 2 ** 24, updatesToRest = 16, rebuildBudget } = {}) {
        const at = memory.scratch(56), { words } = memory;
        memory.fill('default_world_options', at);
        words.set([pairs, contacts, containment, meshDepth].map(Number), (at >> 2) + 1);
        words.set(halvesOf(maxPairs, 'maxPairs'), (at >> 2) + 6);
        if (rebuildBudget !== undefined) words.set(halvesOf(rebuildBudget, 'rebuildBudget'), (at >> 2) + 8);
        words[(at >> 2) + 10] = updatesToRest;
        memory.doubles[(at >> 3) + 6] = contactMargin;
        super(memory, 'World', create(memory, 'world', at), '_crofton_world_destroy');
    }

    /**
     * `positions`: Float32Array, x y z; `indices`: Uint32Array or Uint16Array, three a triangle. Both are copied. With `clusters`
     * views with a picture list its triangles; `oneSided`: back faces are not drawn; `precut`: its ClusteredMesh. Without `triangles` queries
     * and contacts take the mesh for its box, and `update` need not prepare them.
     */
    addMesh(positions, indices, how) {
        const { memory, handle } = this;
        return memory.lend([...meshArrays(positions, indices), new Uint8Array(56)], (places, corners, at) => {
            writeMesh(memory, at, places, corners, positions, indices, how);
            memory.call('world_add_mesh', handle, at, at + 48);
            return handleAt(memory, at + 48, 'mesh');
        });
    }
    /** Gives all objects of a mesh other triangles; parameters as in `addMesh`. Its occluders are removed. */
    replaceMesh(mesh, positions, indices, how) {
        const { memory, handle } = this;
        memory.lend([...meshArrays(positions, indices), new Uint8Array(56)], (places, corners, at) => {
            writeMesh(memory, at, places, corners, positions, indices, how);
            memory.call('world_replace_mesh', handle, giveHandle(memory, mesh, 'mesh', at + 48), at);
        });
    }
    /** Moves the vertices of a mesh that deforms: as many as before. */
    setVertices(mesh, positions) {
        const { memory, handle } = this;
        checkArray(positions, [Float32Array], 'positions');
        checkGroups(positions, 3, 'positions');
        memory.lend([positions, new Uint8Array(56)], (places, at) => {
            writeMesh(memory, at, places, 0, positions, []);
            memory.call('world_set_vertices', handle, giveHandle(memory, mesh, 'mesh', at + 48), at);
        });
    }
    /** Error: objects use the mesh. */
    removeMesh(mesh) { this.#on('remove_mesh', mesh, 'mesh'); }
    /** Returns the clusters of a mesh, as of the last update: `{ clusters: [{ firstTriangle, triangleCount }], triangleOrder }`. */
    clustersOf(mesh) {
        const { memory } = this, at = giveHandle(memory, mesh, 'mesh', memory.scratch(32));
        memory.words[at + 8 >> 2] = 24;
        memory.call('world_get_mesh', this.handle, at, at + 8);
        return clustersAt(memory, at + 16);
    }
    /** Finds boxes inside `mesh`, if it is closed, that hide what is behind them. Objects hide nothing before this call. */
    findOccluders(mesh) {
        const { memory } = this;
        memory.call('world_find_occluders', this.handle, giveHandle(memory, mesh, 'mesh', memory.scratch(16)), 0);
    }
    /**
     * Sets a mesh's occluders: `{ box }`, `{ walled: box }`, `{ convex: positions }`, `{ patch: { positions, indices, oneSided } }`, opaque
     * and within the drawn mesh. None removes them.
     */
    setOccluders(mesh, occluders) {
        const { memory, handle } = this, kinds = ['box', 'walled', 'convex', 'patch'], none = new Float32Array(0);
        const arrays = checkRecords(occluders, 'occluders').flatMap(({ convex, patch }) =>
            patch ? meshArrays(patch.positions, Uint32Array.from(patch.indices)) : [convex ? checkArray(convex, [Float32Array], 'convex') : none, none]);
        memory.lend([new Float64Array(29 * occluders.length + 1), ...arrays], (first, ...places) => {
            occluders.forEach((occluder, i) => {
                const at = first + 232 * i, kind = kinds.findIndex((name) => occluder[name]);
                if (kind < 0) throw failure(1, `an occluder is one of ${kinds.join(', ')}`, i);
                checkGroups(arrays[2 * i], 3, 'positions');
                memory.words.set([232, kind, occluder.patch?.oneSided ? 1 : 0, places[2 * i], arrays[2 * i].length / 3, places[2 * i + 1],
                    arrays[2 * i + 1].length], at >> 2);
                if (kind < 2) writeBox(memory, at + 32, occluder.box ?? occluder.walled);
            });
            const slot = first + 232 * occluders.length;
            memory.call('world_set_occluders', handle, giveHandle(memory, mesh, 'mesh', slot), first, occluders.length);
        });
    }

    /** Adds a node: it moves all that is below it. Objects below have only those of their layers that are also in `layers`. */
    addNode({ parent, transform = IDENTITY, layers = ALL } = {}) {
        const { memory } = this, at = memory.scratch(112);
        if (parent) giveHandle(memory, parent, 'node', at + 96);
        memory.call('world_add_node', this.handle, parent ? at + 96 : 0, writeTransform(memory, at, transform), layersOf(layers), at + 104);
        return handleAt(memory, at + 104, 'node');
    }
    /** Removes the node with all nodes and objects below it. */
    removeNode(node) { this.#on('remove_node', node, 'node'); }
    /** Error: the parent is the node itself or one below it. */
    setParent(node, parent) {
        const { memory } = this, at = giveHandle(memory, node, 'node', memory.scratch(16));
        memory.call('world_set_parent', this.handle, at, parent ? giveHandle(memory, parent, 'node', at + 8) : 0);
    }
    setNodeLayers(node, layers) {
        const { memory } = this, at = giveHandle(memory, node, 'node', memory.scratch(16));
        memory.call('world_set_node_layers', this.handle, at, layersOf(layers));
    }
    setNodeTransform(node, transform) { this.#move('set_node_transforms', node, 'node', transform); }

    /**
     * `{ box: { center, halfExtents, axes } }`, `{ sphere: { center, radius } }`, `{ mesh }` or only `{ shape }`; the last two with a `transform`,
     * under a `node` or in the world. A shape beside another is what rays, casts and contacts use. `user`: a number. `onlyOccludes`: no answer
     * contains the object, but its mesh hides others.
     */
    add(object) {
        const { memory } = this, at = memory.scratch(DESCRIPTION + PARTS + 8);
        this.#describe(object ?? {}, at, at + DESCRIPTION);
        memory.call('world_add', this.handle, at, at + DESCRIPTION + PARTS);
        return handleAt(memory, at + DESCRIPTION + PARTS, 'object');
    }
    /** Adds many in one call; returns their handles. If one is refused, the error's item is its place, and none is added. */
    addMany(objects) {
        const { memory, handle } = this, count = checkRecords(objects, 'objects').length;
        return memory.lend([new Uint8Array(DESCRIPTION * count), new Uint8Array(PARTS * count), new Uint8Array(8 * count)], (first, parts, handles) => {
            objects.forEach((object, i) => this.#describe(object, first + DESCRIPTION * i, parts + PARTS * i, i));
            const added = () => objects.map((_, i) => handleAt(memory, handles + 8 * i, 'object'));
            try {
                memory.call('world_add_many', handle, first, count, handles);
            } catch (error) {
                for (const object of added()) if (object.generation) this.remove(object);
                throw error;
            }
            return added();
        });
    }
    /** Takes memory for so many objects in all, so that no later call has to copy what the world knows of each. */
    reserve(objects) { this.memory.call('world_reserve', this.handle, objects); }
    // Writes 72 bytes of a description, and 256 of its parts.
    #describe({ box, sphere, mesh, shape, transform, node, user = 0, layers = ALL, collidesWith = ALL, occludes = true, onlyOccludes = false, hidden = false },
        at, parts, item) {
        const given = [box, sphere, mesh].filter(Boolean).length;
        if (given > 1 || given === 0 && !shape) throw failure(1, 'an object has one of box, sphere and mesh, or only a shape', item);
        const { memory } = this, { words } = memory, first = at >> 2;
        memory.fill('default_object_description', at);
        words.set(halvesOf(user), first + 2);
        if (box || sphere) writeBound(memory, parts, { box, sphere }), words[first + 4] = parts;
        if (transform) words[first + 5] = writeTransform(memory, parts + 160, transform);
        if (mesh) giveHandle(memory, mesh, 'mesh', at + 32, item), words[first + 6] = 1;
        if (node) giveHandle(memory, node, 'node', at + 40, item), words[first + 7] = 1;
        words.set([layersOf(layers), layersOf(collidesWith), occludes ? 1 : 0, onlyOccludes ? 1 : 0, shape ? handleOf(memory, shape, 'Shape', item) : 0,
            hidden ? 1 : 0], first + 12);
    }
    remove(object) { this.#on('remove', object, 'object'); }
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
    setCollidesWith(object, layers) {
        this.#set(object, 4, (words, first) => { words[first + 13] = layersOf(layers); });
    }
    setOccludes(object, occludes) {
        this.#set(object, 16, (words, first) => { words[first + 14] = occludes ? 1 : 0; });
    }
    /** For an object that has a mesh. */
    setMesh(object, mesh) {
        this.#set(object, 32, (words, first) => {
            giveHandle(this.memory, mesh, 'mesh', 4 * first + 32);
            words[first + 6] = 1;
        });
    }
    /** Null removes the shape; not of an object that was added with only one. */
    setShape(object, shape) {
        this.#set(object, 128, (words, first) => { words[first + 16] = shape === null ? 0 : handleOf(this.memory, shape, 'Shape'); });
    }
    setBox(object, box) {
        this.#set(object, 64, (words, first) => {
            writeBound(this.memory, 4 * first + 72, { box });
            words[first + 4] = 4 * first + 72;
        });
    }
    // Sets one member of an object, by its description.
    #set(object, member, fill) {
        const { memory } = this, at = memory.scratch(72 + 160 + 16);
        giveHandle(memory, object, 'object', at + 232);
        memory.fill('default_object_description', at);
        fill(memory.words, at >> 2);
        memory.call('world_set', this.handle, at + 232, member, at);
    }
    setTransform(object, transform) { this.#move('set_transforms', object, 'object', transform); }
    /** Many in a call: sixteen numbers by columns each. Moves all but those that are refused; the error's item is the place of the first. */
    setTransforms(objects, transforms) { this.#moveMany('set_transforms', objects, 'object', transforms); }
    setNodeTransforms(nodes, transforms) { this.#moveMany('set_node_transforms', nodes, 'node', transforms); }
    /** `boxes`: a Boxes with a box for each. The rest as for `setTransforms`. */
    setBoxes(objects, boxes) {
        const { memory, handle } = this, first = handleOf(memory, boxes, 'Boxes');
        if (boxes.length !== checkRecords(objects, 'objects').length) throw failure(1, `there are ${objects.length} objects and ${boxes.length} boxes`);
        memory.lend([new Uint8Array(8 * objects.length)], (at) => {
            objects.forEach((object, i) => giveHandle(memory, object, 'object', at + 8 * i, i));
            memory.call('world_set_boxes', handle, at, 0, first, 0, objects.length);
        });
    }
    #moveMany(name, handles, kind, transforms) {
        const { memory, handle } = this, count = checkRecords(handles, `${kind}s`).length;
        checkArray(transforms, [Float64Array, Float32Array], 'transforms');
        if (transforms.length !== 16 * count) throw failure(1, `${count} transforms have 16 numbers each, and there are ${transforms.length}`);
        memory.lend([new Uint8Array(8 * count), new Uint8Array(96 * count)], (at, poses) => {
            handles.forEach((one, i) => {
                giveHandle(memory, one, kind, at + 8 * i, i);
                writeTransform(memory, poses + 96 * i, transforms.subarray(16 * i, 16 * i + 16));
            });
            memory.call(`world_${name}`, handle, at, 0, poses, 0, count);
        });
    }
    #move(name, what, kind, transform) {
        const { memory } = this, at = memory.scratch(112);
        writeTransform(memory, at, transform);
        memory.call(`world_${name}`, this.handle, giveHandle(memory, what, kind, at + 96), 0, at, 0, 1);
    }
    #on(name, what, kind) {
        const { memory } = this;
        memory.call(`world_${name}`, this.handle, giveHandle(memory, what, kind, memory.scratch(16)));
    }
    contains(object) {
        try {
            this.#info(object);
            return true;
        } catch (error) {
            if (error.status === 'stale handle') return false;
            throw error;
        }
    }
    // The place of an object's data, 192 bytes: user 8, has box 16, has transform 20, box 24, transform 96.
    #info(object) {
        const { memory } = this, at = giveHandle(memory, object, 'object', memory.scratch(208));
        memory.words[at + 8 >> 2] = 192;
        memory.call('world_get_object', this.handle, at, at + 8);
        return at + 8;
    }
    userOf(object) { return userAt(this.memory, this.#info(object) + 8); }
    /** `{ center, axes, halfExtents }` as of the last update. Error: there was none since the object was added. */
    boxOf(object) {
        const at = this.#info(object), { words, floats } = this.memory;
        if (!words[at + 16 >> 2]) throw failure(5, 'the object has no box before the next update', object.index);
        return { center: vectorAt(this.memory, at + 24), axes: [...floats.subarray(at + 48 >> 2, at + 84 >> 2)],
            halfExtents: [...floats.subarray(at + 84 >> 2, at + 96 >> 2)] };
    }
    /** Sixteen numbers by columns, to the world. Error: the object is a bound, or there was no update since it was added. */
    transformOf(object) {
        const at = this.#info(object), { words, doubles } = this.memory;
        if (!words[at + 20 >> 2]) throw failure(5, 'the object is a bound, or there was no update since it was added', object.index);
        return [0, 1, 2, 3].flatMap((c) => [...doubles.subarray((at + 96 >> 3) + 3 * c, (at + 96 >> 3) + 3 * c + 3), c === 3 ? 1 : 0]);
    }
    /** As of the last update: `{ objects, resting, moving, boxesChanged, outOfRange, occludersWaiting }`. */
    get statistics() {
        const words = this.#statistics(), names = { objects: 2, resting: 4, moving: 6, boxesChanged: 12, outOfRange: 14, occludersWaiting: 18 };
        return Object.fromEntries(Object.entries(names).map(([name, place]) => [name, words[place]]));
    }
    get count() { return this.#statistics()[16]; }
    #statistics() {
        const { memory } = this, at = memory.scratch(80);
        memory.words[at >> 2] = 80;
        memory.call('world_get_statistics', this.handle, at);
        return memory.words.subarray(at >> 2, (at >> 2) + 20);
    }

    /** Attaches a Region: from the next update on, answers contain its objects, moved by `origin`. */
    attach(region, origin = [0, 0, 0]) {
        const { memory } = this, given = handleOf(memory, region, 'Region'), at = memory.scratch(32);
        memory.doubles.set(numbersOf(origin, 3, 'origin'), at >> 3);
        memory.call('world_attach', this.handle, given, at, at + 24);
        return handleAt(memory, at + 24, 'region');
    }
    /** Handles of the region's objects are stale at once; views follow with the next update. */
    detach(attached) { this.#on('detach', attached, 'region'); }
    /** Returns the object at a place in the array that the region was made from. `setHidden` can hide it; other changes are errors. */
    objectIn(attached, place) {
        const { memory } = this, at = giveHandle(memory, attached, 'region', memory.scratch(16));
        memory.call('world_object_in', this.handle, at, place, at + 8);
        return handleAt(memory, at + 8, 'object');
    }
    /** Returns `{ region, place }` of an object. Error: it was added by `add`. */
    placeOf(object) {
        const { memory } = this, at = giveHandle(memory, object, 'object', memory.scratch(24));
        memory.call('world_place_of', this.handle, at, at + 8, at + 16);
        return { region: handleAt(memory, at + 8, 'region'), place: memory.words[at + 16 >> 2] };
    }

    /** Applies the changes, and finds pairs and contacts. Call it once a frame, before queries. */
    update() { this.memory.call('world_update', this.handle, 0); }

    /**
     * Lists what a view sees. Set `camera`, `matrix` (with `depth` and `origin`, as in Frustum) or `volume`, a Frustum; with
     * occlusion also a camera or matrix beside a volume. `layers`; `occlusion`: leaves out what others hide, `{ listOccluded, width, height,
     * maxOccluders, leastCover }`; `picture`: `{ width, height, depth, samples, workLimit }`, lists the triangles that it needs, instead of
     * occlusion; `receivers`: `{ seen, radius }`, with a picture that is a light's shadow map lists only the triangles whose shadows the
     * camera could see, whose view with a picture `seen` answered; `limits`: leaves out what is small or far; `candidates`: bits by object index, BigUint64Array or
     * Uint32Array; `treeOrder`, `conservative`. An array of up to 32 requests is answered at once, each object listed once.
     */
    view(request, visible) {
        const { memory } = this, requests = Array.isArray(request) ? request : [request], result = handleOf(memory, visible, 'ViewResult');
        withRequests(memory, requests, (at) => memory.call('world_view', this.handle, at, requests.length, 0, result));
        return visible;
    }
    /** Lists the occluders that hide an object in a view alone, `{ object, user, place }`; without an object all that were drawn. */
    hiddenBy(visible, object) {
        const { memory } = this, result = handleOf(memory, visible, 'ViewResult'), at = memory.scratch(16), hidden = object ? giveHandle(memory, object, 'object', at) : 0;
        memory.call('view_result_occluders', result, this.handle, hidden, 0, 0, at + 8);
        const count = memory.words[at + 8 >> 2];
        return memory.lend([new Float64Array(3 * count)], (place) => {
            memory.call('view_result_occluders', result, this.handle, hidden, place, count, at + 8);
            return Array.from({ length: count }, (_, i) => ({ ...refAt(memory, place + 24 * i), place: memory.words[place + 24 * i + 16 >> 2] }));
        });
    }

    #hitAt(at) {
        const { memory } = this, { doubles, words } = memory, first = at >> 2;
        return { ...refAt(memory, at), t: doubles[at + 16 >> 3], point: vectorAt(memory, at + 24),
            ...placeAt(memory, at + 48, at + 52),
            normal: vectorAt(memory, at + 56), startedInside: (words[first + 20] & 255) !== 0 };
    }
    /** Returns the nearest hit of a ray, `{ object, user, t, point, triangle, child, normal, startedInside }`, or null. */
    raycast(origin, direction, maxT = Infinity, filter = ALL) {
        const { memory } = this, at = writeRay(memory, memory.scratch(144), origin, direction, maxT);
        withFilter(memory, filter, (given) => memory.call('world_raycast', this.handle, at, 1, given, at + 56));
        return memory.words[at + 56 >> 2] === ALL ? null : this.#hitAt(at + 56);
    }
    /**
     * Many rays in a call: three numbers each, arrays of doubles. Returns `{ t, objects, triangles, normals }`: t is infinite for a ray that hits
     * nothing, and its object, as a triangle where there is none, -1.
     */
    raycastMany(origins, directions, maxT = Infinity, filter = ALL) {
        const { memory, handle } = this, count = checkArray(origins, [Float64Array], 'origins').length / 3;
        checkArray(directions, [Float64Array], 'directions');
        checkGroups(origins, 3, 'origins');
        if (origins.length !== directions.length) throw failure(1, `there are ${origins.length} numbers of origins and ${directions.length} of directions`);
        return memory.lend([new Float64Array(7 * count), new Float64Array(11 * count)], (rays, hits) => {
            for (let i = 0, { doubles } = memory, at = rays >> 3; i < count; ++i, at += 7) {
                for (let k = 0; k < 3; ++k) [doubles[at + k], doubles[at + 3 + k]] = [origins[3 * i + k], directions[3 * i + k]];
                doubles[at + 6] = maxT;
            }
            withFilter(memory, filter, (given) => memory.call('world_raycast', handle, rays, count, given, hits));
            const answer = { t: new Float64Array(count).fill(Infinity), objects: new Int32Array(count).fill(-1),
                triangles: new Int32Array(count).fill(-1), normals: new Float64Array(3 * count) };
            for (let i = 0, { doubles, words } = memory, at = hits; i < count; ++i, at += 88) {
                if (words[at >> 2] === ALL) continue;
                [answer.t[i], answer.objects[i], answer.triangles[i]] = [doubles[at + 16 >> 3], words[at >> 2], words[at + 48 >> 2]];
                answer.normals.set(doubles.subarray(at + 56 >> 3, at + 80 >> 3), 3 * i);
            }
            return answer;
        });
    }
    /** Returns the nearest hit of each object that the ray hits, in order of t, then of index. */
    raycastAll(origin, direction, maxT = Infinity, filter = ALL) {
        return this.#find('hits', 88, (found, at) =>
            withFilter(this.memory, filter, (given) =>
                this.memory.call('world_raycast_all', this.handle, writeRay(this.memory, at, origin, direction, maxT), given, found)), (at) => this.#hitAt(at));
    }
    /** Tells whether a ray hits anything; faster than `raycast`. */
    raycastAny(origin, direction, maxT = Infinity, filter = ALL) {
        const { memory } = this, at = writeRay(memory, memory.scratch(64), origin, direction, maxT);
        withFilter(memory, filter, (given) => memory.call('world_raycast_any', this.handle, at, given, at + 56));
        return memory.words[at + 56 >> 2] !== 0;
    }
    /**
     * Returns the objects that overlap `{ box }`, `{ sphere }`, `{ capsule: { begin, end, radius } }` or `{ shape, transform }`, as
     * `{ object, user }`, by index: their shapes, triangles of meshes, boxes and spheres.
     */
    overlap(shape, filter = ALL) {
        return this.#find('objects', 16, (found, at) =>
            withFilter(this.memory, filter, (given) => this.memory.call('world_overlap', this.handle, this.#writeShape(at, shape), given, found)),
            (at) => refAt(this.memory, at));
    }
    // Asks for a list, and reads what it found.
    #find(what, size, ask, read) {
        const { memory } = this, found = create(memory, 'found');
        try {
            const at = memory.scratch(256);
            ask(found, at);
            memory.call(`found_${what}`, found, at, at + 4);
            return this.#list(at, size, read);
        } finally {
            memory.module._crofton_found_destroy(found);
        }
    }
    // The list whose place and count are at `at`.
    #list(at, size, read) {
        const [first, count] = this.memory.words.slice(at >> 2, (at >> 2) + 2);
        return Array.from({ length: count }, (_, i) => read(first + size * i));
    }
    /** Returns the object nearest to a shape, `{ object, user, distance, onShape, onObject, triangle, child }`, no farther than `maxDistance`; or null. */
    closest(shape, maxDistance = Infinity, filter = ALL) {
        const { memory } = this, at = memory.scratch(344), answer = at + 256;
        withFilter(memory, filter, (given) => {
            memory.words[answer >> 2] = 88;
            memory.call('world_closest', this.handle, this.#writeShape(at, shape), maxDistance, given, answer);
        });
        if (memory.words[answer + 4 >> 2] === ALL) return null;
        return { object: handleAt(memory, answer + 4, 'object'), user: userAt(memory, answer + 16), distance: memory.doubles[answer + 24 >> 3],
            onShape: vectorAt(memory, answer + 32), onObject: vectorAt(memory, answer + 56), ...placeAt(memory, answer + 80, answer + 84) };
    }
    /**
     * Returns the first object that a shape meets which moves by `velocity` and turns by `spin` radians a unit of time about its `pivot`:
     * `{ object, user, time, normal, point, triangle, child, distance, unresolved }`, or null; -1 where there is no triangle. The objects are at rest.
     */
    cast({ shape, transform } = {}, how, filter = ALL) {
        const { memory } = this, at = memory.scratch(312), motion = at + 104, options = at + 176, hit = at + 208;
        writeCast(memory, how, motion, options);
        memory.words[hit >> 2] = 104;
        withFilter(memory, filter, (given) =>
            memory.call('world_cast', this.handle, writePlaced(memory, at, shape, transform), motion, options, given, hit));
        return memory.words[hit + 4 >> 2] === ALL ? null : this.#shapeHitAt(hit);
    }
    /** Returns what `cast` does, of each object that the shape meets, in order of time, then of index. */
    castAll({ shape, transform } = {}, how, filter = ALL) {
        const { memory } = this;
        return this.#find('shape_hits', 104, (found, at) => {
            const motion = at + 104, options = at + 176;
            writeCast(memory, how, motion, options);
            withFilter(memory, filter, (given) =>
                memory.call('world_cast_all', this.handle, writePlaced(memory, at, shape, transform), motion, options, given, found));
        }, (at) => this.#shapeHitAt(at));
    }
    /**
     * Returns where a shape, which need not be an object, touches the objects, up to a margin: `{ object, user, normal, depth, points }`, in order of
     * index. The normal leads from the shape to the object; points are those of `Shape.contacts`.
     */
    contactManifolds({ shape, transform } = {}, { margin = 0, maxPoints = 4 } = {}, filter = ALL) {
        const { memory } = this;
        return this.#find('manifolds', 504, (found, at) => {
            const options = at + 104;
            memory.words[options >> 2] = 24;
            memory.doubles[options + 8 >> 3] = margin;
            memory.words[options + 16 >> 2] = maxPoints;
            withFilter(memory, filter, (given) =>
                memory.call('world_manifolds', this.handle, writePlaced(memory, at, shape, transform), options, given, found));
        }, (at) => ({ object: handleAt(memory, at, 'object'), user: userAt(memory, at + 8), normal: vectorAt(memory, at + 16),
            depth: memory.doubles[at + 40 >> 3], points: pointsAt(memory, at + 56, memory.words[at + 48 >> 2]) }));
    }
    #shapeHitAt(at) {
        const { memory } = this;
        return { object: handleAt(memory, at + 4, 'object'), user: userAt(memory, at + 16), time: memory.doubles[at + 24 >> 3],
            normal: vectorAt(memory, at + 32), point: vectorAt(memory, at + 56), ...placeAt(memory, at + 80, at + 96),
            unresolved: memory.words[at + 84 >> 2] === 2, distance: memory.doubles[at + 88 >> 3] };
    }
    // A probe, in 248 bytes.
    #writeShape(at, { box, sphere, capsule, shape, transform } = {}) {
        if ([box, sphere, capsule, shape].filter(Boolean).length !== 1) throw failure(1, 'a query has one of box, sphere, capsule and shape');
        const { memory } = this, { words, doubles } = memory;
        words[at >> 2] = box ? 0 : sphere ? 1 : capsule ? 2 : 3;
        if (box) writeBox(memory, at + 8, box);
        else if (shape) writePlaced(memory, at + 144, shape, transform), words.copyWithin(at + 136 >> 2, at + 144 >> 2, at + 152 >> 2);
        else {
            const { begin, end = begin, radius } = capsule ?? { begin: sphere.center, radius: sphere.radius };
            doubles.set([...numbersOf(begin, 3, sphere ? 'center' : 'begin'), ...numbersOf(end, 3, 'end'), radius], at + 80 >> 3);
        }
        return at;
    }

    /** Returns the pairs of objects whose boxes or spheres overlap: `{ first, second }`, each `{ object, user }`, in order. */
    pairs() {
        const { memory } = this, at = memory.scratch(8);
        memory.call('world_pairs', this.handle, at, at + 4);
        return this.#list(at, 32, (place) => ({ first: refAt(memory, place), second: refAt(memory, place + 16) }));
    }
    /**
     * Returns the pairs that touch, and those that have ended touching: `{ first, second, phase, inside, normal, depth, points, triangles,
     * shapePoints }`. `memory` of a point of two shapes is a view of four numbers, yours until the next update or growth of memory: 0 when the
     * point begins, kept while it stays.
     */
    contacts() {
        const { memory } = this, at = memory.scratch(8);
        memory.call('world_contacts', this.handle, at, at + 4);
        return this.#list(at, 96, (place) => {
            const { words, bytes, doubles } = memory, vector = (from) => vectorAt(memory, from);
            return { first: refAt(memory, place), second: refAt(memory, place + 16), phase: PHASES[bytes[place + 32]], inside: INSIDE[bytes[place + 33]],
                normal: vector(place + 40), depth: doubles[place + 64 >> 3],
                points: this.#list(place + 72, 32, (p) => ({ position: vector(p), depth: doubles[p + 24 >> 3] })),
                triangles: this.#list(place + 80, 80, (p) => ({ first: words[p >> 2], second: words[p + 4 >> 2], begin: vector(p + 8), end: vector(p + 32),
                    normal: vector(p + 56) })),
                shapePoints: this.#list(place + 88, 104, (p) => ({ position: vector(p), depth: doubles[p + 24 >> 3], normal: vector(p + 56),
                    began: bytes[p + 80] !== 0, memory: memory.floats.subarray(p + 84 >> 2, p + 100 >> 2) })) };
        });
    }
}
