// The viewer's buttons, keys and pointer.

const kMostButtons = 12;  // of scenes

Object.assign(Viewer.prototype, {
    buildTools() {
        this.pickers = [];
        // `keys` are of the buttons, `key` goes from one to the next.
        const picker = (label, names, value, pick, {keys = [], key} = {}) => {
            const buttons = names.map((name, i) => {
                const button = element("button", {type: "button", click: () => pick(i)});
                if (i < keys.length) button.append(element("kbd", {text: keys[i]}), " ");
                button.append(name);
                return button;
            });
            this.pickers.push(
                () => buttons.forEach((b, i) => b.classList.toggle("picked", i === value())));
            const row = element("div", {class: "picker"}, element("span", {text: label}), ...buttons);
            if (key !== undefined && names.length > 1) row.append(element("kbd", {text: key}));
            return row;
        };
        const modes = Object.keys(kModes);
        const {state} = this;
        this.root.append(this.scenePicker(picker, report.scenes.map((scene) => scene.name)),
            picker("method", this.methods, () => state.method, (method) => this.set({method}),
                {keys: [..."0123456789"], key: "← →"}));
        if (report.budgets.length > 1) {
            this.root.append(picker(
                "budget", report.budgets, () => state.budget, (budget) => this.set({budget}),
                {key: "↑ ↓"}));
        }
        if (this.seeds.length > 1) {
            const names = this.seeds.map((s) => (s === kMean ? "mean of all" : String(s)));
            this.root.append(picker("seed", names, () => this.seeds.indexOf(state.seed),
                (i) => this.set({seed: this.seeds[i]}), {key: "n"}));
        }
        const show = picker("show", modes.map((m) => kModes[m].name),
            () => modes.indexOf(state.mode), (i) => this.set({mode: modes[i]}),
            {keys: modes.map((m) => kModes[m].key)});
        this.exposure = element("input", {
            type: "range",
            min: -12,
            max: 12,
            step: 0.25,
            input: () => this.set({stops: Number(this.exposure.value)}),
        });
        this.exposureText = element("output");
        this.magnification = element("output");
        const button = (text, key, click) =>
            element("button", {type: "button", click}, element("kbd", {text: key}), ` ${text}`);
        this.gridButton = button("side by side", "g", () => this.set({isGrid: !state.isGrid}));
        this.bar = element("span", {class: "color-bar"});
        show.append(
            element("label", {class: "exposure"}, "exposure ", element("kbd", {text: "e E"}), " ",
                this.exposure), this.exposureText);
        const place = element("div", {class: "picker"}, element("span", {text: "view"}),
            this.gridButton, button("whole image", "z", () => this.showAll()),
            button("copy crop", "c", () => this.copyCrop()), this.magnification, this.bar);
        this.stage = element("div", {class: "stage"});
        this.readout = element("pre", {class: "readout"});
        this.caption = element("p", {class: "caption"});
        this.root.append(show, place, this.stage, this.readout, this.caption);
    },

    // Many scenes would push the images out of sight.
    scenePicker(picker, names) {
        if (names.length <= kMostButtons) {
            return picker("scene", names, () => this.state.scene, (scene) => this.set({scene}),
                {key: "s"});
        }
        const select = element("select", {
            change: () => {
                select.blur();  // so that keys go to the viewer again
                this.set({scene: select.selectedIndex});
            },
        },
            ...names.map((text) => element("option", {text})));
        this.pickers.push(() => {
            select.selectedIndex = this.state.scene;
        });
        return element("div", {class: "picker"}, element("span", {text: "scene"}), select,
            element("kbd", {text: "s"}));
    },

    updateTools() {
        for (const update of this.pickers) update();
        const {stops, mode, method, isGrid} = this.state;
        const all = mode === "error" ? stops : this.stopsOf(mode);
        this.exposure.value = stops;
        this.exposureText.textContent = `${all < 0 ? "−" : "+"}${Math.abs(all)} stops`;
        this.gridButton.classList.toggle("picked", isGrid);
        const bar = kModes[mode].bar?.(this.stopsOf(mode));
        // Without it nothing moves.
        this.bar.classList.toggle("unused", bar === undefined);
        if (bar) this.bar.replaceChildren(...colorBar(bar));
        const image = this.imageOf(method);
        this.caption.textContent =
            image ? image.caption : `${this.methods[method]}: no image`;
        if (image && report.blocks[image.block].precision === "half") {
            this.caption.textContent += " · half floats: values are rounded to 11 bits";
        }
    },

    showAll() {
        this.views.delete(this.state.scene);
        return this.set({});
    },

    // --- pointer
    // -----------------------------------------------------------------------------------

    listen() {
        this.stage.addEventListener("wheel", (event) => this.onWheel(event), {passive: false});
        this.stage.addEventListener("pointerdown", (event) => this.onDown(event));
        this.stage.addEventListener("pointermove", (event) => this.onMove(event));
        this.stage.addEventListener("pointerup", (event) => this.onUp(event));
        this.stage.addEventListener("pointerleave", () => {
            this.pointer = undefined;
            this.tellPixel();
        });
        document.addEventListener("keydown", (event) => this.onKey(event));
        new ResizeObserver(() => this.set({})).observe(this.root);
    },

    // The pane under the pointer, and where on it that is.
    placeOf(event) {
        const pane = this.panes.find((p) => p.canvas === event.target) ?? this.drag?.pane;
        if (!pane?.image) return undefined;
        const box = pane.canvas.getBoundingClientRect();
        const place = {pane, canvasX: event.clientX - box.left, canvasY: event.clientY - box.top};
        const [x, y] = pane.toImage(pane.image, this.view, place.canvasX, place.canvasY);
        return {...place, exactX: x, exactY: y, x: Math.floor(x), y: Math.floor(y)};
    },

    // Zooms, and keeps what is under the pointer there.
    onWheel(event) {
        const place = this.placeOf(event);
        if (!place) return;
        event.preventDefault();
        this.zoomAt(place, 2 ** (-event.deltaY / 240));
    },

    zoomAt({pane, canvasX, canvasY, exactX, exactY}, factor) {
        const {view} = this;
        const whole = pane.scale(pane.image, {...view, zoom: 1});
        view.zoom = Math.min(kMostZoom / whole, Math.max(0.25, view.zoom * factor));
        const scale = whole * view.zoom;
        view.x = exactX - (canvasX - pane.width / 2) / scale;
        view.y = exactY - (canvasY - pane.height / 2) / scale;
        this.draw();
        this.save();
    },

    onDown(event) {
        const place = this.placeOf(event);
        if (!place || event.button !== 0) return;
        place.pane.canvas.setPointerCapture(event.pointerId);
        this.drag = {...place, from: {...this.view}, selects: event.shiftKey, moved: false};
        event.preventDefault();
    },

    onMove(event) {
        const place = this.placeOf(event);
        this.pointer = place;
        const {drag} = this;
        if (drag && place) {
            const [dx, dy] = [place.canvasX - drag.canvasX, place.canvasY - drag.canvasY];
            drag.moved ||= Math.hypot(dx, dy) > 3;
            if (drag.moved && drag.selects)
                this.select(drag, place);
            else if (drag.moved) {
                const scale = place.pane.scale(place.pane.image, this.view);
                this.view.x = drag.from.x - dx / scale;
                this.view.y = drag.from.y - dy / scale;
            }
            if (drag.moved) this.draw();
        }
        this.tellPixel();
    },

    select(from, to) {
        const {width, height} = to.pane.image;
        const inside = (value, n) => Math.min(n - 1, Math.max(0, value));
        const [x0, x1] = [from.x, to.x].map((x) => inside(x, width)).sort((a, b) => a - b);
        const [y0, y1] = [from.y, to.y].map((y) => inside(y, height)).sort((a, b) => a - b);
        this.selection = {x: x0, y: y0, w: x1 - x0 + 1, h: y1 - y0 + 1};
    },

    // A click goes back and forth between two methods, or picks one of several.
    onUp() {
        const {drag} = this;
        this.drag = undefined;
        if (!drag) return;
        if (drag.moved && drag.selects)
            this.readout.textContent = `crop ${this.cropText()}: c copies it`;
        else if (drag.moved)
            this.save();
        else if (this.state.isGrid)
            this.set({method: drag.pane.method, isGrid: false});
        else
            this.set({method: this.before});
    },

    // --- keys
    // --------------------------------------------------------------------------------------

    onKey(event) {
        const isTyping = event.target.matches("input:not([type=range]), select, textarea");
        if (isTyping || event.ctrlKey || event.altKey || event.metaKey) return;
        const action = this.actionOf(event.key);
        if (action === undefined) return;
        event.preventDefault();
        action();
    },

    actionOf(key) {
        const {scene, method, budget, seed, stops, isGrid} = this.state;
        const number = "0123456789".indexOf(key);
        if (number >= 0)
            return number < this.methods.length ? () => this.set({method: number}) : undefined;
        const toMethod = (by) => () => this.set({method: step(method, by, this.methods.length)});
        const toBudget = (by) => report.budgets.length > 1 ?
            () => this.set({budget: step(budget, by, report.budgets.length)}) :
            undefined;
        const toScene = (by) => () => this.set({scene: step(scene, by, report.scenes.length)});
        const toSeed = (by) => () =>
            this.set({seed: this.seeds[step(this.seeds.indexOf(seed), by, this.seeds.length)]});
        const forget = () => {
            this.selection = null;
            return this.set({});
        };
        const actions = {
            ArrowRight: toMethod(1),
            ArrowLeft: toMethod(-1),
            ArrowDown: toBudget(1),
            ArrowUp: toBudget(-1),
            s: toScene(1),
            S: toScene(-1),
            n: toSeed(1),
            N: toSeed(-1),
            x: () => this.set({method: this.before}),
            e: () => this.set({stops: Math.min(12, stops + 0.5)}),
            E: () => this.set({stops: Math.max(-12, stops - 0.5)}),
            g: () => this.set({isGrid: !isGrid}),
            z: () => this.showAll(),
            c: () => this.copyCrop(),
            Escape: forget,
            "?": () => {
                const keys = document.getElementById("keys");
                keys.open = !keys.open;
            },
        };
        for (const [mode, {key: its}] of Object.entries(kModes))
            actions[its] = () => this.set({mode});
        return actions[key];
    },
});

function colorBar({map, low, high, name}) {
    const stops = [0, 0.25, 0.5, 0.75, 1].map((t) => `rgb(${colorAt(map, t).join(" ")})`);
    return [
        low,
        element("i", {style: `background: linear-gradient(to right, ${stops.join(", ")})`}),
        `${high}  ${name}`,
    ];
}
