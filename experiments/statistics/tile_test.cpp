// [AS64]   M. Abramowitz, I. A. Stegun, Handbook of Mathematical Functions, 1964.
#include "experiments/statistics/tile_test.h"

#include <algorithm>
#include <boost/math/distributions/normal.hpp>
#include <boost/math/distributions/students_t.hpp>
#include <cmath>
#include <functional>
#include <utility>

#include "experiments/statistics/intervals.h"
#include "experiments/statistics/multiplicity.h"
#include "renderer/base/check.h"

namespace misbench {
namespace {

constexpr int kSide = kTileSides.front();
// A difference of this part of a tile's mean is rounding: geometry is in single precision.
constexpr double kRounding = 1e-4;
// Below this part of it noise is rounding too.
constexpr double kNoNoise = 1e-6;
// A tile darker than this part of the image is dark: what is a large part of it is little.
constexpr double kDark = 0.01;

using boost::math::students_t;
using Values = std::vector<double>;

int n_tiles(int pixels, int side) { return (pixels + side - 1) / side; }

// Smallest first.
std::vector<int> sides_of(int width, int height) {
    const int longest = std::max(width, height);
    std::vector<int> sides;
    for (const int side : kTileSides) {
        if (side < longest) sides.push_back(side);
    }
    sides.push_back(longest);
    return sides;
}

// Mean over the pixels of a tile whose corner lies on a corner of smallest tiles.
double mean_of(const TileSums& image, const PixelRect& tile) {
    const int row_length = n_tiles(image.width, kSide);
    double sum = 0;
    for (int y = tile.y0 / kSide; y < n_tiles(tile.y1, kSide); ++y) {
        for (int x = tile.x0 / kSide; x < n_tiles(tile.x1, kSide); ++x) {
            sum += image.sums[static_cast<std::size_t>(y * row_length + x)];
        }
    }
    return sum / (static_cast<double>(tile.x1 - tile.x0) * (tile.y1 - tile.y0));
}

Values means_of(std::span<const TileSums> images, const PixelRect& tile) {
    Values means;
    for (const TileSums& image : images) means.push_back(mean_of(image, tile));
    return means;
}

// A mean over seeds.
struct SeedMean {
    double value = 0;
    double variance = 0;
    double third_moment = 0;  // central
    double degrees_of_freedom = 0;
};

SeedMean mean_over_seeds(const Values& values) {
    const auto n = static_cast<double>(values.size());
    SeedMean mean{.degrees_of_freedom = n - 1};
    for (const double value : values) mean.value += value / n;
    for (const double value : values) {
        const double distance = value - mean.value;
        mean.variance += distance * distance / (n * (n - 1));
        mean.third_moment += distance * distance * distance / (n * (n - 1) * (n - 2));
    }
    return mean;
}

// Of a[i] - factor · b[i], or of the difference of the means.
SeedMean difference_of(const Values& a, const Values& b, double factor, bool is_paired) {
    Values scaled = b;
    for (double& value : scaled) value *= factor;
    if (is_paired) {
        std::ranges::transform(a, scaled, scaled.begin(), std::minus<>());
        return mean_over_seeds(scaled);
    }
    const SeedMean ma = mean_over_seeds(a);
    const SeedMean mb = mean_over_seeds(scaled);
    const double variance = ma.variance + mb.variance;
    const double sum_of_squares = ma.variance * ma.variance / ma.degrees_of_freedom +
                                  mb.variance * mb.variance / mb.degrees_of_freedom;
    return {.value = ma.value - mb.value,
            .variance = variance,
            .third_moment = ma.third_moment - mb.third_moment,
            // Where both are without noise it does not matter.
            .degrees_of_freedom =
                sum_of_squares > 0 ? variance * variance / sum_of_squares : ma.degrees_of_freedom};
}

double two_sided_p(double t, double degrees_of_freedom) {
    return 2 *
           boost::math::cdf(boost::math::complement(students_t(degrees_of_freedom), std::abs(t)));
}

// The p value of a difference without what may be rounding, with a standard error that may be
// larger than its own, and without the skewness δ where that lessens it.  [Hal92], [ZD05]
double guarded_p_value(const SeedMean& difference, double standard_error, double allowed) {
    const double excess = std::abs(difference.value) - allowed;
    if (excess <= 0) return 1;
    if (standard_error <= 0) return 0;
    double t = std::copysign(excess / standard_error, difference.value);
    const double delta =
        difference.third_moment / (standard_error * standard_error * standard_error);
    const double straight = t + delta * t * t / 3 + delta * delta * t * t * t / 27 + delta / 6;
    if (std::abs(straight) < std::abs(t)) t = straight;
    return two_sided_p(t, difference.degrees_of_freedom);
}

// Of the two tests that the first's mean lies outside of the second's ± margin.  [Sch87]
double equivalence_p_value(const Values& a, const Values& b, double margin, bool is_paired) {
    const auto one_sided = [&](double factor, double sign) {
        const SeedMean difference = difference_of(a, b, factor, is_paired);
        const double inside = sign * difference.value;
        if (difference.variance <= 0) return inside > 0 ? 0.0 : 1.0;
        return boost::math::cdf(boost::math::complement(students_t(difference.degrees_of_freedom),
                                                        inside / std::sqrt(difference.variance)));
    };
    return std::max(one_sided(1 - margin, 1), one_sided(1 + margin, -1));
}

double median(Values values) {
    if (values.empty()) return 0;
    const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
    std::nth_element(values.begin(), middle, values.end());
    return *middle;
}

// A tile before it is judged.
struct Measured {
    TileDifference test;
    SeedMean difference;
    double brightness = 0;
};

// Row by row; `row_length` of them in a row.
struct MeasuredTiles {
    std::vector<Measured> tiles;
    int row_length = 0;
};

// The median of the standard errors, relative to the brightness, of the tiles around one. Zero
// where there are none. Noise varies little from tile to tile, but its estimate from few seeds
// does.
double typical_error_around(const MeasuredTiles& all, int index) {
    const int n_rows = static_cast<int>(all.tiles.size()) / all.row_length;
    const int row = index / all.row_length;
    const int column = index % all.row_length;
    Values errors;
    for (int y = std::max(row - 1, 0); y < std::min(row + 2, n_rows); ++y) {
        for (int x = std::max(column - 1, 0); x < std::min(column + 2, all.row_length); ++x) {
            const int neighbour = y * all.row_length + x;
            const Measured& tile = all.tiles[static_cast<std::size_t>(neighbour)];
            if (neighbour == index || tile.brightness <= 0) continue;
            errors.push_back(tile.test.standard_error / tile.brightness);
        }
    }
    return median(std::move(errors));
}

// Nothing but rounding on both sides: there is no test.
bool is_constant(const Measured& tile) {
    return tile.test.standard_error <= kNoNoise * tile.brightness && tile.test.guarded_p == 1;
}

void judge(Measured& tile, double typical_error) {
    TileDifference& test = tile.test;
    // Without noise of its own a tile is not given that of others.
    const bool is_noisy = test.standard_error > kNoNoise * tile.brightness;
    test.guarded_error =
        is_noisy ? std::max(test.standard_error, typical_error * tile.brightness) : 0;
    test.guarded_p =
        guarded_p_value(tile.difference, test.guarded_error, kRounding * tile.brightness);
    test.p_value = is_noisy ? two_sided_p(test.z(), test.degrees_of_freedom) : test.guarded_p;
}

double share_of_rare_samples(std::span<const TileSums> first, std::span<const TileSums> second) {
    double all = 0;
    double rare = 0;
    for (std::size_t i = 0; i < first[0].sums.size(); ++i) {
        double expected = 0;
        for (const TileSums& image : second) {
            expected += image.sums[i] / static_cast<double>(second.size());
        }
        for (const TileSums& image : first) {
            all += image.sums[i];
            if (image.sums[i] > kRareTimes * expected) rare += image.sums[i];
        }
    }
    return all > 0 ? rare / all : 0;
}

// The tests of one scale but for what depends on the number of scales.
ScaleTest test_scale(std::span<const TileSums> first, std::span<const TileSums> second, int side,
                     double image_mean, const TileTestOptions& options) {
    ScaleTest scale;
    scale.side = side;
    MeasuredTiles all{.tiles = {}, .row_length = n_tiles(first[0].width, side)};
    double worst = 0;
    bool has_bright_tile = false;
    for (int y = 0; y < first[0].height; y += side) {
        for (int x = 0; x < first[0].width; x += side) {
            const PixelRect tile{x, y, std::min(x + side, first[0].width),
                                 std::min(y + side, first[0].height)};
            const Values a = means_of(first, tile);
            const Values b = means_of(second, tile);
            Measured measured;
            measured.test.tile = tile;
            measured.difference = difference_of(a, b, 1, options.is_paired);
            measured.test.first = mean_over_seeds(a).value;
            measured.test.second = mean_over_seeds(b).value;
            measured.test.standard_error = std::sqrt(measured.difference.variance);
            measured.test.degrees_of_freedom = measured.difference.degrees_of_freedom;
            measured.brightness =
                0.5 * (std::abs(measured.test.first) + std::abs(measured.test.second));
            all.tiles.push_back(measured);
            if (measured.test.second > kDark * image_mean) {
                worst =
                    std::max(worst, equivalence_p_value(a, b, options.margin, options.is_paired));
                has_bright_tile = true;
            }
        }
    }
    if (has_bright_tile) scale.equivalence_p = worst;
    for (int i = 0; i < static_cast<int>(all.tiles.size()); ++i) {
        Measured& tile = all.tiles[static_cast<std::size_t>(i)];
        judge(tile, typical_error_around(all, i));
        if (is_constant(tile)) continue;
        scale.tiles.push_back(tile.test);
        ++scale.histogram.at(static_cast<std::size_t>(std::min(9.0, 10 * tile.test.p_value)));
    }
    Values p;
    for (const TileDifference& tile : scale.tiles) p.push_back(tile.guarded_p);
    const Values adjusted = benjamini_hochberg(p);
    for (std::size_t i = 0; i < adjusted.size(); ++i) scale.tiles[i].adjusted_p = adjusted[i];
    return scale;
}

// Standard errors between a mean and zero for a two-sided test at `level` to find it with
// probability kPower: the noncentral t distribution as a normal one.  [AS64, 26.7.10]
double detectable_distance(double level, double degrees_of_freedom) {
    const students_t t(degrees_of_freedom);
    const double limit = boost::math::quantile(boost::math::complement(t, level / 2));
    return limit * (1 - 1 / (4 * degrees_of_freedom)) +
           boost::math::quantile(boost::math::normal(), kPower) *
               std::sqrt(1 + limit * limit / (2 * degrees_of_freedom));
}

// At the level at which a single tile is found among all of its scale.
void find_detectable_bias(ScaleTest& scale, double image_mean, double level_of_scale) {
    const double level = level_of_scale / static_cast<double>(scale.tiles.size());
    Values of_tile;
    Values of_image;
    for (const TileDifference& tile : scale.tiles) {
        if (!(tile.second > kDark * image_mean)) continue;
        const double bias =
            kRounding * tile.second +
            detectable_distance(level, tile.degrees_of_freedom) * tile.guarded_error;
        of_tile.push_back(bias / tile.second);
        of_image.push_back(bias / image_mean);
    }
    scale.detectable_of_tile = median(std::move(of_tile));
    scale.detectable_of_image = median(std::move(of_image));
}

}  // namespace

TileSums tile_sums(int width, int height, std::span<const float> rgb) {
    MISBENCH_CHECK(rgb.size() ==
                   3 * static_cast<std::size_t>(width) * static_cast<std::size_t>(height));
    const auto row_length = static_cast<std::size_t>(n_tiles(width, kSide));
    TileSums image{.width = width, .height = height, .sums = {}};
    image.sums.resize(row_length * static_cast<std::size_t>(n_tiles(height, kSide)));
    std::size_t value = 0;
    for (int y = 0; y < height; ++y) {
        for (int x = 0; x < width; ++x) {
            double sum = 0;
            for (int channel = 0; channel < 3; ++channel) sum += double{rgb[value++]};
            image.sums[static_cast<std::size_t>(y / kSide) * row_length +
                       static_cast<std::size_t>(x / kSide)] += sum / 3;
        }
    }
    return image;
}

const TileDifference* ImageTest::strongest() const {
    const TileDifference* found = nullptr;
    // Of equal ones that of the finest scale says best where.
    for (const ScaleTest& scale : scales) {
        for (const TileDifference& tile : scale.tiles) {
            if (found == nullptr || tile.adjusted_p < found->adjusted_p) found = &tile;
        }
    }
    return found;
}

ImageTest test_tiles(std::span<const TileSums> first, std::span<const TileSums> second,
                     const TileTestOptions& options) {
    MISBENCH_CHECK(std::min(first.size(), second.size()) >= kFewestForInterval);
    MISBENCH_CHECK(!options.is_paired || first.size() == second.size());
    const int width = first[0].width;
    const int height = first[0].height;
    for (const std::span<const TileSums> images : {first, second}) {
        for (const TileSums& image : images) {
            MISBENCH_CHECK(image.width == width && image.height == height);
        }
    }
    const double image_mean = mean_over_seeds(means_of(second, {0, 0, width, height})).value;
    const std::vector<int> sides = sides_of(width, height);
    const auto n_scales = static_cast<double>(sides.size());
    ImageTest test{.is_paired = options.is_paired, .scales = {}};
    for (const int side : sides) {
        ScaleTest scale = test_scale(first, second, side, image_mean, options);
        find_detectable_bias(scale, image_mean, options.alpha / n_scales);
        test.scales.push_back(std::move(scale));
    }
    if (const TileDifference* strongest = test.strongest()) {
        test.p_value = std::min(1.0, n_scales * strongest->adjusted_p);
    }
    test.rare_share = share_of_rare_samples(first, second);
    return test;
}

}  // namespace misbench
