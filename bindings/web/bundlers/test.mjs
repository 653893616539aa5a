// SPDX-License-Identifier: MIT
// The package as npm packs it, in a blank project: built by each bundler, opened in a headless Chromium, in the page and in a
// worker; and in node. Run it by test.sh.
import test, { after, before } from 'node:test';
import assert from 'node:assert/strict';
import { execFileSync, spawn } from 'node:child_process';
import { createServer } from 'node:http';
import { cpSync, existsSync, readFileSync, rmSync, writeFileSync } from 'node:fs';
import { extname, join, normalize } from 'node:path';
import { fileURLToPath } from 'node:url';
import { Browser, missing } from '../test/browser.js';

const HERE = fileURLToPath(new URL('./', import.meta.url)), PROJECT = process.cwd();
const EXPECTED = '50 seen, hit at 4';  // boxes at z = 0 to -49; a sphere from z = -4 on
const TYPES = { '.html': 'text/html', '.js': 'text/javascript', '.mjs': 'text/javascript', '.wasm': 'application/wasm' };
let browser, server;

before(async () => {
    if (missing) return;
    server = createServer((request, reply) => {
        try {
            const path = normalize(decodeURIComponent(new URL(request.url, 'http://x').pathname));
            reply.setHeader('Content-Type', TYPES[extname(path)] ?? 'application/octet-stream');
            reply.end(readFileSync(join(PROJECT, path)));
        } catch {
            reply.writeHead(404).end();
        }
    }).listen(0, '127.0.0.1');
    await new Promise((done) => server.on('listening', done));
    browser = new Browser();
});
after(async () => {
    await browser?.close();
    server?.close();
});

/** The sources of the page, which import `from`, in a folder of their own. */
function pageOf(name, from) {
    const folder = join(PROJECT, name);
    rmSync(folder, { recursive: true, force: true });
    cpSync(join(HERE, 'app'), folder, { recursive: true });
    for (const file of ['main.js', 'worker.js'])
        writeFileSync(join(folder, file), readFileSync(join(folder, file), 'utf8').replace("'CROFTON'", `'${from}'`));
    return folder;
}
const pageWith = (script) => `<!doctype html><title>page</title><script type="module" src="${script}"></script>\n`;
const bin = (name, folder, ...rest) => execFileSync(join(PROJECT, 'node_modules/.bin', name), rest, { cwd: folder, encoding: 'utf8', stdio: 'pipe' });

async function says(url) {
    const page = await browser.open(url, { when: 'Boolean(globalThis.answer)' });
    const answer = await page.evaluate('globalThis.answer');
    await page.close();
    return answer;
}
const served = (path) => `http://127.0.0.1:${server.address().port}/${path}`;
const expectBoth = async (path) => assert.deepEqual(await says(served(path)), [EXPECTED, EXPECTED]);

const bundlers = {
    vite(folder) {
        writeFileSync(join(folder, 'index.html'), pageWith('./main.js'));
        writeFileSync(join(folder, 'vite.config.js'), "export default { base: './', worker: { format: 'es' } };\n");
        bin('vite', folder, 'build');
        return 'dist/index.html';
    },
    webpack(folder) {
        writeFileSync(join(folder, 'webpack.config.js'), "export default { mode: 'production', entry: './main.js' };\n");
        bin('webpack', folder);
        writeFileSync(join(folder, 'dist/index.html'), pageWith('./main.js'));
        return 'dist/index.html';
    },
    esbuild(folder) {
        bin('esbuild', folder, 'main.js', 'worker.js', '--bundle', '--format=esm', '--splitting', '--outdir=dist');
        writeFileSync(join(folder, 'dist/index.html'), pageWith('./main.js'));
        return 'dist/index.html';
    },
    rollup(folder) {
        writeFileSync(join(folder, 'rollup.config.js'), "import { nodeResolve } from '@rollup/plugin-node-resolve';\n" +
            "export default { input: ['main.js', 'worker.js'], output: { dir: 'dist' }, plugins: [nodeResolve()] };\n");
        bin('rollup', folder, '-c');
        writeFileSync(join(folder, 'dist/index.html'), pageWith('./main.js'));
        return 'dist/index.html';
    },
};
for (const [name, bundle] of Object.entries(bundlers))
    test(`${name}: runs in a page and in a worker`, { skip: missing ?? false }, async () => {
        await expectBoth(`${name}/${bundle(pageOf(name, 'crofton'))}`);
    });

test('vite: its development server runs the page as it is', { skip: missing ?? false }, async () => {
    const folder = pageOf('vite_dev', 'crofton');
    writeFileSync(join(folder, 'index.html'), pageWith('./main.js'));
    const vite = spawn(join(PROJECT, 'node_modules/.bin/vite'), ['--port', '0', '--host', '127.0.0.1'], { cwd: folder });
    try {
        let said = '';
        const address = await new Promise((done, failed) => {
            vite.stdout.on('data', (data) => {
                said += String(data).replace(/\u001b\[[0-9;]*m/g, '');
                const found = /http:\/\/127\.0\.0\.1:\d+\//.exec(said);
                if (found) done(found[0]);
            });
            vite.on('exit', () => failed(new Error(said)));
        });
        assert.deepEqual(await says(address), [EXPECTED, EXPECTED]);
    } finally {
        vite.kill();
    }
});

test('a page without a bundler', { skip: missing ?? false }, async () => {
    const folder = pageOf('script', '/node_modules/crofton/js/crofton.js');
    writeFileSync(join(folder, 'index.html'), pageWith('./main.js'));
    await expectBoth('script/index.html');
});

test('node, and the licence is in the package', () => {
    const folder = pageOf('node', 'crofton');
    writeFileSync(join(folder, 'in_node.mjs'), "import { load } from 'crofton';\nimport { run } from './program.js';\nconsole.log(await run(load));\n");
    assert.equal(execFileSync(process.execPath, ['in_node.mjs'], { cwd: folder, encoding: 'utf8' }).trim(), EXPECTED);
    assert.ok(existsSync(join(PROJECT, 'node_modules/crofton/LICENSE')));
});
