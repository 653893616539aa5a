// SPDX-License-Identifier: MIT
// Cameras of the page: { position, yaw, pitch }, radians; yaw 0 looks along -z. Matrices by columns, for WebGL.
export const LENS = { fovY: 1, near: 1, far: 1500 };

export function cameraOf({ position, yaw, pitch }, aspect) {
    const forward = [Math.sin(yaw) * Math.cos(pitch), Math.sin(pitch), -Math.cos(yaw) * Math.cos(pitch)];
    return { position, forward, up: [0, 1, 0], aspect, ...LENS };
}

const cross = (a, b) => [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]];
const unit = (a) => a.map((c) => c / Math.hypot(...a));

function sides({ forward, up }) {
    const right = unit(cross(forward, up));
    return [right, cross(right, forward)];
}

/** From the world to clip space. */
export function matrixOf(camera) {
    const [right, up] = sides(camera), { position, forward, fovY, aspect, near, far } = camera;
    const t = 1 / Math.tan(fovY / 2), a = (far + near) / (far - near), b = 2 * far * near / (far - near);
    const dot = (v) => v[0] * position[0] + v[1] * position[1] + v[2] * position[2];
    const columns = [];
    for (let k = 0; k < 3; ++k) columns.push(t / aspect * right[k], t * up[k], a * forward[k], forward[k]);
    return Float32Array.from([...columns, -t / aspect * dot(right), -t * dot(up), -a * dot(forward) - b, -dot(forward)]);
}

/** The twelve edges of a frustum as points of lines; no farther than `reach`. */
export function edgesOf(camera, reach = 400) {
    const [right, up] = sides(camera), { position, forward, fovY, aspect, near, far } = camera;
    const corner = (x, y, d) => position.map((p, k) =>
        p + d * (forward[k] + Math.tan(fovY / 2) * (x * aspect * right[k] + y * up[k])));
    const at = [near, Math.min(far, reach)].map((d) => [[-1, -1], [1, -1], [1, 1], [-1, 1]].map(([x, y]) => corner(x, y, d)));
    const lines = [];
    for (let i = 0; i < 4; ++i)
        lines.push(at[0][i], at[1][i], at[1][i], at[1][(i + 1) % 4], at[0][i], at[0][(i + 1) % 4]);
    return Float32Array.from(lines.flat());
}

/** Beside and above a camera, with its frustum in the middle of the picture. */
export function besideOf({ position, yaw }) {
    const ahead = [Math.sin(yaw), 0, -Math.cos(yaw)], right = [Math.cos(yaw), 0, Math.sin(yaw)];
    const place = position.map((p, k) => p - 40 * ahead[k] + 85 * right[k] + (k === 1 ? 75 : 0));
    const way = position.map((p, k) => p + 75 * ahead[k] - place[k]);
    return { position: place, yaw: Math.atan2(way[0], -way[2]), pitch: Math.atan2(way[1], Math.hypot(way[0], way[2])) };
}

/** Between two poses, at `part` from 0 to 1; turns the shorter way. */
export function between(a, b, part) {
    const smooth = part * part * (3 - 2 * part), mix = (x, y) => x + smooth * (y - x), turn = b.yaw - a.yaw;
    return { position: a.position.map((x, k) => mix(x, b.position[k])), pitch: mix(a.pitch, b.pitch),
        yaw: a.yaw + smooth * (turn - 2 * Math.PI * Math.round(turn / (2 * Math.PI))) };
}

/** Where the flight along a closed path is after `seconds`; it rounds the path's corners. */
export function tour(path, seconds) {
    const round = 14, legs = path.map((from, i) => {
        const to = path[(i + 1) % path.length], length = Math.hypot(to[0] - from[0], to[2] - from[2]);
        return { from, length, way: [(to[0] - from[0]) / length, (to[2] - from[2]) / length] };
    });
    let along = 9 * seconds % legs.reduce((sum, { length }) => sum + length, 0), i = 0;
    while (along > legs[i].length) along -= legs[i++].length;
    const { from, length, way } = legs[i], next = legs[(i + 1) % legs.length], last = legs[(i + legs.length - 1) % legs.length];
    const onLeg = (leg, far) => [leg.from[0] + far * leg.way[0], leg.from[2] + far * leg.way[1]];
    let place = onLeg(legs[i], along), ahead = way;
    const bend = (before, after, corner, part) => {
        const begin = onLeg(before, before.length - round), end = onLeg(after, round), rest = 1 - part;
        place = [0, 1].map((k) => rest * rest * begin[k] + 2 * part * rest * corner[2 * k] + part * part * end[k]);
        ahead = [0, 1].map((k) => rest * before.way[k] + part * after.way[k]);
    };
    if (along > length - round) bend(legs[i], next, next.from, (along - length + round) / (2 * round));
    else if (along < round) bend(last, legs[i], from, (along + round) / (2 * round));
    return { position: [place[0], 6.5 + 1.5 * Math.sin(seconds / 4), place[1]], yaw: Math.atan2(ahead[0], -ahead[1]), pitch: -0.06 };
}
