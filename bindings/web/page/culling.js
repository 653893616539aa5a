// SPDX-License-Identifier: MIT
// What a camera sees of the town: one verdict an object. A tree of fitted boxes says which are in the frustum, a world of
// meshes which of those are hidden.
import { MESHES, placed, transformOf } from './town.js';

export const VERDICTS = ['outside', 'straddling', 'inside', 'occluded'];
export const CRITERIA = {
    axes: { says: 'along the mesh’s axes' },
    volume: { says: 'least volume', weights: { volume: 1 } },
    area: { says: 'least area', weights: { area: 1 } },
    perimeter: { says: 'least mean width', weights: { meanCurvature: 1 } },
};

function boundOf({ positions }) {
    const low = [Infinity, Infinity, Infinity], high = [-Infinity, -Infinity, -Infinity];
    positions.forEach((value, i) => {
        low[i % 3] = Math.min(low[i % 3], value);
        high[i % 3] = Math.max(high[i % 3], value);
    });
    return { center: low.map((l, k) => (l + high[k]) / 2), halfExtents: low.map((l, k) => (high[k] - l) / 2),
        axes: [1, 0, 0, 0, 1, 0, 0, 0, 1] };
}

export class Culling {
    #crofton; #objects; #world; #tree; #visible; #seen; #frustum; #boxes;

    constructor(crofton, objects) {
        this.#crofton = crofton;
        this.#objects = objects;
        this.#visible = new crofton.ViewResult();
        this.#seen = new crofton.ViewResult();
        this.#frustum = new crofton.Frustum();
        this.#world = new crofton.World();
        const meshes = MESHES.map(({ positions, indices, occludes }) => {
            const mesh = this.#world.addMesh(positions, indices);
            if (occludes) this.#world.setConvexOccluder(mesh, positions);
            return mesh;
        });
        objects.forEach((object, i) => {
            const { index } = this.#world.add({ mesh: meshes[object.mesh], transform: transformOf(object) });
            if (index !== i) throw new Error('objects of a new world are not numbered in turn');
        });
        this.#world.update();
        this.verdicts = new Uint8Array(objects.length);
        this.setCriterion('axes');
    }

    /** Fits the boxes anew; one of CRITERIA. */
    setCriterion(name) {
        const { weights } = CRITERIA[name];
        const fitted = MESHES.map((mesh) =>
            weights ? this.#crofton.fitBox(mesh.positions, { quality: 'exact', criterion: weights }) : boundOf(mesh));
        this.#boxes?.free();
        this.#tree?.free();
        this.#boxes = new this.#crofton.Boxes(this.#objects.length);
        this.#objects.forEach((object, i) => {
            const box = placed(fitted[object.mesh], object);
            this.#boxes.set(i, box.center, box.halfExtents, box.axes);
        });
        this.#tree = new this.#crofton.Tree(this.#boxes);
        this.criterion = name;
    }

    /** Bytes of the boxes, 72 each, as the library holds them. */
    get boxBytes() { return this.#boxes.bytes.slice(); }

    /** Fills `verdicts`; gives how many there are of each, and the milliseconds of culling. */
    run(camera, occlusion) {
        const start = performance.now(), { verdicts } = this;
        verdicts.fill(0);
        this.#tree.cull(this.#frustum.setCamera(camera), this.#visible);
        const { ids, verdicts: found } = this.#visible;
        for (let i = 0; i < ids.length; ++i) verdicts[ids[i]] = found[i];
        if (occlusion) {
            this.#world.view({ camera, occlusion: { listOccluded: true } }, this.#seen);
            for (const id of this.#seen.occluded) if (verdicts[id]) verdicts[id] = 3;
        }
        const counts = [0, 0, 0, 0];
        for (const verdict of verdicts) ++counts[verdict];
        return { counts, ms: performance.now() - start };
    }
}
