// SPDX-License-Identifier: MIT
// Culls meshes and the instances of InstancedMeshes of three.js by Crofton's tree. Copy this file; it uses only public members of three.js.
//
//   const culler = new CroftonCuller(await load(), [instancedMesh, mesh]);
//   culler.update(camera);                  // once a frame, before renderer.render(scene, camera)
//   culler.setMatrixAt(instancedMesh, 7, matrix);
import { Box3, InstancedMesh, Matrix4, Vector3, WebGLCoordinateSystem } from 'three';

/** The instances of matrices in an order in which neighbours in the world are mostly neighbours in memory: what a view sees is then read together. */
function orderInSpace(matrices, count) {
    const low = [0, 1, 2].map((k) => { let least = Infinity; for (let i = 0; i < count; ++i) least = Math.min(least, matrices[16 * i + 12 + k]); return least; });
    let size = 1e-30;
    for (let i = 0; i < count; ++i) for (let k = 0; k < 3; ++k) size = Math.max(size, matrices[16 * i + 12 + k] - low[k]);
    const keys = new Float64Array(count);  // the bits of the three places in turn, and below them the instance
    for (let i = 0; i < count; ++i) {
        const cells = low.map((least, k) => Math.floor(127 * (matrices[16 * i + 12 + k] - least) / size) || 0);
        let key = 0;
        for (let bit = 6; bit >= 0; --bit) for (const cell of cells) key = 2 * key + (cell >> bit & 1);
        keys[i] = key * 2 ** 32 + i;
    }
    return Uint32Array.from(keys.sort(), (key) => key % 2 ** 32);
}
function inOrder(array, order, size) {
    const result = new Float32Array(size * order.length);
    order.forEach((from, to) => result.set(array.subarray(size * from, size * (from + 1)), size * to));
    return result;
}

export class CroftonCuller {
    #crofton; #tree; #visible; #frustum; #items = []; #entries = []; #matrix = new Matrix4(); #moved = new Set();

    /** Takes the matrices that `meshes` have now. From here on they are drawn as `update` says: set their matrices by this object. */
    constructor(crofton, meshes) {
        for (const mesh of meshes) {
            if (!mesh.geometry.boundingBox) mesh.geometry.computeBoundingBox();
            mesh.updateWorldMatrix(true, false);
            const isInstanced = mesh instanceof InstancedMesh, first = this.#items.length, count = isInstanced ? mesh.count : 1;
            const entry = { mesh, isInstanced, first, places: null, matrices: null, colors: null };
            if (isInstanced) {
                const order = orderInSpace(mesh.instanceMatrix.array, count);
                entry.places = new Uint32Array(count);
                order.forEach((index, place) => { entry.places[index] = place; });
                entry.matrices = inOrder(mesh.instanceMatrix.array, order, 16);
                if (mesh.instanceColor) entry.colors = inOrder(mesh.instanceColor.array, order, 3);
            }
            this.#entries.push(entry);
            for (let i = 0; i < count; ++i) this.#items.push({ entry, index: i });
            mesh.frustumCulled = false;
        }
        this.#crofton = crofton;
        const boxes = this.#boundsOf(this.#items.keys(), this.#items.length);
        this.#tree = new crofton.Tree(boxes);
        boxes.free();
        this.#visible = new crofton.ViewResult();
        this.#frustum = new crofton.Frustum();
    }

    /** Lets three.js draw what `camera` sees: the `count` of an InstancedMesh, the `visible` of a mesh. Returns how many are seen. */
    update(camera) {
        if (this.#moved.size) this.#applyMoves();
        camera.updateWorldMatrix(true, false);
        this.#matrix.copy(camera.matrixWorld).invert().premultiply(camera.projectionMatrix);
        const depth = camera.reversedDepth ? 'reversed' : camera.coordinateSystem === WebGLCoordinateSystem ? 'minusOneToOne' : 'zeroToOne';
        this.#tree.cull(this.#frustum.setMatrix(this.#matrix.elements, depth), this.#visible);
        const ids = this.#visible.ids;  // ascending, so each mesh's instances follow each other
        let k = 0;
        for (const entry of this.#entries) k = entry.isInstanced ? this.#drawInstances(entry, ids, k) : this.#drawMesh(entry, ids, k);
        return ids.length;
    }

    /** Moves an instance, or with `index` 0 a mesh that has been moved already. Takes effect in `update`. */
    setMatrixAt(mesh, index, matrix) {
        const entry = this.#entries.find((one) => one.mesh === mesh);
        if (!entry) throw new Error('this mesh was not given to the culler');
        const place = entry.isInstanced ? entry.places[index] : 0;
        if (place === undefined) throw new Error('the mesh had no such instance when it was given to the culler');
        if (entry.isInstanced) matrix.toArray(entry.matrices, 16 * place);
        this.#moved.add(entry.first + place);
    }

    /** Gives the library's memory back, and draws everything again. */
    dispose() {
        for (const entry of this.#entries) {
            if (!entry.isInstanced) entry.mesh.visible = true;
            else this.#drawInstances(entry, entry.places.map((place) => entry.first + place), 0);  // as they were
            entry.mesh.frustumCulled = true;
        }
        for (const one of [this.#tree, this.#visible, this.#frustum]) one.free();
    }

    #drawInstances({ mesh, first, matrices, colors }, ids, k) {
        const to = mesh.instanceMatrix.array, end = first + matrices.length / 16;
        let count = 0;
        for (; k < ids.length && ids[k] < end; ++k, ++count) {
            const from = 16 * (ids[k] - first), at = 16 * count;
            for (let c = 0; c < 16; ++c) to[at + c] = matrices[from + c];
            if (colors) for (let c = 0; c < 3; ++c) mesh.instanceColor.array[3 * count + c] = colors[3 * (ids[k] - first) + c];
        }
        for (const [attribute, size] of [[mesh.instanceMatrix, 16], [colors && mesh.instanceColor, 3]]) {
            if (!attribute) continue;
            attribute.clearUpdateRanges();
            attribute.addUpdateRange(0, size * count);
            attribute.needsUpdate = true;
        }
        mesh.count = count;
        return k;
    }

    #drawMesh({ mesh, first }, ids, k) {
        mesh.visible = ids[k] === first;
        return k + mesh.visible;
    }

    #boundsOf(items, count) {
        const boxes = new this.#crofton.Boxes(count), matrix = new Matrix4(), own = new Matrix4(), bound = new Box3();
        const center = new Vector3(), half = new Vector3();
        let place = 0;
        for (const item of items) {
            const { entry, index } = this.#items[item], { mesh } = entry;
            matrix.copy(mesh.matrixWorld);
            if (entry.isInstanced) matrix.multiply(own.fromArray(entry.matrices, 16 * index));
            bound.copy(mesh.geometry.boundingBox).applyMatrix4(matrix).getCenter(center);
            // A little larger: three.js draws in single precision.
            bound.getSize(half).multiplyScalar(0.500001).addScalar(1e-6 * (10 + Math.abs(center.x) + Math.abs(center.y) + Math.abs(center.z)));
            boxes.set(place++, center.toArray(), half.toArray());
        }
        return boxes;
    }

    #applyMoves() {
        const items = [...this.#moved];
        for (const item of items) if (!this.#items[item].entry.isInstanced) this.#items[item].entry.mesh.updateWorldMatrix(true, false);
        const boxes = this.#boundsOf(items, items.length);
        this.#tree.move(items, boxes);
        this.#tree.refit();
        boxes.free();
        this.#moved.clear();
    }
}
