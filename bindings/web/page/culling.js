// SPDX-License-Identifier: MIT
// What a camera's picture needs of the town: triangles, by a World whose meshes are cut into clusters.

/** Of objects and of triangles: what the frustum does not reach, what is drawn, what others hide. */
export const VERDICTS = ['outside', 'drawn', 'hidden'];

export class Culling {
    #world; #seen; #inFrustum; #clusters; #objects;

    constructor(crofton, { meshes, objects }) {
        this.#world = new crofton.World({ pairs: false });
        this.#seen = new crofton.ViewResult();
        this.#inFrustum = new crofton.ViewResult();
        this.#objects = objects;
        const handles = meshes.map(({ positions, indices }) => 
            this.#world.addMesh(positions, indices, { clusters: true, oneSided: true, triangles: false }));
        objects.forEach(({ mesh, matrix }, i) => {
            const { index } = this.#world.add({ mesh: handles[mesh], transform: matrix });
            if (index !== i) throw new Error('objects of a new world are not numbered in turn');
        });
        this.#world.update();
        /** By mesh: `{ clusters, triangleOrder }`. */
        this.#clusters = handles.map((mesh) => this.#world.clustersOf(mesh));
        this.verdicts = new Uint8Array(objects.length);
    }
    clustersOf(object) { return this.#clusters[this.#objects[object].mesh]; }

    /**
     * Fills `verdicts`, an object each, and `words`: object, cluster and the two halves of the mask of its triangles, for each
     * cluster to draw. `picture`: its size; edges are not smoothed. Without `occlusion` all that the frustum reaches is
     * drawn. Returns the milliseconds that the view to draw took.
     */
    run(camera, picture, occlusion) {
        const { verdicts } = this, start = performance.now();
        if (occlusion) this.#world.view({ camera, picture: { ...picture, depth: 'minusOneToOne' } }, this.#seen);
        else this.#world.view({ camera }, this.#inFrustum);
        const ms = performance.now() - start;
        if (occlusion) this.#world.view({ camera }, this.#inFrustum);
        verdicts.fill(0);
        for (const id of this.#inFrustum.ids) verdicts[id] = occlusion ? 2 : 1;
        this.words = occlusion ? this.#seen.triangleWords : this.#wholeObjects();
        for (let i = 0; i < this.words.length; i += 4) verdicts[this.words[i]] = 1;
        return ms;
    }
    #wholeObjects() {
        const words = [];
        for (const object of this.#inFrustum.ids)
            this.clustersOf(object).clusters.forEach(({ triangleCount: count }, cluster) =>
                words.push(object, cluster, count < 32 ? 2 ** count - 1 : 0xffffffff, count < 64 ? count < 32 ? 0 : 2 ** (count - 32) - 1 : 0xffffffff));
        return Uint32Array.from(words);
    }
}
