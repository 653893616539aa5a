// SPDX-License-Identifier: MIT

const NAMES = ['ok', 'invalid argument', 'not finite', 'out of range', 'degenerate', 'empty', 'unsupported', 'input/output', 'parse',
    'cancelled', 'budget exceeded', 'unavailable', 'stale handle', 'internal', 'bad handle', 'wrong struct size', 'busy',
    'out of memory'];

/** An error: `status` in words, a message, and the item of the input that caused it (-1: no single item). */
export class CroftonError extends Error {
    constructor(status, message, item = -1) {
        super(message);
        this.name = 'CroftonError';
        this.status = status;
        this.item = item;
    }
}

export function failure(status, message, item) {
    return new CroftonError(typeof status === 'number' ? NAMES[status] ?? 'unknown status' : status, message, item);
}
