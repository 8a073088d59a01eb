#!/usr/bin/env python3
"""Compares misbench's FLIP with that of its authors, image by image. See README.md; run by run.sh.

Exit codes: 0 means and maps agree, 1 they do not, 2 usage.
"""

import argparse
import dataclasses
import json
import pathlib
import subprocess
import sys
import tempfile

import flip_evaluator
import numpy as np

import mitsuba_side
from scenes import SOURCE_FOLDER

PIXELS_PER_DEGREE = 67
METRICS = {"LDR": "flip.ldr.ppd67", "HDR": "flip.hdr.ppd67"}
# Of the mean, relative; and of a pixel, whose values are between 0 and 1.
MEAN_TOLERANCE = 1e-3
MAP_TOLERANCE = 1e-3
RENDERED = ("CornellBox", "VeachMIS", "Box/LightTop")


@dataclasses.dataclass
class Pair:
    name: str
    image: np.ndarray
    reference: np.ndarray


def noise(seed, height, width, brightness=0.5):
    return np.random.default_rng(seed).gamma(2, brightness / 2, size=(height, width, 3))


def with_fireflies(image, value):
    """Every 97th pixel, from the seventh on."""
    result = image.copy()
    result.reshape(-1, 3)[7::97] = value
    return result


def made_up_pairs():
    small = noise(1, 23, 37), noise(2, 23, 37)
    large = noise(3, 200, 300), noise(4, 200, 300)
    ramp = np.linspace(0, 2, 96 * 128 * 3).reshape(96, 128, 3)
    grey = np.full((60, 80, 3), 0.4)
    half_black = large[1].copy()
    half_black[:120] = 0
    colours = np.zeros((40, 60, 3))
    colours[:, :30, 1] = colours[:, 30:, 2] = 1
    return [
        Pair("noise, 37×23", *small),
        Pair("noise, 300×200", *large),
        Pair("noise, 1×60", noise(5, 60, 1), noise(6, 60, 1)),
        Pair("noise, 5×4", noise(7, 4, 5), noise(8, 4, 5)),
        Pair("noise on a ramp", ramp * noise(9, 96, 128, 1), ramp),
        Pair("grey, a little lighter", grey * 1.1, grey),
        Pair("black image", 0 * small[1], small[1]),
        Pair("green and blue changed over", colours[..., [0, 2, 1]], colours),
        Pair("fireflies of 10²", with_fireflies(grey, 1e2), grey * noise(10, 60, 80, 1)),
        Pair("fireflies of 10¹²", with_fireflies(grey, 1e12), grey * noise(10, 60, 80, 1)),
        Pair("fireflies of 10⁴ in the reference", *[with_fireflies(i, 1e4 * k) for k, i in
                                                  enumerate(large)]),
        Pair("60 % of the reference black", large[0], half_black),
    ]


class Misbench:
    def __init__(self, program, folder):
        self._program = str(program)
        self._folder = folder

    def render(self, scene, n_samples, seed):
        output = self._folder / "rendered.exr"
        command = ["render", scene, "--size", "320x240", "--spp", str(n_samples)]
        self._run(*command, "--seed", str(seed), "-o", str(output))
        return mitsuba_side.read_image(output)

    def flip(self, pair, metric):
        """Its mean and its map."""
        image, reference, output = (
            self._folder / f"{name}.exr" for name in ("image", "reference", "map")
        )
        mitsuba_side.write_exr(image, pair.image)
        mitsuba_side.write_exr(reference, pair.reference)
        result = self._run("compare", str(image), "--reference", str(reference),
                           "--metric", metric, "--format", "json", "--map", str(output))
        mean = json.loads(result)["images"][0]["metrics"][metric]
        return mean, mitsuba_side.read_image(output)[..., 0]

    def _run(self, *arguments):
        run = subprocess.run([self._program, *arguments], capture_output=True, text=True)
        if run.returncode != 0:
            raise RuntimeError(run.stderr.strip())
        return run.stdout


def flip_of_its_authors(pair, dynamic_range):
    images = [pair.reference, pair.image]
    if dynamic_range == "LDR":
        images = [np.clip(image, 0, 1) for image in images]
    reference, image = (np.ascontiguousarray(image, dtype=np.float32) for image in images)
    flip_map, mean, _ = flip_evaluator.evaluate(
        reference, image, dynamic_range, inputsRGB=False, applyMagma=False,
        parameters={"ppd": PIXELS_PER_DEGREE},
    )
    return mean, np.asarray(flip_map, dtype=np.float64)[..., 0]


def compare(misbench, pair, dynamic_range):
    """Prints a row of the table; returns whether the two agree."""
    our_mean, our_map = misbench.flip(pair, METRICS[dynamic_range])
    their_mean, their_map = flip_of_its_authors(pair, dynamic_range)
    of_mean = our_mean / their_mean - 1 if their_mean else our_mean
    of_map = np.abs(our_map - their_map).max()
    agree = abs(of_mean) <= MEAN_TOLERANCE and of_map <= MAP_TOLERANCE
    print(f"| {pair.name} | {dynamic_range} | {our_mean:.6f} | {their_mean:.6f} | {of_mean:.1e} "
          f"| {of_map:.1e} | {'same' if agree else 'DIFFERS'} |", flush=True)
    return agree


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("--misbench", metavar="PATH",
                        default=SOURCE_FOLDER / "build/release/bin/misbench")
    arguments = parser.parse_args()
    mitsuba_side.choose_variant()  # only to read and write files
    print("| pair | | misbench | flip-evaluator | mean, relative | map, largest | result |")
    print("|---|---|---|---|---|---|---|")
    with tempfile.TemporaryDirectory() as folder:
        misbench = Misbench(arguments.misbench, pathlib.Path(folder))
        pairs = made_up_pairs()
        for scene in RENDERED:
            pairs.append(Pair(scene, misbench.render(scene, 4, 1), misbench.render(scene, 64, 2)))
        results = [compare(misbench, pair, dynamic_range)
                   for pair in pairs for dynamic_range in METRICS]
    print(f"{sum(results)} of {len(results)} agree", file=sys.stderr)
    return 0 if all(results) else 1


if __name__ == "__main__":
    sys.exit(main())
