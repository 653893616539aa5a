// SPDX-License-Identifier: MIT
// Plain JavaScript: random numbers, and verdicts of boxes against planes in double precision.

export function random(seed) {
    return () => {
        seed = seed + 0x6d2b79f5 | 0;
        let t = Math.imul(seed ^ seed >>> 15, 1 | seed);
        t = t + Math.imul(t ^ t >>> 7, 61 | t) ^ t;
        return ((t ^ t >>> 14) >>> 0) / 4294967296;
    };
}

/** A rotation, nine numbers, from a quaternion. */
export function rotation(next) {
    const q = Array.from({ length: 4 }, () => 2 * next() - 1), n = Math.hypot(...q), [x, y, z, w] = q.map((c) => c / n);
    return [1 - 2 * (y * y + z * z), 2 * (x * y + z * w), 2 * (x * z - y * w), 2 * (x * y - z * w), 1 - 2 * (x * x + z * z),
        2 * (y * z + x * w), 2 * (x * z + y * w), 2 * (y * z - x * w), 1 - 2 * (x * x + y * y)];
}

/** 'out': beyond a plane by more than `near`; 'in': within all; 'seen': a point of the box is inside; else 'unsure'. */
export function verdict({ origin, planes }, { center, axes, halfExtents }, near = 1e-4) {
    let inside = true;
    const c = center.map((x, i) => x - origin[i]);
    const dot = (n, at, v) => n[0] * v[at] + n[1] * v[at + 1] + n[2] * v[at + 2];
    for (const { normal, offset } of planes) {
        const size = Math.hypot(...normal), middle = (dot(normal, 0, c) + offset) / size;
        let reach = 0;
        for (let k = 0; k < 3; ++k) reach += Math.abs(dot(normal, 3 * k, axes)) / size * halfExtents[k];
        if (middle + reach < -near) return 'out';
        if (middle - reach < near) inside = false;
    }
    if (inside) return 'in';
    for (let corner = 0; corner < 27; ++corner) {
        const t = [corner % 3 - 1, Math.floor(corner / 3) % 3 - 1, Math.floor(corner / 9) - 1];
        const p = [0, 1, 2].map((i) => c[i] + [0, 1, 2].reduce((sum, k) => sum + t[k] * halfExtents[k] * axes[3 * k + i], 0));
        if (planes.every(({ normal, offset }) => dot(normal, 0, p) + offset > near)) return 'seen';
    }
    return 'unsure';
}
