// SPDX-License-Identifier: MIT
// The library's classes over one build in memory.
import { Memory } from './memory.js';
import { loadModule } from './load.js';
import { Boxes, Frustum } from './geometry.js';
import { Tree, cullBoxes, classify } from './cull.js';
import { DepthCuller } from './depth.js';
import { fitBox } from './fit.js';
import { Triangulator } from './triangulate.js';
import { Region } from './region.js';
import * as queries from './queries.js';
import { ClusteredMesh, Shape, permuteTriangles } from './shape.js';
import { ViewResult, limitsOfCamera } from './views.js';
import { World } from './world.js';

/** Starts `build`; every class is a member of the result. */
export async function loadLibrary(build, options = {}) {
    const memory = new Memory(await loadModule(build, options));
    const bind = (Class) => class extends Class {
        constructor(...given) { super(memory, ...given); }
    };
    const crofton = {
        version: memory.text(memory.module._crofton_version_string()),
        /** The size of the library's memory in bytes. When it grows, views of it are detached. */
        get memoryBytes() { return memory.bytes.byteLength; },
        Boxes: bind(Boxes), Frustum: bind(Frustum), Tree: bind(Tree),
        Triangulator: bind(Triangulator), World: bind(World), ViewResult: bind(ViewResult), Region: bind(Region), Shape: bind(Shape),
        ClusteredMesh: bind(ClusteredMesh), DepthCuller: bind(DepthCuller),
        ...Object.fromEntries(Object.entries(queries).map(([name, query]) => [name, (...given) => query(memory, ...given)])),
        cullBoxes: (boxes, frustum, visible, how) => cullBoxes(memory, boxes, frustum, visible, how),
        classify: (boxes, frustum) => classify(memory, boxes, frustum),
        limitsOfCamera: (camera, pictureHeight, pixels) => limitsOfCamera(memory, camera, pictureHeight, pixels),
        permuteTriangles,
        fitBox: (points, how) => fitBox(memory, points, how),
        setLogger: (logger) => memory.setLogger(logger),
        log: (level, message) => memory.log(level, message),
    };
    return Object.freeze(crofton);
}
