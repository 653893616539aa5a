# SPDX-License-Identifier: MIT
"""Meshes and boxes as a picture that a notebook turns: a page of its own, drawn by WebGL."""
import base64
import html
import json
import pathlib

import numpy as np

from ._crofton import Box, Mesh

MOST_TRIANGLES = 500_000
BOX_EDGES = np.array([[a, a | bit] for bit in (1, 2, 4) for a in range(8) if not a & bit])
PAGE = """<!doctype html><meta charset="utf-8"><title>Crofton</title>
<style>html,body{margin:0;height:100%;background:#f6f6f4}canvas{width:100%;height:100%;display:block;touch-action:none}
p{position:absolute;margin:.5em;font:13px sans-serif;color:#444}</style><p></p><canvas></canvas><script>
const scene = SCENE, canvas = document.querySelector('canvas'), gl = canvas.getContext('webgl');
const say = (text) => { document.querySelector('p').textContent = text; };
const floats = (text) => new Float32Array(Uint8Array.from(atob(text), (c) => c.charCodeAt(0)).buffer);
function start() {
    const program = gl.createProgram();
    for (const [kind, text] of [[gl.VERTEX_SHADER, `attribute vec3 p, n; uniform mat3 turn; uniform vec3 mid, view; varying vec3 m;
void main() { vec3 q = turn * (p - mid); m = turn * n; gl_Position = vec4(q.xy * view.xy, -q.z * view.z, 1.0); }`],
        [gl.FRAGMENT_SHADER, `precision mediump float; varying vec3 m; uniform vec4 color;
void main() { float light = color.a > 0.5 ? 1.0 : 0.35 + 0.65 * abs(normalize(m).z); gl_FragColor = vec4(color.rgb * light, 1.0); }`]]) {
        const shader = gl.createShader(kind);
        gl.shaderSource(shader, text);
        gl.compileShader(shader);
        gl.attachShader(program, shader);
    }
    gl.bindAttribLocation(program, 0, 'p');
    gl.bindAttribLocation(program, 1, 'n');
    gl.linkProgram(program);
    gl.useProgram(program);
    gl.enable(gl.DEPTH_TEST);
    const buffer = (text) => {
        const made = gl.createBuffer();
        gl.bindBuffer(gl.ARRAY_BUFFER, made);
        gl.bufferData(gl.ARRAY_BUFFER, floats(text), gl.STATIC_DRAW);
        return made;
    };
    const parts = scene.parts.map((part) => ({ ...part, p: buffer(part.points), n: part.normals && buffer(part.normals) }));
    const at = (name) => gl.getUniformLocation(program, name);
    let yaw = 0.6, pitch = 0.4, zoom = 1;
    const draw = () => {
        canvas.width = canvas.clientWidth * devicePixelRatio;
        canvas.height = canvas.clientHeight * devicePixelRatio;
        gl.viewport(0, 0, canvas.width, canvas.height);
        gl.clearColor(0.965, 0.965, 0.957, 1);
        gl.clear(gl.COLOR_BUFFER_BIT | gl.DEPTH_BUFFER_BIT);
        const [c, s, d, t] = [Math.cos(yaw), Math.sin(yaw), Math.cos(pitch), Math.sin(pitch)];
        gl.uniformMatrix3fv(at('turn'), false, [c, s * t, -s * d, 0, d, t, s, -c * t, c * d]);
        const scale = zoom / scene.radius, aspect = canvas.width / canvas.height;
        gl.uniform3f(at('mid'), ...scene.middle);
        gl.uniform3f(at('view'), scale / Math.max(aspect, 1), scale * Math.min(aspect, 1), 0.5 / scene.radius);
        for (const part of parts) {
            gl.bindBuffer(gl.ARRAY_BUFFER, part.p);
            gl.enableVertexAttribArray(0);
            gl.vertexAttribPointer(0, 3, gl.FLOAT, false, 0, 0);
            if (part.n) {
                gl.bindBuffer(gl.ARRAY_BUFFER, part.n);
                gl.enableVertexAttribArray(1);
                gl.vertexAttribPointer(1, 3, gl.FLOAT, false, 0, 0);
            } else gl.disableVertexAttribArray(1);
            gl.uniform4f(at('color'), ...part.color, part.n ? 0 : 1);
            gl.drawArrays(part.n ? gl.TRIANGLES : gl.LINES, 0, part.count);
        }
    };
    canvas.onpointerdown = (e) => canvas.setPointerCapture(e.pointerId);
    canvas.onpointermove = (e) => {
        if (!e.buttons) return;
        yaw += e.movementX * 0.01;
        pitch = Math.max(-1.57, Math.min(1.57, pitch + e.movementY * 0.01));
        draw();
    };
    canvas.addEventListener('wheel', (e) => { e.preventDefault(); zoom *= Math.exp(-e.deltaY * 0.001); draw(); }, { passive: false });
    addEventListener('resize', draw);
    say(scene.title + ': drag to turn, turn the wheel to come nearer');
    draw();
    document.title = 'drawn';
}
if (gl) start(); else say('This browser has no WebGL.');
</script>
"""
COLORS = [(0.36, 0.55, 0.75), (0.80, 0.55, 0.35), (0.45, 0.65, 0.45), (0.70, 0.45, 0.65)]


class Picture:
    """Meshes and boxes in a page of their own. A notebook shows it; `save` writes it as a file for any browser."""

    def __init__(self, things, title=""):
        """`things`: a Mesh, a Box, or a list of them, boxes as their edges. At most 500,000 triangles."""
        things = list(things) if isinstance(things, (list, tuple)) else [things]
        for thing in things:
            if not isinstance(thing, (Mesh, Box)):
                raise TypeError("things: a Mesh, a Box, or a list of them is expected")
        if not things:
            raise ValueError("things: there is nothing to show")
        triangles = sum(len(thing.indices) for thing in things if isinstance(thing, Mesh))
        if triangles > MOST_TRIANGLES:
            raise ValueError(f"things: {triangles} triangles, and a picture has at most {MOST_TRIANGLES}: show a part")
        points = np.concatenate([t.positions if isinstance(t, Mesh) else t.corners for t in things]).astype("f8")
        low, high = points.min(axis=0), points.max(axis=0)
        meshes = sum(isinstance(thing, Mesh) for thing in things)
        self.title = title or ", ".join([f"{triangles} triangles"] * (meshes > 0) + [f"{len(things) - meshes} boxes"] * (meshes < len(things)))
        self._scene = {"title": self.title, "middle": [float(x) for x in (low + high) / 2],
                       "radius": float(np.linalg.norm(high - low) / 2) or 1.0,
                       "parts": [_part(thing, COLORS[i % len(COLORS)]) for i, thing in enumerate(things)]}

    def to_html(self):
        """A page that needs nothing else."""
        # No text of the scene can end the script.
        return PAGE.replace("SCENE", json.dumps(self._scene).replace("<", "\\u003c"))

    def save(self, path):
        """Writes the page into a file."""
        pathlib.Path(path).write_text(self.to_html(), encoding="utf-8")

    def _repr_html_(self):
        return f'<iframe srcdoc="{html.escape(self.to_html())}" style="width:100%;height:420px;border:0"></iframe>'

    def __repr__(self):
        return f"Picture({self.title})"


def _part(thing, color):
    if isinstance(thing, Box):
        return {"count": 24, "color": (0.15, 0.15, 0.15), "points": _text(thing.corners[BOX_EDGES])}
    corners = thing.positions[thing.indices]
    normals = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    normals /= np.maximum(np.linalg.norm(normals, axis=1, keepdims=True), np.float32(1e-30))
    return {"count": 3 * len(corners), "color": color, "points": _text(corners),
            "normals": _text(np.repeat(normals, 3, axis=0))}


def _text(numbers):
    return base64.b64encode(np.ascontiguousarray(numbers, dtype="<f4").tobytes()).decode()
