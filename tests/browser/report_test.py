"""Looks at a report in headless Chromium as a reader does; see README.md."""
import argparse
import glob
import json
import math
import os
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
"""

checks = []


def check(fact, *said):
    checks.append(bool(fact))
    print("ok   " if fact else "FAIL ", *said)


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
    heat = (math.log10(error) + 4) / 5  # from 1e-4 to 10
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
    press(page, "E")
    check(colors(page) == before, "E takes it back")


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
    check(page.run("viewer.panes.length") == 4, "g shows all methods beside the reference")
    press(page, "g")
    page.mouse("mouseMoved", x, y)
    said = page.run("viewer.readout.textContent")
    value = page.run("viewer.pixel(viewer.state.method, viewer.pointer.x, viewer.pointer.y)")
    check(f"{value['image'][0]:.6g}"[:7] in said, "the readout tells the pixel's values")


def look_at_crops(page):
    crop = page.run("""(() => {
        viewer.selection = {x: 10, y: 12, w: 8, h: 5};
        return viewer.copyCrop().then(async ({blob, k}) => {
            const bitmap = await createImageBitmap(blob);
            return [k, bitmap.width, bitmap.height, viewer.readout.textContent];
        });
    })()""")
    k, width, height, said = crop
    check((width, height) == (8 * k, 5 * k) and "[10, 12, 8, 5]" in said, "a crop is copied:", said)


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


def look(page, html, store, exact):
    page.open(html)
    page.run("viewer.shown")
    check(page.run("viewer.panes[0].bitmap !== null"), "an image is shown")
    look_at_pixels(page, store, exact)
    look_at_keys(page)
    look_at_modes(page)
    look_at_places(page)
    look_at_crops(page)
    look_at_tables(page)
    look_at_charts(page)
    page.run("viewer.set({scene: 1, method: 3, mode: 'error', stops: -1})")
    page.open(html)
    page.run("viewer.shown")
    state = page.run("viewer.state")
    check([state[k] for k in ("scene", "method", "mode", "stops")] == [1, 3, "error", -1],
          "a reload keeps what is looked at")
    check(page.complaints == [], "the console has no complaints", *page.complaints)


def main():
    arguments = argparse.ArgumentParser(description=__doc__)
    arguments.add_argument("--misbench", required=True)
    arguments.add_argument("--chromium", default="chromium")
    options = arguments.parse_args()
    with tempfile.TemporaryDirectory() as folder:
        experiment, store = os.path.join(folder, "looked-at.yaml"), os.path.join(folder, "store")
        with open(experiment, "w", encoding="utf-8") as file:
            file.write(EXPERIMENT)

        def misbench(*words):
            subprocess.run([options.misbench, *words], check=True, stdout=subprocess.DEVNULL)

        misbench("run", experiment, "--store", store)
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
