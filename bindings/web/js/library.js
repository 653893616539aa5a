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
import { cast, closestPoint, contacts, distance, penetration, raycast, touches } from './queries.js';
import { failure } from './error.js';
import { ClusteredMesh, Shape, permuteTriangles } from './shape.js';
import { ViewResult, limitsOfCamera } from './views.js';
import { World } from './world.js';

/** What JavaScript itself says of an argument that cannot be read, as an error of the library's. */
const told = (error) => error instanceof TypeError || error instanceof RangeError ? Object.assign(failure(1, error.message), { cause: error }) : error;
const telling = (call) => call && function () {
    try {
        return call.apply(this, arguments);
    } catch (error) {
        throw told(error);
    }
};

/** Starts `build`; every class is a member of the result. */
export async function loadLibrary(build, options = {}) {
    const memory = new Memory(await loadModule(build, options));
    const bind = (Class) => {
        const Bound = class extends Class {
            constructor(...given) {
                try {
                    super(memory, ...given);
                } catch (error) {
                    throw told(error);
                }
            }
        };
        const { constructor, ...own } = Object.getOwnPropertyDescriptors(Class.prototype);
        for (const [name, { value, get }] of Object.entries(own))
            Object.defineProperty(Bound.prototype, name, get ? { get: telling(get) } : { value: telling(value) });
        return Bound;
    };
    const functions = { touches, distance, penetration, contacts, cast, closestPoint, raycast, cullBoxes, classify, limitsOfCamera, fitBox };
    const crofton = {
        version: memory.text(memory.module._crofton_version_string()),
        /** The size of the library's memory in bytes. When it grows, views of it are detached. */
        get memoryBytes() { return memory.bytes.byteLength; },
        Boxes: bind(Boxes), Frustum: bind(Frustum), Tree: bind(Tree),
        Triangulator: bind(Triangulator), World: bind(World), ViewResult: bind(ViewResult), Region: bind(Region), Shape: bind(Shape),
        ClusteredMesh: bind(ClusteredMesh), DepthCuller: bind(DepthCuller),
        ...Object.fromEntries(Object.entries(functions).map(([name, call]) => [name, telling((...given) => call(memory, ...given))])),
        permuteTriangles: telling(permuteTriangles),
        setLogger: (logger) => memory.setLogger(logger),
        log: (level, message) => memory.log(level, message),
    };
    return Object.freeze(crofton);
}
