// SPDX-License-Identifier: MIT
// The package is as small as it promises: at most 900 kB compressed, with both builds.
import test from 'node:test';
import assert from 'node:assert/strict';
import { existsSync, readFileSync, readdirSync, statSync } from 'node:fs';
import { fileURLToPath } from 'node:url';
import { gzipSync } from 'node:zlib';

const root = fileURLToPath(new URL('../', import.meta.url));
const missing = ['simd', 'plain'].find((name) => !existsSync(`${root}wasm/${name}.wasm`));
const filesOf = (path) => statSync(path).isDirectory() ? readdirSync(path).flatMap((name) => filesOf(`${path}/${name}`)) : [path];

test('the package compresses to at most 900 kB', { skip: missing ? `the build ${missing} is not here` : false }, () => {
    const { files } = JSON.parse(readFileSync(`${root}package.json`, 'utf8'));
    const bytes = ['package.json', ...files].flatMap((name) => filesOf(root + name))
        .reduce((sum, file) => sum + gzipSync(readFileSync(file), { level: 9 }).length, 0);
    assert.ok(bytes <= 900000, `${bytes} bytes`);
});
