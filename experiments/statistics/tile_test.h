// Do two methods have the same expected image? A t-test for each tile, at several scales: a tile's
// mean is one value a seed, so the samples within an image may depend on each other as they like
// (splats, shared light paths, photons), and means over tiles are nearer to normal than pixels.
//
// Tiles hold the mean of the three channels: what only moves light between them is not seen.
//
// [JHD20]  A. Jung, J. Hanika, C. Dachsbacher, Detecting Bias in Monte Carlo Renderers using
//          Welch's t-test, JCGT 9(2), 2020.
// [Hal92]  P. Hall, On the removal of skewness by transformation, JRSS B 54(1), 1992.
// [ZD05]   X.-H. Zhou, P. Dinh, Nonparametric confidence intervals for the one- and two-sample
//          problems, Biostatistics 6(2), 2005.
// [Sch87]  D. J. Schuirmann, A comparison of the two one-sided tests procedure and the power
//          approach, Journal of Pharmacokinetics and Biopharmaceutics 15, 1987.
#pragma once

#include <array>
#include <cstddef>
#include <span>
#include <vector>

namespace misbench {

// Sides of the tiles in pixels; the whole image comes on top, and in the place of tiles that would
// cover it. Tiles at the right and at the bottom may be smaller.
inline constexpr std::array kTileSides = {8, 32, 128};
// Of minimum detectable biases.
inline constexpr double kPower = 0.8;
// A tile of one seed this many times brighter than it should be shows a rare sample.
inline constexpr double kRareTimes = 4;

// One render: sums over the tiles of the smallest side, row by row, of the mean of the channels.
struct TileSums {
    int width = 0;  // of the image, in pixels
    int height = 0;
    std::vector<double> sums;
};
TileSums tile_sums(int width, int height, std::span<const float> rgb);

// x0 <= x < x1, y0 <= y < y1.
struct PixelRect {
    int x0 = 0, y0 = 0, x1 = 0, y1 = 0;
    bool operator==(const PixelRect&) const = default;
};

struct TileDifference {
    PixelRect tile;
    double first = 0;  // means over the seeds
    double second = 0;
    double standard_error = 0;  // of their difference
    double degrees_of_freedom = 0;
    double guarded_error = 0;  // the larger one of it and what the tiles around make likely
    double p_value = 1;        // [JHD20]: uniform where there is no bias
    double guarded_p = 1;      // of guarded_error, and of t without its skewness
    double adjusted_p = 1;     // of guarded_p, by Benjamini and Hochberg over the scale

    double z() const { return standard_error > 0 ? (first - second) / standard_error : 0; }
};

struct ScaleTest {
    int side = 0;  // of the tiles; of the last scale, which is the whole image, its longer one
    // But for those where both have neither noise nor a difference beyond rounding.
    std::vector<TileDifference> tiles;
    std::array<int, 10> histogram{};  // of p_value, by tenths
    // The bias of one tile that is found with probability kPower (0.74 for 10 seeds: what guards
    // against skewness takes a little): the median tile's, relative to the second's mean in the
    // tile, and in the image. Dark tiles take no part.
    double detectable_of_tile = 0;
    double detectable_of_image = 0;
    // That a tile's means differ by the margin or more, for the worst tile that is not dark: at a
    // small p every one of them lies within.  [Sch87]
    double equivalence_p = 1;
};

struct ImageTest {
    bool is_paired = false;
    std::vector<ScaleTest> scales;  // the smallest tiles first, then up to the whole image
    // That there is no bias at any scale: the smallest adjusted p times the number of scales.
    double p_value = 1;
    // Part of the first's light that lies in rare samples: in values of the smallest tiles, over
    // all seeds, above kRareTimes the second's mean.
    double rare_share = 0;

    // The tile of the smallest adjusted p; null where no tile has a test.
    const TileDifference* strongest() const;
};

struct TileTestOptions {
    // first[i] and second[i] are of one seed, hence use the same random numbers. Taken for
    // independent they would not be tested at the level that is said; rates of false alarms at
    // level 1 %, in percent, of normal values with correlation rho:
    //
    //              n = 3         n = 5         n = 10
    //     rho    Welch pairs   Welch pairs   Welch pairs
    //    -0.5     1.2   0.9     2.2   1.0     3.2   0.9
    //     0       0.6   0.9     0.9   1.2     0.8   0.9
    //     0.5     0.2   1.0     0.2   1.0     0.1   0.9
    //     0.95    0.0   1.1     0.0   0.8     0.0   0.9
    bool is_paired = false;
    double margin = 0.01;  // of equivalence, relative to the second's mean
    double alpha = 0.01;   // of the whole test, for the minimum detectable bias
};

// REQUIRES: kFewestForInterval images or more on either side, all of one size, and of pairs equally
// many.
//
// Heavy tails: the mean of few seeds of a method with rare bright samples lies below its
// expectation just when its standard error is small as well, so that plain t-tests raise alarms.
// Guards are a standard error that is never below what the tiles around make likely, and a t
// without the skewness that the seeds show. False alarms at level 1 % in an image of 144 tiles, in
// percent, of tile means that are normal (spread 0.1), or lognormal (the spread is given), without
// guards and with them:
//
//                              n = 5             n = 10            n = 20
//     first     second     plain  guarded    plain  guarded    plain  guarded
//     normal    normal      0.7     0.0       1.0     0.3       1.0     0.0
//     1         1           0.0     0.0       0.0     0.0       0.0     0.3
//     0.3       0.1         3.0     0.7       4.3     0.0       2.7     0.0
//     0.5       0.1        15.7     0.3      21.0     0.0      18.0     0.0
//     1         0.1        83.0     0.3      91.0     0.3      81.7     0.7
//
// Not guarded against is what no seed of a whole neighbourhood shows: caustics that are never hit,
// and light so rare that most tiles have none of it. `rare_share` tells of such methods.
//
// How often the loss of a part of the light in 16 tiles of the 144 is found at level 1 %, spread of
// tile means 0.1, by independent seeds and by pairs that do not correlate; beside it the test of
// the whole image alone:
//
//              n = 5                 n = 10                n = 20
//     loss   seeds pairs image     seeds pairs image     seeds pairs image
//      5 %     0     0     2         40     7    12        98    88    28
//     10 %    28     4    16        100    82    52       100    99    94
//     20 %    88    59    76        100    98   100       100   100   100
ImageTest test_tiles(std::span<const TileSums> first, std::span<const TileSums> second,
                     const TileTestOptions& options);

}  // namespace misbench
