// SPDX-License-Identifier: MIT
// 100,000 instances, drawn with the culling of three.js' BatchedMesh and with CroftonCuller: the times of culling, and whether every
// pixel is that of drawing all.
import * as THREE from 'three';
import { load } from 'crofton';
import { CroftonCuller } from './CroftonCuller.js';

const COUNT = 100000, SIDE = 2000;

function makeShapes() {
    const shapes = [new THREE.BoxGeometry(2, 3, 2), new THREE.ConeGeometry(1.5, 4, 6), new THREE.IcosahedronGeometry(1.2)];
    for (const shape of shapes) if (!shape.index) shape.setIndex([...Array(shape.attributes.position.count).keys()]);
    return shapes;
}

/** Calls `use(i, matrix)` for each instance; `i` % 3 is its shape. */
function forInstances(use) {
    const object = new THREE.Object3D();
    let state = 7;
    const random = () => (state = Math.imul(state, 1664525) + 1013904223 >>> 0) / 2 ** 32;
    for (let i = 0; i < COUNT; ++i) {
        object.position.set((random() - 0.5) * SIDE, random() * 8, (random() - 0.5) * SIDE);
        object.rotation.set(random() * 6, random() * 6, random() * 6);
        object.scale.setScalar(0.5 + random());
        object.updateMatrix();
        use(i, object.matrix);
    }
}

function makeBatch(shapes, material) {
    const batch = new THREE.BatchedMesh(COUNT, 500, 1000, material), ids = shapes.map((shape) => batch.addGeometry(shape));
    forInstances((i, matrix) => batch.setMatrixAt(batch.addInstance(ids[i % 3]), matrix));
    batch.sortObjects = false;
    batch.frustumCulled = false;
    return batch;
}

function makeInstanced(shapes, material) {
    const meshes = shapes.map((shape, s) => new THREE.InstancedMesh(shape, material, Math.ceil((COUNT - s) / 3)));
    forInstances((i, matrix) => meshes[i % 3].setMatrixAt(Math.floor(i / 3), matrix));
    for (const mesh of meshes) mesh.frustumCulled = false;
    return meshes;
}

async function start() {
    const crofton = await load(), shapes = makeShapes(), material = new THREE.MeshNormalMaterial();
    const batch = makeBatch(shapes, material), meshes = makeInstanced(shapes, material), scene = new THREE.Scene().add(...meshes);
    const renderer = new THREE.WebGLRenderer({ preserveDrawingBuffer: true });
    renderer.setSize(640, 360);
    document.body.append(renderer.domElement);
    const camera = new THREE.PerspectiveCamera(60, 16 / 9, 0.5, 150);
    const place = (i) => {
        camera.position.set(700 * Math.sin(i), 8, 700 * Math.cos(1.7 * i));
        camera.rotation.set(0, 2.3 * i, 0);
        camera.updateMatrixWorld();
    };
    const time = (cull) => {
        const begin = performance.now();
        for (let i = 0; i < 20; ++i) place(i), cull();
        return (performance.now() - begin) / 20;
    };
    const picture = (i) => {
        place(i);
        renderer.render(scene, camera);
        const gl = renderer.getContext(), pixels = new Uint8Array(4 * 640 * 360);
        gl.readPixels(0, 0, 640, 360, gl.RGBA, gl.UNSIGNED_BYTE, pixels);
        return pixels;
    };
    const views = [0, 1, 2, 3, 4], all = views.map(picture), matrices = meshes.map((mesh) => mesh.instanceMatrix.array.slice()), culler = new CroftonCuller(crofton, meshes);
    const answer = { own: Infinity, crofton: Infinity, seen: [], different: 0, lit: 0 };
    for (let repeat = 0; repeat < 7; ++repeat) {
        answer.own = Math.min(answer.own, time(() => batch.onBeforeRender(renderer, scene, camera, batch.geometry, material)));
        answer.crofton = Math.min(answer.crofton, time(() => culler.update(camera)));
    }
    for (const i of views) {
        place(i);
        answer.seen.push(culler.update(camera));
        const ours = picture(i);
        for (let k = 0; k < ours.length; ++k) {
            if (all[i][k] !== ours[k]) ++answer.different;
            if (k % 4 < 3 && ours[k]) ++answer.lit;
        }
    }
    // An instance that comes before the camera is seen; when the culler goes, everything is drawn again.
    place(0);
    const before = culler.update(camera), ahead = new THREE.Matrix4().setPosition(camera.getWorldDirection(new THREE.Vector3())
        .multiplyScalar(20).add(camera.position)), hidden = COUNT / 2 | 0;
    const far = new THREE.Matrix4().setPosition(0, 0, 5 * SIDE);
    culler.setMatrixAt(meshes[hidden % 3], Math.floor(hidden / 3), far);
    const without = culler.update(camera);
    culler.setMatrixAt(meshes[hidden % 3], Math.floor(hidden / 3), ahead);
    answer.moved = culler.update(camera) - without === 1 && before - without <= 1;
    culler.dispose();
    matrices[hidden % 3].set(ahead.elements, 16 * Math.floor(hidden / 3));
    answer.all = meshes.reduce((sum, mesh) => sum + mesh.count, 0) === COUNT &&
        meshes.every((mesh, m) => mesh.instanceMatrix.array.every((number, i) => number === Math.fround(matrices[m][i])));
    globalThis.answer = answer;
    document.getElementById('says').textContent = `Culling of ${COUNT} instances: three.js ${answer.own.toFixed(2)} ms, Crofton ${
        answer.crofton.toFixed(3)} ms: ${(answer.own / answer.crofton).toFixed(0)} times as fast; ${answer.different} bytes of pixels differ.`;
}

start().catch((error) => { globalThis.answer = { error: String(error?.stack ?? error) }; });
