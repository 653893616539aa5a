// SPDX-License-Identifier: MIT
// Crofton for JavaScript: culling, boxes around points, triangulation. README.md is the guide.
import { packaged } from './load.js';
import { loadLibrary } from './library.js';

/** Loads the library; every class is a member of the result. */
export const load = (options = {}) => loadLibrary(packaged, options);

export { CroftonError } from './error.js';
