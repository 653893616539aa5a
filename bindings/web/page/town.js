// SPDX-License-Identifier: MIT
// The town: few meshes, many objects. The same numbers on every machine: no sine, whole-number random numbers.
// Metres; y is up. A mesh is { name, positions, indices, occludes }; an object { mesh, position, cos, sin }: turned about y.
const PITCH = 40;

/** Triangles of a convex solid between two rings of corners, the lower and the upper, both seen counterclockwise from above. */
function solid(name, lower, upper, occludes) {
    const n = lower.length, indices = [];
    for (let i = 0; i < n; ++i) {
        const j = (i + 1) % n;
        indices.push(i, j, n + j, i, n + j, n + i);
        if (i > 0 && i < n - 1) indices.push(0, i + 1, i, n, n + i, n + i + 1);
    }
    return { name, positions: Float32Array.from([...lower, ...upper].flat()), indices: Uint32Array.from(indices), occludes };
}

const ring = (x, y, z, cx = 0, cz = 0) => [[cx - x, y, cz + z], [cx + x, y, cz + z], [cx + x, y, cz - z], [cx - x, y, cz - z]];
const block = (name, x, height, z) => solid(name, ring(x, 0, z), ring(x, height, z), true);

function house() {
    const positions = Float32Array.from([...ring(7, 0, 5), ...ring(7, 6, 5), [-7, 10, 0], [7, 10, 0]].flat());
    const walls = [0, 1, 5, 0, 5, 4, 1, 2, 6, 1, 6, 5, 2, 3, 7, 2, 7, 6, 3, 0, 4, 3, 4, 7, 0, 2, 1, 0, 3, 2];
    const roof = [4, 5, 9, 4, 9, 8, 6, 7, 8, 6, 8, 9, 5, 6, 9, 7, 4, 8];
    return { name: 'house', positions, indices: Uint32Array.from([...walls, ...roof]), occludes: true };
}

function tree() {
    const six = [[2, 0], [1, -1.7], [-1, -1.7], [-2, 0], [-1, 1.7], [1, 1.7]];
    return solid('tree', six.map(([x, z]) => [x, 1, z]), six.map(([x, z]) => [x / 8, 7, z / 8]), false);
}

export const MESHES = [house(), block('flats', 11, 16, 8), block('tower', 9, 34, 9), block('hall', 15, 9, 11), tree(),
    solid('jib', ring(0.6, 0, 0.6), ring(0.6, 22, 0.6, 16, 10), false), block('lamp', 0.15, 5, 0.15)];

/** The objects of a town of `lots` × `lots` lots. */
export function makeTown(lots = 48) {
    let state = 20260101;
    const random = () => {
        state = Math.imul(state ^ state >>> 15, 0x2c1b3c6d) + 0x6d2b79f5 | 0;
        return ((state ^ state >>> 13) >>> 8) / 2 ** 24;
    };
    const turns = [[1, 0], [0, 1], [-1, 0], [0, -1], [0.8, 0.6], [0.96, 0.28]];
    const objects = [];
    const put = (mesh, x, z, y = 0, turn = Math.floor(random() * 4)) => {
        const [cos, sin] = turns[turn];
        objects.push({ mesh, position: [x, y, z], cos, sin });
    };
    for (let i = 0; i < lots; ++i)
        for (let k = 0; k < lots; ++k) {
            const x = (i - lots / 2 + 0.5) * PITCH, z = (k - lots / 2 + 0.5) * PITCH, kind = random();
            const middle = Math.abs(i - lots / 2) + Math.abs(k - lots / 2) < lots / 4;
            if (kind < 0.06) {
                for (let t = 0; t < 8; ++t) put(4, x + 26 * (random() - 0.5), z + 26 * (random() - 0.5), 0, Math.floor(random() * 6));
                continue;
            }
            put(middle ? kind < 0.6 ? 2 : 1 : kind < 0.55 ? 0 : kind < 0.85 ? 1 : 3, x, z);
            if (kind > 0.97) put(5, x - 14, z - 13, 0, 4 + Math.floor(random() * 2));
            for (let t = 0; t < 3; ++t) put(4, x - 12 + 12 * t, z + 15, 0, Math.floor(random() * 6));
            put(6, x + 15.5, z - 15.5);
        }
    return objects;
}

/** Sixteen numbers by columns. */
export const transformOf = ({ position: [x, y, z], cos, sin }) => [cos, 0, -sin, 0, 0, 1, 0, 0, sin, 0, cos, 0, x, y, z, 1];

/**
 * The box of an object from that of its mesh. Turned axes become floats, each at most √3 / 2²⁵ < 5.2e-8 from what it was:
 * a corner may leave the box by that much of the half extents' sum. Twice as much is added.
 */
export function placed(box, { position, cos, sin }) {
    const turn = ([x, y, z]) => [cos * x + sin * z, y, cos * z - sin * x];
    const margin = 1.04e-7 * box.halfExtents.reduce((sum, half) => sum + half, 0);
    return { center: turn(box.center).map((c, k) => c + position[k]), halfExtents: box.halfExtents.map((half) => half + margin),
        axes: [0, 3, 6].flatMap((first) => turn(box.axes.slice(first, first + 3))) };
}
