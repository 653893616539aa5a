// SPDX-License-Identifier: MIT
export type Vector = ArrayLike<number>;
export interface Box { center: number[]; axes: number[]; halfExtents: number[] }
export interface BoxLike { center: Vector; halfExtents: Vector; axes?: Vector }
export interface Camera {
    position?: Vector; forward?: Vector; up?: Vector;
    /** Radians. */
    fovY?: number;
    /** Full height of the view volume: makes the camera orthographic. */
    height?: number;
    aspect?: number; near?: number; far?: number;
}
export type Depth = 'reversed' | 'zeroToOne' | 'minusOneToOne';
export interface LoadOptions {
    /** The bytes of the WebAssembly, if the page already has them; otherwise they are unpacked from the package. */
    wasmBinary?: ArrayBuffer | Uint8Array;
}
export interface CullOptions { conservative?: boolean; treeOrder?: boolean }
export interface ObjectHandle { readonly kind: 'object'; readonly index: number; readonly generation: number }
export interface MeshHandle { readonly kind: 'mesh'; readonly index: number; readonly generation: number }
export interface ObjectHit { object: ObjectHandle; user: number; t: number; point: number[]; triangle: number; normal: number[]; startedInside: boolean }
export interface ObjectRef { object: ObjectHandle; user: number }
/** One of the three. */
export interface QueryShape { box?: BoxLike; sphere?: { center: Vector; radius: number }; capsule?: { begin: Vector; end: Vector; radius: number } }
export interface Triangulation {
    indices: Uint32Array;
    /** Total length of the diagonals. */
    weight: number;
    /** Proved bound of (weight - minimum) / minimum; infinite if unknown. */
    gap: number;
    optimal: boolean;
}
/** The statuses of the C API, in words. */
export type Status = 'invalid argument' | 'not finite' | 'out of range' | 'degenerate' | 'empty' | 'unsupported' | 'input/output' | 'parse' |
    'cancelled' | 'budget exceeded' | 'unavailable' | 'stale handle' | 'internal' | 'bad handle' | 'wrong struct size' | 'busy' | 'out of memory';
export class CroftonError extends Error {
    readonly status: Status;
    /** The item of the input; -1: no single item. */
    readonly item: number;
}
/** Holds memory of the library until `free`, or until it is garbage-collected. Any use after `free` throws. */
export interface Owned { free(): void }
export interface Boxes extends Owned {
    readonly length: number;
    readonly bytes: Uint8Array;
    /** Numbers become floats: axes the nearest, half extents the next above. */
    set(i: number, center: Vector, halfExtents: Vector, axes?: Vector): void;
    get(i: number): Box;
    setAll(centers: Float64Array | Float32Array, halfExtents: Float64Array | Float32Array, axes?: Float64Array | Float32Array): void;
    validate(): void;
}
export interface Frustum extends Owned {
    setCamera(camera: Camera): this;
    setMatrix(matrix: Vector, depth?: Depth, origin?: Vector): this;
    readonly planes: { origin: number[]; planes: { normal: number[]; offset: number }[] };
}
export interface Tree extends Owned {
    cull(frustum: Frustum, visible: ViewResult, how?: CullOptions): ViewResult;
    move(items: ArrayLike<number>, boxes: Boxes): void;
    remove(item: number): void;
    refit(): void;
}
export interface Triangulator extends Owned {
    triangulate(points: Float64Array, ringEnds?: number[], method?: 'ear' | 'delaunay' | 'minimumWeight'): Triangulation;
}
/** Views: valid until the next view or any growth of memory. */
export interface ViewResult extends Owned {
    readonly length: number;
    readonly ids: Uint32Array;
    readonly verdicts: Uint8Array;
    readonly occluded: Uint32Array;
    /** For a view with a picture: what to draw; bit k of `triangles` stands for triangle k of the cluster. */
    readonly triangles: { object: number; cluster: number; triangles: bigint }[];
    /** The same without BigInt or copies, four words each: object, cluster, low and high half of the bits. */
    readonly triangleWords: Uint32Array;
    readonly statistics: Record<'nodesTested' | 'boxesTested' | 'acceptedWhole' | 'straddling' | 'exactTests' | 'falsePositives' |
        'occludersDrawn', number>;
}
export type Bits = BigUint64Array | Uint32Array;
export interface DrawLimits {
    eye: Vector;
    /** Leaves out what is farther than this times its radius; the default is infinite. */
    maxDistanceInRadii?: number;
    leastRadius?: number;
    /** 32 numbers; by object index. */
    layerDistances?: Float32Array; itemDistances?: Float32Array;
    /** The limits of objects that were drawn before are `hysteresis` times as long. */
    drawnBefore?: Bits; hysteresis?: number;
}
export interface ViewRequest {
    camera?: Camera; matrix?: Vector; depth?: Depth; origin?: Vector; volume?: Frustum; layers?: number;
    occlusion?: { listOccluded?: boolean; width?: number; height?: number; maxOccluders?: number; leastCover?: number };
    /** Instead of occlusion; `depth` is the depth range of the projection, 'reversed' by default; `samples` in each pixel: 1, 2, 4 or 8. */
    picture?: { width?: number; height?: number; depth?: Depth; samples?: number };
    /** With a picture that is a light's shadow map: lists only the triangles whose shadows a camera could see. `seen` is the answer to the
     * camera's view, with a picture; `radius`, 1 by default: how far a lookup's texels are from its point along each axis. */
    receivers?: { seen: ViewResult; radius?: number };
    limits?: DrawLimits;
    /** Bit i says whether object i may be seen. Objects that have moved since their first update may always be seen. */
    candidates?: Bits;
    treeOrder?: boolean; conservative?: boolean;
}
export interface World extends Owned {
    readonly count: number;
    addMesh(positions: Float32Array, indices: Uint32Array | Uint16Array, how?: { clusters?: boolean; oneSided?: boolean }): MeshHandle;
    clustersOf(mesh: MeshHandle): { clusters: { firstTriangle: number; triangleCount: number }[]; triangleOrder: Uint32Array };
    /** Error: objects use the mesh. */
    removeMesh(mesh: MeshHandle): void;
    findOccluders(mesh: MeshHandle): void;
    setConvexOccluder(mesh: MeshHandle, positions: Float32Array): void;
    /** `transform`: sixteen numbers by columns, the last row 0, 0, 0, 1. */
    add(object: { box?: BoxLike; sphere?: { center: Vector; radius: number }; mesh?: MeshHandle; transform?: Vector;
        user?: number; layers?: number; occludes?: boolean }): ObjectHandle;
    remove(object: ObjectHandle): void;
    setHidden(object: ObjectHandle, hidden: boolean): void;
    setUser(object: ObjectHandle, user: number): void;
    setLayers(object: ObjectHandle, layers: number): void;
    setBox(object: ObjectHandle, box: BoxLike): void;
    setTransform(object: ObjectHandle, transform: Vector): void;
    contains(object: ObjectHandle): boolean;
    update(): void;
    /** `camera` or `volume`, or both: then objects are tested against the volume, and hidden from the camera. */
    view(request: ViewRequest, visible: ViewResult): ViewResult;
    raycast(origin: Vector, direction: Vector, maxT?: number, layers?: number): ObjectHit | null;
    raycastAny(origin: Vector, direction: Vector, maxT?: number, layers?: number): boolean;
    /** By index. Touching counts. */
    overlap(shape: QueryShape, layers?: number): ObjectRef[];
    /** `distance` is 0 for an object that overlaps. */
    closest(shape: QueryShape, maxDistance?: number, layers?: number): (ObjectRef & { distance: number; onShape: number[]; onObject: number[] }) | null;
}
export interface Crofton {
    readonly version: string;
    readonly memoryBytes: number;
    readonly Boxes: new (count: number) => Boxes;
    readonly Frustum: new (from?: { camera?: Camera; matrix?: Vector; depth?: Depth; origin?: Vector; layers?: number }) => Frustum;
    readonly Tree: new (boxes: Boxes) => Tree;
    readonly Triangulator: new () => Triangulator;
    readonly World: new () => World;
    readonly ViewResult: new () => ViewResult;
    cullBoxes(boxes: Boxes, frustum: Frustum, visible: ViewResult, how?: CullOptions): ViewResult;
    /** A verdict a box: 0 outside, 1 straddling, 2 inside. */
    classify(boxes: Boxes, frustum: Frustum): Uint8Array;
    fitBox(points: Float32Array | Float64Array, how?: { quality?: 'fast' | 'tight' | 'exact';
        criterion?: { volume?: number; area?: number; meanCurvature?: number } }): Box;
    setLogger(logger: ((level: number, message: string) => void) | null): void;
    log(level: number, message: string): void;
}
export function load(options?: LoadOptions): Promise<Crofton>;
