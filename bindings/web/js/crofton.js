// SPDX-License-Identifier: MIT
// Crofton for JavaScript: what a camera sees, boxes around points, triangles of polygons. README.md is the guide.
import { packaged } from './load.js';
import { loadLibrary } from './library.js';

/** Loads the library; every class is a member of what it gives. */
export const load = (options = {}) => loadLibrary(packaged, options);

export { CroftonError } from './error.js';
