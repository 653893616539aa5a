// SPDX-License-Identifier: MIT
// Draws the town in WebGL2: all vertices lie in one buffer, and a buffer of indices says which triangles are drawn.

/** Red, green and blue of a verdict, from 0 to 1. */
export const COLOURS = [[0.62, 0.66, 0.72], [0.16, 0.70, 0.40], [0.88, 0.22, 0.25]];
const SKY = [0.62, 0.77, 0.92], SUN = [0.48, 0.72, 0.50], SHADOWS = 2048;

const VERTEX = `#version 300 es
layout(location=0) in vec3 position; layout(location=1) in vec4 paint;
uniform mat4 toClip, toSun; out vec3 place; out vec3 colour; out vec3 shade;
void main() {
    place = position;
    colour = paint.rgb * paint.rgb;
    shade = (toSun * vec4(position, 1.0)).xyz * 0.5 + 0.5;
    gl_Position = toClip * vec4(position, 1.0);
}`;
// Colours are held as their square roots. A tint keeps the light and a part of the colour; of the grey one only the light stays.
const FRAGMENT = `#version 300 es
precision highp float; precision highp sampler2DShadow;
in vec3 place; in vec3 colour; in vec3 shade; uniform vec3 eye; uniform vec4 tint; uniform sampler2DShadow shadows; out vec4 pixel;
void main() {
    vec3 sun = normalize(vec3(${SUN})), n = normalize(cross(dFdx(place), dFdy(place)));
    float facing = dot(n, sun), lit = 0.0;
    vec3 at = shade - vec3(0.0, 0.0, 0.0012);
    for (int i = 0; i < 4; ++i)
        lit += 0.25 * texture(shadows, at + vec3(float(i & 1) - 0.5, float(i >> 1) - 0.5, 0.0) / ${SHADOWS}.0);
    vec3 light = vec3(0.34, 0.40, 0.50) * (0.7 + 0.3 * n.y) + vec3(0.16, 0.13, 0.10) * max(0.0, -facing)
        + vec3(1.0, 0.93, 0.80) * max(0.0, facing) * lit;
    vec3 own = mix(colour, tint.rgb * tint.rgb * (0.55 + 0.6 * dot(colour, vec3(0.3, 0.6, 0.1))), tint.a);
    vec3 seen = mix(own * light, vec3(${SKY}) * vec3(${SKY}), 1.0 - exp(-distance(place, eye) / 1500.0));
    pixel = vec4(sqrt(seen), 1.0);
}`;
const LINE_VERTEX = `#version 300 es
layout(location=0) in vec3 position; uniform mat4 toClip;
void main() { gl_Position = toClip * vec4(position, 1.0); }`;
const LINE_FRAGMENT = `#version 300 es
precision mediump float; out vec4 pixel;
void main() { pixel = vec4(0.05, 0.10, 0.40, 1.0); }`;

function compile(gl, ...texts) {
    const program = gl.createProgram();
    [gl.VERTEX_SHADER, gl.FRAGMENT_SHADER].forEach((kind, i) => {
        const shader = gl.createShader(kind);
        gl.shaderSource(shader, texts[i]);
        gl.compileShader(shader);
        gl.attachShader(program, shader);
    });
    gl.linkProgram(program);
    if (!gl.getProgramParameter(program, gl.LINK_STATUS)) throw new Error(`WebGL: ${gl.getProgramInfoLog(program)}`);
    return program;
}

/** Looks along the sun at a disc of `reach` metres around the town's middle. By columns, to clip space. */
function sunMatrix(reach) {
    const length = Math.hypot(...SUN), [x, y, z] = SUN.map((c) => c / length), flat = Math.hypot(x, z);
    const right = [z / flat, 0, -x / flat], up = [-x * y / flat, flat, -z * y / flat];
    const columns = [0, 1, 2].flatMap((k) => [right[k] / reach, up[k] / reach, -[x, y, z][k] / reach, 0]);
    return Float32Array.from([...columns, 0, 0, 0, 1]);
}

export class Drawing {
    #gl; #program; #lines; #vao; #indices; #line; #lineVao; #shadow; #toSun; #room = 0;

    /** `culling` says in which order a mesh's triangles are drawn. */
    constructor(gl, town, culling) {
        this.#gl = gl;
        this.#program = compile(gl, VERTEX, FRAGMENT);
        this.#lines = compile(gl, LINE_VERTEX, LINE_FRAGMENT);
        this.#place(town, culling);
        this.#line = gl.createBuffer();
        this.#lineVao = gl.createVertexArray();
        gl.bindVertexArray(this.#lineVao);
        gl.bindBuffer(gl.ARRAY_BUFFER, this.#line);
        gl.enableVertexAttribArray(0);
        gl.vertexAttribPointer(0, 3, gl.FLOAT, false, 12, 0);
        this.#castShadows();
    }

    /** Places all objects: four words a vertex. `all` has the corners of all triangles, an object's from `first[object]` on. */
    #place({ meshes, objects }, culling) {
        const gl = this.#gl, vertices = objects.reduce((sum, { mesh }) => sum + meshes[mesh].positions.length / 3, 0);
        this.first = new Uint32Array(objects.length + 1);
        objects.forEach(({ mesh }, i) => { this.first[i + 1] = this.first[i] + meshes[mesh].indices.length; });
        this.all = new Uint32Array(this.first[objects.length]);
        const floats = new Float32Array(4 * vertices), bytes = new Uint8Array(floats.buffer);
        const orders = meshes.map(() => null);
        let vertex = 0;
        objects.forEach(({ mesh, matrix: m }, i) => {
            const { positions, indices, colors } = meshes[mesh], order = orders[mesh] ??= culling.clustersOf(i).triangleOrder;
            for (let t = 0, to = this.first[i]; t < order.length; ++t, to += 3)
                for (let k = 0; k < 3; ++k) this.all[to + k] = vertex + indices[3 * order[t] + k];
            for (let v = 0; v < positions.length; v += 3, ++vertex) {
                const x = positions[v], y = positions[v + 1], z = positions[v + 2], at = 4 * vertex;
                floats[at] = m[0] * x + m[4] * y + m[8] * z + m[12];
                floats[at + 1] = m[1] * x + m[5] * y + m[9] * z + m[13];
                floats[at + 2] = m[2] * x + m[6] * y + m[10] * z + m[14];
                bytes[4 * at + 12] = colors[v], bytes[4 * at + 13] = colors[v + 1], bytes[4 * at + 14] = colors[v + 2];
            }
        });
        this.triangles = this.all.length / 3;
        this.#vao = gl.createVertexArray();
        gl.bindVertexArray(this.#vao);
        gl.bindBuffer(gl.ARRAY_BUFFER, gl.createBuffer());
        gl.bufferData(gl.ARRAY_BUFFER, floats, gl.STATIC_DRAW);
        gl.enableVertexAttribArray(0);
        gl.vertexAttribPointer(0, 3, gl.FLOAT, false, 16, 0);
        gl.enableVertexAttribArray(1);
        gl.vertexAttribPointer(1, 4, gl.UNSIGNED_BYTE, true, 16, 12);
        this.#indices = gl.createBuffer();
        gl.bindBuffer(gl.ELEMENT_ARRAY_BUFFER, this.#indices);
        this.scratch = new Uint32Array(this.all.length);
    }

    /** The sun's shadow map, once: neither it nor the town moves. */
    #castShadows() {
        const gl = this.#gl;
        this.#toSun = sunMatrix(440);
        this.#shadow = gl.createTexture();
        gl.bindTexture(gl.TEXTURE_2D, this.#shadow);
        gl.texStorage2D(gl.TEXTURE_2D, 1, gl.DEPTH_COMPONENT24, SHADOWS, SHADOWS);
        for (const [name, value] of [[gl.TEXTURE_COMPARE_MODE, gl.COMPARE_REF_TO_TEXTURE], [gl.TEXTURE_MIN_FILTER, gl.LINEAR],
            [gl.TEXTURE_MAG_FILTER, gl.LINEAR], [gl.TEXTURE_WRAP_S, gl.CLAMP_TO_EDGE], [gl.TEXTURE_WRAP_T, gl.CLAMP_TO_EDGE]])
            gl.texParameteri(gl.TEXTURE_2D, name, value);
        const target = gl.createFramebuffer();
        gl.bindFramebuffer(gl.FRAMEBUFFER, target);
        gl.framebufferTexture2D(gl.FRAMEBUFFER, gl.DEPTH_ATTACHMENT, gl.TEXTURE_2D, this.#shadow, 0);
        gl.viewport(0, 0, SHADOWS, SHADOWS);
        gl.clear(gl.DEPTH_BUFFER_BIT);
        gl.enable(gl.DEPTH_TEST);
        gl.useProgram(this.#lines);
        gl.uniformMatrix4fv(gl.getUniformLocation(this.#lines, 'toClip'), false, this.#toSun);
        gl.bindVertexArray(this.#vao);
        gl.bufferData(gl.ELEMENT_ARRAY_BUFFER, this.all, gl.DYNAMIC_DRAW);
        gl.drawElements(gl.TRIANGLES, this.all.length, gl.UNSIGNED_INT, 0);
        gl.bindFramebuffer(gl.FRAMEBUFFER, null);
        gl.deleteFramebuffer(target);
    }

    /** Copies the corners of the listed triangles to `scratch` from `to` on; returns where they end. */
    listed(words, culling, to = 0) {
        const { all, scratch, first } = this;
        for (let i = 0; i < words.length; i += 4) {
            const object = words[i], { firstTriangle, triangleCount } = culling.clustersOf(object).clusters[words[i + 1]];
            const from = first[object] + 3 * firstTriangle;
            for (let t = 0, corner = from; t < triangleCount; ++t, corner += 3)
                if (words[i + 2 + (t >> 5)] >>> (t & 31) & 1) {
                    scratch[to] = all[corner], scratch[to + 1] = all[corner + 1], scratch[to + 2] = all[corner + 2];
                    to += 3;
                }
        }
        return to;
    }
    /** The same for those that are not listed, of objects with that verdict. */
    unlisted(words, culling, verdict, to) {
        const { all, scratch, first } = this, { verdicts } = culling;
        for (let object = 0, i = 0; object < verdicts.length; ++object) {
            const begin = i;
            while (i < words.length && words[i] === object) i += 4;
            if ((verdicts[object] === 0) !== (verdict === 0)) continue;
            if (begin === i) {
                scratch.set(all.subarray(first[object], first[object + 1]), to);
                to += first[object + 1] - first[object];
                continue;
            }
            let next = begin;
            culling.clustersOf(object).clusters.forEach(({ firstTriangle, triangleCount }, cluster) => {
                const at = next < i && words[next + 1] === cluster ? next : -1, from = first[object] + 3 * firstTriangle;
                if (at >= 0) next += 4;
                for (let t = 0; t < triangleCount; ++t)
                    if (at < 0 || !(words[at + 2 + (t >> 5)] >>> (t & 31) & 1)) {
                        scratch.set(all.subarray(from + 3 * t, from + 3 * t + 3), to);
                        to += 3;
                    }
            });
        }
        return to;
    }

    /** `parts`: `{ from, to, tint }` of the corners in `scratch`, new ones if `changed`; `edges`: lines of a frustum, or null. */
    frame(parts, changed, matrix, eye, edges) {
        const gl = this.#gl, program = this.#program, uniform = (name) => gl.getUniformLocation(program, name);
        gl.viewport(0, 0, gl.drawingBufferWidth, gl.drawingBufferHeight);
        gl.clearColor(...SKY, 1);
        gl.clear(gl.COLOR_BUFFER_BIT | gl.DEPTH_BUFFER_BIT);
        gl.enable(gl.DEPTH_TEST);
        gl.enable(gl.CULL_FACE);
        gl.enable(gl.POLYGON_OFFSET_FILL);  // docs/depth.md, requirements on the renderer
        gl.polygonOffset(1 / 256, 0);
        gl.useProgram(program);
        gl.uniformMatrix4fv(uniform('toClip'), false, matrix);
        gl.uniformMatrix4fv(uniform('toSun'), false, this.#toSun);
        gl.uniform3f(uniform('eye'), ...eye);
        gl.bindTexture(gl.TEXTURE_2D, this.#shadow);
        gl.bindVertexArray(this.#vao);
        if (changed) gl.bufferData(gl.ELEMENT_ARRAY_BUFFER, this.scratch.subarray(0, parts.at(-1).to), gl.DYNAMIC_DRAW);
        for (const { from, to, tint } of parts) {
            gl.uniform4f(uniform('tint'), ...tint);
            if (to > from) gl.drawElements(gl.TRIANGLES, to - from, gl.UNSIGNED_INT, 4 * from);
        }
        if (edges) this.#drawLines(edges, matrix);
    }
    #drawLines(edges, matrix) {
        const gl = this.#gl;
        gl.useProgram(this.#lines);
        gl.uniformMatrix4fv(gl.getUniformLocation(this.#lines, 'toClip'), false, matrix);
        gl.bindVertexArray(this.#lineVao);
        gl.bindBuffer(gl.ARRAY_BUFFER, this.#line);
        gl.bufferData(gl.ARRAY_BUFFER, edges, gl.DYNAMIC_DRAW);
        gl.drawArrays(gl.LINES, 0, edges.length / 3);
    }
}
