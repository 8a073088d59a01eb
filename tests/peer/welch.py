"""Do two renderers have the same expected image? Welch's test on tiles, at several scales.

A tile's mean is one value a seed, so samples within an image may depend on each other as they like.

[JHD20]  A. Jung, J. Hanika, C. Dachsbacher, Detecting Bias in Monte Carlo Renderers using Welch's
         t-test, JCGT 9(2), 2020.
[BH95]   Y. Benjamini, Y. Hochberg, Controlling the False Discovery Rate, JRSS B 57(1), 1995.

Student's t and [BH95] come from scipy: a check should not rest on numerics of its own.
"""

import dataclasses

import numpy as np
from scipy import stats

# Chosen before any image was compared.
TILE_SIDES = (8, 32, 128)  # pixels; the whole image comes on top
FALSE_DISCOVERY_RATE = 0.01
POWER = 0.8
# Constants are rounded to six digits in scene files and tables, and geometry is in single
# precision: a difference of this part of a tile's mean is none.
TOLERANCE = 1e-4
# Tiles darker than this part of the image take no part in the typical detectable bias.
DARK = 1e-2


@dataclasses.dataclass
class Scale:
    name: str
    n_tests: int
    n_differing: int
    largest_difference: float  # of the tests that differ, relative to their tile; signed
    detectable_bias: float  # median over tiles, relative to the tile


@dataclasses.dataclass
class Comparison:
    scales: list
    n_seeds: tuple
    mean_difference: float  # of the whole image, all channels, relative; signed
    smallest_p: float  # adjusted

    @property
    def differs(self):
        return any(scale.n_differing for scale in self.scales)


def tile_means(images, side):
    """images: seeds × height × width × channels. Tiles at the border may be smaller."""
    rows = np.arange(0, images.shape[1], side)
    columns = np.arange(0, images.shape[2], side)
    sums = np.add.reduceat(np.add.reduceat(images, rows, axis=1), columns, axis=2)
    heights = np.diff(np.append(rows, images.shape[1]))
    widths = np.diff(np.append(columns, images.shape[2]))
    return sums / (heights[:, None] * widths[None, :])[..., None]


def scale_sides(height, width):
    """The sides of the tiles by name; a tile that covers the image is the whole image."""
    largest = max(height, width)
    sides = {str(side): side for side in TILE_SIDES if side < largest}
    return sides | {"image": largest}


class Welch:
    """The test of each tile and channel of one scale.  [JHD20]"""

    def __init__(self, ours, theirs):
        n1, n2 = len(ours), len(theirs)
        v1, v2 = ours.var(axis=0, ddof=1) / n1, theirs.var(axis=0, ddof=1) / n2
        self.mean = 0.5 * (ours.mean(axis=0) + theirs.mean(axis=0))
        self.difference = ours.mean(axis=0) - theirs.mean(axis=0)
        self.standard_error = np.sqrt(v1 + v2)
        with np.errstate(divide="ignore", invalid="ignore"):
            nu = (v1 + v2) ** 2 / (v1**2 / (n1 - 1) + v2**2 / (n2 - 1))
            # Where both are without noise the degrees of freedom do not matter.
            self.degrees = np.where(np.isfinite(nu), nu, min(n1, n2) - 1)

    def p_values(self):
        excess = np.maximum(np.abs(self.difference) - TOLERANCE * np.abs(self.mean), 0)
        with np.errstate(divide="ignore", invalid="ignore"):
            t = np.where(excess > 0, excess / self.standard_error, 0)
        return 2 * stats.t.sf(t, self.degrees)

    def relative_difference(self):
        return self.difference / np.where(self.mean == 0, 1, np.abs(self.mean))

    def detectable_bias(self, level):
        """What a two-sided test at `level` finds with probability POWER, relative to the mean."""
        bright = self.mean > DARK * self.mean.mean()
        if not bright.any():
            return 0.0
        quantiles = stats.t.isf(level / 2, self.degrees) + stats.t.ppf(POWER, self.degrees)
        half_width = TOLERANCE * self.mean + quantiles * self.standard_error
        return float(np.median((half_width[bright] / self.mean[bright])))


def compare(ours, theirs):
    """ours, theirs: seeds × height × width × channels; returns a Comparison."""
    ours, theirs = np.asarray(ours, np.float64), np.asarray(theirs, np.float64)
    if ours.shape[1:] != theirs.shape[1:]:
        raise ValueError(f"image sizes differ: {ours.shape[1:]} and {theirs.shape[1:]}")
    if not (np.isfinite(ours).all() and np.isfinite(theirs).all()):
        raise ValueError("an image has a value that is not finite")
    sides = scale_sides(*ours.shape[1:3])
    tests = {
        name: Welch(tile_means(ours, side), tile_means(theirs, side))
        for name, side in sides.items()
    }
    p_values = {name: test.p_values() for name, test in tests.items()}
    pooled = np.concatenate([p.ravel() for p in p_values.values()])
    adjusted = stats.false_discovery_control(pooled, method="bh")  # [BH95]

    scales = []
    start = 0
    for name, test in tests.items():
        n = p_values[name].size
        found = (adjusted[start : start + n] <= FALSE_DISCOVERY_RATE).reshape(p_values[name].shape)
        start += n
        relative = np.where(found, test.relative_difference(), 0)
        scales.append(
            Scale(
                name=name,
                n_tests=n,
                n_differing=int(found.sum()),
                largest_difference=float(relative.flat[np.abs(relative).argmax()]),
                # The level at which a single tile is found among all of them.
                detectable_bias=test.detectable_bias(FALSE_DISCOVERY_RATE / pooled.size),
            )
        )
    return Comparison(
        scales=scales,
        n_seeds=(len(ours), len(theirs)),
        mean_difference=float(ours.mean() / theirs.mean() - 1) if theirs.mean() > 0 else 0.0,
        smallest_p=float(adjusted.min()),
    )
