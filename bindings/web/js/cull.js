// SPDX-License-Identifier: MIT
import { failure } from './error.js';
import { Owned, create, handleOf, indicesOf } from './memory.js';

/** Writes a request for a frustum to the scratch memory. */
function writeRequest(memory, frustum, { conservative = false, treeOrder = false } = {}) {
    const volume = handleOf(memory, frustum, 'Frustum'), at = memory.scratch(52), { words } = memory, first = at >> 2;
    memory.fill('default_view_request', at);
    words[first + 3] = volume + 8;
    words[first + 4] = words[(volume >> 2) + 1];
    words[first + 9] = conservative ? 1 : 0;
    words[first + 10] = treeOrder ? 1 : 0;
    return at;
}

/** A hierarchy over boxes, which it copies. */
export class Tree extends Owned {
    constructor(memory, boxes) {
        super(memory, 'Tree', create(memory, 'tree', handleOf(memory, boxes, 'Boxes'), 0, boxes.length, 0), '_crofton_tree_destroy');
    }
    cull(frustum, visible, how) {
        const { memory } = this, result = handleOf(memory, visible, 'ViewResult');
        memory.call('tree_view', this.handle, writeRequest(memory, frustum, how), 0, result);
        return visible;
    }
    /** `items`: ids; item items[i] becomes box i. Call refit before the next query. */
    move(items, boxes) {
        const given = handleOf(this.memory, boxes, 'Boxes');
        if (items?.length !== boxes.length) throw failure(3, `${items?.length ?? 'no'} items and ${boxes.length} boxes`);
        this.memory.lend([indicesOf(items, 'items')], (at) => this.memory.call('tree_move', this.handle, at, given, items.length));
    }
    remove(item) { this.memory.call('tree_remove', this.handle, indicesOf([item], 'item')[0]); }
    refit() { this.memory.call('tree_refit', this.handle, 0); }
}

/** Does the same for a plain list of boxes, without a tree. */
export function cullBoxes(memory, boxes, frustum, visible, how) {
    const given = handleOf(memory, boxes, 'Boxes'), result = handleOf(memory, visible, 'ViewResult');
    memory.call('view_boxes', given, 0, boxes.length, writeRequest(memory, frustum, how), 0, result);
    return visible;
}

/** Returns the exact verdict of each box: 0 outside, 1 straddling, 2 inside. */
export function classify(memory, boxes, frustum) {
    const given = handleOf(memory, boxes, 'Boxes'), volume = handleOf(memory, frustum, 'Frustum');
    const at = memory.allocate(boxes.length, 'verdicts');
    try {
        memory.call('classify', volume + 8, given, boxes.length, at);
        return memory.bytes.slice(at, at + boxes.length);
    } finally {
        memory.free(at);
    }
}
