// What the page holds: numbers as JSON, and the pixels of its images as blocks of text at its end,
// which are decoded when they are looked at (their layout: pixel_block.h).
"use strict";

const report = JSON.parse(document.getElementById("data").textContent);

// An element with properties (`class`, `text`, `data-…` and listeners by name) and children.
function element(tag, properties = {}, ...children) {
    const made = document.createElement(tag);
    for (const [name, value] of Object.entries(properties)) {
        if (typeof value === "function")
            made.addEventListener(name, value);
        else if (name === "text")
            made.textContent = value;
        else
            made.setAttribute(name, value);
    }
    made.append(...children);
    return made;
}

// What outlives a reload, where the browser lets pages from disk keep anything.
const kept = {
    save(key, value) {
        try {
            sessionStorage.setItem(`${key} of ${report.experiment}`, JSON.stringify(value));
        } catch {
            // It is looked at from the start, then.
        }
    },
    load(key) {
        try {
            return JSON.parse(sessionStorage.getItem(`${key} of ${report.experiment}`)) ?? {};
        } catch {
            return {};
        }
    },
};

const kHalfToFloat = Float32Array.from({length: 65536}, (_, bits) => {
    const sign = bits & 0x8000 ? -1 : 1;
    const exponent = (bits >> 10) & 31;
    const fraction = bits & 1023;
    if (exponent === 31) return fraction ? NaN : sign * Infinity;
    if (exponent === 0) return sign * fraction * 2 ** -24;
    return sign * (1 + fraction / 1024) * 2 ** (exponent - 15);
});

const nextFrame = () => new Promise((resolve) => setTimeout(resolve, 20));

// While the page is still loading, blocks further down are not there yet.
async function textOfBlock(number) {
    for (;;) {
        const holder = document.getElementById(`block-${number}`);
        const isWhole = document.readyState !== "loading" ||
            (holder !== null && holder.nextElementSibling !== null);
        if (holder !== null && isWhole) return holder.textContent;
        if (isWhole) throw new Error(`the page has lost its image ${number}`);
        await nextFrame();
    }
}

async function inflate(text) {
    if (typeof DecompressionStream === "undefined") {
        throw new Error("this browser is too old: it has no DecompressionStream");
    }
    const packed = atob(text);
    const bytes = new Uint8Array(packed.length);
    for (let i = 0; i < bytes.length; ++i) bytes[i] = packed.charCodeAt(i);
    const stream = new Blob([bytes]).stream().pipeThrough(new DecompressionStream("deflate-raw"));
    return new Uint8Array(await new Response(stream).arrayBuffer());
}

// The bits of value `i` of a plane, of which the highest bytes come first.
function bitsOfPlane(bytes, plane, n, nBytes) {
    const bits = nBytes === 2 ? new Uint16Array(n) : new Uint32Array(n);
    const start = plane * nBytes * n;
    for (let b = 0; b < nBytes; ++b) {
        const shift = 8 * (nBytes - 1 - b);
        for (let i = 0; i < n; ++i) bits[i] |= bytes[start + b * n + i] << shift;
    }
    return bits;
}

// {width, height, planes: red, green and blue as floats, isHalf}.
async function decodeBlock(number) {
    const {width, height, precision, scale} = report.blocks[number];
    const bytes = await inflate(await textOfBlock(number));
    const n = width * height;
    const isHalf = precision === "half";
    const bits = [0, 1, 2].map((plane) => bitsOfPlane(bytes, plane, n, isHalf ? 2 : 4));
    for (const plane of [bits[0], bits[2]]) {
        for (let i = 0; i < n; ++i) plane[i] += bits[1][i];
    }
    const planes = bits.map((plane) => {
        if (!isHalf) return new Float32Array(plane.buffer);
        const values = new Float32Array(n);
        for (let i = 0; i < n; ++i) values[i] = kHalfToFloat[plane[i]] / scale;
        return values;
    });
    return {width, height, planes, isHalf};
}

// The values of the keys that were asked for last, as many as weigh no more than a limit.
class Cache {
    constructor(limit, make, weigh) {
        Object.assign(this, {limit, make, weigh, weight: 0, held: new Map()});
    }
    get(key) {
        const known = this.held.get(key);
        const entry = known ?? {value: this.make(key), weight: this.weigh(key)};
        if (known === undefined) this.weight += entry.weight;
        this.held.delete(key);
        this.held.set(key, entry);
        for (const [oldest, {weight}] of this.held) {
            if (this.weight <= this.limit || oldest === key) break;
            this.held.delete(oldest);
            this.weight -= weight;
        }
        return entry.value;
    }
}

const kDecodedBytes = 256 * 2 ** 20;
const decodedBlocks = new Cache(kDecodedBytes, decodeBlock,
    (number) => 12 * report.blocks[number].width * report.blocks[number].height);
