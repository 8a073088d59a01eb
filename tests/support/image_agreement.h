// Do estimators have the same expected image? Welch's test on tiles of several sizes, with one
// number a tile, channel and seed, so that the samples within an image may depend on each other as
// they like: splats, shared light paths, photons.
//
// The p-values of all tiles of all pairs of a scene go through Benjamini and Hochberg's procedure.
// What it finds is looked at again with four times as many other seeds, and is a disagreement only
// if those say so too.
//
// Heavy tails: the mean of few seeds of an estimator with rare bright samples lies below its
// expectation just when its standard error is small as well, so that plain t-tests raise far too
// many alarms at the small levels that many tiles need. What is guarded:
// - False alarms: by a t without the skewness that the seeds show, and, where no seed saw the rare
//   samples, which no statistic of these seeds can tell from a bias, by the second look. Tails that
//   five times n_seeds images miss are not: such estimators cannot be compared by these means.
// - Misses: a heavy tail hides a bias, as it hides the mean. Agreement::detectable_bias_* say what
//   would have been found; a test asks that this be small enough.
//
// [JHD20]  A. Jung, J. Hanika, C. Dachsbacher, Detecting Bias in Monte Carlo Renderers using
//          Welch's t-test, JCGT 9(2), 2020.
// [Hal92]  P. Hall, On the removal of skewness by transformation, JRSS B 54(1), 1992.
// [ZD05]   X.-H. Zhou, P. Dinh, Nonparametric confidence intervals for the one- and two-sample
//          problems, Biostatistics 6(2), 2005.
// [BH95]   Y. Benjamini, Y. Hochberg, Controlling the False Discovery Rate, JRSS B 57(1), 1995.
#pragma once

#include <cstdint>
#include <functional>
#include <span>
#include <string>
#include <vector>

#include "renderer/image/image.h"

namespace misbench::test {

// Sides of the tiles in pixels; the whole image comes on top. As in tests/peer/welch.py.
inline constexpr int kTileSides[] = {8, 32};
// A difference of this part of a tile's mean is rounding: geometry is in single precision.
inline constexpr double kRounding = 1e-4;

// x0 <= x < x1, y0 <= y < y1.
struct PixelRange {
    int x0 = 0, y0 = 0, x1 = 0, y1 = 0;
};

struct MeanOfSeeds {
    double value = 0;
    double standard_error = 0;
    double third_moment = 0;  // central, of the mean
};

struct TileTest {
    PixelRange tile;
    bool is_image = false;  // the tile is the whole image
    int channel = 0;        // 0 red, 1 green, 2 blue
    MeanOfSeeds first;
    MeanOfSeeds second;
    double allowed = 0;  // difference that counts as none
    double degrees_of_freedom = 0;
    double p_value = 1;

    // The bias that a test at `level` finds in four of five cases.
    double detectable(double level) const;
};

// Pixels that take part, one flag each.
using PixelMask = std::vector<std::uint8_t>;

// The test of every tile and channel, over the pixels of the mask; a tile without such pixels has
// none. `bias` is the part of the brightness that the two
// may differ by, where brightness is the tile's or the median tile's, whichever is larger: what a
// blur carries into a dark tile comes from brighter ones. Tiles without variance in both are
// compared by what is allowed, rounding included.
// REQUIRES: three images or more on either side, all of one size, which is the mask's.
std::vector<TileTest> welch_tests(std::span<const Image> first, std::span<const Image> second,
                                  const PixelMask& mask, double bias = 0);

// The largest p-value that is a discovery at that rate of false ones; negative: there is none.
double largest_discovery(std::vector<double> p_values, double false_discovery_rate);  // [BH95]

// An estimator on one scene.
struct ImageSource {
    std::string name;
    std::function<Image(std::int64_t seed)> image;  // all of one size; called from many threads
    PixelMask mask;                                 // pixels whose light it estimates completely
    double bias = 0;                                // that it is known to have, as in welch_tests
};

struct Difference {
    std::string text;  // scene, estimators, tile, both means, p
    double p_value = 1;
};

struct Agreement {
    std::size_t n_tests = 0;
    double detectable_bias_of_tile = 0;   // of a smallest tile; medians, relative to the mean
    double detectable_bias_of_image = 0;  // of the whole image
    std::vector<Difference> disagreements;
    std::vector<Difference> withdrawn;  // found by the first seeds, not confirmed by the others
};

struct AgreementTest {
    std::string scene;
    int n_seeds = 16;
    double false_discovery_rate = 0;
    int n_threads = 2;
};

// Compares every pair of sources.
// REQUIRES: two sources or more, images of one size.
Agreement compare_all_pairs(std::span<const ImageSource> sources, const AgreementTest& test);

}  // namespace misbench::test
