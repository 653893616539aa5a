// SPDX-License-Identifier: MIT
// The answers of every build have the digests that are published for all platforms.
import test from 'node:test';
import assert from 'node:assert/strict';
import { execFileSync } from 'node:child_process';
import { readFileSync } from 'node:fs';
import { fileURLToPath } from 'node:url';

const root = fileURLToPath(new URL('../../../', import.meta.url));
const published = readFileSync(`${root}bindings/web/test/digests.txt`, 'utf8').trim();

test('the published digest of triangulations is that of the native tests', () => {
    const [, digest] = /^triangulate (\w+)$/m.exec(published);
    assert.ok(readFileSync(`${root}tests/determinism/triangulate_test.cpp`, 'utf8').includes(`0x${digest},`));
});
for (const build of (process.env.CROFTON_BUILDS ?? 'simd,plain').split(','))
    test(`${build}: culling near and far, fitting and triangulation have the native digests`, () => {
        const flags = ['--no-experimental-fetch'];  // Emscripten 3.1.6 takes node's fetch for a browser's
        const said = execFileSync(process.execPath, [...flags, `${root}build/web/${build}/digests.js`], { encoding: 'utf8' });
        assert.equal(said.trim(), published);
    });
