// SPDX-License-Identifier: MIT
// Culls the instances of a BatchedMesh of three.js by Crofton's tree instead of by its own loop over all of them.
import * as THREE from 'three';

/** Boxes of the instances in the batch's frame, as a tree. Call it again when instances were added or moved. */
export function makeTree(crofton, batch, count) {
    const boxes = new crofton.Boxes(count), matrix = new THREE.Matrix4(), bound = new THREE.Box3();
    const center = new THREE.Vector3(), half = new THREE.Vector3();
    for (let i = 0; i < count; ++i) {
        batch.getMatrixAt(i, matrix);
        batch.getBoundingBoxAt(batch.getGeometryIdAt(i), bound).applyMatrix4(matrix);
        bound.getCenter(center);
        // A little larger: the matrices are single precision.
        bound.getSize(half).multiplyScalar(0.500001).addScalar(1e-5);
        boxes.set(i, center.toArray(), half.toArray());
    }
    const tree = new crofton.Tree(boxes);
    boxes.free();
    return tree;
}

/** Lets `tree` choose what `batch` draws. Gives a function that hands culling back to three.js. */
export function cullWith(crofton, batch, tree) {
    const own = batch.onBeforeRender, shadow = batch.onBeforeShadow;
    const visible = new crofton.VisibleSet(), frustum = new crofton.Frustum(), matrix = new THREE.Matrix4();
    batch.onBeforeRender = (renderer, scene, camera, geometry) => {
        matrix.multiplyMatrices(camera.projectionMatrix, camera.matrixWorldInverse).multiply(batch.matrixWorld);
        const depth = renderer.coordinateSystem === THREE.WebGPUCoordinateSystem ? 'zeroToOne' : 'minusOneToOne';
        tree.cull(frustum.setMatrix(matrix.elements, depth), visible);
        // The members that three.js fills in its own onBeforeRender; revision 170.
        const { _multiDrawStarts: starts, _multiDrawCounts: counts, _instanceInfo: instances, _geometryInfo: shapes } = batch;
        const bytes = geometry.getIndex()?.array.BYTES_PER_ELEMENT ?? 1, order = batch._indirectTexture.image.data;
        // In the order of instances, as three.js draws without sorting: where two are equally deep, the same one is seen.
        const ids = visible.ids;
        let drawn = 0;
        for (let k = 0; k < ids.length; ++k) {
            const instance = instances[ids[k]];
            if (!instance.visible || !instance.active) continue;
            const shape = shapes[instance.geometryIndex];
            starts[drawn] = shape.start * bytes;
            counts[drawn] = shape.count;
            order[drawn++] = ids[k];
        }
        batch._indirectTexture.needsUpdate = true;
        batch._multiDrawCount = drawn;
    };
    batch.onBeforeShadow = (renderer, object, camera, shadowCamera, geometry) => batch.onBeforeRender(renderer, null, shadowCamera, geometry);
    return () => {
        [batch.onBeforeRender, batch.onBeforeShadow] = [own, shadow];
        batch._visibilityChanged = true;
        visible.free();
        frustum.free();
    };
}
