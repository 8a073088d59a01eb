// From pixels to what a screen shows: the image itself, its difference to the reference, its error
// in false colours.

// Encoded sRGB (IEC 61966-2-1) of i/65535.
const kSrgb = Uint8Array.from({length: 65536}, (_, i) => {
    const linear = i / 65535;
    const encoded = linear <= 0.0031308 ? 12.92 * linear : 1.055 * linear ** (1 / 2.4) - 0.055;
    return Math.round(255 * encoded);
});
const kNonFinite = [255, 0, 255];

// Colours between stops at equal distances, of 0 to 1 in steps: red, green, blue in turn.
const kMapSteps = 1024;
function colorMap(stops) {
    const map = new Uint8ClampedArray(3 * kMapSteps);
    for (let i = 0; i < kMapSteps; ++i) {
        const at = (i / (kMapSteps - 1)) * (stops.length - 1);
        const k = Math.min(Math.floor(at), stops.length - 2);
        for (let c = 0; c < 3; ++c) {
            map[3 * i + c] = stops[k][c] + (at - k) * (stops[k + 1][c] - stops[k][c]);
        }
    }
    return map;
}
const kDiverging =
    colorMap([[5, 48, 97], [67, 147, 195], [247, 247, 247], [214, 96, 77], [103, 0, 31]]);
const kHeat = colorMap([[0, 0, 4], [87, 16, 110], [188, 55, 84], [249, 142, 9], [252, 255, 164]]);

// Where the color of t, of 0 to 1, begins in a map.
function placeInMap(t) {
    return 3 * Math.round((kMapSteps - 1) * Math.min(1, Math.max(0, t)));
}
const colorAt = (map, t) => [...map.slice(placeInMap(t), placeInMap(t) + 3)];

// The constant of relmse.eps0.01.
const kEpsilon = 0.01;
// Of a color map over errors: from so many decades below to above what is typical of a scene, so that
// all methods and seeds of it have the same colors. Few pixels make most of a mean error.
const kErrorDecades = [-3, 1];
const kTypicalError = 0.03;  // where none is measured

function typicalError(scene) {
    const {name} = report.scenes[scene];
    const metric = report.metrics.find(({metric}) => metric.startsWith("relmse.eps0.01"));
    const means = metric === undefined ?
        [] :
        metric.cells.filter((cell) => cell.scene === name && cell.mean && cell.mean.value > 0)
            .map((cell) => cell.mean.value)
            .sort((a, b) => a - b);
    if (means.length === 0) return kTypicalError;
    return 10 ** Math.round(Math.log10(means[Math.floor(means.length / 2)]));
}

function differenceAt(image, reference, i) {
    let sum = 0;
    for (let c = 0; c < 3; ++c) sum += image.planes[c][i] - reference.planes[c][i];
    return sum / 3;
}

function relativeSquaredErrorAt(image, reference, i) {
    let sum = 0;
    for (let c = 0; c < 3; ++c) {
        const r = reference.planes[c][i];
        sum += (image.planes[c][i] - r) ** 2 / (r * r + kEpsilon);
    }
    return sum / 3;
}

// `painter` gives what writes the color of pixel i to `data` from `at` on; `values` are the numbers
// behind it; `bar` is the color bar, with what its ends stand for. `stops` is the exposure.
const kModes = {
    image: {
        name: "image",
        key: "i",
        needsReference: false,
        values: (image, _, i) => image.planes.map((plane) => plane[i]),
        painter: ({planes}, _, stops) => {
            const gain = 65535 * 2 ** stops;
            return (i, data, at) => {
                for (let c = 0; c < 3; ++c) {
                    data[at + c] =
                        kSrgb[Math.min(65535, Math.max(0, gain * planes[c][i] + 0.5)) | 0];
                }
            };
        },
    },
    difference: {
        name: "difference",
        key: "d",
        needsReference: true,
        values: (image, reference, i) => [differenceAt(image, reference, i)],
        painter: (image, reference, stops) => mapPainter(
            kDiverging, (i) => 0.5 + 0.5 * 2 ** stops * differenceAt(image, reference, i)),
        bar: (stops) => {
            const limit = tickText(2 ** -stops);
            return {map: kDiverging, low: `−${limit}`, high: `+${limit}`, name: "difference"};
        },
    },
    error: {
        name: "relative squared error",
        key: "r",
        needsReference: true,
        values: (image, reference, i) => [relativeSquaredErrorAt(image, reference, i)],
        painter: (image, reference, stops) => {
            const [low, high] = errorRange(stops).map(Math.log10);
            return mapPainter(kHeat,
                (i) =>
                    (Math.log10(relativeSquaredErrorAt(image, reference, i)) - low) / (high - low));
        },
        bar: (stops) => {
            const [low, high] = errorRange(stops).map(tickText);
            return {map: kHeat, low, high, name: "relative squared error, logarithmic"};
        },
    },
};

// Stops are relative to a typical error of 1.
const errorRange = (stops) => kErrorDecades.map((decade) => 10 ** decade / 2 ** stops);

function mapPainter(map, place) {
    return (i, data, at) => {
        const from = placeInMap(place(i));
        for (let c = 0; c < 3; ++c) data[at + c] = map[from + c];
    };
}

// The whole image as a canvas of its own size.
function paint(mode, image, reference, stops) {
    const {width, height, planes} = image;
    const canvas = new OffscreenCanvas(width, height);
    const context = canvas.getContext("2d", {willReadFrequently: true});
    const pixels = context.createImageData(width, height);
    const {data} = pixels;
    const paintPixel = kModes[mode].painter(image, reference, stops);
    for (let i = 0; i < width * height; ++i) {
        // A sum is finite only if its terms are; one beyond the largest double does not occur.
        if (Number.isFinite(planes[0][i] + planes[1][i] + planes[2][i])) {
            paintPixel(i, data, 4 * i);
        } else {
            data.set(kNonFinite, 4 * i);
        }
        data[4 * i + 3] = 255;
    }
    context.putImageData(pixels, 0, 0);
    return canvas;
}
