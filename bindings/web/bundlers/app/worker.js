// SPDX-License-Identifier: MIT
import { load } from 'CROFTON';
import { run } from './program.js';

run(load).then((said) => postMessage({ said }), (error) => postMessage({ error: String(error?.stack ?? error) }));
