// SPDX-License-Identifier: MIT
// The page: a flight through the town, its switches, and what the address says:
//   #at=x,y,z,yaw,pitch  stand there      #frozen=x,y,z,yaw,pitch  the camera that culls stands there
//   #criterion=volume    #occlusion=0
//   #all  draw what is culled too        #plainly  edges are not smoothed
import { load } from 'crofton';
import { makeTown } from './town.js';
import { CRITERIA, Culling, VERDICTS } from './culling.js';
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
    flying: 'Only what may be seen is drawn: green objects lie within the view, amber ones cross its edge.',
    frozen: 'The view is frozen and seen from outside. Green and amber are drawn, red is hidden behind them and left out, grey lies outside.',
};

class Page {
    constructor(gl, culling, objects) {
        Object.assign(this, { gl, culling, objects, drawing: new Drawing(gl, objects), map: new TownMap(element('map'), objects),
            keys: new Set(), seconds: 0 });
        this.pose = poseOf(address.get('at'));
        this.flying = !this.pose;
        this.pose ??= tour(0);
        this.frozen = poseOf(address.get('frozen'));
        this.demonstrates = this.flying && !this.frozen;
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
            if (fingers.size === 2) this.step((apart() - before) / 4);
            else this.turn(x / 300, -y / 300);
        };
        canvas.onwheel = (event) => this.step(-event.deltaY / 20);
        onkeydown = (event) => {
            if (event.target.tagName === 'SELECT' || event.ctrlKey || event.metaKey) return;
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
            -ahead * Math.cos(yaw) * Math.cos(pitch) + aside * Math.sin(yaw)], seconds * (held('shift') ? 150 : 40));
    }
    fly(seconds) {
        const { begins, aside, looks, back } = DEMONSTRATION;
        if (!this.demonstrates || (this.shown === undefined && this.seconds < begins)) {
            this.pose = tour(this.seconds += seconds);
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
        if (this.flying) this.fly(seconds);
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
        element('story').textContent = this.frozen ? STORY.frozen : STORY.flying;
        this.mean = this.mean === undefined ? ms : 0.9 * this.mean + 0.1 * ms;
        const needed = counts[1] + counts[2], say = (count) => count.toLocaleString('en');
        element('time').textContent = `${say(this.objects.length)} objects, ${drawn > needed
            ? `all shown here; a frame needs ${say(needed)},` : `${say(drawn)} drawn,`} culled in ${this.mean.toFixed(2)} ms`;
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
