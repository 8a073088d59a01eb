// The images: one method at a time in place, or all beside each other, with everything else staying
// where it is.

const kReference = 0;  // the reference's number among the methods
const kMean = "mean";
const kMostZoom = 400;              // screen pixels a pixel
const kReadoutHeight = 150;         // with the caption
const kMostBitmaps = 64 * 2 ** 20;  // bytes

const step = (from, by, length) => (from + by + length) % length;
const keyOfImage = (scene, method, budget, seed) => [scene, method, budget, seed].join("/");

class Viewer {
    constructor(root) {
        this.root = root;
        this.methods = ["reference", ...report.methods];
        this.images = new Map();
        for (const image of report.images) {
            const method = image.method === null ? kReference : image.method + 1;
            const key = method === kReference ?
                keyOfImage(image.scene, method, "", "") :
                keyOfImage(image.scene, method, image.budget, image.seed);
            this.images.set(key, image);
        }
        this.seeds =
            [...new Set(report.images.map((image) => image.seed).filter((s) => s !== null))];
        if (this.seeds.length === 0) this.seeds = [kMean];
        this.state = {
            scene: 0,
            method: Math.min(1, report.methods.length),
            budget: 0,
            seed: this.seeds[0],
            mode: "image",
            stops: 0,
            isGrid: false,
        };
        this.before = kReference;
        this.views = new Map();  // by scene
        this.selection = null;
        this.bitmaps = new Cache(kMostBitmaps, (key) => this.makeBitmap(key),
            (key) => 4 * report.blocks[key.split("|")[0]].width *
                report.blocks[key.split("|")[0]].height);
        this.panes = [];
        this.buildTools();
        this.listen();
        this.shown = Promise.resolve();
    }

    // --- what is looked at -----------------------------------------------------------------------

    imageOf(method) {
        const {scene, budget, seed} = this.state;
        const key = method === kReference ? keyOfImage(scene, method, "", "") :
                                            keyOfImage(scene, method, budget, seed);
        return this.images.get(key);
    }

    // Where no image is finished, there may still be one of another method.
    anyBlock() {
        return report.images.find((image) => image.scene === this.state.scene)?.block;
    }

    // Where nothing is finished yet, no place is worth keeping.
    get view() {
        const {scene} = this.state;
        const block = this.anyBlock();
        if (block === undefined) return {x: 0, y: 0, zoom: 1};
        if (!this.views.has(scene)) {
            const {width, height} = report.blocks[block];
            this.views.set(scene, {x: width / 2, y: height / 2, zoom: 1});
        }
        return this.views.get(scene);
    }

    // Stops of exposure: the image's are relative to its scene's, those of errors to what is typical
    // of it.
    stopsOf(mode) {
        const {scene, stops} = this.state;
        const own =
            mode === "error" ? -Math.log2(typicalError(scene)) : report.scenes[scene].exposure;
        return stops + own;
    }

    set(change) {
        if (change.method !== undefined && change.method !== this.state.method) {
            this.before = this.state.method;
        }
        if (change.scene !== undefined && change.scene !== this.state.scene) this.selection = null;
        Object.assign(this.state, change);
        this.shown = this.show().catch((error) => {
            this.readout.textContent = error.message;
        });
        return this.shown;
    }

    async makeBitmap(key) {
        const [block, mode, stops, reference] = key.split("|");
        const decoded = [decodedBlocks.get(Number(block))];
        if (reference !== "") decoded.push(decodedBlocks.get(Number(reference)));
        const [image, other] = await Promise.all(decoded);
        return {image, bitmap: paint(mode, image, other, Number(stops))};
    }

    // What a pane shows of a method: {image, bitmap}, or why there is nothing.
    async picture(method) {
        const {mode} = this.state;
        const image = this.imageOf(method);
        if (image === undefined) return {missing: "no image"};
        const reference = this.imageOf(kReference);
        if (kModes[mode].needsReference && reference === undefined)
            return {missing: "no reference"};
        const other = kModes[mode].needsReference ? reference.block : "";
        return this.bitmaps.get([image.block, mode, this.stopsOf(mode), other].join("|"));
    }

    // Shows the state; a later call overtakes one that is still decoding.
    async show() {
        this.updateTools();
        const turn = (this.turn = (this.turn ?? 0) + 1);
        const {mode} = this.state;
        const methods = this.state.isGrid ? this.methods.map((_, i) => i) : [this.state.method];
        const pictures = await Promise.all(methods.map((method) => this.picture(method)));
        const reference = this.imageOf(kReference);
        const decodedReference = reference && (await decodedBlocks.get(reference.block));
        if (turn !== this.turn) return;
        this.reference = decodedReference;
        this.layOut(methods);
        pictures.forEach((picture, i) => {
            const pane = this.panes[i];
            pane.method = methods[i];
            pane.bitmap = picture.bitmap ?? null;
            pane.image = picture.image ?? null;
            pane.values = (p) => kModes[mode].values(pane.image, decodedReference, p);
            const missing = picture.missing ? `: ${picture.missing}` : "";
            pane.label.textContent = this.methods[methods[i]] + missing;
            pane.label.hidden = !this.state.isGrid && missing === "";
            pane.root.classList.toggle(
                "picked", this.state.isGrid && methods[i] === this.state.method);
        });
        this.draw();
        this.tellPixel();
        this.save();
        setTimeout(() => this.decodeAhead(turn), 50);
    }

    // So that flipping to the other methods does not wait.
    async decodeAhead(turn) {
        for (let method = 0; method < this.methods.length && turn === this.turn; ++method) {
            const image = this.imageOf(method);
            if (image !== undefined) await decodedBlocks.get(image.block);
        }
    }

    layOut(methods) {
        while (this.panes.length > methods.length) this.panes.pop().root.remove();
        while (this.panes.length < methods.length) {
            const pane = new Pane("");
            this.panes.push(pane);
            this.stage.append(pane.root);
        }
        const block = this.anyBlock();
        const {width, height} = block === undefined ? {width: 4, height: 3} : report.blocks[block];
        const columns = methods.length === 1 ?
            1 :
            Math.min(methods.length, this.stage.clientWidth < 900 ? 2 : 3);
        const gap = 6;
        const paneWidth = Math.floor((this.stage.clientWidth - gap * (columns - 1)) / columns);
        // The viewer fits into the window, from its first button to its readout.
        const above =
            this.stage.getBoundingClientRect().top - this.root.getBoundingClientRect().top;
        const most = Math.max(300, window.innerHeight - above - kReadoutHeight);
        const paneHeight = Math.floor(Math.min(most, (paneWidth * height) / width));
        this.stage.style.gridTemplateColumns = `repeat(${columns}, max-content)`;
        for (const pane of this.panes) pane.resize(paneWidth, paneHeight);
    }

    draw() {
        for (const pane of this.panes) pane.draw(this.view, this.selection);
        const pane = this.panes.find((p) => p.image !== null);
        const scale = pane ? pane.scale(pane.image, this.view) : 1;
        this.magnification.textContent =
            `${scale >= 10 ? scale.toFixed(0) : scale.toPrecision(2)} ×`;
    }

    // --- pixels ----------------------------------------------------------------------------------

    // Everything known of one pixel, as numbers: `image` and `reference` are [red, green, blue].
    async pixel(method, x, y) {
        const entry = this.imageOf(method);
        const image = entry && (await decodedBlocks.get(entry.block));
        return image && this.valuesAt(image, x, y);
    }

    valuesAt(image, x, y) {
        const i = y * image.width + x;
        const values = {x, y, image: image.planes.map((plane) => plane[i])};
        if (!this.reference) return values;
        values.reference = this.reference.planes.map((plane) => plane[i]);
        values.difference = differenceAt(image, this.reference, i);
        values.error = relativeSquaredErrorAt(image, this.reference, i);
        return values;
    }

    tellPixel() {
        const {pane, x, y} = this.pointer ?? {};
        const image = pane?.image;
        if (!image || x < 0 || y < 0 || x >= image.width || y >= image.height) {
            this.readout.textContent = this.selection ?
                `crop ${this.cropText()}: c copies it` :
                "point at a pixel for its values; drag pans, the wheel zooms, shift and drag selects";
            return;
        }
        const values = this.valuesAt(image, x, y);
        const line = (place, name, numbers) => place.padEnd(18) + name.padEnd(10) +
            numbers.map((v) => v.toPrecision(6).padStart(13)).join("");
        const number = (value) => value.toPrecision(4).padStart(12);
        const at = `x ${String(x).padStart(4)}  y ${String(y).padStart(4)}`;
        let text = line(at, "image", values.image);
        if (values.reference) {
            text += `     difference            ${number(values.difference)}\n`;
            text += line("", "reference", values.reference);
            text += `     relative squared error${number(values.error)}`;
        }
        this.readout.textContent = text;
    }

    // As figure files write it.
    cropText() {
        const {x, y, w, h} = this.selection;
        return `[${x}, ${y}, ${w}, ${h}]`;
    }

    // What is selected, else what is in sight, as large as it is shown.
    async copyCrop() {
        const pane = this.panes.find((p) => p.method === this.state.method) ?? this.panes[0];
        if (!pane?.image) return;
        const crop = this.selection ?? this.inSight(pane);
        const k = Math.max(1, Math.round(pane.scale(pane.image, this.view)));
        const canvas = new OffscreenCanvas(k * crop.w, k * crop.h);
        const context = canvas.getContext("2d");
        context.imageSmoothingEnabled = false;
        context.drawImage(
            pane.bitmap, crop.x, crop.y, crop.w, crop.h, 0, 0, k * crop.w, k * crop.h);
        const blob = await canvas.convertToBlob({type: "image/png"});
        const what = `[${crop.x}, ${crop.y}, ${crop.w}, ${crop.h}], magnified ${k} ×`;
        try {
            await navigator.clipboard.write([new ClipboardItem({"image/png": blob})]);
            this.readout.textContent = `copied ${what}`;
        } catch {
            // The browser keeps its clipboard to itself.
            const {scene, method} = this.state;
            const name = `${report.scenes[scene].name}-${this.methods[method]}.png`;
            const link = element(
                "a", {href: URL.createObjectURL(blob), download: name.replaceAll("/", "-")});
            link.click();
            setTimeout(() => URL.revokeObjectURL(link.href), 1000);
            this.readout.textContent = `saved ${what}`;
        }
        return {blob, crop, k};
    }

    inSight(pane) {
        const [left, top] = pane.toImage(pane.image, this.view, 0, 0);
        const [right, bottom] = pane.toImage(pane.image, this.view, pane.width, pane.height);
        const x = Math.max(0, Math.floor(left));
        const y = Math.max(0, Math.floor(top));
        return {
            x,
            y,
            w: Math.max(1, Math.min(pane.image.width, Math.ceil(right)) - x),
            h: Math.max(1, Math.min(pane.image.height, Math.ceil(bottom)) - y),
        };
    }

    // --- the state over a reload -----------------------------------------------------------------

    save() {
        kept.save("viewer", {...this.state, views: [...this.views]});
    }

    restore() {
        const {views, ...state} = kept.load("viewer");
        const isThere = state.scene < report.scenes.length && state.method < this.methods.length &&
            state.budget < report.budgets.length && this.seeds.includes(state.seed);
        if (!isThere) return this.set({});
        this.views = new Map(views);
        return this.set(state);
    }
}
