// SPDX-License-Identifier: MIT
import { failure } from './error.js';
import { Owned, create, indicesOf } from './memory.js';

/** Writes a request for a frustum to the scratch memory. */
function writeRequest(memory, frustum, { conservative = false, treeOrder = false } = {}) {
    const at = memory.scratch(52), { words } = memory, first = at >> 2;
    memory.fill('default_view_request', at);
    words[first + 3] = frustum.handle + 8;
    words[first + 4] = words[(frustum.handle >> 2) + 1];
    words[first + 9] = conservative ? 1 : 0;
    words[first + 10] = treeOrder ? 1 : 0;
    return at;
}

/** A hierarchy over boxes, which it copies. */
export class Tree extends Owned {
    constructor(memory, boxes) {
        super(memory, 'Tree', create(memory, 'tree', boxes.handle, 0, boxes.length, 0), '_crofton_tree_destroy');
    }
    cull(frustum, visible, how) {
        this.memory.call('tree_view', this.handle, writeRequest(this.memory, frustum, how), 0, visible.handle);
        return visible;
    }
    /** `items`: ids; item items[i] becomes box i. Call refit before the next query. */
    move(items, boxes) {
        if (items.length !== boxes.length) throw failure(3, `${items.length} items and ${boxes.length} boxes`);
        this.memory.lend([indicesOf(items, 'items')], (at) => this.memory.call('tree_move', this.handle, at, boxes.handle, items.length));
    }
    remove(item) { this.memory.call('tree_remove', this.handle, indicesOf([item], 'item')[0]); }
    refit() { this.memory.call('tree_refit', this.handle, 0); }
}

/** Does the same for a plain list of boxes, without a tree. */
export function cullBoxes(memory, boxes, frustum, visible, how) {
    memory.call('view_boxes', boxes.handle, 0, boxes.length, writeRequest(memory, frustum, how), 0, visible.handle);
    return visible;
}

/** Returns the exact verdict of each box: 0 outside, 1 straddling, 2 inside. */
export function classify(memory, boxes, frustum) {
    const at = memory.allocate(boxes.length, 'verdicts');
    try {
        memory.call('classify', frustum.handle + 8, boxes.handle, boxes.length, at);
        return memory.bytes.slice(at, at + boxes.length);
    } finally {
        memory.free(at);
    }
}
