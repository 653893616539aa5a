// SPDX-License-Identifier: MIT
import { load } from 'CROFTON';
import { run } from './program.js';

const worker = new Worker(new URL('./worker.js', import.meta.url), { type: 'module' });
const fromWorker = new Promise((done, failed) => {
    worker.onmessage = ({ data }) => data.error ? failed(new Error(data.error)) : done(data.said);
    worker.onerror = (event) => failed(new Error(`worker: ${event.message}`));
});
Promise.all([run(load), fromWorker]).then((said) => { globalThis.answer = said; },
    (error) => { globalThis.answer = [String(error?.stack ?? error)]; });
