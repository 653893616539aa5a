// SPDX-License-Identifier: MIT
// 100,000 instances, drawn with the culling of three.js and with Crofton's: the times of culling, and whether every pixel is equal.
import * as THREE from 'three';
import { load } from 'crofton';
import { cullWith, makeTree } from './batch.js';

const COUNT = 100000, SIDE = 2000;

function makeBatch() {
    const shapes = [new THREE.BoxGeometry(2, 3, 2), new THREE.ConeGeometry(1.5, 4, 6), new THREE.IcosahedronGeometry(1.2)];
    for (const shape of shapes) if (!shape.index) shape.setIndex([...Array(shape.attributes.position.count).keys()]);
    const batch = new THREE.BatchedMesh(COUNT, 500, 1000, new THREE.MeshNormalMaterial());
    const ids = shapes.map((shape) => batch.addGeometry(shape)), object = new THREE.Object3D();
    let state = 7;
    const random = () => (state = Math.imul(state, 1664525) + 1013904223 >>> 0) / 2 ** 32;
    for (let i = 0; i < COUNT; ++i) {
        object.position.set((random() - 0.5) * SIDE, random() * 8, (random() - 0.5) * SIDE);
        object.rotation.set(random() * 6, random() * 6, random() * 6);
        object.scale.setScalar(0.5 + random());
        object.updateMatrix();
        batch.setMatrixAt(batch.addInstance(ids[i % ids.length]), object.matrix);
    }
    batch.sortObjects = false;
    batch.frustumCulled = false;
    return batch;
}

async function start() {
    const crofton = await load(), batch = makeBatch(), scene = new THREE.Scene().add(batch);
    const renderer = new THREE.WebGLRenderer({ preserveDrawingBuffer: true });
    renderer.setSize(640, 360);
    document.body.append(renderer.domElement);
    const camera = new THREE.PerspectiveCamera(60, 16 / 9, 0.5, 150), tree = makeTree(crofton, batch, COUNT);
    const place = (i) => {
        camera.position.set(700 * Math.sin(i), 8, 700 * Math.cos(1.7 * i));
        camera.rotation.set(0, 2.3 * i, 0);
        camera.updateMatrixWorld();
    };
    const cull = () => {
        const begin = performance.now();
        for (let i = 0; i < 20; ++i) place(i), batch.onBeforeRender(renderer, scene, camera, batch.geometry, batch.material);
        return (performance.now() - begin) / 20;
    };
    const picture = (i) => {
        place(i);
        renderer.render(scene, camera);
        const gl = renderer.getContext(), pixels = new Uint8Array(4 * 640 * 360);
        gl.readPixels(0, 0, 640, 360, gl.RGBA, gl.UNSIGNED_BYTE, pixels);
        return { pixels, drawn: batch._multiDrawCount };
    };
    const answer = { own: Infinity, crofton: Infinity, drawn: [], different: 0, lit: 0 };
    for (let repeat = 0; repeat < 7; ++repeat) {
        answer.own = Math.min(answer.own, cull());
        const giveBack = cullWith(crofton, batch, tree);
        answer.crofton = Math.min(answer.crofton, cull());
        giveBack();
    }
    for (let i = 0; i < 5; ++i) {
        const own = picture(i), giveBack = cullWith(crofton, batch, tree), ours = picture(i);
        giveBack();
        answer.drawn.push([own.drawn, ours.drawn]);
        for (let k = 0; k < own.pixels.length; ++k) {
            if (own.pixels[k] !== ours.pixels[k]) ++answer.different;
            if (k % 4 < 3 && own.pixels[k]) ++answer.lit;
        }
    }
    globalThis.answer = answer;
    document.getElementById('says').textContent = `Culling of ${COUNT} instances: three.js ${answer.own.toFixed(2)} ms, Crofton ${
        answer.crofton.toFixed(3)} ms: ${(answer.own / answer.crofton).toFixed(0)} times as fast; ${answer.different} bytes of pixels differ.`;
}

start().catch((error) => { globalThis.answer = { error: String(error?.stack ?? error) }; });
