// SPDX-License-Identifier: MIT
// The town: that of `crofton view town`, as make_town.py wrote it. Metres; y is up.

/**
 * Reads town.bin, unpacked: `{ meshes, objects, flight }`. A mesh is `{ positions, indices, colors }`, an object `{ mesh, matrix }`, its
 * matrix of sixteen numbers by columns; `flight` is the corners of a closed path over the middle of streets.
 */
export function readTown(bytes) {
    let at = 0;
    const take = (Type, count) => {
        const size = count * Type.BYTES_PER_ELEMENT, values = new Type(bytes.slice(at, at += size).buffer);
        return values;
    };
    const [meshCount, objectCount, cornerCount] = take(Uint32Array, 3);
    const heads = take(Uint32Array, 2 * meshCount), steps = take(Float32Array, meshCount);
    const transforms = take(Float32Array, 12 * objectCount), flight = take(Float32Array, 3 * cornerCount);
    const meshOf = take(Uint16Array, objectCount);
    const sum = (first) => heads.reduce((total, count, i) => i % 2 === first ? total + count : total, 0);
    const places = take(Int16Array, 3 * sum(0)), corners = take(Int16Array, 3 * sum(1)), colors = take(Uint8Array, 3 * sum(0));
    let vertex = 0, corner = 0;
    const meshes = Array.from({ length: meshCount }, (_, m) => {
        const [vertices, triangles] = heads.subarray(2 * m, 2 * m + 2), whole = new Int16Array(3);
        const positions = new Float32Array(3 * vertices), indices = new Uint32Array(3 * triangles);
        for (let i = 0; i < positions.length; ++i) positions[i] = steps[m] * (whole[i % 3] += places[3 * vertex + i]);
        for (let i = 0, last = 0; i < indices.length; ++i) indices[i] = last = last + corners[3 * corner + i] & 0xffff;
        const own = colors.subarray(3 * vertex, 3 * (vertex + vertices));
        vertex += vertices;
        corner += triangles;
        return { positions, indices, colors: own };
    });
    const objects = Array.from(meshOf, (mesh, i) => {
        const t = transforms.subarray(12 * i, 12 * i + 12);
        return { mesh, matrix: [...t.subarray(0, 3), 0, ...t.subarray(3, 6), 0, ...t.subarray(6, 9), 0, ...t.subarray(9), 1] };
    });
    return { meshes, objects, flight: Array.from({ length: cornerCount }, (_, i) => [...flight.subarray(3 * i, 3 * i + 3)]) };
}
