#!/usr/bin/env python3
"""Tests the comparison with images of which it is known whether they differ.

Mitsuba against itself with other seeds must be the same; with 2 % more of everything, or 10 % more
in one part of the image, it must differ.
"""

import sys

import numpy as np

import mitsuba_side
import welch
from scenes import SCENE_FOLDER

SCENES = ("area-light", "roughdielectric-ggx", "spot-light", "envmap")
N_SEEDS = 8
N_SAMPLES = 64
MAX_DEPTH = 6


def check(name, comparison, must_differ):
    right = comparison.differs == must_differ
    found = "differs" if comparison.differs else "same"
    print(f"{'ok  ' if right else 'FAIL'} {name}: {found}, smallest p {comparison.smallest_p:.2g}")
    return right


def false_positive_rate():
    """Of 200 comparisons of independent, skewed noise of one distribution."""
    rng = np.random.default_rng(7)

    def images():
        return rng.gamma(0.05, 20, size=(N_SEEDS, 96, 128, 3))

    n_trials = 200
    return sum(welch.compare(images(), images()).differs for _ in range(n_trials)) / n_trials


def main():
    mitsuba_side.choose_variant()
    right = True
    for name in SCENES:
        scene = mitsuba_side.MitsubaScene(SCENE_FOLDER / "features" / f"{name}.xml")
        images = [
            scene.render(MAX_DEPTH, N_SAMPLES, seed) for seed in range(1, 2 * N_SEEDS + 1)
        ]
        ours, theirs = np.array(images[:N_SEEDS]), np.array(images[N_SEEDS:])
        right &= check(f"{name}, other seeds", welch.compare(ours, theirs), False)
        right &= check(f"{name}, 2 % more", welch.compare(1.02 * ours, theirs), True)
        ours[:, 40:72, 50:82] *= 1.1
        right &= check(f"{name}, 10 % more in a part", welch.compare(ours, theirs), True)
    rate = false_positive_rate()
    print(f"false positives on noise alone: {100 * rate:.1f} %")
    right &= rate <= 0.05
    return 0 if right else 1


if __name__ == "__main__":
    sys.exit(main())
