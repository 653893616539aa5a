// SPDX-License-Identifier: MIT
// The map: the town from above, each object in the colour of its verdict, so that what is culled is seen as well. North,
// -z, is up.
import { edgesOf } from './camera.js';
import { COLOURS } from './draw.js';
import { MESHES } from './town.js';

/** Metres from the middle of the map to its edge. */
const REACH = 980;
const GROUND = 0xffdedad6;
/** Later ones are drawn over earlier ones: what is drawn lies on top. */
const ORDER = [0, 3, 1, 2];
const WORDS = COLOURS.map((rgb) => rgb.reduce((word, c, k) => word | Math.round(255 * c) << 8 * k, 0xff000000) >>> 0);

export class TownMap {
    #context; #image; #words; #size; #places;

    constructor(canvas, objects) {
        this.#size = canvas.width;
        this.#context = canvas.getContext('2d');
        this.#image = this.#context.createImageData(this.#size, this.#size);
        this.#words = new Uint32Array(this.#image.data.buffer);
        const scale = this.at(1) - this.at(0);
        const half = MESHES.map(({ positions }) => Math.round(scale * Math.max(...positions.filter((_, i) => i % 3 === 0))));
        this.#places = objects.map(({ mesh, position: [x, , z] }) => ({ x: Math.round(this.at(x)), y: Math.round(this.at(z)),
            half: half[mesh] }));
    }

    /** Where on the map a coordinate lies, x from the left and z from the top. */
    at(metres) { return (metres / REACH + 1) * this.#size / 2; }

    /** `camera` is the one that culls, `eye` where the viewer stands. */
    draw(verdicts, camera, eye) {
        const size = this.#size, words = this.#words, context = this.#context;
        words.fill(GROUND);
        for (const verdict of ORDER)
            this.#places.forEach(({ x, y, half }, i) => {
                if (verdicts[i] !== verdict) return;
                for (let row = y - half; row <= y + half; ++row)
                    words.fill(WORDS[verdict], size * row + x - half, size * row + x + half + 1);
            });
        context.putImageData(this.#image, 0, 0);
        context.strokeStyle = 'rgb(26 38 115)';
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
