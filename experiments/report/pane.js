// One image on the screen. All panes look at the same place of their images: `view` is the point in
// the middle, in pixels of the image, and the magnification relative to showing all of it.

// From so many screen pixels a pixel on there is room for its values.
const kRoomForValues = 64;

class Pane {
    constructor(label) {
        this.canvas = element("canvas");
        this.label = element("span", {class: "pane-label", text: label});
        this.root = element("div", {class: "pane"}, this.canvas, this.label);
        this.bitmap = null;  // what paint() gives
        this.image = null;   // and its pixels
        this.values = null;  // what is written into a pixel, from its number
    }

    resize(width, height) {
        const density = window.devicePixelRatio;
        this.width = width;
        this.height = height;
        this.canvas.style.width = `${width}px`;
        this.canvas.style.height = `${height}px`;
        const [w, h] = [Math.round(width * density), Math.round(height * density)];
        if (this.canvas.width !== w || this.canvas.height !== h) {
            this.canvas.width = w;
            this.canvas.height = h;
        }
    }

    // Screen pixels a pixel of an image. Small images are magnified by a whole number.
    scale(image, view) {
        const fit = Math.min(this.width / image.width, this.height / image.height);
        return (fit >= 1 ? Math.floor(fit) : fit) * view.zoom;
    }

    // From a place on the canvas to one in the image.
    toImage(image, view, x, y) {
        const scale = this.scale(image, view);
        return [view.x + (x - this.width / 2) / scale, view.y + (y - this.height / 2) / scale];
    }

    draw(view, selection) {
        const context = this.canvas.getContext("2d");
        context.setTransform(1, 0, 0, 1, 0, 0);
        context.clearRect(0, 0, this.canvas.width, this.canvas.height);
        if (this.bitmap === null) return;
        const density = window.devicePixelRatio;
        const scale = this.scale(this.image, view) * density;
        const left = Math.round(this.canvas.width / 2 - view.x * scale);
        const top = Math.round(this.canvas.height / 2 - view.y * scale);
        context.imageSmoothingEnabled = scale < 1;
        context.drawImage(
            this.bitmap, left, top, this.image.width * scale, this.image.height * scale);
        if (scale >= kRoomForValues * density) this.drawValues(context, left, top, scale);
        if (selection !== null) {
            const {x, y, w, h} = selection;
            const box = [left + x * scale, top + y * scale, w * scale, h * scale];
            context.lineWidth = 3 * density;
            context.strokeStyle = "#000";
            context.strokeRect(...box);
            context.lineWidth = density;
            context.strokeStyle = "#fff";
            context.strokeRect(...box);
        }
    }

    // The numbers of every pixel in sight, in black or white, whichever is read better.
    drawValues(context, left, top, scale) {
        const {width, height} = this.image;
        const size = Math.floor(scale / 5.5);
        context.font = `${size}px ui-monospace, "DejaVu Sans Mono", monospace`;
        context.textAlign = "center";
        context.textBaseline = "middle";
        const pixels = this.bitmap.getContext("2d");
        const first = (start) => Math.max(0, Math.floor(-start / scale));
        const end = (start, size, n) => Math.min(n, Math.ceil((size - start) / scale));
        for (let y = first(top); y < end(top, this.canvas.height, height); ++y) {
            for (let x = first(left); x < end(left, this.canvas.width, width); ++x) {
                const [r, g, b] = pixels.getImageData(x, y, 1, 1).data;
                context.fillStyle = 0.3 * r + 0.6 * g + 0.1 * b > 110 ? "#000" : "#fff";
                const numbers = this.values(y * width + x);
                numbers.forEach((number, k) => {
                    const down = 1.3 * size * (k - (numbers.length - 1) / 2);
                    context.fillText(shortNumber(number), left + (x + 0.5) * scale,
                        top + (y + 0.5) * scale + down);
                });
            }
        }
    }
}

// Few digits, for tight places.
function shortNumber(value) {
    if (!Number.isFinite(value)) return String(value);
    const size = Math.abs(value);
    return size !== 0 && (size < 1e-3 || size >= 1e5) ? value.toExponential(1) :
                                                        value.toPrecision(3);
}
