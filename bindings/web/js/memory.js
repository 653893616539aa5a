// SPDX-License-Identifier: MIT
// The library's memory: views that survive its growth, temporary arrays, and errors of calls.
import { failure } from './error.js';

const MOST = 0x7fff0000;

/** Throws if `array` is of the wrong type or its buffer was transferred. */
export function checkArray(array, kinds, what) {
    if (!kinds.some((kind) => array instanceof kind))
        throw failure(1, `${what} must be a ${kinds.map((kind) => kind.name).join(' or ')}`);
    if (array.length === 0) {
        try {
            new Uint8Array(array.buffer);
        } catch {
            throw failure(1, `${what}: its ArrayBuffer is detached (it was transferred, or the memory it views has grown)`);
        }
    }
    return array;
}

/** Returns a vector's numbers. Throws if their number is not `count`. */
export function numbersOf(vector, count, what) {
    if (ArrayBuffer.isView(vector)) checkArray(vector, [vector.constructor], what);
    const numbers = Array.from(vector ?? []);
    if (numbers.length !== count) throw failure(1, `${what} must have ${count} numbers, and there are ${numbers.length}`);
    return numbers;
}

/** Throws if an array does not consist of whole groups of `count` numbers. */
export function checkGroups(array, count, what) {
    if (array.length % count) throw failure(1, `${what} must have ${count} numbers each, and there are ${array.length}`);
}

/** Throws unless `list` is an array of objects. */
export function checkRecords(list, what) {
    if (!Array.isArray(list)) throw failure(1, `${what} must be an array`);
    const bad = list.findIndex((item) => typeof item !== 'object' || item === null);
    if (bad >= 0) throw failure(1, `${what}: item ${bad} is no object`, bad);
    return list;
}

/** Converts indices for the library. Throws for numbers that are not integers of 32 bits. */
export function indicesOf(numbers, what) {
    const indices = Uint32Array.from(numbers);
    const bad = indices.findIndex((index, i) => index !== numbers[i]);
    if (bad >= 0) throw failure(3, `${what}: ${numbers[bad]} is no index`, bad);
    return indices;
}

export class Memory {
    #bytes; #doubles; #floats; #words;
    #thrown; #hook = 0; #scratch = 0; #scratchBytes = 0;

    constructor(module) {
        this.module = module;
    }

    #renew() {
        const { buffer } = this.module.HEAPU8;
        this.#bytes = new Uint8Array(buffer);
        this.#doubles = new Float64Array(buffer);
        this.#floats = new Float32Array(buffer);
        this.#words = new Uint32Array(buffer);
    }
    get bytes() { if (!this.#bytes?.length) this.#renew(); return this.#bytes; }
    get doubles() { if (!this.#bytes?.length) this.#renew(); return this.#doubles; }
    get floats() { if (!this.#bytes?.length) this.#renew(); return this.#floats; }
    get words() { if (!this.#bytes?.length) this.#renew(); return this.#words; }

    allocate(bytes, what) {
        if (!Number.isInteger(bytes) || bytes < 0) throw failure(1, `${what}: ${bytes} is no size`);
        const place = bytes > MOST ? 0 : this.module._malloc(bytes + 8);
        if (!place) throw failure(17, `${what}: ${bytes} bytes do not fit into WebAssembly's memory`);
        return place;
    }
    free(place) { this.module._free(place); }

    /** Returns zeroed memory for the structs of one call; the next call reuses it. */
    scratch(bytes) {
        if (bytes > this.#scratchBytes) {
            const place = this.allocate(bytes, 'a call');
            if (this.#scratch) this.free(this.#scratch);
            [this.#scratch, this.#scratchBytes] = [place, bytes];
        }
        this.bytes.fill(0, this.#scratch, this.#scratch + bytes);
        return this.#scratch;
    }

    /** Copies typed arrays into the library's memory while `use` runs. */
    lend(arrays, use) {
        const places = [];
        try {
            for (const array of arrays) {
                const place = this.allocate(array.byteLength, 'an array');
                places.push(place);
                this.bytes.set(new Uint8Array(array.buffer, array.byteOffset, array.byteLength), place);
            }
            return use(...places);
        } finally {
            for (const place of places) this.free(place);
        }
    }

    /** Writes the struct that a function of the library returns. */
    fill(name, at) { this.module[`_crofton_${name}`](at); }

    /** Calls a function of the library. Throws for a status that is not 0, and what a callback threw. */
    call(name, ...given) {
        let status;
        try {
            status = this.module[`_crofton_${name}`](...given);
        } catch (error) {
            if (error instanceof TypeError) throw failure(1, `crofton_${name}: a number is expected: ${error.message}`);
            throw failure(13, `crofton_${name} stopped: ${error?.message ?? error}`);
        }
        if (this.#thrown) {
            const { error } = this.#thrown;
            this.#thrown = undefined;
            throw error;
        }
        if (status !== 0)
            throw failure(status, this.text(this.module._crofton_last_error()), this.module._crofton_web_error_item());
    }

    text(place) {
        const { bytes } = this;
        let end = place;
        while (bytes[end]) ++end;
        return new TextDecoder().decode(bytes.slice(place, end));
    }

    /** `logger(level, message)`. The call that logged rethrows what it throws when it is done. */
    setLogger(logger) {
        if (logger && typeof logger !== 'function') throw failure(1, 'a logger is a function, or null');
        const hook = logger && this.module.addFunction((_user, level, message) => {
            try {
                logger(level, this.text(message));
            } catch (error) {
                this.#thrown ??= { error };
            }
        }, 'viii');
        this.call('set_log_hook', hook || 0, 0);
        if (this.#hook) this.module.removeFunction(this.#hook);
        this.#hook = hook || 0;
    }
    log(level, message) {
        this.lend([new TextEncoder().encode(`${message}\0`)], (place) => this.call('log', level, place));
    }
}

/** Something that the library owns until it is freed. The garbage collector frees what was forgotten. */
const forgotten = new FinalizationRegistry(({ memory, place, release }) => memory.module[release](place));

export class Owned {
    #place; #memory; #name;
    constructor(memory, name, place, release) {
        [this.#memory, this.#name, this.#place] = [memory, name, place];
        this.#release = release;
        forgotten.register(this, { memory, place, release }, this);
    }
    #release;
    /** The handle; throws after free. */
    get handle() {
        if (!this.#place) throw failure(14, `this ${this.#name} was freed: make another`);
        return this.#place;
    }
    get memory() { return this.#memory; }
    get typeName() { return this.#name; }
    free() {
        if (!this.#place) return;
        forgotten.unregister(this);
        this.#memory.module[this.#release](this.#place);
        this.#place = 0;
    }
}

/** The handle of an argument. Throws unless it is a `name` of this library; `item`: its place in a list. */
export function handleOf(memory, thing, name, item) {
    if (!(thing instanceof Owned && thing.typeName === name)) throw failure(1, `a ${name} is expected here`, item);
    if (thing.memory !== memory) throw failure(1, `this ${name} comes from another call of load()`, item);
    return thing.handle;
}

/** Calls crofton_NAME_create, whose last parameter takes the handle. */
export function create(memory, name, ...given) {
    const slot = memory.allocate(8, name);
    try {
        memory.call(`${name}_create`, ...given, slot);
        return memory.words[slot >> 2];
    } finally {
        memory.free(slot);
    }
}
