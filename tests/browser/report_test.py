"""Looks at a report in headless Chromium as a reader does; see README.md."""
import argparse
import glob
import json
import math
import os
import shutil
import struct
import subprocess
import tempfile
import time

from browser import Browser
from exr import read_exr

EXPERIMENT = """
name: looked-at
scenes: [CornellBox, Box/LightTop]
image: {width: 48, height: 36}
methods:
  direct: {method: path, max_depth: 2}
  longer: {method: path, max_depth: 4}
  longest: {method: path, max_depth: 6}
baseline: direct
seeds: 3
budgets: [{samples: 2}, {samples: 8}]
reference: {method: longest, samples: 32}
metrics: [relmse.eps0.01, mse]
claims:
  - {claim: longer paths have less error, method: longest, against: direct, expect: less}
"""

WIDTH, HEIGHT = 48, 36
MISBENCH = "misbench"
SKIPPED = 77  # for ctest

checks = []


def check(fact, *said):
    checks.append(bool(fact))
    print("ok   " if fact else "FAIL ", *said)


def bright(x, y, channel):
    """A pixel of an image of another renderer: nine decades, as of a lamp in a dark room."""
    return 10.0 ** (-3 + 9 * ((7 * x + 11 * y + 3 * channel) % 48) / 47)


def write_bright_image(path):
    rows = [struct.pack("<3f", *(bright(x, y, c) for c in range(3)))
            for y in reversed(range(HEIGHT)) for x in range(WIDTH)]
    with open(path, "wb") as file:
        file.write(b"PF\n%d %d\n-1.0\n" % (WIDTH, HEIGHT) + b"".join(rows))


def run_of(store, scene, method_depth, samples, seed):
    """The image of one run of the store."""
    for path in glob.glob(os.path.join(store, "runs", "*", "record.json")):
        with open(path, encoding="utf-8") as file:
            record = json.load(file)
        task = record["task"]
        if (task["scene"] == scene and task["parameters"]["max_depth"] == method_depth
                and task["budget"] == {"samples": samples} and task["seed"] == seed):
            return os.path.join(os.path.dirname(path), "image.exr")
    raise LookupError(f"no run of {scene} with seed {seed}")


def look_at_pixels(page, store, exact):
    """Pixels are those of the EXR files, as rounded as the report says."""
    page.run("viewer.set({scene: 0, method: 2, budget: 1, seed: 1, mode: 'image', stops: 0})")
    width, height, pixel = read_exr(run_of(store, "CornellBox", 4, 8, 1))
    worst = 0
    for x, y in [(0, 0), (width - 1, 0), (0, height - 1), (17, 23), (width - 1, height - 1)]:
        shown = page.run(f"viewer.pixel(2, {x}, {y})")["image"]
        worst = max(worst, *(abs(a - b) / abs(b) if b else abs(a)
                             for a, b in zip(shown, pixel(x, y))))
    check(worst == 0 if exact else worst <= 2 ** -11,
          f"a pixel's value is the EXR's: off by {worst:.2e} of it at most")

    images = [read_exr(run_of(store, "CornellBox", 4, 8, seed))[2] for seed in (1, 2, 3)]
    page.run("viewer.set({seed: 'mean'})")
    shown = page.run("viewer.pixel(2, 17, 23)")["image"]
    mean = [sum(image(17, 23)[c] for image in images) / 3 for c in range(3)]
    check(all(math.isclose(a, b, rel_tol=2 ** -10) for a, b in zip(shown, mean)),
          "the mean image is the mean of the seeds")


def look_at_bright_pixels(page, exact):
    """Of an imported image: far beyond what a screen shows, and far below it."""
    page.run("viewer.set({scene: 0, method: 4, budget: 1, seed: 1, mode: 'image', stops: 0})")
    worst = 0
    for x, y in [(0, 0), (1, 0), (5, 7), (47, 35), (20, 30), (31, 2)]:
        shown = page.run(f"viewer.pixel(4, {x}, {y})")["image"]
        for channel in range(3):
            real, = struct.unpack("<f", struct.pack("<f", bright(x, y, channel)))
            # Half floats reach down to 2^-29 of the largest value with all of their bits.
            floor = 0 if exact else 1e6 * 2 ** -40
            off = max(0, abs(shown[channel] - real) - floor)
            worst = max(worst, off / real)
    check(worst == 0 if exact else worst <= 2 ** -11,
          f"values from 0.001 to a million are kept: off by {worst:.2e} of them at most")
    said = page.run("viewer.caption.textContent")
    check(("half floats" in said) != exact, "the caption says how values are rounded")


X, Y = 24, 18  # the pixel whose color is looked at


def colors(page):
    """The color of that pixel, as the screen has it."""
    return page.run(f"""(() => {{
        const {{canvas, image}} = viewer.panes[0];
        const scale = viewer.panes[0].scale(image, viewer.view);
        const x = canvas.width / 2 + ({X} + 0.5 - viewer.view.x) * scale;
        const y = canvas.height / 2 + ({Y} + 0.5 - viewer.view.y) * scale;
        return [...canvas.getContext('2d').getImageData(x, y, 1, 1).data].slice(0, 3);
    }})()""")


def picture(page):
    """A number that changes with what the first pane shows."""
    return page.run("""(() => {
        const {canvas} = viewer.panes[0];
        const {data} = canvas.getContext('2d').getImageData(0, 0, canvas.width, canvas.height);
        let sum = 0;
        for (let i = 0; i < data.length; ++i) sum = (31 * sum + data[i]) % 1000003;
        return sum;
    })()""")


def press(page, key, **more):
    page.key(key, **more)
    page.run("viewer.shown")


def look_at_keys(page):
    page.run("viewer.set({scene: 0, method: 1, budget: 0, seed: 'mean', mode: 'image'})")
    seen = {}
    for key in "0123":
        press(page, key)
        seen[key] = picture(page)
    check(len(set(seen.values())) == 4, "keys flip between four different images")
    press(page, "1")
    check(picture(page) == seen["1"], "and back to the same one")
    press(page, "ArrowRight")
    check(picture(page) == seen["2"], "an arrow goes to the one beside it")
    press(page, "x")
    check(picture(page) == seen["1"], "x goes back to the one before")
    press(page, "ArrowDown")
    check(page.run("viewer.state.budget") == 1 and picture(page) != seen["1"],
          "an arrow down shows another budget")
    press(page, "s")
    check(page.run("viewer.state.scene") == 1, "s shows another scene")
    press(page, "S")


def look_at_modes(page):
    page.run("viewer.set({scene: 0, method: 1, budget: 0, seed: 'mean', mode: 'image'})")
    shown = {"i": picture(page)}
    for key in "dr":
        press(page, key)
        shown[key] = picture(page)
    check(len(set(shown.values())) == 3, "difference and false colours are not the image")
    found = page.run(f"viewer.pixel(1, {X}, {Y})")
    pairs = list(zip(found["image"], found["reference"]))
    error = sum((a - b) ** 2 / (b * b + 0.01) for a, b in pairs) / 3
    check(math.isclose(found["error"], error, rel_tol=1e-9), "the error is that of its pixels")
    means = page.run("report.metrics[0].cells.filter((c) => c.scene === report.scenes[0].name)"
                     ".map((c) => c.mean?.value).filter((v) => v > 0)")
    middle = round(math.log10(sorted(means)[len(means) // 2]))
    heat = (math.log10(error) - middle + 3) / 4  # three decades below, one above
    check(colors(page) == page.run(f"colorAt(kHeat, {heat})"), "and so is its false color")
    press(page, "d")
    difference = sum(a - b for a, b in pairs) / 3
    red, _, blue = colors(page)
    check((red > blue) == (difference > 0), "red is more than the reference, blue is less")
    press(page, "r")
    press(page, "0")
    check(colors(page) == [0, 0, 4], "the reference has no error")
    press(page, "d")
    check(colors(page) == [247, 247, 247], "nor a difference")
    press(page, "i")
    press(page, "1")
    before = colors(page)
    press(page, "e")
    check(sum(colors(page)) > sum(before), "e exposes longer")
    exposed = [encoded(2 ** 0.5 * value) for value in found["image"]]
    check(all(abs(a - b) <= 1 for a, b in zip(colors(page), exposed)), "by half a stop, in sRGB")
    press(page, "E")
    check(colors(page) == before, "E takes it back")
    press(page, "r")
    bar = page.run("viewer.bar.innerText.split(/\\s+/)")
    shown = page.run("getComputedStyle(viewer.bar).visibility")
    check(shown == "visible" and "error," in bar
          and all(math.isclose(float(text), 10.0 ** (middle + side), rel_tol=1e-9)
                  for text, side in zip(bar, (-3, 1))),
          "the color bar tells what the colors mean:", *bar)
    press(page, "i")
    check(page.run("getComputedStyle(viewer.bar).visibility") == "hidden",
          "an image has no color bar")


def encoded(linear):
    """The sRGB byte of a linear value (IEC 61966-2-1)."""
    linear = min(1, max(0, linear))
    code = 12.92 * linear if linear <= 0.0031308 else 1.055 * linear ** (1 / 2.4) - 0.055
    return round(255 * code)


def look_at_seeds(page):
    page.run("viewer.set({scene: 0, method: 1, budget: 0, seed: 'mean', mode: 'image'})")
    mean, caption = picture(page), page.run("viewer.caption.textContent")
    check("mean of 3 seeds" in caption, "the caption names the mean:", caption)
    press(page, "n")
    caption = page.run("viewer.caption.textContent")
    check(page.run("viewer.state.seed") == 1 and picture(page) != mean and "seed 1" in caption,
          "n shows a seed's own image:", caption)
    press(page, "N")
    check(picture(page) == mean, "N goes back to the mean")


def look_at_places(page):
    """Zoom and pan are the same in all images."""
    page.run("document.getElementById('viewer').scrollIntoView()")
    page.run("viewer.set({method: 1, isGrid: false}).then(() => viewer.showAll())")
    box = page.run("""(() => {
        const box = viewer.panes[0].canvas.getBoundingClientRect();
        return [box.left, box.top, box.width, box.height];
    })()""")
    x, y = round(box[0] + 0.3 * box[2]), round(box[1] + 0.6 * box[3])
    page.mouse("mouseMoved", x, y)
    pointed = page.run("[viewer.pointer.exactX, viewer.pointer.exactY]")
    page.mouse("mouseWheel", x, y, deltaX=0, deltaY=-720)
    page.mouse("mouseMoved", x + 1, y)
    page.mouse("mouseMoved", x, y)
    again = page.run("[viewer.pointer.exactX, viewer.pointer.exactY]")
    check(page.run("viewer.view.zoom") == 8, "the wheel zooms")
    check(all(abs(a - b) < 0.01 for a, b in zip(pointed, again)), "around the pointer")
    place = page.run("JSON.stringify(viewer.view)")
    press(page, "2")
    check(page.run("JSON.stringify(viewer.view)") == place, "another method stays in the place")
    page.mouse("mousePressed", x, y, button="left", clickCount=1)
    page.mouse("mouseMoved", x - 40, y - 20, button="left", buttons=1)
    page.mouse("mouseReleased", x - 40, y - 20, button="left")
    moved = json.loads(page.run("JSON.stringify(viewer.view)"))
    check(moved["x"] > json.loads(place)["x"], "dragging pans")
    press(page, "z")
    check(page.run("viewer.view.zoom") == 1, "z shows the whole image")
    press(page, "g")
    check(page.run("viewer.panes.length") == 5, "g shows all methods beside the reference")
    box = page.run("""(() => {
        const box = viewer.panes[1].canvas.getBoundingClientRect();
        return [box.left + box.width / 2, box.top + box.height / 2];
    })()""")
    page.mouse("mouseWheel", *box, deltaX=0, deltaY=-240)
    scales = page.run("viewer.panes.filter((p) => p.image).map((p) => p.scale(p.image,"
                      " viewer.view))")
    check(page.run("viewer.view.zoom") == 2 and len(scales) == 4 and len(set(scales)) == 1,
          "all of them zoom together")
    check("no image" in page.run("viewer.panes[4].root.innerText"),
          "where there is no image it says so")
    press(page, "z")
    press(page, "g")
    page.mouse("mouseMoved", x, y)
    said = page.run("viewer.readout.textContent")
    value = page.run("viewer.pixel(viewer.state.method, viewer.pointer.x, viewer.pointer.y)")
    check(f"{value['image'][0]:.6g}"[:7] in said, "the readout tells the pixel's values")


def look_at_crops(page):
    """Shift and drag, then c: what is pasted is what was seen."""
    page.run("viewer.set({scene: 0, method: 1, budget: 0, seed: 'mean', mode: 'image'})"
             ".then(() => viewer.showAll())")
    place = """((x, y) => {
        const pane = viewer.panes[0], box = pane.canvas.getBoundingClientRect();
        const scale = pane.scale(pane.image, viewer.view);
        return [box.left + pane.width / 2 + (x - viewer.view.x) * scale,
                box.top + pane.height / 2 + (y - viewer.view.y) * scale];
    })"""
    (left, top), (right, bottom) = (page.run(f"{place}({x}, {y})")
                                    for x, y in ((10.5, 12.5), (17.5, 16.5)))
    shift = 8
    page.mouse("mousePressed", left, top, button="left", clickCount=1, modifiers=shift)
    page.mouse("mouseMoved", right, bottom, button="left", buttons=1, modifiers=shift)
    page.mouse("mouseReleased", right, bottom, button="left", modifiers=shift)
    check(page.run("viewer.selection") == {"x": 10, "y": 12, "w": 8, "h": 5},
          "shift and dragging select a crop")
    page.call("Browser.grantPermissions",
              permissions=["clipboardReadWrite", "clipboardSanitizedWrite"])
    page.key("c")
    for _ in range(50):
        said = page.run("viewer.readout.textContent")
        if said.startswith(("copied", "saved")):
            break
        time.sleep(0.1)
    check(said.startswith("copied [10, 12, 8, 5]"), "c copies it:", said)
    k, width, height, pasted = page.run("""(async () => {
        const [item] = await navigator.clipboard.read();
        const bitmap = await createImageBitmap(await item.getType("image/png"));
        const context = new OffscreenCanvas(bitmap.width, bitmap.height).getContext("2d");
        context.drawImage(bitmap, 0, 0);
        const k = bitmap.width / 8;
        const {data} = context.getImageData(3.5 * k, 2.5 * k, 1, 1);
        return [k, bitmap.width, bitmap.height, [...data].slice(0, 3)];
    })()""")
    shown = page.run("[...viewer.panes[0].bitmap.getContext('2d').getImageData(13, 14, 1, 1).data]")
    check((width, height) == (8 * k, 5 * k) and k >= 1, "as large as it is shown")
    check(pasted == shown[:3], "with the colors that are seen")
    press(page, "Escape")
    check(page.run("viewer.selection") is None, "esc forgets it")


def look_at_tables(page):
    names = "[...tables[0].body.rows].filter((r) => !r.hidden).map((r) => r.innerText)"
    original = page.run(names)
    page.run("tables[0].headers[tables[0].nLabels + 1].click()")
    values = page.run("[...tables[0].body.rows].map((r) => Number(r.cells[tables[0].nLabels + 1]"
                      ".dataset.value))")
    check(values == sorted(values) and len(values) == 4, "a click sorts the table")
    page.run("tables[0].headers[tables[0].nLabels + 1].click()")
    page.run("tables[0].headers[tables[0].nLabels + 1].click()")
    check(page.run(names) == original, "the third gives the order of the experiment")
    page.run("(() => { const f = document.getElementById('row-filter'); f.value = 'cornell';"
             "f.dispatchEvent(new Event('input')); })()")
    check(len(page.run(names)) == 2, "a filter leaves the rows of a scene")
    title = page.run("tables[0].body.rows[0].cells[tables[0].nLabels].title")
    check("seeds: 1: " in title and "[" in title, "a cell tells its interval and seeds")
    page.run("tables[0].body.rows[1].cells[tables[0].nLabels + 2].click()")
    page.run("viewer.shown")
    check(page.run("[viewer.state.scene, viewer.state.budget, viewer.state.method]") == [0, 1, 3],
          "a click on a cell shows its image")


def look_at_charts(page):
    check(page.run("charts.charts.length") == 3, "there are three charts")
    check(page.run("charts.charts[2].data.datasets[0].data.length") == 2,
          "a curve has a point for each budget")
    # Of every method's color: a chart without its marks has grid, letters and legend all the same.
    drawn = page.run("""charts.charts.map(({canvas, chartArea: {left, top, width, height}}) => {
        const {data} = canvas.getContext("2d").getImageData(left, top, width, height);
        const seen = new Set();
        for (let i = 0; i < data.length; i += 4)
            if (data[i + 3] > 200) seen.add(data[i] << 16 | data[i + 1] << 8 | data[i + 2]);
        return report.methods.slice(0, 3).filter(
            (method) => seen.has(parseInt(colorOfMethod(method).slice(1), 16))).length;
    })""")
    check(drawn == [3, 3, 3], "each has the marks of all methods:", drawn)


def look_at_words(page):
    claims = page.run("document.querySelector('#claims table')?.innerText ?? ''")
    check("longer paths have less error" in claims and "reproduced" in claims,
          "claims stand with their findings")
    last = page.run("[...document.querySelectorAll('main > section')].pop().id")
    text = page.run("document.getElementById('provenance').innerText")
    build = subprocess.run([MISBENCH, "--version"], check=True, capture_output=True,
                           text=True).stdout.split()[1]
    check(last == "provenance" and build in text and "Renderer 1.0" in text,
          "at the end stands what it was made with")
    page.key("?")
    keys = page.run("document.querySelector('#images').innerText")
    check("shift" in keys and "esc" in keys, "? tells the keys")


def look(page, html, store, exact):
    page.open(html)
    page.run("viewer.shown")
    check(page.run("viewer.panes[0].bitmap !== null"), "an image is shown")
    look_at_pixels(page, store, exact)
    look_at_bright_pixels(page, exact)
    look_at_keys(page)
    look_at_modes(page)
    look_at_seeds(page)
    look_at_places(page)
    look_at_crops(page)
    look_at_tables(page)
    look_at_charts(page)
    look_at_words(page)
    page.run("viewer.set({scene: 1, method: 3, mode: 'error', stops: -1})")
    page.open(html)
    page.run("viewer.shown")
    state = page.run("viewer.state")
    check([state[k] for k in ("scene", "method", "mode", "stops")] == [1, 3, "error", -1],
          "a reload keeps what is looked at")
    check(page.complaints == [], "the console has no complaints", *page.complaints)
    outside = [url for url in page.requests if not url.startswith(("file:", "data:", "blob:"))]
    files = {url for url in page.requests if url.startswith("file:")}
    check(outside == [] and len(files) == 1, "nothing is asked for but the page", *outside)


def main():
    arguments = argparse.ArgumentParser(description=__doc__)
    arguments.add_argument("--misbench", required=True)
    arguments.add_argument("--chromium", default="chromium")
    options = arguments.parse_args()
    if shutil.which(options.chromium) is None:
        print(f"skipped: there is no '{options.chromium}'; apt-get install chromium, or --chromium")
        raise SystemExit(SKIPPED)
    global MISBENCH
    MISBENCH = options.misbench
    with tempfile.TemporaryDirectory() as folder:
        experiment, store = os.path.join(folder, "looked-at.yaml"), os.path.join(folder, "store")
        with open(experiment, "w", encoding="utf-8") as file:
            file.write(EXPERIMENT)

        def misbench(*words):
            subprocess.run([options.misbench, *words], check=True, stdout=subprocess.DEVNULL)

        misbench("run", experiment, "--store", store)
        write_bright_image(os.path.join(folder, "bright.pfm"))
        misbench("import", store, "--experiment", "looked-at", "--scene", "CornellBox", "--method",
                 "bright", "--samples", "8", "--renderer", "Renderer 1.0",
                 os.path.join(folder, "bright.pfm"))
        for words in ([], ["--full-precision"]):
            html = os.path.join(folder, "report.html")
            misbench("report", store, "-o", html, *words)
            begin = time.monotonic()
            with Browser(options.chromium) as page:
                look(page, html, store, exact=bool(words))
            print(f"looked at for {time.monotonic() - begin:.1f} s\n")
    raise SystemExit(0 if all(checks) else 1)


if __name__ == "__main__":
    main()
