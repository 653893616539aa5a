// SPDX-License-Identifier: MIT
// Serves the sample, opens it in a headless Chromium, and checks its pixels and its ratio.
import { createServer } from 'node:http';
import { existsSync } from 'node:fs';
import { readFile } from 'node:fs/promises';
import { extname, join, normalize } from 'node:path';
import { fileURLToPath } from 'node:url';
import { Browser, missing } from '../../bindings/web/test/browser.js';

const ROOT = fileURLToPath(new URL('../../', import.meta.url));
const least = Number(process.env.CROFTON_LEAST_RATIO ?? 40);
const why = missing ?? (existsSync(`${ROOT}samples/threejs/node_modules/three`) ? null : 'no three.js; `npm install` here')
    ?? (existsSync(`${ROOT}bindings/web/wasm/simd.base64.js`) ? null : 'the package is not built; bindings/web/test.sh');
if (why) {
    console.log(`threejs: skipped, ${why}`);
    process.exit(0);
}
const types = { '.html': 'text/html', '.js': 'text/javascript', '.wasm': 'application/wasm' };
const server = createServer(async (request, reply) => {
    try {
        const path = normalize(decodeURIComponent(new URL(request.url, 'http://x').pathname));
        reply.setHeader('Content-Type', types[extname(path)] ?? 'application/octet-stream');
        reply.end(await readFile(join(ROOT, path)));
    } catch {
        reply.writeHead(404).end();
    }
}).listen(0, '127.0.0.1');
await new Promise((done) => server.on('listening', done));
const browser = new Browser();
try {
    const url = `http://127.0.0.1:${server.address().port}/samples/threejs/index.html`;
    const answer = await (await browser.open(url, { when: 'Boolean(globalThis.answer)' })).evaluate('globalThis.answer');
    console.log(JSON.stringify(answer));
    const ratio = answer.own / answer.crofton;
    console.log(`threejs: three.js ${answer.own?.toFixed(3)} ms, Crofton ${answer.crofton?.toFixed(3)} ms, ${ratio.toFixed(1)} x; ` +
        `${answer.different} bytes of pixels differ`);
    if (answer.error || answer.different !== 0 || !(answer.lit > 10000) || !answer.moved || !answer.all || !(ratio >= least)) process.exitCode = 1;
} finally {
    await browser.close();
    server.close();
}
