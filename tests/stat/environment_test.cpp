// Environment maps of every shape: samples against density, density against radiance, radiance
// against the documented orientation.
#include "renderer/scene/environment.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <functional>
#include <random>

#include "renderer/base/error.h"
#include "renderer/base/rng.h"
#include "tests/support/statistics.h"

namespace misbench {
namespace {

using Filter = EnvironmentDescription::Filter;

// One false alarm among all comparisons of this binary with this probability.
constexpr double kAlpha = 0.01;
constexpr int kSamples = 200'000;

Image noise(int width, int height) {
    std::mt19937 random(static_cast<unsigned>(1000 * width + height));
    Image image(width, height);
    for (float& value : image.rgb) value = static_cast<float>(random() % 1000) * 0.01F;
    return image;
}

// Black, but for one white pixel.
Image one_pixel(int width, int height, std::size_t pixel, float value) {
    Image image(width, height);
    std::fill_n(&image.rgb[3 * pixel], 3, value);
    return image;
}

Image dim_but_for_one(int width, int height, std::size_t pixel) {
    Image image = noise(width, height);
    image.rgb[3 * pixel] = 1e6F;
    return image;
}

// The map's axes are the world's (0.8, 0, 0.6), or its opposite where mirrored, (0.6, 0, -0.8) and
// (0, 1, 0). Where the map is moved to does not count.
Transform turned(bool mirror) {
    const float sign = mirror ? -1 : 1;
    return {{{{0.8F * sign, 0.6F, 0, 5}, {0, 0, 1, 6}, {0.6F * sign, -0.8F, 0, 7}}}};
}

struct Row {
    const char* name;
    Image image;
    Filter filter = Filter::Nearest;
    Transform to_world{};
};

const std::vector<Row>& rows() {
    static const std::vector<Row> kRows = {
        {"constant", noise(1, 1)},
        {"nearest", noise(4, 3)},
        {"one_row", noise(5, 1)},
        {"one_column", noise(1, 6)},
        {"poles", dim_but_for_one(8, 16, 5)},
        {"sun", one_pixel(6, 5, 15, 1e6F)},
        {"turned", noise(4, 3), Filter::Nearest, turned(false)},
        {"mirrored", noise(5, 4), Filter::Nearest, turned(true)},
        {"bilinear", noise(4, 4), Filter::Bilinear},
        {"bilinear_constant", noise(1, 1), Filter::Bilinear},
        {"bilinear_one_row", noise(5, 1), Filter::Bilinear},
        {"bilinear_two_rows", noise(3, 2), Filter::Bilinear},
        {"bilinear_one_column", noise(1, 6), Filter::Bilinear},
        {"bilinear_poles", dim_but_for_one(8, 17, 133), Filter::Bilinear},
        {"bilinear_sun", one_pixel(6, 5, 15, 1e6F), Filter::Bilinear},
        {"bilinear_mirrored", noise(5, 4), Filter::Bilinear, turned(true)},
    };
    return kRows;
}

Environment environment(const Row& row) {
    return Environment({.radiance = std::make_shared<const Image>(row.image),
                        .filter = row.filter,
                        .to_world = row.to_world});
}
Environment environment(const Image& image, Filter filter = Filter::Nearest) {
    return environment({"", image, filter});
}

// Rows' χ² and three means, and the χ² of the wide map.
double level() { return test::sidak(kAlpha, 4 * static_cast<int>(rows().size()) + 1); }

// The direction at angles θ and φ of the map.
Vec3 direction(const Row& row, double theta, double phi) {
    return row.to_world.direction({static_cast<float>(std::sin(theta) * std::cos(phi)),
                                   static_cast<float>(std::cos(theta)),
                                   static_cast<float>(std::sin(theta) * std::sin(phi))});
}

// A grid of bins so fine that no border of a cell crosses one.
class Grid {
 public:
    Grid(const Row& row, int refinement) : row_(row) {
        const int rows = row.image.height;
        n_theta_ = refinement * (row.filter == Filter::Bilinear ? std::max(1, rows - 1) : rows);
        n_phi_ = refinement * row.image.width;
    }

    std::size_t size() const { return static_cast<std::size_t>(n_theta_ * n_phi_); }

    std::size_t bin_of(Vec3 w) const {
        const auto& m = row_.to_world.rows;
        const auto local = [&](std::size_t axis) {
            return double{m[0][axis]} * double{w.x} + double{m[1][axis]} * double{w.y} +
                   double{m[2][axis]} * double{w.z};
        };
        const double theta = std::acos(std::clamp(local(1), -1.0, 1.0));
        const double turn = std::atan2(local(2), local(0)) / (2 * M_PI);
        const double phi = turn < 0 ? turn + 1 : turn;
        const int i = std::min(static_cast<int>(theta / M_PI * n_theta_), n_theta_ - 1);
        const int k = std::min(static_cast<int>(phi * n_phi_), n_phi_ - 1);
        return static_cast<std::size_t>(i * n_phi_ + k);
    }

    // f of every bin's middle and solid angle.
    void for_each(const std::function<void(Vec3, double)>& f) const {
        for (int i = 0; i < n_theta_; ++i) {
            const double theta = M_PI / n_theta_;
            const double solid_angle =
                (std::cos(i * theta) - std::cos((i + 1) * theta)) * 2 * M_PI / n_phi_;
            for (int k = 0; k < n_phi_; ++k) {
                f(direction(row_, (i + 0.5) * theta, (k + 0.5) * 2 * M_PI / n_phi_), solid_angle);
            }
        }
    }

 private:
    const Row& row_;
    int n_theta_;
    int n_phi_;
};

class EveryEnvironment : public testing::TestWithParam<std::size_t> {
 protected:
    const Row& row_ = rows()[GetParam()];
    Environment environment_ = environment(row_);
};

Environment::Sample draw(const Environment& environment, std::uint32_t i) {
    Rng rng(11, i, 0);
    const float u = rng.uniform();
    return environment.sample(double{rng.uniform()}, double{u});
}

TEST_P(EveryEnvironment, IsSampledByItsDensity) {
    const Grid grid(row_, 4);
    std::vector<double> observed(grid.size());
    for (std::uint32_t i = 0; i < kSamples; ++i) ++observed[grid.bin_of(draw(environment_, i).w)];
    std::vector<double> expected;
    grid.for_each([&](Vec3 w, double solid_angle) {
        expected.push_back(kSamples * solid_angle * environment_.pdf(w));
    });
    EXPECT_GT(test::p_value_of_counts(observed, expected), level());
}

TEST_P(EveryEnvironment, HasADensityOfIntegralOneInProportionToLuminance) {
    double sum = 0;
    const float total = luminance(environment_.total());
    Grid(row_, 4).for_each([&](Vec3 w, double solid_angle) {
        const double pdf = environment_.pdf(w);
        sum += solid_angle * pdf;
        EXPECT_TRUE(pdf > 0 || environment_.radiance(w) == Rgb{});
        if (row_.filter == Filter::Nearest) {
            const double expected = double{luminance(environment_.radiance(w)) / total};
            EXPECT_NEAR(pdf, expected, 1e-6 * expected);
        }
    });
    EXPECT_NEAR(sum, 1, 1e-6);
}

TEST_P(EveryEnvironment, HasTheTotalOfItsRadiance) {
    std::array<std::vector<double>, 3> estimates;
    for (std::uint32_t i = 0; i < kSamples; ++i) {
        const Environment::Sample sample = draw(environment_, i);
        estimates[0].push_back(double{sample.radiance.r} / sample.pdf);
        estimates[1].push_back(double{sample.radiance.g} / sample.pdf);
        estimates[2].push_back(double{sample.radiance.b} / sample.pdf);
    }
    const Rgb total = environment_.total();
    EXPECT_GT(test::p_value_of_mean(estimates[0], double{total.r}), level());
    EXPECT_GT(test::p_value_of_mean(estimates[1], double{total.g}), level());
    EXPECT_GT(test::p_value_of_mean(estimates[2], double{total.b}), level());

    std::array<double, 3> sum{};
    Grid(row_, 64).for_each([&](Vec3 w, double solid_angle) {
        const Rgb radiance = environment_.radiance(w);
        sum[0] += solid_angle * double{radiance.r};
        sum[1] += solid_angle * double{radiance.g};
        sum[2] += solid_angle * double{radiance.b};
    });
    EXPECT_NEAR(sum[0], double{total.r}, 1e-3 * sum[0]);
    EXPECT_NEAR(sum[1], double{total.g}, 1e-3 * sum[1]);
    EXPECT_NEAR(sum[2], double{total.b}, 1e-3 * sum[2]);
}

TEST_P(EveryEnvironment, SamplesWhatItIsAskedForAfterwards) {
    const float brightest = *std::max_element(row_.image.rgb.begin(), row_.image.rgb.end());
    int n_across_a_border = 0;
    for (std::uint32_t i = 0; i < kSamples; ++i) {
        const Environment::Sample sample = draw(environment_, i);
        ASSERT_GT(sample.pdf, 0);
        ASSERT_NEAR(length(sample.w), 1, 1e-6);
        const Rgb radiance = environment_.radiance(sample.w);
        const bool same = std::abs(environment_.pdf(sample.w) / sample.pdf - 1) < 1e-9 &&
                          max_abs({radiance.r - sample.radiance.r, radiance.g - sample.radiance.g,
                                   radiance.b - sample.radiance.b}) < 1e-5F * brightest;
        if (!same) ++n_across_a_border;
    }
    EXPECT_LE(n_across_a_border, 10);
}

INSTANTIATE_TEST_SUITE_P(All, EveryEnvironment, testing::Range(std::size_t{0}, rows().size()),
                         [](const auto& row) { return std::string(rows()[row.param].name); });

TEST(Environment, TurnsFromXTowardsZWithItsTopUp) {
    // Pixel i has radiance i + 1.
    Image image(4, 2);
    for (std::size_t i = 0; i < image.rgb.size(); ++i) {
        image.rgb[i] = static_cast<float>(i / 3 + 1);
    }
    const auto at = [&](const Transform& to_world, Vec3 local) {
        return environment({"", image, Filter::Nearest, to_world})
            .radiance(to_world.direction(normalized(local)))
            .r;
    };
    for (const Transform& to_world : {Transform{}, turned(false), turned(true)}) {
        EXPECT_EQ(at(to_world, {1, 1, 1}), 1);
        EXPECT_EQ(at(to_world, {-1, 1, 1}), 2);
        EXPECT_EQ(at(to_world, {-1, 1, -1}), 3);
        EXPECT_EQ(at(to_world, {1, 1, -1}), 4);
        EXPECT_EQ(at(to_world, {1, -1, 1}), 5);
        EXPECT_EQ(at(to_world, {1, -0.01F, -1}), 8);
    }
    // The map's +X is the world's (0.8, 0, 0.6).
    EXPECT_EQ(environment({"", image, Filter::Nearest, turned(false)})
                  .radiance(normalized({0.8F + 0.1F * 0.6F, 0.1F, 0.6F - 0.1F * 0.8F}))
                  .r,
              1);
}

TEST(Environment, PutsBilinearPixelsOnColumnCentresAndPoles) {
    const Row row{"", noise(4, 3), Filter::Bilinear};
    const Environment map = environment(row);
    for (int y = 0; y < 3; ++y) {
        for (int x = 0; x < 4; ++x) {
            // The direction of a pole itself has no φ.
            const double theta = std::clamp(y * M_PI / 2, 1e-6, M_PI - 1e-6);
            const Rgb radiance = map.radiance(direction(row, theta, (x + 0.5) * M_PI / 2));
            const float* expected = &row.image.rgb[static_cast<std::size_t>(3 * (4 * y + x))];
            EXPECT_NEAR(radiance.r, expected[0], 1e-4F) << x << ' ' << y;
            EXPECT_NEAR(radiance.b, expected[2], 1e-4F) << x << ' ' << y;
        }
    }
    // Halfway between the last column and the first, and a quarter of the way down.
    const Rgb between = map.radiance(direction(row, M_PI / 4, 0));
    const std::vector<float>& rgb = row.image.rgb;
    EXPECT_NEAR(between.r, (rgb[0] + rgb[9] + rgb[12] + rgb[21]) / 4, 1e-4F);
    EXPECT_TRUE(std::isfinite(map.radiance({0, 1, 0}).r));
    EXPECT_TRUE(std::isfinite(map.radiance({-0.0F, -1, -0.0F}).r));
}

TEST(Environment, OfOnePixelIsUniform) {
    for (const Filter filter : {Filter::Nearest, Filter::Bilinear}) {
        const Environment map = environment(one_pixel(1, 1, 0, 2), filter);
        EXPECT_TRUE(map.is_constant());
        EXPECT_TRUE(map.is_lit());
        EXPECT_NEAR(map.pdf({0, 0, 1}), 1 / (4 * M_PI), 1e-9);
        EXPECT_NEAR(map.sample(0.9, 0.1).pdf, 1 / (4 * M_PI), 1e-9);
        EXPECT_FLOAT_EQ(map.total().g, static_cast<float>(8 * M_PI));
        EXPECT_GE(map.n_bytes(), sizeof(Environment));
    }
    EXPECT_FALSE(environment(noise(2, 1)).is_constant());
}

TEST(Environment, ThatIsBlackIsNotLit) {
    for (const Filter filter : {Filter::Nearest, Filter::Bilinear}) {
        const Environment map = environment(Image(3, 2), filter);
        EXPECT_FALSE(map.is_lit());
        EXPECT_EQ(map.total(), Rgb{});
        EXPECT_EQ(map.pdf({0, 1, 0}), 0);
        EXPECT_EQ(map.radiance({0, 1, 0}), Rgb{});
    }
}

TEST(Environment, HasADensityWhereTheLuminanceIsRoundedToNothing) {
    Image image(2, 2);
    image.rgb[2] = std::numeric_limits<float>::denorm_min();
    ASSERT_EQ(luminance({0, 0, image.rgb[2]}), 0);
    const Environment map = environment(image);
    EXPECT_TRUE(map.is_lit());
    const Environment::Sample sample = map.sample(0.5, 0.5);
    EXPECT_GT(sample.pdf, 0);
    EXPECT_EQ(sample.radiance.b, image.rgb[2]);
}

TEST(Environment, WithMoreLightThanANumberHoldsIsRefused) {
    EXPECT_THAT([] { environment(one_pixel(1, 1, 0, 3e38F)); },
                testing::ThrowsMessage<Error>(testing::HasSubstr("more than a number holds")));
}

TEST(Environment, OfManyColumnsIsSampledByItsDensity) {
    const Row row{"", noise(8192, 1)};
    const Environment map = environment(row);
    const Grid grid(row, 1);
    constexpr std::uint32_t kMany = 1'000'000;
    std::vector<double> observed(grid.size());
    for (std::uint32_t i = 0; i < kMany; ++i) ++observed[grid.bin_of(draw(map, i).w)];
    std::vector<double> expected;
    grid.for_each(
        [&](Vec3 w, double solid_angle) { expected.push_back(kMany * solid_angle * map.pdf(w)); });
    EXPECT_GT(test::p_value_of_counts(observed, expected), level());
}

TEST(Environment, TakesTheEndsOfItsRandomNumbers) {
    // The largest and the smallest of what Rng gives.
    const Environment map = environment(dim_but_for_one(7, 5, 20), Filter::Bilinear);
    for (const float u : {0.0F, 1 - 0x1p-24F}) {
        for (const float v : {0.0F, 1 - 0x1p-24F}) {
            const Environment::Sample sample = map.sample(double{v}, double{u});
            EXPECT_GT(sample.pdf, 0);
            EXPECT_NEAR(length(sample.w), 1, 1e-6);
        }
    }
}

TEST(DiscreteDistribution, PassesOnWhatItDidNotNeedOfU) {
    const std::vector<double> weights = {0, 1, 0, 3, 4, 0, 0};
    const DiscreteDistribution distribution(weights);
    constexpr int kSteps = 8000;
    std::vector<int> counts(weights.size());
    for (int i = 0; i < kSteps; ++i) {
        const double u = (i + 0.5) / kSteps;
        const std::uint32_t index = distribution.select(u).index;
        const double remainder = distribution.rest(u, index);
        // The remainder grows evenly from 0 to 1 within a choice.
        const double share = weights[index] / 8 * kSteps;
        EXPECT_NEAR(remainder, (counts[index] + 0.5) / share, 1e-9);
        ++counts[index];
    }
    EXPECT_EQ(counts, (std::vector<int>{0, 1000, 0, 3000, 4000, 0, 0}));
    EXPECT_EQ(distribution.probability(0), 0);
    EXPECT_DOUBLE_EQ(distribution.probability(3), 0.375);
    EXPECT_EQ(distribution.probability(6), 0);
}

TEST(DiscreteDistribution, KeepsTheRemainderInRangeAtItsBorders) {
    // n = 49, of which no border is a binary fraction.
    const std::vector<double> weights(49, 1);
    const DiscreteDistribution distribution(weights);
    double border = 0;
    for (std::size_t i = 0; i < weights.size(); ++i) {
        for (double u : {std::nextafter(border, 0.0), border, std::nextafter(border, 1.0)}) {
            const std::uint32_t index = distribution.select(u).index;
            const double remainder = distribution.rest(u, index);
            EXPECT_LE(index > i ? index - i : i - index, 1U);
            EXPECT_GE(remainder, 0);
            EXPECT_LT(remainder, 1);
        }
        border += distribution.probability(static_cast<std::uint32_t>(i));
    }
    EXPECT_EQ(distribution.select(std::nextafter(1.0, 0.0)).index, 48U);
}

}  // namespace
}  // namespace misbench
