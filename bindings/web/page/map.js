// SPDX-License-Identifier: MIT
// The map: the town from above, each object in the colour of its verdict. North, -z, is up.
import { edgesOf } from './camera.js';
import { COLOURS } from './draw.js';

const GROUND = 0xffe4e0dc;
/** Later ones are drawn over earlier ones. */
const ORDER = [0, 2, 1];
const WORDS = COLOURS.map((rgb) => rgb.reduce((word, c, k) => word | Math.round(255 * c) << 8 * k, 0xff000000) >>> 0);

/** Low and high corner of an object's mesh in the world. */
function boundOf(positions, m) {
    const low = [Infinity, Infinity, Infinity], high = [-Infinity, -Infinity, -Infinity];
    for (let v = 0; v < positions.length; v += 3)
        for (let k = 0; k < 3; ++k) {
            const c = m[k] * positions[v] + m[4 + k] * positions[v + 1] + m[8 + k] * positions[v + 2] + m[12 + k];
            low[k] = Math.min(low[k], c);
            high[k] = Math.max(high[k], c);
        }
    return [low, high];
}

export class TownMap {
    #context; #image; #words; #size; #places;

    /** `reach`: metres from the middle of the map to its edge. */
    constructor(canvas, { meshes, objects }, reach = 190) {
        this.#size = canvas.width;
        this.reach = reach;
        this.#context = canvas.getContext('2d');
        this.#image = this.#context.createImageData(this.#size, this.#size);
        this.#words = new Uint32Array(this.#image.data.buffer);
        // The ground is not drawn: it is everywhere, and under everything.
        this.#places = [];
        objects.forEach(({ mesh, matrix }, i) => {
            const [low, high] = boundOf(meshes[mesh].positions, matrix);
            if (high[1] - low[1] < 0.5) return;
            const [x0, y0, x1, y1] = [low[0], low[2], high[0], high[2]].map((c) => Math.max(0, Math.min(this.#size - 1, Math.round(this.at(c)))));
            if (x1 - x0 < this.#size / 8 && y1 - y0 < this.#size / 8 && x1 > x0 && y1 > y0) this.#places.push({ i, x0, y0, x1, y1 });
        });
    }

    /** Where on the map a coordinate lies, x from the left and z from the top. */
    at(metres) { return (metres / this.reach + 1) * this.#size / 2; }

    /** `camera` is the one that culls, `eye` where the viewer stands. */
    draw(verdicts, camera, eye) {
        const size = this.#size, words = this.#words, context = this.#context;
        words.fill(GROUND);
        for (const verdict of ORDER)
            for (const { i, x0, y0, x1, y1 } of this.#places)
                if (verdicts[i] === verdict)
                    for (let row = y0; row <= y1; ++row) words.fill(WORDS[verdict], size * row + x0, size * row + x1 + 1);
        context.putImageData(this.#image, 0, 0);
        context.strokeStyle = 'rgb(26 38 115)';
        context.lineWidth = 1.5;
        context.beginPath();
        const edges = edgesOf(camera, camera.far);
        for (let i = 0; i < edges.length; i += 6) {
            context.moveTo(this.at(edges[i]), this.at(edges[i + 2]));
            context.lineTo(this.at(edges[i + 3]), this.at(edges[i + 5]));
        }
        context.stroke();
        context.fillStyle = '#000';
        context.beginPath();
        context.arc(this.at(eye[0]), this.at(eye[2]), 4, 0, 2 * Math.PI);
        context.fill();
    }
}
