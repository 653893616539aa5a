// SPDX-License-Identifier: MIT
// The page: a flight through the town, its switches, and what the address says:
//   #at=x,y,z,yaw,pitch  stand there      #frozen=x,y,z,yaw,pitch  the camera that culls stands there
//   #occlusion=0         draw what is hidden too
//   #all                 draw the whole town
import { load } from 'crofton';
import { readTown } from './town.js';
import { Culling, VERDICTS } from './culling.js';
import { besideOf, between, cameraOf, edgesOf, matrixOf, tour } from './camera.js';
import { COLOURS, Drawing } from './draw.js';
import { TownMap } from './map.js';

const element = (id) => document.getElementById(id);
const address = new URLSearchParams(location.hash.slice(1));
const poseOf = (text) => {
    const numbers = text?.split(',').map(Number) ?? [];
    if (numbers.length !== 5 || !numbers.every(Number.isFinite)) return null;
    return { position: numbers.slice(0, 3), yaw: numbers[3], pitch: numbers[4] };
};

// The flight stops once for a demonstration, seconds: the frustum freezes, the viewer turns aside, looks and comes back.
const DEMONSTRATION = { begins: 6, aside: 3, looks: 9, back: 2.5 };
const STORY = {
    flying: 'Only the triangles that show in this picture are drawn. None that shows is missing.',
    frozen: 'Seen from outside: green was drawn, red is hidden behind it and left out, grey is outside the view.',
};
const OWN = [0, 0, 0, 0], TINTS = COLOURS.map((rgb, verdict) => [...rgb, verdict === 0 ? 0.85 : 0.75]);

class Page {
    constructor(gl, culling, town) {
        Object.assign(this, { gl, culling, town, drawing: new Drawing(gl, town, culling), map: new TownMap(element('map'), town),
            keys: new Set(), seconds: 0, isExact: gl.getParameter(gl.SUBPIXEL_BITS) >= 8 });
        this.pose = poseOf(address.get('at'));
        this.flying = !this.pose;
        this.pose ??= tour(town.flight, 0);
        this.frozen = poseOf(address.get('frozen'));
        this.demonstrates = this.flying && !this.frozen;
        this.occlusion = address.get('occlusion') !== '0';
        this.all = address.has('all');
    }

    connect() {
        const { canvas } = this.gl;
        element('occlusion').checked = this.occlusion;
        element('occlusion').onchange = (event) => { this.occlusion = event.target.checked; };
        element('freeze').checked = Boolean(this.frozen);
        element('freeze').onchange = (event) => this.userFreezes(event.target.checked);
        element('fly').checked = this.flying;
        element('more').open = !matchMedia('(max-width: 600px)').matches;
        element('fly').onchange = (event) => {
            this.endDemonstration();
            this.flying = event.target.checked;
        };
        const fingers = new Map(), apart = () => { const [a, b] = fingers.values(); return Math.hypot(a.x - b.x, a.y - b.y); };
        canvas.onpointerdown = (event) => {
            canvas.setPointerCapture(event.pointerId);
            fingers.set(event.pointerId, { x: event.clientX, y: event.clientY });
        };
        canvas.onpointerup = canvas.onpointercancel = (event) => fingers.delete(event.pointerId);
        canvas.onpointermove = (event) => {
            const last = fingers.get(event.pointerId), before = fingers.size === 2 ? apart() : 0;
            if (!last) return;
            const [x, y] = [event.clientX - last.x, event.clientY - last.y];
            Object.assign(last, { x: event.clientX, y: event.clientY });
            if (fingers.size === 2) this.step((apart() - before) / 8);
            else this.turn(x / 300, -y / 300);
        };
        canvas.onwheel = (event) => this.step(-event.deltaY / 40);
        onkeydown = (event) => {
            if (event.ctrlKey || event.metaKey) return;
            if (event.key === 'f') this.userFreezes(!this.frozen);
            else this.keys.add(event.key.toLowerCase());
        };
        onkeyup = (event) => this.keys.delete(event.key.toLowerCase());
        onblur = () => this.keys.clear();
    }
    stopFlying() {
        this.endDemonstration();
        this.flying = element('fly').checked = false;
    }
    endDemonstration() {
        this.demonstrates = false;
        this.shown = undefined;
    }
    userFreezes(on) {
        this.endDemonstration();
        this.freeze(on);
    }
    freeze(on) {
        this.frozen = on ? structuredClone(this.pose) : null;
        element('freeze').checked = on;
    }
    turn(yaw, pitch) {
        this.stopFlying();
        const from = this.pose;
        this.pose = { ...from, yaw: from.yaw + yaw, pitch: Math.max(-1.5, Math.min(1.5, from.pitch + pitch)) };
    }
    /** Ahead, where the viewer looks. */
    step(metres) {
        const { yaw, pitch, position } = this.pose;
        this.go([Math.sin(yaw) * Math.cos(pitch), Math.sin(pitch), -Math.cos(yaw) * Math.cos(pitch)], metres);
    }
    go(way, metres) {
        this.stopFlying();
        this.pose = { ...this.pose, position: this.pose.position.map((p, k) => k === 1 ? Math.max(0.5, p + metres * way[k]) : p + metres * way[k]) };
    }
    walk(seconds) {
        const held = (...names) => names.some((name) => this.keys.has(name)) ? 1 : 0;
        const ahead = held('w', 'arrowup') - held('s', 'arrowdown'), aside = held('d', 'arrowright') - held('a', 'arrowleft');
        const rise = held('e') - held('q');
        if (!ahead && !aside && !rise) return;
        const { yaw, pitch } = this.pose;
        this.go([ahead * Math.sin(yaw) * Math.cos(pitch) + aside * Math.cos(yaw), ahead * Math.sin(pitch) + rise,
            -ahead * Math.cos(yaw) * Math.cos(pitch) + aside * Math.sin(yaw)], seconds * (held('shift') ? 60 : 12));
    }
    fly(seconds) {
        const { begins, aside, looks, back } = DEMONSTRATION;
        if (!this.demonstrates || (this.shown === undefined && this.seconds < begins)) {
            this.pose = tour(this.town.flight, this.seconds += seconds);
            return;
        }
        if (this.shown === undefined) {
            this.shown = 0;
            this.freeze(true);
        }
        const time = this.shown += seconds, away = Math.min(1, time / aside, Math.max(0, (aside + looks + back - time) / back));
        this.pose = between(this.frozen, besideOf(this.frozen), away);
        if (away > 0 || time < aside) return;
        this.freeze(false);
        this.endDemonstration();
    }

    frame(seconds) {
        const { gl } = this, { canvas } = gl, scale = Math.min(devicePixelRatio, 1.5);
        const [width, height] = [Math.max(1, canvas.clientWidth * scale | 0), Math.max(1, canvas.clientHeight * scale | 0)];
        if (canvas.width !== width || canvas.height !== height) [canvas.width, canvas.height] = [width, height];
        this.walk(seconds);  // a key ends the flight
        if (this.flying) this.fly(seconds);
        const viewer = cameraOf(this.pose, width / height), camera = this.frozen ? cameraOf(this.frozen, width / height) : viewer;
        const key = JSON.stringify([camera, width, height, this.occlusion, Boolean(this.frozen), this.all]), changed = key !== this.key;
        if (changed) this.cull(camera, { width, height });
        this.key = key;
        this.drawing.frame(this.parts, changed, matrixOf(viewer), viewer.position, this.frozen && edgesOf(camera, 160));
        this.map.draw(this.culling.verdicts, camera, viewer.position);
        if (changed) this.show();
        this.answer = { objects: this.objects, triangles: this.triangles, camera };
    }
    /** Says what is drawn, and counts the objects and triangles of each verdict. */
    cull(camera, picture) {
        const { culling, drawing, frozen } = this, ms = culling.run(camera, picture, this.occlusion), { words } = culling;
        this.mean = this.mean === undefined ? ms : 0.9 * this.mean + 0.1 * ms;
        const drawn = drawing.listed(words, culling);
        this.parts = [{ from: 0, to: drawn, tint: frozen ? TINTS[1] : OWN }];
        if (this.all) {  // in the order in which a renderer without culling draws
            drawing.scratch.set(drawing.all);
            this.parts = [{ from: 0, to: drawing.all.length, tint: OWN }];
        } else if (frozen) {
            const hidden = drawing.unlisted(words, culling, 2, drawn), outside = drawing.unlisted(words, culling, 0, hidden);
            this.parts.push({ from: drawn, to: hidden, tint: TINTS[2] }, { from: hidden, to: outside, tint: TINTS[0] });
        }
        this.objects = [0, 0, 0];
        const corners = [0, drawn, -drawn];
        culling.verdicts.forEach((verdict, i) => {
            ++this.objects[verdict];
            corners[verdict === 0 ? 0 : 2] += drawing.first[i + 1] - drawing.first[i];
        });
        this.triangles = corners.map((count) => count / 3);
    }
    show() {
        const say = (count) => count.toLocaleString('en');
        VERDICTS.forEach((name, verdict) => {
            element(`${name}-objects`).textContent = say(this.objects[verdict]);
            element(`${name}-triangles`).textContent = say(this.triangles[verdict]);
        });
        element('story').textContent = this.frozen ? STORY.frozen : STORY.flying;
        element('time').textContent = `${(100 * this.triangles[1] / this.drawing.triangles).toFixed(1)} % of the town is drawn${
            this.occlusion && this.isExact ? ', and the picture is the same to the pixel' : ''}. Found in ${this.mean.toFixed(1)} ms.`;
    }
}

function say(text) {
    element('message').textContent = text;
    element('message').hidden = false;
    document.documentElement.dataset.state = 'refused';
}

/** A script that gives bytes, compressed: a file may not fetch others, but may run them. */
async function bytesFromScript(name) {
    await new Promise((done, failed) => {
        const script = document.createElement('script');
        script.src = `${name}.js`;
        script.onload = done;
        script.onerror = () => failed(new Error(`${name}.js is missing beside this page`));
        document.head.append(script);
    });
    const packed = Uint8Array.from(atob(globalThis.croftonBytes[name]), (c) => c.charCodeAt(0));
    return new Uint8Array(await new Response(new Blob([packed]).stream().pipeThrough(new DecompressionStream('deflate'))).arrayBuffer());
}

async function start() {
    if (typeof WebAssembly !== 'object')
        return say('This browser has no WebAssembly, or it is switched off. The page needs it for culling; the guides work without.');
    const gl = element('view').getContext('webgl2', { antialias: false, preserveDrawingBuffer: true });
    if (!gl) return say('This browser gives no WebGL 2 here. The page needs it for drawing; the guides work without.');
    element('view').addEventListener('webglcontextlost', () => say('The graphics driver stopped WebGL. Load the page again.'));
    const [wasmBinary, bytes] = await Promise.all(['simd.wasm', 'town'].map(bytesFromScript));
    const crofton = await load({ wasmBinary }), town = readTown(bytes), page = new Page(gl, new Culling(crofton, town), town);
    page.connect();
    VERDICTS.forEach((name, verdict) => {
        element(name).style.setProperty('--tint', `rgb(${COLOURS[verdict].map((c) => Math.round(255 * c))})`);
    });
    element('build').textContent = `Crofton ${crofton.version}`;
    let last;
    const next = (now) => {
        page.frame(Math.min(0.1, (now - (last ?? now)) / 1000));
        if (last === undefined) {
            document.documentElement.dataset.state = 'ready';
            document.documentElement.dataset.ready = Math.round(performance.now());
        }
        last = now;
        requestAnimationFrame(next);
    };
    globalThis.croftonPage = page;
    requestAnimationFrame(next);
}

start().catch((error) => say(`The page could not start: ${error?.message ?? error}`));
