// SPDX-License-Identifier: MIT
// The live page in a headless Chromium, opened as a file: what it says is what the native library says, and its pictures
// show it.
import { after, before, test } from 'node:test';
import assert from 'node:assert/strict';
import { execFileSync } from 'node:child_process';
import { existsSync, mkdirSync, writeFileSync } from 'node:fs';
import { fileURLToPath, pathToFileURL } from 'node:url';
import { Browser, missing } from './browser.js';
import { load } from '../js/crofton.js';
import { MESHES, makeTown, transformOf } from '../page/town.js';
import { CRITERIA, Culling } from '../page/culling.js';

const ROOT = fileURLToPath(new URL('../../../', import.meta.url));
const SITE = `${ROOT}build/web/page`, ADDRESS = `${pathToFileURL(SITE)}/index.html`;
const READY = 'document.documentElement.dataset.state';
const LIBRARIES = ['crofton_bake', 'crofton'].map((name) => `${ROOT}build/release/engine/lib${name}.a`);
const STREET = '200,9,120,0.1,-0.02', ABOVE = '0,220,520,0.3,-0.5';
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

const answer = (page) => page.evaluate(`(() => { const p = croftonPage; p.frame(0); let digest = 2166136261;
    for (const v of p.culling.verdicts) digest = Math.imul(digest ^ v, 16777619);
    return { ...p.answer, digest: digest >>> 0, text: ['outside', 'straddling', 'inside', 'occluded'].map((id) =>
        Number(document.getElementById(id).textContent.replaceAll(',', ''))) }; })()`);
/** Shares of the picture by hue: grey, amber, green and red things; and a digest of all pixels. */
const pixels = (page) => page.evaluate(`(() => { const p = croftonPage, gl = p.gl; p.frame(0);
    const data = new Uint8Array(4 * gl.drawingBufferWidth * gl.drawingBufferHeight);
    gl.readPixels(0, 0, gl.drawingBufferWidth, gl.drawingBufferHeight, gl.RGBA, gl.UNSIGNED_BYTE, data);
    let digest = 2166136261; const share = { amber: 0, green: 0, red: 0 };
    for (let i = 0; i < data.length; i += 4) { const [r, g, b] = data.subarray(i, i + 3);
        digest = Math.imul(digest ^ (r << 16 | g << 8 | b), 16777619);
        if (g > 1.3 * r && g > 1.15 * b) ++share.green; else if (r > 1.5 * g && r > 1.3 * b) ++share.red;
        else if (r > 1.2 * g && g > 1.3 * b) ++share.amber; }
    return { digest: digest >>> 0, ...share }; })()`);

// The first load also starts the browser's processes and its graphics, here by software: the next is measured.
test('page: interactive within 2 s', { skip }, async () => {
    const ready = (page) => page.evaluate('Number(document.documentElement.dataset.ready)');
    const first = await see('', ready), next = await see('', ready);
    assert.ok(next < 2000 * Number(process.env.CROFTON_SLOW ?? 1), `${first} ms, then ${next} ms`);
});

test('page: with what is culled drawn as well, the picture is the same', { skip }, async () => {
    for (const at of [STREET, '20,14,300,0.1,-0.1', '-60,3,-120,2.1,0.05']) {
        const some = await see(`plainly&at=${at}`, async (page) => [await pixels(page), await answer(page)]);
        const all = await see(`plainly&at=${at}&all`, async (page) => [await pixels(page), await answer(page)]);
        assert.equal(some[0].digest, all[0].digest, at);
        assert.ok(some[1].drawn * 10 < all[1].drawn, `${some[1].drawn} of ${all[1].drawn} drawn`);
        assert.ok(some[0].green > 1000 && some[0].red === 0, JSON.stringify(some[0]));
    }
});

test('page: frozen, the viewer moves on and the counts stay', { skip }, () => see(`at=${STREET}`, async (page) => {
    const first = await answer(page);
    await page.evaluate('document.getElementById("freeze").click()');
    await page.evaluate(`croftonPage.pose = { position: [0, 220, 520], yaw: 0.3, pitch: -0.5 }`);
    const later = await answer(page), shown = await pixels(page);
    assert.deepEqual(later.counts, first.counts);
    assert.equal(later.digest, first.digest);
    assert.equal(later.drawn, makeTown().length);
    assert.ok(shown.red > 1000 && shown.green > 100, JSON.stringify(shown));
    await page.evaluate('document.getElementById("freeze").click()');
    assert.notDeepEqual((await answer(page)).counts, first.counts);
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
        assert.ok(Math.hypot(...held.map((c, k) => c - flown.position[k])) > 100, held);
        assert.match(text, /drawn, red is hidden/);
    });
    await see('', async (page) => {
        const [flying, frozen] = await page.evaluate(`(() => { ${step}
            for (let i = 0; i < 90; ++i) p.fly(0.1);
            p.keys.add('w'); p.walk(0.1); p.keys.clear();
            return [p.flying, p.frozen !== null]; })()`);
        assert.ok(!flying && frozen, 'the viewer stands where it was, the view still frozen');
    });
});

test('page: without occlusion nothing is occluded, and nothing else changes', { skip }, () => see(`at=${STREET}`, async (page) => {
    const with_ = await answer(page);
    await page.evaluate('document.getElementById("occlusion").click()');
    const without = await answer(page);
    assert.ok(with_.counts[3] > 100 && without.counts[3] === 0);
    assert.equal(without.counts[0], with_.counts[0]);
    assert.deepEqual(without.text, without.counts);
}));

/** Objects whose place on the map has the colour of their verdict, of another, or of none. */
const mapped = (page) => page.evaluate(`(() => { const p = croftonPage, canvas = document.getElementById('map'); p.frame(0);
    const { data } = canvas.getContext('2d').getImageData(0, 0, canvas.width, canvas.height);
    const tint = (id) => getComputedStyle(document.getElementById(id).parentElement).getPropertyValue('--tint');
    const tints = ['outside', 'straddling', 'inside', 'occluded'].map((id) => tint(id).match(/\\d+/g).join());
    const found = { own: 0, other: 0, none: 0, red: 0 };
    p.objects.forEach(({ position: [x, , z] }, i) => {
        const at = 4 * (canvas.width * Math.round(p.map.at(z)) + Math.round(p.map.at(x)));
        const verdict = tints.indexOf(data.subarray(at, at + 3).join());
        ++found[verdict < 0 ? 'none' : verdict === p.culling.verdicts[i] ? 'own' : 'other'];
        if (verdict === 3) ++found.red;
    });
    return found; })()`);

test('page: the map shows each object in the colour of its verdict', { skip }, () => see(`at=${STREET}`, async (page) => {
    const all = makeTown().length, { counts } = await answer(page), first = await mapped(page);
    // Houses cover some of the trees beside them, lines of the frustum some of both.
    assert.ok(first.own > 0.97 * all && first.none < 0.02 * all, JSON.stringify(first));
    assert.ok(first.red > 0.9 * counts[3], JSON.stringify(first));
    await page.evaluate('document.getElementById("occlusion").click()');
    const second = await mapped(page);
    assert.ok(second.own > 0.97 * all && second.red === 0, JSON.stringify(second));
}));

test('page: the box of an object holds its mesh, to the last bit', { skip: notBuilt }, async () => {
    const objects = makeTown(), culling = new Culling(await load(), objects);
    const cross = (a, b) => [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]];
    const dot = (a, b) => a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
    for (const criterion of Object.keys(CRITERIA)) {
        culling.setCriterion(criterion);
        const { buffer } = culling.boxBytes;
        objects.forEach(({ mesh, position, cos, sin }, i) => {
            const center = new Float64Array(buffer, 72 * i, 3), floats = [...new Float32Array(buffer, 72 * i + 24, 12)];
            const axes = [0, 3, 6].map((first) => floats.slice(first, first + 3)), half = floats.slice(9);
            const volume = dot(axes[0], cross(axes[1], axes[2]));
            const { positions } = MESHES[mesh];
            for (let v = 0; v < positions.length; v += 3) {
                const [x, y, z] = positions.subarray(v, v + 3);
                const p = [cos * x + sin * z, y, cos * z - sin * x].map((c, k) => c + position[k] - center[k]);
                // Coordinates along the axes as they are stored: these are not quite orthogonal.
                for (let k = 0; k < 3; ++k) {
                    const along = dot(p, cross(axes[(k + 1) % 3], axes[(k + 2) % 3])) / volume;
                    assert.ok(Math.abs(along) <= half[k], `${criterion}, object ${i}, axis ${k}: ${Math.abs(along) - half[k]} outside`);
                }
            }
        });
    }
});

test('page: counts are those of the native library, for every criterion', {
    skip: skip || (LIBRARIES.every(existsSync) ? false : `no ${LIBRARIES}: cmake --preset release; ninja -C build/release crofton_bake`) }, async () => {
    const objects = makeTown(), culling = new Culling(await load(), objects), program = `${ROOT}build/web/town_counts`;
    execFileSync('g++', ['-std=c++20', '-O1', `-I${ROOT}engine/c_api/include`, `-I${ROOT}engine/bake/c_api/include`,
        `${ROOT}bindings/web/native/town_counts.cpp`, ...LIBRARIES,
        '-lqhull_r', '-lhwy', '-lpthread', '-o', program]);
    for (const criterion of Object.keys(CRITERIA)) {
        const answers = [];
        for (const [at, occlusion] of [[STREET, 1], [ABOVE, 1], [STREET, 0]])
            answers.push([occlusion, await see(`at=${at}&criterion=${criterion}&occlusion=${occlusion}`, answer)]);
        culling.setCriterion(criterion);
        const numbers = [MESHES.length];
        for (const { positions, indices, occludes } of MESHES)
            numbers.push(positions.length, ...positions, indices.length, ...indices, occludes ? 1 : 0);
        numbers.push(objects.length);
        for (const object of objects)
            numbers.push(object.mesh, ...transformOf(object).filter((_, i) => i % 4 !== 3));
        const { buffer } = culling.boxBytes;
        for (let i = 0; i < objects.length; ++i)
            numbers.push(...new Float64Array(buffer, 72 * i, 3), ...new Float32Array(buffer, 72 * i + 24, 12));
        numbers.push(answers.length);
        for (const [occlusion, { camera }] of answers)
            numbers.push(occlusion, ...camera.position, ...camera.forward, ...camera.up, camera.fovY, camera.aspect, camera.near, camera.far);
        mkdirSync(`${ROOT}build/web`, { recursive: true });
        writeFileSync(`${program}.in`, new Uint8Array(Float64Array.from(numbers).buffer));
        const native = execFileSync(program, [`${program}.in`], { encoding: 'utf8' }).trim().split('\n');
        answers.forEach(([, { counts, digest, text }], i) => {
            assert.equal(native[i], [...counts, digest].join(' '), `${criterion}, camera ${i}`);
            assert.deepEqual(text, counts);
        });
    }
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
