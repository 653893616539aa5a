// SPDX-License-Identifier: MIT
// Starts a build: Emscripten's function, and the bytes of the WebAssembly.
import { failure } from './error.js';

// A function that splats an integer: valid only where there is SIMD.
const PROBE = new Uint8Array([0, 97, 115, 109, 1, 0, 0, 0, 1, 5, 1, 96, 0, 1, 123, 3, 2, 1, 0, 10, 10, 1, 8, 0, 65, 0, 253, 15,
    253, 98, 11]);

/** The package's build. Its WebAssembly is compressed text in a module: nothing is fetched, so it works in every bundler. */
export const packaged = {
    create: async () => (await import('../wasm/simd.js')).default,
    bytes: async () => unpack((await import('../wasm/simd.base64.js')).default),
};

async function unpack(base64) {
    const text = atob(base64), packed = new Uint8Array(text.length);
    for (let i = 0; i < packed.length; ++i) packed[i] = text.charCodeAt(i);
    const stream = new Blob([packed]).stream().pipeThrough(new DecompressionStream('deflate'));
    return new Uint8Array(await new Response(stream).arrayBuffer());
}

/** `build` has the functions `create` and `bytes`. Pass bytes that you already have as `wasmBinary`. */
export async function loadModule(build, { wasmBinary } = {}) {
    if (typeof WebAssembly !== 'object')
        throw failure('unavailable', 'this JavaScript engine has no WebAssembly, which Crofton needs');
    if (!build.plain && !WebAssembly.validate(PROBE))
        throw failure('unavailable', 'this JavaScript engine has no SIMD in WebAssembly, which Crofton needs: Chrome 95, Firefox 113, Safari 16.4 and node 18 have it');
    try {
        const create = await build.create(), bytes = wasmBinary ?? await build.bytes();
        return await create({ wasmBinary: bytes, locateFile: (file) => file, printErr: (line) => console.warn(line) });
    } catch (error) {
        if (error?.name === 'CroftonError') throw error;
        throw failure('unavailable', `Crofton's WebAssembly could not be started: ${error?.message ?? error}`);
    }
}
