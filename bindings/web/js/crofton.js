// SPDX-License-Identifier: MIT
// Crofton for JavaScript: what a camera sees, boxes around points, triangles of polygons. README.md is the guide.
import { CroftonError } from './error.js';
import { Memory } from './memory.js';
import { loadModule } from './load.js';
import { Boxes, Frustum } from './geometry.js';
import { Tree, cullBoxes, classify } from './cull.js';
import { fitBox } from './fit.js';
import { Triangulator } from './triangulate.js';
import { World, ViewResult } from './world.js';

export { CroftonError };

/** Loads the library once; every class is a member of what it gives. `options.simd` false takes the build without SIMD. */
export async function load(options = {}) {
    const memory = new Memory(await loadModule(options));
    const bind = (Class) => class extends Class {
        constructor(...given) { super(memory, ...given); }
    };
    const crofton = {
        simd: memory.module.simd,
        version: memory.text(memory.module._crofton_version_string()),
        /** Bytes of the library's memory; it grows, and views of it are then detached. */
        get memoryBytes() { return memory.bytes.byteLength; },
        Boxes: bind(Boxes), Frustum: bind(Frustum), Tree: bind(Tree),
        Triangulator: bind(Triangulator), World: bind(World), ViewResult: bind(ViewResult),
        cullBoxes: (boxes, frustum, visible, how) => cullBoxes(memory, boxes, frustum, visible, how),
        classify: (boxes, frustum) => classify(memory, boxes, frustum),
        fitBox: (points, how) => fitBox(memory, points, how),
        setLogger: (logger) => memory.setLogger(logger),
        log: (level, message) => memory.log(level, message),
    };
    return Object.freeze(crofton);
}

/** Whether this JavaScript engine has WebAssembly with SIMD. */
export { hasSimd } from './load.js';
