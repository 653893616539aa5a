// SPDX-License-Identifier: MIT
// The package's build, and the one without SIMD, which only the tests have.
import { readFile } from 'node:fs/promises';
import { load } from '../js/crofton.js';
import { loadLibrary } from '../js/library.js';

const plain = {
    plain: true,
    create: async () => (await import('../wasm/plain.js')).default,
    bytes: () => readFile(new URL('../wasm/plain.wasm', import.meta.url)),
};
export const loadBuild = (name) => name === 'simd' ? load() : loadLibrary(plain);
