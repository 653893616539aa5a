// SPDX-License-Identifier: MIT
// The live page in a headless Chromium, opened as a file: what it says is what the native library says, and its pictures
// show it.
import { after, before, test } from 'node:test';
import assert from 'node:assert/strict';
import { execFileSync } from 'node:child_process';
import { existsSync, mkdirSync, readFileSync, writeFileSync } from 'node:fs';
import { fileURLToPath, pathToFileURL } from 'node:url';
import { Browser, missing } from './browser.js';
import { inflateSync } from 'node:zlib';
import { readTown } from '../page/town.js';

const ROOT = fileURLToPath(new URL('../../../', import.meta.url));
const SITE = `${ROOT}build/web/page`, ADDRESS = `${pathToFileURL(SITE)}/index.html`;
const READY = 'document.documentElement.dataset.state';
const LIBRARIES = ['crofton'].map((name) => `${ROOT}build/release/engine/lib${name}.a`);
const STREET = '-20,3,28,1.17,0', ABOVE = '-60,90,120,0.6,-0.5';
const town = readTown(Uint8Array.from(inflateSync(readFileSync(`${ROOT}bindings/web/page/town.bin`))));
const notBuilt = existsSync(`${ROOT}bindings/web/wasm/simd.wasm`) ? false : 'the package is not built';
const skip = missing ?? notBuilt;
let browser;

before(async () => {
    if (skip) return;
    execFileSync('python3', [`${ROOT}bindings/web/site.py`, '--page-only', '--out', SITE]);
    browser = new Browser();
});
after(() => browser?.close());

async function see(hash, use) {
    const page = await browser.open(`${ADDRESS}#${hash}`, { when: READY });
    try {
        assert.equal(await page.evaluate(READY), 'ready', await page.evaluate('document.getElementById("message").textContent'));
        return await use(page);
    } finally {
        await page.close();
    }
}

const answer = (page) => page.evaluate(`(() => { const p = croftonPage; p.key = null; p.frame(0);
    let digest = 2166136261;
    for (const word of p.culling.words) digest = Math.imul(digest ^ word, 16777619);
    const said = (what) => ['outside', 'drawn', 'hidden'].map((id) => Number(document.getElementById(id + what).textContent.replaceAll(',', '')));
    return { ...p.answer, digest: digest >>> 0, width: p.gl.drawingBufferWidth, height: p.gl.drawingBufferHeight,
        text: [said('-objects'), said('-triangles')] }; })()`);
/** Shares of the picture by hue: green and red things; and a digest of all pixels. */
const pixels = (page) => page.evaluate(`(() => { const p = croftonPage, gl = p.gl; p.frame(0);
    const data = new Uint8Array(4 * gl.drawingBufferWidth * gl.drawingBufferHeight);
    gl.readPixels(0, 0, gl.drawingBufferWidth, gl.drawingBufferHeight, gl.RGBA, gl.UNSIGNED_BYTE, data);
    let digest = 2166136261; const share = { green: 0, red: 0 };
    for (let i = 0; i < data.length; i += 4) { const [r, g, b] = data.subarray(i, i + 3);
        digest = Math.imul(digest ^ (r << 16 | g << 8 | b), 16777619);
        if (g > 1.3 * r && g > 1.15 * b) ++share.green; else if (r > 1.5 * g && r > 1.3 * b) ++share.red; }
    return { digest: digest >>> 0, ...share }; })()`);

// By the clock, as on an idle machine: the browser's threads ran for a part of the time that they wanted to, and waited for other programs in
// the rest, which Linux counts. What sleeps or loads counts in full. The first load also starts the browser's processes and its graphics, here by
// software; of the next, one must be in time.
test('page: interactive within 2 s', { skip }, async () => {
    const loads = [];
    for (let i = 0; i < 6 && !loads.slice(1).some(({ idle }) => idle < 2000); ++i) {
        const before = browser.processorTime();
        const clock = await see('', (page) => page.evaluate('Number(document.documentElement.dataset.ready)'));
        const [ran, waited] = browser.processorTime().map((now, k) => now - before[k]);
        loads.push({ clock, idle: Math.round(clock * ran / (ran + waited)) });
    }
    assert.ok(loads.at(-1).idle < 2000, JSON.stringify(loads));
});

// A driver that moves vertices to sixteenths of a pixel gives pixels at edges to other triangles than it should (docs/depth.md).
test('page: with the whole town drawn, the picture is the same', { skip }, async () => {
    for (const at of [STREET, ABOVE, '40,2,-60,2.1,0.05'])
        await see(`at=${at}`, async (page) => {
            const { triangles: [outside, drawn, hidden] } = await answer(page);
            assert.ok(drawn > 100 && drawn * 5 < outside + hidden, `${drawn} of ${drawn + outside + hidden} drawn`);
            const [different, count, bits] = await page.evaluate(`(() => { const p = croftonPage, gl = p.gl, pictures = [false, true].map((all) => {
                Object.assign(p, { all, key: null });
                p.frame(0);
                const data = new Uint32Array(gl.drawingBufferWidth * gl.drawingBufferHeight);
                gl.readPixels(0, 0, gl.drawingBufferWidth, gl.drawingBufferHeight, gl.RGBA, gl.UNSIGNED_BYTE, new Uint8Array(data.buffer));
                return data;
            });
            return [pictures[0].filter((word, i) => word !== pictures[1][i]).length, pictures[0].length, gl.getParameter(gl.SUBPIXEL_BITS)]; })()`);
            assert.ok(different <= (bits >= 8 ? 0 : 0.002 * count), `${different} of ${count} pixels, ${bits} bits`);
        });
});

test('page: frozen, the viewer moves on and the counts stay', { skip }, () => see(`at=${STREET}`, async (page) => {
    const first = await answer(page);
    await page.evaluate('document.getElementById("freeze").click()');
    await page.evaluate(`croftonPage.pose = { position: [-60, 90, 120], yaw: 0.6, pitch: -0.5 }`);
    const later = await answer(page), shown = await pixels(page);
    assert.deepEqual(later.triangles, first.triangles);
    assert.equal(later.digest, first.digest);
    assert.ok(shown.red > 1000 && shown.green > 100, JSON.stringify(shown));
    await page.evaluate('document.getElementById("freeze").click()');
    assert.notDeepEqual((await answer(page)).triangles, first.triangles);
}));

test('page: the flight freezes once, turns aside, says what the colours are, and goes on; a key ends it', { skip }, async () => {
    const step = 'globalThis.requestAnimationFrame = () => 0; const p = croftonPage, says = () => document.getElementById("story").textContent;';
    await see('', async (page) => {
        const [flown, held, after, text] = await page.evaluate(`(() => { ${step} const places = [];
            for (let i = 0; i < 62; ++i) p.fly(0.1);
            const flown = p.frozen;
            for (let i = 0; i < 50; ++i) p.fly(0.1);
            p.frame(0.01); const text = says(), held = p.pose.position;
            for (let i = 0; i < 300; ++i) p.fly(0.1);
            return [flown, held, p.frozen, text]; })()`);
        assert.ok(flown && !after, 'it froze, and went on');
        assert.ok(Math.hypot(...held.map((c, k) => c - flown.position[k])) > 50, held);
        assert.match(text, /green was drawn, red is hidden/);
    });
    await see('', async (page) => {
        const [flying, frozen] = await page.evaluate(`(() => { ${step}
            for (let i = 0; i < 90; ++i) p.fly(0.1);
            const press = (key) => { for (const kind of ['keydown', 'keyup']) { dispatchEvent(new KeyboardEvent(kind, { key })); p.frame(0.01); } };
            press('x'); const still = p.flying; press('w');
            return [!still || p.flying, p.frozen !== null]; })()`);
        assert.ok(!flying && frozen, 'the viewer stands where it was, the view still frozen');
    });
});

test('page: without occlusion nothing is hidden, and nothing else changes', { skip }, () => see(`at=${STREET}`, async (page) => {
    const with_ = await answer(page);
    await page.evaluate('document.getElementById("occlusion").click()');
    const without = await answer(page);
    assert.ok(with_.objects[2] > 100 && without.objects[2] === 0);
    assert.equal(without.objects[0], with_.objects[0]);
    assert.equal(without.triangles[1], with_.triangles[1] + with_.triangles[2]);
    assert.deepEqual(without.text, [without.objects, without.triangles]);
}));

/** Pixels of the map by verdict. */
const mapped = (page) => page.evaluate(`(() => { const p = croftonPage, canvas = document.getElementById('map'); p.frame(0);
    const { data } = canvas.getContext('2d').getImageData(0, 0, canvas.width, canvas.height), counts = [0, 0, 0];
    const tints = ['outside', 'drawn', 'hidden'].map((id) => getComputedStyle(document.getElementById(id)).getPropertyValue('--tint').match(/\\d+/g).join());
    for (let i = 0; i < data.length; i += 4) { const verdict = tints.indexOf(data.subarray(i, i + 3).join()); if (verdict >= 0) ++counts[verdict]; }
    return counts; })()`);

test('page: the map shows each verdict in its colour', { skip }, () => see(`at=${STREET}`, async (page) => {
    const first = await mapped(page);
    assert.ok(first.every((count) => count > 200), JSON.stringify(first));
    await page.evaluate('document.getElementById("occlusion").click()');
    const second = await mapped(page);
    assert.ok(second[2] === 0 && second[1] > first[1], JSON.stringify(second));
}));

test('page: the town is that of the command line', {
    skip: existsSync(`${ROOT}build/release/samples/crofton/assets/libcrofton_assets.a`) ? false : 'no build/release' }, () => {
    execFileSync('python3', [`${ROOT}bindings/web/page/make_town.py`, '--check']);
});

test('page: what is drawn is what the native library lists', {
    skip: skip || (LIBRARIES.every(existsSync) ? false : `no ${LIBRARIES}: cmake --preset release; ninja -C build/release crofton`) }, async () => {
    const program = `${ROOT}build/web/town_counts`, answers = [];
    execFileSync('g++', ['-std=c++20', '-O1', `-I${ROOT}engine/c_api/include`, `${ROOT}bindings/web/native/town_counts.cpp`, ...LIBRARIES,
        '-lqhull_r', '-lhwy', '-lpthread', '-o', program]);
    for (const at of [STREET, ABOVE]) answers.push(await see(`at=${at}`, answer));
    const numbers = [town.meshes.length];
    for (const { positions, indices } of town.meshes) numbers.push(positions.length, ...positions, indices.length, ...indices);
    numbers.push(town.objects.length);
    for (const { mesh, matrix } of town.objects) numbers.push(mesh, ...matrix.filter((_, i) => i % 4 !== 3));
    numbers.push(answers.length);
    for (const { camera, width, height } of answers)
        numbers.push(...camera.position, ...camera.forward, ...camera.up, camera.fovY, camera.aspect, camera.near, camera.far, width, height);
    mkdirSync(`${ROOT}build/web`, { recursive: true });
    writeFileSync(`${program}.in`, new Uint8Array(Float64Array.from(numbers).buffer));
    const native = execFileSync(program, [`${program}.in`], { encoding: 'utf8' }).trim().split('\n');
    answers.forEach(({ objects, triangles, digest, text }, i) => {
        assert.equal(native[i], `${objects[1] + objects[2]} ${triangles[1]} ${digest}`, `camera ${i}`);
        assert.deepEqual(text, [objects, triangles]);
    });
});

test('page: says so where there is no WebGL, no WebAssembly, or no SIMD', { skip }, async () => {
    for (const [first, state, word] of [['HTMLCanvasElement.prototype.getContext = () => null', 'refused', /no WebGL 2/],
        ['delete globalThis.WebAssembly', 'refused', /no WebAssembly/],
        ['WebAssembly.validate = () => false', 'refused', /no SIMD/]]) {
        const page = await browser.open(ADDRESS, { when: READY, first });
        assert.equal(await page.evaluate(READY), state);
        assert.match(await page.evaluate('document.getElementById("message").textContent'), word);
        await page.close();
    }
});
