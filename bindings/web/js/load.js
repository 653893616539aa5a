// SPDX-License-Identifier: MIT
// Chooses the build with SIMD or the one without, and gets its bytes in node and in browsers.
import { failure } from './error.js';

// A function that splats an integer: valid only where there is SIMD.
const PROBE = new Uint8Array([0, 97, 115, 109, 1, 0, 0, 0, 1, 5, 1, 96, 0, 1, 123, 3, 2, 1, 0, 10, 10, 1, 8, 0, 65, 0, 253, 15,
    253, 98, 11]);

export function hasSimd() {
    return typeof WebAssembly === 'object' && WebAssembly.validate(PROBE);
}

async function bytesOf(url) {
    if (url.protocol === 'file:' && typeof process === 'object') {
        const { readFile } = await import('node:fs/promises');
        return readFile(url);
    }
    const answer = await fetch(url);
    if (!answer.ok) throw failure('input/output', `${url.href} could not be loaded: ${answer.status} ${answer.statusText}`);
    return new Uint8Array(await answer.arrayBuffer());
}

export async function loadModule({ simd, wasmBinary } = {}) {
    if (typeof WebAssembly !== 'object')
        throw failure('unavailable', 'this JavaScript engine has no WebAssembly, which Crofton needs');
    if (simd === true && !hasSimd())
        throw failure('unavailable', 'this JavaScript engine has no SIMD in WebAssembly: leave `simd` out');
    const name = simd ?? hasSimd() ? 'simd' : 'plain';
    let made;
    try {
        const { default: create } = await import(`../wasm/${name}.js`);
        const binary = wasmBinary ?? await bytesOf(new URL(`../wasm/${name}.wasm`, import.meta.url));
        made = await create({ wasmBinary: binary, locateFile: (name) => name, printErr: (line) => console.warn(line) });
    } catch (error) {
        if (error?.name === 'CroftonError') throw error;
        throw failure('unavailable', `the build "${name}" could not be started: ${error?.message ?? error}`);
    }
    made.simd = name === 'simd';
    return made;
}
