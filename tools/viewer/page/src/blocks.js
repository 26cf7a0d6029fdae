// SPDX-License-Identifier: GPL-3.0-or-later
// Arrays as the page carries them: base64 of a zlib stream of bytes sorted by significance, of differences. The other
// side is tools/viewer/block.cpp.

const kinds = { u8: [Uint8Array, 1], u16: [Uint16Array, 2], u32: [Uint32Array, 4], f32: [Uint32Array, 4] };

function bytesOf(base64) {
    if (Uint8Array.fromBase64) return Uint8Array.fromBase64(base64);
    const text = atob(base64);
    const bytes = new Uint8Array(text.length);
    for (let i = 0; i < text.length; ++i) bytes[i] = text.charCodeAt(i);
    return bytes;
}

async function inflate(bytes) {
    const stream = new Blob([bytes]).stream().pipeThrough(new DecompressionStream("deflate"));
    return new Uint8Array(await new Response(stream).arrayBuffer());
}

function joinPlanes(bytes, length, size, Type) {
    const out = new Type(length);
    if (size === 1) out.set(bytes);
    else if (size === 2) for (let i = 0; i < length; ++i) out[i] = bytes[i] | (bytes[length + i] << 8);
    else
        for (let i = 0; i < length; ++i)
            out[i] =
                bytes[i] | (bytes[length + i] << 8) | (bytes[2 * length + i] << 16) | (bytes[3 * length + i] << 24);
    return out;
}

/** Bytes of a block -> typed array. `about` = [element, length, order, stride]. */
export async function decode(base64, about) {
    const [element, length, order, stride] = about;
    const [Type, size] = kinds[element];
    const bytes = await inflate(bytesOf(base64));
    if (bytes.length !== length * size) throw new Error("a block of this page is damaged");
    const values = joinPlanes(bytes, length, size, Type);
    for (let k = 0; k < order; ++k) for (let i = stride; i < length; ++i) values[i] += values[i - stride];
    return element === "f32" ? new Float32Array(values.buffer) : values;
}

/** Reads blocks from the document; each is decoded once and its text is then dropped. */
export class BlockStore {
    constructor(about, root = document) {
        this.about = about;
        this.root = root;
        this.cache = new Map();
    }
    get(id) {
        if (id === null || id === undefined) return Promise.resolve(null);
        if (!this.cache.has(id)) {
            const element = this.root.getElementById("b" + id);
            const promise = element
                ? decode(element.textContent, this.about[id])
                : Promise.reject(new Error("a block of this page is missing"));
            promise.then(() => element && element.remove(), () => {});
            this.cache.set(id, promise);
        }
        return this.cache.get(id);
    }
}
