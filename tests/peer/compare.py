#!/usr/bin/env python3
"""Compares misbench's path tracer with Mitsuba 3's, scene by scene. See README.md; run by run.sh.

Exit codes: 0 no difference but the documented ones, 1 a difference or a scene that did not render,
2 usage.
"""

import argparse
import dataclasses
import json
import pathlib
import subprocess
import sys

import numpy as np

import mitsuba_side
import welch
from scenes import SOURCE_FOLDER, all_scenes

QUICK_SAMPLES_DIVISOR = 4
QUICK_SEEDS = 8
# Differences of this part of the local mean have the full colour in a difference image.
FULL_COLOUR = 0.1


@dataclasses.dataclass
class Result:
    scene: str
    size: tuple = ()
    max_depth: int = 0
    n_samples: int = 0
    comparison: welch.Comparison | None = None
    documented: str | None = None
    error: str | None = None

    @property
    def verdict(self):
        if self.error:
            return "failed: " + self.error
        if not self.comparison.differs:
            return "same"
        return "differs as documented" if self.documented else "DIFFERS"

    @property
    def passed(self):
        return self.verdict in ("same", "differs as documented")


class Misbench:
    def __init__(self, program, folder):
        self._program = program
        self._folder = folder

    def render(self, file, size, max_depth, n_samples, seed):
        output = self._folder / "misbench.exr"
        command = [self._program, "render", file, "--method", "path"]
        for key in ("max_depth", "rr_depth"):  # equal: no Russian roulette
            command += ["--set", f"{key}={max_depth}"]
        command += ["--size", f"{size[0]}x{size[1]}", "--spp", n_samples, "--seed", seed]
        run = subprocess.run(
            [str(part) for part in [*command, "-o", output]], capture_output=True, text=True
        )
        if run.returncode != 0:
            raise RuntimeError((run.stderr.strip() or f"exit code {run.returncode}").split("\n")[0])
        return mitsuba_side.read_image(output)


def blur(image, side):
    """The mean of each pixel's tile, at the size of the image."""
    tiles = welch.tile_means(image[None], side)[0]
    full = np.repeat(np.repeat(tiles, side, axis=0), side, axis=1)
    return full[: image.shape[0], : image.shape[1]]


def keep_images(folder, name, ours, theirs):
    """Both means as EXR, and side by side with their difference as PNG: red where ours is more."""
    folder.mkdir(parents=True, exist_ok=True)
    stem = folder / name.replace("/", "-")
    means = ours.mean(axis=0), theirs.mean(axis=0)
    for image, renderer in zip(means, ("misbench", "mitsuba")):
        mitsuba_side.write_exr(f"{stem}-{renderer}.exr", image)
    side = welch.TILE_SIDES[0]
    grey = [blur(image.mean(axis=2, keepdims=True), side)[..., 0] for image in means]
    relative = (grey[0] - grey[1]) / (np.maximum(*grey) + 1e-9) / FULL_COLOUR
    difference = np.stack([relative, 0 * relative, -relative], axis=2)
    exposure = 0.5 / max(float(np.median(means[1])), 1e-9)
    shown = [exposure * image for image in means]
    mitsuba_side.write_png(f"{stem}.png", np.concatenate([*shown, difference], axis=1))


def compare_scene(scene, arguments):
    n_samples, n_seeds = scene.n_samples, scene.n_seeds
    if arguments.quick:
        n_samples, n_seeds = max(1, n_samples // QUICK_SAMPLES_DIVISOR), QUICK_SEEDS
    result = Result(
        scene.name, max_depth=scene.max_depth, n_samples=n_samples, documented=scene.documented
    )
    folder = arguments.build_folder / "scenes" / scene.name
    folder.mkdir(parents=True, exist_ok=True)
    misbench = Misbench(arguments.misbench, folder)
    try:
        our_file, their_file = scene.prepare(scene.file, folder)
        comparable = folder / "mitsuba.xml"
        mitsuba_side.write_comparable(their_file, comparable, scene.size)
        mitsuba_scene = mitsuba_side.MitsubaScene(comparable)
        result.size = mitsuba_scene.size
        ours, theirs = [], []
        for seed in range(1, n_seeds + 1):
            ours.append(
                misbench.render(our_file, result.size, scene.max_depth, n_samples, seed)
            )
            theirs.append(mitsuba_scene.render(scene.max_depth, n_samples, seed))
        ours, theirs = np.array(ours), np.array(theirs)
        result.comparison = welch.compare(ours, theirs)
        if arguments.keep:
            keep_images(arguments.keep, scene.name, ours, theirs)
    except (OSError, RuntimeError, ValueError) as error:
        result.error = str(error).strip().split("\n")[0]
    return result


def percent(value):
    return f"{100 * value:.2g} %"


def table_head():
    return (
        "| scene | size | depth | spp × seeds | differing tests: 8² · 32² · 128² · image "
        "| largest | mean | detectable: 8² · 32² · image | result |\n"
        "|---|---|---|---|---|---|---|---|---|"
    )


def table_row(result):
    if result.comparison is None:
        return f"| {result.scene} | | {result.max_depth} | | | | | | {result.verdict} |"
    scales = {scale.name: scale for scale in result.comparison.scales}
    differing = " · ".join(
        f"{scales[name].n_differing}/{scales[name].n_tests}" if name in scales else "–"
        for name in ("8", "32", "128", "image")
    )
    detectable = " · ".join(percent(scales[n].detectable_bias) for n in ("8", "32", "image"))
    largest = max((scale.largest_difference for scale in scales.values()), key=abs)
    return (
        f"| {result.scene} | {result.size[0]}×{result.size[1]} | {result.max_depth} "
        f"| {result.n_samples} × {result.comparison.n_seeds[0]} | {differing} "
        f"| {percent(largest) if largest else '–'} "
        f"| {percent(result.comparison.mean_difference)} | {detectable} | {result.verdict} |"
    )


def as_json(results, variant):
    import mitsuba

    def of(result):
        return dataclasses.asdict(result) | {"verdict": result.verdict}

    header = {
        "mitsuba": mitsuba.__version__,
        "variant": variant,
        "false_discovery_rate": welch.FALSE_DISCOVERY_RATE,
        "power": welch.POWER,
        "tolerance": welch.TOLERANCE,
    }
    return json.dumps(header | {"scenes": [of(result) for result in results]}, indent=1)


def parse_arguments(scenes):
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    build = SOURCE_FOLDER / "build"
    parser.add_argument("--scenes", nargs="+", metavar="NAME", help="only these; default: all")
    parser.add_argument("--list", action="store_true", help="print the names of the scenes")
    parser.add_argument("--misbench", default=build / "release/bin/misbench", metavar="PATH")
    parser.add_argument("--quick", action="store_true", help="fewer samples and seeds")
    parser.add_argument("--keep", type=pathlib.Path, metavar="FOLDER",
                        help="write mean images and difference images there")
    parser.add_argument("--json", action="store_true", help="JSON instead of a table")
    parser.add_argument("--build-folder", type=pathlib.Path, default=build / "peer",
                        metavar="FOLDER", help="for derived scenes")
    arguments = parser.parse_args()
    names = {scene.name for scene in scenes}
    for name in arguments.scenes or ():
        if name not in names:
            parser.error(f"unknown scene '{name}'; known: {' '.join(sorted(names))}")
    return arguments


def main():
    scenes = all_scenes()
    arguments = parse_arguments(scenes)
    chosen = [scene for scene in scenes if not arguments.scenes or scene.name in arguments.scenes]
    if arguments.list:
        print("\n".join(scene.name for scene in chosen))
        return 0
    variant = mitsuba_side.choose_variant()
    print(f"mitsuba variant {variant}", file=sys.stderr)
    if not arguments.json:
        print(table_head())
    results = []
    for scene in chosen:
        results.append(compare_scene(scene, arguments))
        if not arguments.json:
            print(table_row(results[-1]), flush=True)
    if arguments.json:
        print(as_json(results, variant))
    n_failed = sum(not result.passed for result in results)
    print(f"{len(results) - n_failed} passed, {n_failed} failed", file=sys.stderr)
    return 1 if n_failed else 0


if __name__ == "__main__":
    sys.exit(main())
