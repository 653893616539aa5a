// SPDX-License-Identifier: MIT
// Draws the town in WebGL2: instances of each mesh with the colours of their verdicts, the ground and a frustum's edges.
import { MESHES } from './town.js';

/** Red, green and blue of a verdict, from 0 to 1. */
export const COLOURS = [[0.42, 0.46, 0.52], [0.98, 0.70, 0.20], [0.25, 0.72, 0.48], [0.86, 0.27, 0.33]];
const SKY = [0.66, 0.78, 0.90];

const VERTEX = `#version 300 es
layout(location=0) in vec3 local; layout(location=1) in vec3 origin; layout(location=2) in vec2 turn; layout(location=3) in vec3 tint;
uniform mat4 toClip; out vec3 place; out vec3 colour;
void main() {
    place = origin + vec3(turn.x*local.x + turn.y*local.z, local.y, turn.x*local.z - turn.y*local.x);
    colour = tint;
    gl_Position = toClip * vec4(place, 1.0);
}`;
const FRAGMENT = `#version 300 es
precision highp float;
in vec3 place; in vec3 colour; uniform vec3 eye; uniform float flatness; out vec4 pixel;
void main() {
    vec3 n = normalize(cross(dFdx(place), dFdy(place)));
    float light = mix(0.62 + 0.25*n.y + 0.2*dot(n, vec3(0.6, 0.0, 0.8)), 1.0, flatness);
    float mist = flatness > 0.5 ? 0.0 : 1.0 - exp(-distance(place, eye) / 1400.0);
    pixel = vec4(mix(colour*light, vec3(${SKY}), mist), 1.0);
}`;
const INSTANCE = 8;

function compile(gl) {
    const program = gl.createProgram();
    for (const [kind, text] of [[gl.VERTEX_SHADER, VERTEX], [gl.FRAGMENT_SHADER, FRAGMENT]]) {
        const shader = gl.createShader(kind);
        gl.shaderSource(shader, text);
        gl.compileShader(shader);
        gl.attachShader(program, shader);
    }
    gl.linkProgram(program);
    if (!gl.getProgramParameter(program, gl.LINK_STATUS)) throw new Error(`WebGL: ${gl.getProgramInfoLog(program)}`);
    return program;
}

export class Drawing {
    #gl; #program; #meshes; #instances; #line; #lineVao;

    constructor(gl, objects) {
        this.#gl = gl;
        this.#program = compile(gl);
        const ground = { positions: Float32Array.from([-3000, 0, 3000, 3000, 0, 3000, 3000, 0, -3000, -3000, 0, -3000]),
            indices: Uint32Array.from([0, 1, 2, 0, 2, 3]) };
        const counts = MESHES.map((_, m) => objects.filter(({ mesh }) => mesh === m).length);
        this.#meshes = [...MESHES, ground].map((mesh, m) => this.#makeMesh(mesh, counts[m] ?? 1));
        this.#line = gl.createBuffer();
        this.#lineVao = gl.createVertexArray();
        gl.bindVertexArray(this.#lineVao);
        gl.bindBuffer(gl.ARRAY_BUFFER, this.#line);
        gl.enableVertexAttribArray(0);
        gl.vertexAttribPointer(0, 3, gl.FLOAT, false, 12, 0);
    }

    #makeMesh({ positions, indices }, most) {
        const gl = this.#gl, vao = gl.createVertexArray(), buffer = gl.createBuffer();
        gl.bindVertexArray(vao);
        gl.bindBuffer(gl.ARRAY_BUFFER, gl.createBuffer());
        gl.bufferData(gl.ARRAY_BUFFER, positions, gl.STATIC_DRAW);
        gl.enableVertexAttribArray(0);
        gl.vertexAttribPointer(0, 3, gl.FLOAT, false, 12, 0);
        gl.bindBuffer(gl.ELEMENT_ARRAY_BUFFER, gl.createBuffer());
        gl.bufferData(gl.ELEMENT_ARRAY_BUFFER, indices, gl.STATIC_DRAW);
        gl.bindBuffer(gl.ARRAY_BUFFER, buffer);
        for (const [place, size, at] of [[1, 3, 0], [2, 2, 3], [3, 3, 5]]) {
            gl.enableVertexAttribArray(place);
            gl.vertexAttribPointer(place, size, gl.FLOAT, false, 4 * INSTANCE, 4 * at);
            gl.vertexAttribDivisor(place, 1);
        }
        return { vao, buffer, corners: indices.length, data: new Float32Array(INSTANCE * most), count: 0 };
    }

    /** The objects whose verdict `shown` accepts; `edges`: lines of a frustum, or null. Gives how many were drawn. */
    frame(objects, verdicts, shown, matrix, eye, edges) {
        const gl = this.#gl, meshes = this.#meshes, ground = meshes.at(-1);
        for (const mesh of meshes) mesh.count = 0;
        let drawn = 0;
        objects.forEach((object, i) => {
            if (!shown(verdicts[i])) return;
            const mesh = meshes[object.mesh];
            mesh.data.set([...object.position, object.cos, object.sin, ...COLOURS[verdicts[i]]], INSTANCE * mesh.count++);
            ++drawn;
        });
        ground.data.set([0, 0, 0, 1, 0, 0.52, 0.55, 0.50]);
        ground.count = 1;
        gl.viewport(0, 0, gl.drawingBufferWidth, gl.drawingBufferHeight);
        gl.clearColor(...SKY, 1);
        gl.clear(gl.COLOR_BUFFER_BIT | gl.DEPTH_BUFFER_BIT);
        gl.enable(gl.DEPTH_TEST);
        gl.enable(gl.CULL_FACE);
        gl.useProgram(this.#program);
        gl.uniformMatrix4fv(gl.getUniformLocation(this.#program, 'toClip'), false, matrix);
        gl.uniform3f(gl.getUniformLocation(this.#program, 'eye'), ...eye);
        gl.uniform1f(gl.getUniformLocation(this.#program, 'flatness'), 0);
        for (const { vao, buffer, corners, data, count } of meshes) {
            if (!count) continue;
            gl.bindVertexArray(vao);
            gl.bindBuffer(gl.ARRAY_BUFFER, buffer);
            gl.bufferData(gl.ARRAY_BUFFER, data.subarray(0, INSTANCE * count), gl.DYNAMIC_DRAW);
            gl.drawElementsInstanced(gl.TRIANGLES, corners, gl.UNSIGNED_INT, 0, count);
        }
        if (edges) this.#lines(edges);
        return drawn;
    }

    #lines(edges) {
        const gl = this.#gl;
        gl.uniform1f(gl.getUniformLocation(this.#program, 'flatness'), 1);
        gl.bindVertexArray(this.#lineVao);
        gl.bindBuffer(gl.ARRAY_BUFFER, this.#line);
        gl.bufferData(gl.ARRAY_BUFFER, edges, gl.DYNAMIC_DRAW);
        gl.vertexAttrib3f(1, 0, 0, 0);
        gl.vertexAttrib2f(2, 1, 0);
        gl.vertexAttrib3f(3, 0.1, 0.15, 0.45);
        gl.drawArrays(gl.LINES, 0, edges.length / 3);
    }
}
