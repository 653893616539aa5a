// SPDX-License-Identifier: MIT
// The package is as small as it promises: at most 850 kB compressed.
import test from 'node:test';
import assert from 'node:assert/strict';
import { execFileSync } from 'node:child_process';
import { existsSync } from 'node:fs';
import { fileURLToPath } from 'node:url';

const root = fileURLToPath(new URL('../', import.meta.url));
const skip = existsSync(`${root}wasm/simd.base64.js`) ? false : 'the package is not built';

test('`npm pack` makes at most 850 kB, and leaves the tests and the build without SIMD out', { skip }, () => {
    const [{ size, files }] = JSON.parse(execFileSync('npm', ['pack', '--dry-run', '--json'], { cwd: root, encoding: 'utf8' }));
    assert.ok(size <= 850000, `${size} bytes`);
    const names = files.map(({ path }) => path);
    for (const name of ['js/crofton.js', 'wasm/simd.js', 'wasm/simd.base64.js', 'LICENSE', 'README.md'])
        assert.ok(names.includes(name), name);
    assert.deepEqual(names.filter((name) => /plain|test|native|\.wasm$/.test(name)), []);
});
