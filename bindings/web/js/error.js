// SPDX-License-Identifier: MIT

const NAMES = ['ok', 'invalid argument', 'not finite', 'out of range', 'degenerate', 'empty', 'unsupported', 'input/output', 'parse',
    'cancelled', 'budget exceeded', 'unavailable', 'stale handle', 'internal', 'bad handle', 'wrong struct size', 'busy',
    'out of memory'];

/** What went wrong: `status` in words, a sentence, and which item of the input (-1: none in particular). */
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
