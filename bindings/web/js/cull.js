// SPDX-License-Identifier: MIT
import { failure } from './error.js';
import { Owned, create, indicesOf } from './memory.js';

/** The answer to a query, in memory that is kept. Its arrays are views: valid until its next query or any growth of memory. */
export class VisibleSet extends Owned {
    constructor(memory) { super(memory, 'VisibleSet', create(memory, 'visible_set'), '_crofton_visible_set_destroy'); }
    #items() {
        const at = this.memory.scratch(16);
        this.memory.call('visible_set_items', this.handle, at, at + 4, at + 8);
        return this.memory.words.subarray(at >> 2, (at >> 2) + 3);
    }
    get length() { return this.#items()[2]; }
    get ids() {
        const [ids, , count] = this.#items();
        return this.memory.words.subarray(ids >> 2, (ids >> 2) + count);
    }
    /** 1: straddling, 2: inside, for each of `ids`. */
    get verdicts() {
        const [, verdicts, count] = this.#items();
        return this.memory.bytes.subarray(verdicts, verdicts + count);
    }
    get statistics() {
        const at = this.memory.scratch(56);
        this.memory.words[at >> 2] = 56;
        this.memory.call('visible_set_statistics', this.handle, at);
        const names = ['nodesTested', 'boxesTested', 'acceptedWhole', 'straddling', 'exactTests', 'falsePositives'];
        return Object.fromEntries(names.map((name, i) => [name, this.memory.words[(at >> 2) + 2 + 2 * i]]));
    }
}

function writeOptions(memory, { conservative = false, treeOrder = false } = {}) {
    if (!conservative && !treeOrder) return 0;
    const at = memory.scratch(24);
    memory.words.set([24, conservative ? 1 : 0, treeOrder ? 1 : 0], at >> 2);
    return at;
}

/** A hierarchy over boxes, which it copies. */
export class Tree extends Owned {
    constructor(memory, boxes) {
        super(memory, 'Tree', create(memory, 'tree', boxes.handle, 0, boxes.length, 0), '_crofton_tree_destroy');
    }
    cull(frustum, visible, how) {
        this.memory.call('cull_tree', this.handle, frustum.handle, writeOptions(this.memory, how), 0, visible.handle);
        return visible;
    }
    /** `items`: ids; item items[i] becomes box i. Call refit before the next query. */
    move(items, boxes) {
        if (items.length !== boxes.length) throw failure(3, `${items.length} items and ${boxes.length} boxes`);
        this.memory.lend([indicesOf(items, 'items')], (at) => this.memory.call('tree_move', this.handle, at, boxes.handle, items.length));
    }
    remove(item) { this.memory.call('tree_remove', this.handle, indicesOf([item], 'item')[0]); }
    refit() { this.memory.call('tree_refit', this.handle); }
}

/** The same from a plain list of boxes, without a tree. */
export function cullBoxes(memory, boxes, frustum, visible, how) {
    memory.call('cull_boxes', boxes.handle, 0, boxes.length, frustum.handle, writeOptions(memory, how), 0, visible.handle);
    return visible;
}

/** A verdict a box, exactly: 0 outside, 1 straddling, 2 inside. */
export function classify(memory, boxes, frustum) {
    const at = memory.allocate(boxes.length, 'verdicts');
    try {
        memory.call('classify', frustum.handle + 8, boxes.handle, boxes.length, at);
        return memory.bytes.slice(at, at + boxes.length);
    } finally {
        memory.free(at);
    }
}
