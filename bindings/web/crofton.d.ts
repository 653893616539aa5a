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
export interface ObjectHit { object: ObjectHandle; user: number; t: number; point: number[]; triangle: number; child: number; normal: number[]; startedInside: boolean }
export interface ObjectRef { object: ObjectHandle; user: number }
export interface NodeHandle { readonly kind: 'node'; readonly index: number; readonly generation: number }
export interface AttachedRegion { readonly kind: 'region'; readonly index: number; readonly generation: number }
export interface Sphere { center: Vector; radius: number }
/** A shape where it stands; `transform` is a rotation and a translation. */
export interface Placed { shape: Shape; transform?: Vector }
/** One of the four. */
export interface QueryShape { box?: BoxLike; sphere?: Sphere; capsule?: { begin: Vector; end: Vector; radius: number }; shape?: Shape; transform?: Vector }
export interface Motion {
    velocity?: Vector;
    /** Radians a unit of time around this axis of the world, through `pivot`, in the shape's frame. */
    spin?: Vector; pivot?: Vector;
    /** 1. */
    duration?: number;
    /** How far apart they may still be at the time of a hit; 0: 1e-6. */
    tolerance?: number;
    maxSteps?: number; ignoreInitialOverlaps?: boolean;
}
export interface ShapeHit { object: ObjectHandle; user: number; time: number; normal: number[]; point: number[]; triangle: number; child: number; distance: number; unresolved: boolean }
export interface Contact {
    first: ObjectRef; second: ObjectRef; phase: 'began' | 'stayed' | 'ended'; inside: 'nothing' | 'first' | 'second' | 'partly';
    /** Unit, from first to second; 0 if no direction is known. */
    normal: number[]; depth: number;
    points: { position: number[]; depth: number }[];
    triangles: { first: number; second: number; begin: number[]; end: number[]; normal: number[] }[];
    /** Of two shapes. `memory`: four numbers of yours, a view until the next update or growth of memory. */
    shapePoints: { position: number[]; depth: number; normal: number[]; began: boolean; memory: Float32Array }[];
}
/** One of these. Solids of revolution have y as axis, with the origin half way up. */
export type ShapeDescription = { sphere: { radius: number } } | { capsule: { radius: number; halfHeight: number } } |
    { cylinder: { radius: number; halfHeight: number } } | { cone: { radius: number; halfHeight: number } } | { box: { halfExtents: Vector } } |
    { triangle: Vector } | { hull: { positions: Float32Array; maxVertices?: number } } | { halfSpace: { normal: Vector; offset?: number } } |
    { mesh: { positions: Float32Array; indices: ArrayLike<number>; frontOnly?: boolean } } |
    { heightField: { columns: number; heights: Float32Array; materials?: Uint8Array; spacing?: Vector; frontOnly?: boolean } } |
    { rounded: { core: Shape; radius: number } } | { compound: Placed[] };
/** Geometry by which a mesh's objects hide others: opaque, within the drawn mesh. */
export type Occluder = { box: BoxLike } | { walled: BoxLike } | { convex: Float32Array } |
    { patch: { positions: Float32Array; indices: ArrayLike<number>; oneSided?: boolean } };
export interface MeshOptions {
    /** Views with a picture list the triangles by clusters; `oneSided`: back faces are not drawn; `precut`: the mesh's clusters, cut before. */
    clusters?: boolean; oneSided?: boolean; precut?: ClusteredMesh;
    /** False: queries and contacts take the mesh for its box, and `update` takes less time. */
    triangles?: boolean;
}
export interface ObjectDescription { box?: BoxLike; sphere?: Sphere; mesh?: MeshHandle; shape?: Shape; transform?: Vector; node?: NodeHandle;
    user?: number; layers?: number; collidesWith?: number; occludes?: boolean; onlyOccludes?: boolean; hidden?: boolean }
/** Limits a query of a world: a layer mask, or a mask and objects that are not found, such as the one that asks. */
export type Filter = number | { layers?: number; ignored?: ObjectHandle[] };
export interface RegionObject { box?: BoxLike; sphere?: Sphere; shape?: Shape; mesh?: number; transform?: Vector; user?: number; layers?: number;
    collidesWith?: number; occludes?: boolean; onlyOccludes?: boolean }
export interface RegionOptions {
    meshes?: ({ positions: Float32Array; indices: Uint32Array | Uint16Array } & MeshOptions)[]; findOccluders?: boolean;
    /** 1e9: with meshes or shapes no coordinate of an origin may be larger. */
    maxOrigin?: number;
}
export interface WorldOptions {
    pairs?: boolean; contacts?: boolean; containment?: boolean; meshDepth?: boolean; contactMargin?: number; maxPairs?: number; updatesToRest?: number;
    /** Items' worth of background work on the tree in each update; 0: none. As many as are good unless told. */
    rebuildBudget?: number;
}
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
/** Never changes; what uses it keeps what it needs. */
export interface Shape extends Owned {
    /** The box along the axes that contains it in its frame; infinite for half-spaces. */
    readonly bounds: { min: number[]; max: number[] };
    /** For density 1, in its frame; `inertia`: nine numbers, about the center. Error: surfaces have no mass. */
    readonly mass: { volume: number; center: number[]; inertia: number[] };
}
/** A child of a compound, or a triangle of a mesh or height field. */
export interface Part { child: number; triangle: number }
/** Proved: the true distance or depth is from `lower` to `upper`. `normal`: unit, from a to b. */
export interface ShapePair { lower: number; upper: number; onA: number[]; onB: number[]; normal: number[]; partA: Part; partB: Part }
export interface Impact {
    time: number;
    /** The gap at that time; negative: how deep they overlap, from the start. */
    distance: number; onA: number[]; onB: number[]; normal: number[]; partA: Part; partB: Part;
    /** `maxSteps` was too small: they do not touch before `time`. */
    unresolved: boolean;
}
export interface DepthObject {
    mesh: ClusteredMesh;
    /** Sixteen numbers by columns: takes positions of the mesh to clip space, as the vertex shader does. */
    toClip: Vector;
    oneSided?: boolean;
    /** False for alpha-tested and transparent objects. */
    hides?: boolean;
    /** By how much drawn vertices may be off, besides rounding. */
    positionError?: number;
}
export interface Picture {
    width?: number; height?: number; depth?: Depth; samples?: number;
    /** 0 for no limit. Otherwise a number of clusters that are tested and of triangles that are drawn, together; what is left is listed whole. */
    workLimit?: number;
}
/** Finds the triangles of pictures and of shadow maps of meshes that no World holds. */
export interface DepthCuller extends Owned {
    findVisible(objects: DepthObject[], picture?: Picture): DepthCuller;
    /** `toClip` of the casters leads to the clip space of the shadow map. `seen` last answered for the camera's picture, `objects` are those of
     * that call; without a `mesh` where nothing of it was listed; `solid`: anything within the mesh's bound may be seen. */
    findCasters(objects: DepthObject[], map: Picture, receivers: { seen: DepthCuller;
        objects: { mesh?: ClusteredMesh; toMap: Vector; solid?: boolean }[]; radius?: number }): DepthCuller;
    /** As in ViewResult; views until the next call. `object` is a place in the list. */
    readonly triangleWords: Uint32Array;
    readonly triangles: { object: number; cluster: number; triangles: bigint }[];
    readonly statistics: Record<'objectsListed' | 'objectsAsked' | 'clustersAsked' | 'clustersDrawn' | 'trianglesDrawn' | 'trianglesListed', number>;
    /** A lower bound at a pixel of the last picture; minus infinity where nothing is proved to cover it. Row 0 is at the bottom. */
    nearness(x: number, y: number): number;
}
/** Bit k of an answer's `triangles` is triangle `triangleOrder[firstTriangle + k]` of the mesh. */
export interface Clusters { clusters: { firstTriangle: number; triangleCount: number }[]; triangleOrder: Uint32Array }
/** A mesh cut into clusters. */
export interface ClusteredMesh extends Owned {
    /** A copy. */
    readonly clusters: Clusters;
    /** A copy, to store. */
    readonly bytes: Uint8Array;
}
/** Many objects that do not move, for `World.attach`. */
export interface Region extends Owned {
    readonly count: number;
    /** Around all objects, relative to the origin. */
    readonly bounds: { min: number[]; max: number[] };
    /** The mesh of the object at a place; -1: none. */
    meshOf(place: number): number;
    /** What a view's triangles refer to. Error: there is no such mesh, or it has none. */
    clustersOf(mesh: number): Clusters;
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
    /** A copy: bit v for view v of several, for each of `ids`. */
    masks(world: World): Uint32Array;
    /** The same as those above, of one view of several. */
    occludedOf(view: number): Uint32Array;
    trianglesOf(view: number): { object: number; cluster: number; triangles: bigint }[];
    triangleWordsOf(view: number): Uint32Array;
    statisticsOf(view: number): ViewResult['statistics'];
    /** A copy of the depth buffer of a view with occlusion, row by row from the bottom: 1 / w, or below -1e38 where nothing is drawn. */
    readonly depth: { width: number; height: number; nearness: Float32Array };
    depthOf(view: number): ViewResult['depth'];
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
    picture?: Picture;
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
    addMesh(positions: Float32Array, indices: Uint32Array | Uint16Array, how?: MeshOptions): MeshHandle;
    /** Gives its objects other triangles. Removes its occluders. */
    replaceMesh(mesh: MeshHandle, positions: Float32Array, indices: Uint32Array | Uint16Array, how?: MeshOptions): void;
    setVertices(mesh: MeshHandle, positions: Float32Array): void;
    clustersOf(mesh: MeshHandle): Clusters;
    /** Error: objects use the mesh. */
    removeMesh(mesh: MeshHandle): void;
    findOccluders(mesh: MeshHandle): void;
    setOccluders(mesh: MeshHandle, occluders: Occluder[]): void;
    /** The occluders that hide an object in a view alone; without an object all that were drawn. */
    hiddenBy(visible: ViewResult, object?: ObjectHandle): (ObjectRef & { place: number })[];
    addNode(node?: { parent?: NodeHandle; transform?: Vector; layers?: number }): NodeHandle;
    /** With all nodes and objects below it. */
    removeNode(node: NodeHandle): void;
    setParent(node: NodeHandle, parent?: NodeHandle): void;
    setNodeLayers(node: NodeHandle, layers: number): void;
    setNodeTransform(node: NodeHandle, transform: Vector): void;
    /** `transform`: sixteen numbers by columns, the last row 0, 0, 0, 1. */
    add(object: ObjectDescription): ObjectHandle;
    /** Adds many in one call. If one is refused, the error's item is its place, and none is added. */
    addMany(objects: ObjectDescription[]): ObjectHandle[];
    /** Takes memory for so many objects in all. */
    reserve(objects: number): void;
    remove(object: ObjectHandle): void;
    setHidden(object: ObjectHandle, hidden: boolean): void;
    setUser(object: ObjectHandle, user: number): void;
    setLayers(object: ObjectHandle, layers: number): void;
    setCollidesWith(object: ObjectHandle, layers: number): void;
    setOccludes(object: ObjectHandle, occludes: boolean): void;
    setMesh(object: ObjectHandle, mesh: MeshHandle): void;
    setShape(object: ObjectHandle, shape: Shape | null): void;
    setBox(object: ObjectHandle, box: BoxLike): void;
    setTransform(object: ObjectHandle, transform: Vector): void;
    /** Sixteen numbers each. All are moved but those that are refused; the error's item is the place of the first. */
    setTransforms(objects: ObjectHandle[], transforms: Float64Array | Float32Array): void;
    setNodeTransforms(nodes: NodeHandle[], transforms: Float64Array | Float32Array): void;
    setBoxes(objects: ObjectHandle[], boxes: Boxes): void;
    contains(object: ObjectHandle): boolean;
    userOf(object: ObjectHandle): number;
    /** As of the last update. Error: there was none since the object was added. */
    boxOf(object: ObjectHandle): Box;
    /** Sixteen numbers, to the world. Error: the object is a bound. */
    transformOf(object: ObjectHandle): number[];
    update(): void;
    /** `camera` or `volume`, or both: then objects are tested against the volume, and hidden from the camera. */
    view(request: ViewRequest | ViewRequest[], visible: ViewResult): ViewResult;
    raycast(origin: Vector, direction: Vector, maxT?: number, filter?: Filter): ObjectHit | null;
    /** Three numbers each. `t` is infinite where nothing is hit, the object's index and the triangle are -1. */
    raycastMany(origins: Float64Array, directions: Float64Array, maxT?: number, filter?: Filter):
        { t: Float64Array; objects: Int32Array; triangles: Int32Array; normals: Float64Array };
    raycastAll(origin: Vector, direction: Vector, maxT?: number, filter?: Filter): ObjectHit[];
    raycastAny(origin: Vector, direction: Vector, maxT?: number, filter?: Filter): boolean;
    /** The first object that a moving shape meets; objects are at rest. */
    cast(shape: Placed, motion: Motion, filter?: Filter): ShapeHit | null;
    /** The first hit of each object that it meets, in order of time. */
    castAll(shape: Placed, motion: Motion, filter?: Filter): ShapeHit[];
    /** Where a shape, which need not be an object, touches the objects, in order of index. The normal leads from the shape to the object. */
    contactManifolds(shape: Placed, options?: { margin?: number; maxPoints?: number }, filter?: Filter): 
        (ObjectRef & { normal: number[]; depth: number; points: { position: number[]; depth: number; partA: Part; partB: Part }[] })[];
    pairs(): { first: ObjectRef; second: ObjectRef }[];
    contacts(): Contact[];
    readonly statistics: Record<'objects' | 'resting' | 'moving' | 'boxesChanged' | 'outOfRange' | 'occludersWaiting', number>;
    attach(region: Region, origin?: Vector): AttachedRegion;
    detach(region: AttachedRegion): void;
    objectIn(region: AttachedRegion, place: number): ObjectHandle;
    placeOf(object: ObjectHandle): { region: AttachedRegion; place: number };
    /** By index. Touching counts. */
    overlap(shape: QueryShape, filter?: Filter): ObjectRef[];
    /** `distance` is 0 for an object that overlaps. */
    closest(shape: QueryShape, maxDistance?: number, filter?: Filter): (ObjectRef & { distance: number; onShape: number[]; onObject: number[]; triangle: number; child: number }) | null;
}
export interface Crofton {
    readonly version: string;
    readonly memoryBytes: number;
    readonly Boxes: new (count: number) => Boxes;
    readonly Frustum: new (from?: { camera?: Camera; matrix?: Vector; depth?: Depth; origin?: Vector; layers?: number }) => Frustum;
    readonly Tree: new (boxes: Boxes) => Tree;
    readonly Triangulator: new () => Triangulator;
    readonly World: new (options?: WorldOptions) => World;
    readonly Shape: new (description: ShapeDescription) => Shape;
    readonly ClusteredMesh: { new (positions: Float32Array, indices: ArrayLike<number>, how?: { maxTriangles?: number }): ClusteredMesh; new (bytes: Uint8Array): ClusteredMesh };
    readonly DepthCuller: new () => DepthCuller;
    readonly Region: new (objects: RegionObject[], how?: RegionOptions) => Region;
    readonly ViewResult: new () => ViewResult;
    cullBoxes(boxes: Boxes, frustum: Frustum, visible: ViewResult, how?: CullOptions): ViewResult;
    /** A verdict a box: 0 outside, 1 straddling, 2 inside. */
    classify(boxes: Boxes, frustum: Frustum): Uint8Array;
    /** For a request's `limits`: leaves out what is less than `pixels` wide in a picture `pictureHeight` pixels high. */
    limitsOfCamera(camera: Camera, pictureHeight: number, pixels: number): DrawLimits;
    /** A mesh's indices in the order of its clusters: each cluster is then one range of an index buffer. */
    permuteTriangles<T extends Uint32Array | Uint16Array>(clusters: Pick<Clusters, 'triangleOrder'>, indices: T): T;
    fitBox(points: Float32Array | Float64Array, how?: { quality?: 'fast' | 'tight' | 'exact';
        criterion?: { volume?: number; area?: number; meanCurvature?: number } }): Box;
    /** Of two shapes, without a World. Touching counts. */
    touches(a: Placed | Shape, b: Placed | Shape): boolean;
    /** 0 if they overlap. */
    distance(a: Placed | Shape, b: Placed | Shape): ShapePair & { distance: number };
    /** Moving b by depth times normal ends the overlap; null: there is none. */
    penetration(a: Placed | Shape, b: Placed | Shape): (ShapePair & { depth: number }) | null;
    /** The deepest contact, up to `maxPoints` points, 4 by default and at most 8. `margin`: gaps of up to this count. */
    contacts(a: Placed | Shape, b: Placed | Shape, how?: { margin?: number; maxPoints?: number }):
        { normal: number[]; depth: number; points: { position: number[]; depth: number; partA: Part; partB: Part }[] };
    /** The first touch of two moving shapes; `duration`, `tolerance`, `maxSteps` and `ignoreInitialOverlaps` are those of the first motion. */
    cast(a: Placed | Shape, motion: Motion, b: Placed | Shape, motionOfB?: Pick<Motion, 'velocity' | 'spin' | 'pivot'>): Impact | null;
    /** The point of a shape that is nearest to `point`; `distance` is 0 inside a solid; `normal`: unit, from `point` to the shape. */
    closestPoint(shape: Placed | Shape, point: Vector): { distance: number; point: number[]; normal: number[]; part: Part };
    /** Triangles, meshes and height fields have no inside. */
    raycast(shape: Placed | Shape, origin: Vector, direction: Vector, maxT?: number):
        { t: number; point: number[]; normal: number[]; part: Part; startedInside: boolean } | null;
    setLogger(logger: ((level: number, message: string) => void) | null): void;
    log(level: number, message: string): void;
}
export function load(options?: LoadOptions): Promise<Crofton>;
