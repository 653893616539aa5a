// SPDX-License-Identifier: MIT
// The page: a flight through the town, its switches, and what the address says:
//   #at=x,y,z,yaw,pitch  stand there      #frozen=x,y,z,yaw,pitch  the camera that culls stands there
//   #criterion=volume    #occlusion=0
//   #all  draw what is culled too        #plainly  edges are not smoothed
import { load } from 'crofton';
import { makeTown } from './town.js';
import { CRITERIA, Culling, VERDICTS } from './culling.js';
import { cameraOf, edgesOf, matrixOf, tour } from './camera.js';
import { COLOURS, Drawing } from './draw.js';
import { TownMap } from './map.js';

const element = (id) => document.getElementById(id);
const address = new URLSearchParams(location.hash.slice(1));
const poseOf = (text) => {
    const numbers = text?.split(',').map(Number) ?? [];
    if (numbers.length !== 5 || !numbers.every(Number.isFinite)) return null;
    return { position: numbers.slice(0, 3), yaw: numbers[3], pitch: numbers[4] };
};

class Page {
    constructor(gl, culling, objects) {
        Object.assign(this, { gl, culling, objects, drawing: new Drawing(gl, objects), map: new TownMap(element('map'), objects),
            keys: new Set(), seconds: 0 });
        this.pose = poseOf(address.get('at'));
        this.flying = !this.pose;
        this.pose ??= tour(0);
        this.frozen = poseOf(address.get('frozen'));
        this.occlusion = address.get('occlusion') !== '0';
        this.all = address.has('all');
        if (address.get('criterion') in CRITERIA) culling.setCriterion(address.get('criterion'));
    }

    connect() {
        const { canvas } = this.gl;
        for (const [name, { says }] of Object.entries(CRITERIA)) element('criterion').append(new Option(says, name));
        element('criterion').value = this.culling.criterion;
        element('criterion').onchange = (event) => this.culling.setCriterion(event.target.value);
        element('occlusion').checked = this.occlusion;
        element('occlusion').onchange = (event) => { this.occlusion = event.target.checked; };
        element('freeze').checked = Boolean(this.frozen);
        element('freeze').onchange = (event) => this.freeze(event.target.checked);
        element('fly').checked = this.flying;
        element('fly').onchange = (event) => { this.flying = event.target.checked; };
        canvas.onpointerdown = (event) => canvas.setPointerCapture(event.pointerId);
        canvas.onpointermove = (event) => { if (event.buttons) this.turn(event.movementX / 300, -event.movementY / 300); };
        onkeydown = (event) => {
            if (event.target.tagName === 'SELECT' || event.ctrlKey || event.metaKey) return;
            if (event.key === 'f') this.freeze(!this.frozen);
            else this.keys.add(event.key.toLowerCase());
        };
        onkeyup = (event) => this.keys.delete(event.key.toLowerCase());
        onblur = () => this.keys.clear();
    }
    stopFlying() { this.flying = element('fly').checked = false; }
    freeze(on) {
        this.frozen = on ? structuredClone(this.pose) : null;
        element('freeze').checked = on;
    }
    turn(yaw, pitch) {
        this.stopFlying();
        const from = this.pose;
        this.pose = { ...from, yaw: from.yaw + yaw, pitch: Math.max(-1.5, Math.min(1.5, from.pitch + pitch)) };
    }
    walk(seconds) {
        const held = (...names) => names.some((name) => this.keys.has(name)) ? 1 : 0;
        const ahead = held('w', 'arrowup') - held('s', 'arrowdown'), aside = held('d', 'arrowright') - held('a', 'arrowleft');
        const rise = held('e') - held('q');
        if (!ahead && !aside && !rise) return;
        this.stopFlying();
        const { yaw, pitch, position } = this.pose, step = seconds * (held('shift') ? 150 : 40);
        const way = [ahead * Math.sin(yaw) * Math.cos(pitch) + aside * Math.cos(yaw), ahead * Math.sin(pitch) + rise,
            -ahead * Math.cos(yaw) * Math.cos(pitch) + aside * Math.sin(yaw)];
        this.pose = { yaw, pitch, position: position.map((p, k) => k === 1 ? Math.max(0.5, p + step * way[k]) : p + step * way[k]) };
    }

    frame(seconds) {
        const { gl } = this, { canvas } = gl, scale = Math.min(devicePixelRatio, 1.5);
        const [width, height] = [Math.max(1, canvas.clientWidth * scale | 0), Math.max(1, canvas.clientHeight * scale | 0)];
        if (canvas.width !== width || canvas.height !== height) [canvas.width, canvas.height] = [width, height];
        if (this.flying) this.pose = tour(this.seconds += seconds);
        else this.walk(seconds);
        const viewer = cameraOf(this.pose, width / height), camera = this.frozen ? cameraOf(this.frozen, width / height) : viewer;
        const { counts, ms } = this.culling.run(camera, this.occlusion);
        const shown = this.frozen || this.all ? () => true : (verdict) => verdict === 1 || verdict === 2;
        const drawn = this.drawing.frame(this.objects, this.culling.verdicts, shown, matrixOf(viewer), viewer.position,
            this.frozen && edgesOf(camera));
        this.map.draw(this.culling.verdicts, camera, viewer.position);
        this.show(counts, ms, drawn);
        this.answer = { counts, drawn, camera };
    }
    show(counts, ms, drawn) {
        VERDICTS.forEach((name, verdict) => { element(name).textContent = counts[verdict].toLocaleString('en'); });
        this.mean = this.mean === undefined ? ms : 0.9 * this.mean + 0.1 * ms;
        element('time').textContent = `${this.objects.length.toLocaleString('en')} objects, ${
            drawn.toLocaleString('en')} drawn, culled in ${this.mean.toFixed(2)} ms`;
    }
}

function say(text) {
    element('message').textContent = text;
    element('message').hidden = false;
    document.documentElement.dataset.state = 'refused';
}

/** A script that gives the bytes of the compiled library: a file may not fetch others, but may run them. */
function bytesFromScript() {
    return new Promise((done, failed) => {
        const script = document.createElement('script');
        script.src = 'simd.wasm.js';
        script.onload = () => {
            const text = atob(globalThis.croftonBytes), bytes = new Uint8Array(text.length);
            for (let i = 0; i < bytes.length; ++i) bytes[i] = text.charCodeAt(i);
            done(bytes);
        };
        script.onerror = () => failed(new Error('simd.wasm.js is missing beside this page'));
        document.head.append(script);
    });
}

async function start() {
    if (typeof WebAssembly !== 'object')
        return say('This browser has no WebAssembly, or it is switched off. The page needs it for culling; the guides work without.');
    const gl = element('view').getContext('webgl2', { antialias: !address.has('plainly'), preserveDrawingBuffer: true });
    if (!gl) return say('This browser gives no WebGL 2 here. The page needs it for drawing; the guides work without.');
    element('view').addEventListener('webglcontextlost', () => say('The graphics driver stopped WebGL. Load the page again.'));
    const crofton = await load({ wasmBinary: await bytesFromScript() });
    const objects = makeTown(), page = new Page(gl, new Culling(crofton, objects), objects);
    page.connect();
    VERDICTS.forEach((name, verdict) => {
        element(name).parentElement.style.setProperty('--tint', `rgb(${COLOURS[verdict].map((c) => Math.round(255 * c))})`);
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
