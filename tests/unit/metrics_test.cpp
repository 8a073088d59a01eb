#include "results/metrics/metrics.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

#include "renderer/base/error.h"

namespace misbench {
namespace {

Image filled(int width, int height, float value) {
    Image image(width, height);
    std::ranges::fill(image.rgb, value);
    return image;
}

Image noise(int width, int height, unsigned seed) {
    Image image(width, height);
    std::mt19937 random(seed);
    std::gamma_distribution<float> gamma(2.0F, 0.5F);
    for (float& value : image.rgb) value = gamma(random);
    return image;
}

// Walks the table: a new metric is tested without a line here.
class EveryMetric : public testing::TestWithParam<std::string> {
 protected:
    const Metric& metric() const { return find_metric(GetParam()); }
};

class RankingMetric : public EveryMetric {};

TEST_P(EveryMetric, IsFoundByItsId) {
    EXPECT_EQ(metric().id, GetParam());
    EXPECT_FALSE(metric().formula.empty());
}

TEST_P(EveryMetric, RefusesImagesOfDifferentSize) {
    const Image small = filled(4, 3, 1.0F);
    const Image turned = filled(3, 4, 1.0F);  // as many values
    EXPECT_NO_THROW(measure(metric(), small, {small, small}));
    for (const auto& [image, a, b] :
         {std::tuple(&turned, &small, &small), std::tuple(&small, &turned, &small),
          std::tuple(&small, &small, &turned)}) {
        try {
            measure(metric(), *image, {*a, *b});
            ADD_FAILURE() << "measured";
        } catch (const Error& e) {
            EXPECT_EQ(e.code(), Errc::InvalidArgument);
            EXPECT_NE(std::string(e.what()).find("3x4"), std::string::npos) << e.what();
        }
    }
    const Image empty;
    EXPECT_THROW(measure(metric(), empty, {empty, empty}), Error);
}

TEST_P(RankingMetric, HasNoErrorWhereTheImageIsTheReference) {
    const Image image = noise(50, 40, 1);
    EXPECT_EQ(measure(metric(), image, {image, image}), 0);
}

TEST_P(RankingMetric, IsLargerForTheWorseImage) {
    const Image reference = noise(50, 40, 1);
    Image bad = reference;
    Image worse = reference;
    for (float& value : bad.rgb) value += 0.1F;
    for (float& value : worse.rgb) value += 0.2F;
    EXPECT_LT(measure(metric(), bad, {reference, reference}),
              measure(metric(), worse, {reference, reference}));
}

std::vector<std::string> ids(bool also_without_rank) {
    std::vector<std::string> chosen;
    for (const Metric& metric : metrics()) {
        if (metric.better != Direction::None || also_without_rank) chosen.emplace_back(metric.id);
    }
    return chosen;
}

std::string test_name(const testing::TestParamInfo<std::string>& tested) {
    std::string name = tested.param;
    std::ranges::replace(name, '.', '_');
    std::ranges::replace(name, '-', '_');
    return name;
}

INSTANTIATE_TEST_SUITE_P(Metrics, EveryMetric, testing::ValuesIn(ids(true)), test_name);
INSTANTIATE_TEST_SUITE_P(Metrics, RankingMetric, testing::ValuesIn(ids(false)), test_name);

TEST(Metrics, HaveTheNumbersOfTheirFormulas) {
    const Image image = filled(5, 5, 2.0F);
    const Image a = filled(5, 5, 1.0F);
    const Image b = filled(5, 5, 0.5F);
    const double error = (2.0 - 1.0) * (2.0 - 0.5);
    EXPECT_DOUBLE_EQ(measure(find_metric("mse"), image, {a, b}), error);
    EXPECT_DOUBLE_EQ(measure(find_metric("relmse.eps0.01"), image, {a, b}),
                     error / (0.75 * 0.75 + 0.01));
    EXPECT_DOUBLE_EQ(measure(find_metric("mrse.eps0.01"), image, {a, b}), error / (0.75 + 0.01));
    EXPECT_DOUBLE_EQ(measure(find_metric("mean"), image, {a, b}), 2);
    EXPECT_DOUBLE_EQ(measure(find_metric("smape.eps0.01"), image, {a, b}), 1.25 / (2.75 + 0.01));
    EXPECT_DOUBLE_EQ(measure(find_metric("luminance.rec709"), image, {a, b}), 2);
    EXPECT_NEAR(measure(find_metric("luminance.rec709.bias.eps1e-9"), image, {a, b}),
                (2 - 0.75) / 0.75, 1e-8);
}

TEST(Metrics, OfLuminanceWeighTheChannels) {
    Image image(2, 1);
    image.rgb = {1, 0, 0, 0, 0, 1};
    EXPECT_DOUBLE_EQ(measure(find_metric("luminance.rec709"), image, {image, image}),
                     0.5 * (0.2126 + 0.0722));
    // Darker than the reference is negative.
    Image reference = image;
    for (float& value : reference.rgb) value *= 2;
    EXPECT_NEAR(
        measure(find_metric("luminance.rec709.bias.eps1e-9"), image, {reference, reference}), -0.5,
        1e-8);
}

TEST(Metrics, AreFiniteWhereEverythingIsBlackOrOneFireflyIsAll) {
    const Image black = filled(40, 40, 0.0F);
    const Image firefly = [&black] {
        Image image = black;
        image.rgb[1500] = 1e12F;
        return image;
    }();
    for (const Metric& metric : metrics()) {
        for (const auto& [image, reference] :
             {std::pair(&black, &black), std::pair(&firefly, &black),
              std::pair(&black, &firefly)}) {
            EXPECT_TRUE(std::isfinite(measure(metric, *image, {*reference, *reference})))
                << metric.id;
        }
        const double of_nothing = measure(metric, black, {black, black});
        EXPECT_EQ(of_nothing, 0) << metric.id;
    }
}

TEST(Metrics, ShareOfTheWorstPixelsTellsFirefliesFromNoise) {
    const Metric& metric = find_metric("relmse.eps0.01.worst0.001");
    const Image reference = filled(50, 40, 1.0F);
    Image even = filled(50, 40, 2.0F);
    EXPECT_NEAR(measure(metric, even, {reference, reference}), 0.001, 1e-12);
    // Of 2000 pixels the two largest count.
    Image spiky = reference;
    for (const std::size_t p : {7U, 900U, 1999U}) {
        for (std::size_t c = 0; c < 3; ++c) spiky.rgb[3 * p + c] = 11.0F;
    }
    EXPECT_NEAR(measure(metric, spiky, {reference, reference}), 2.0 / 3, 1e-12);
    // And of a few, one.
    Image small = filled(4, 1, 1.0F);
    const Image small_reference = filled(4, 1, 1.0F);
    small.rgb[0] = 3.0F;
    small.rgb[3] = 2.0F;
    EXPECT_NEAR(measure(metric, small, {small_reference, small_reference}), 4.0 / 5, 1e-12);
}

TEST(Metrics, WithoutSquaresAreMeasuredAgainstTheMeanOfTheHalves) {
    const Image image = noise(20, 20, 1);
    const Image a = noise(20, 20, 2);
    const Image b = noise(20, 20, 3);
    Image mean = a;
    for (std::size_t i = 0; i < mean.rgb.size(); ++i) mean.rgb[i] = 0.5F * (a.rgb[i] + b.rgb[i]);
    for (const char* id : {"smape.eps0.01", "flip.ldr.ppd67", "flip.hdr.ppd67"}) {
        const Metric& metric = find_metric(id);
        EXPECT_NEAR(measure(metric, image, {a, b}), measure(metric, image, {mean, mean}), 1e-6)
            << id;
        EXPECT_EQ(measure(metric, image, {a, b}), measure(metric, image, {b, a})) << id;
    }
}

TEST(Metrics, HaveMapsOfWhichTheyAreTheMean) {
    const Image image = noise(30, 20, 1);
    const Image a = noise(30, 20, 2);
    const Image b = noise(30, 20, 3);
    for (const Metric& metric : metrics()) {
        if (metric.map == nullptr) {
            EXPECT_THROW(measure_map(metric, image, {a, b}), Error);
            continue;
        }
        const auto map = measure_map(metric, image, {a, b});
        ASSERT_EQ(map.size(), image.n_pixels());
        if (metric.better == Direction::None) continue;  // a share is no mean
        double sum = 0;
        for (const double value : map) sum += value;
        EXPECT_EQ(measure(metric, image, {a, b}), sum / 600) << metric.id;
    }
}

TEST(Metrics, SayHowTheyAggregate) {
    EXPECT_EQ(aggregation(find_metric("mse")),
              "mean over seeds, geometric mean of ratios across scenes");
    EXPECT_EQ(aggregation(find_metric("mean")), "mean over seeds");
    // What ranks has ratios, what ranks nothing has none.
    for (const Metric& metric : metrics()) {
        EXPECT_EQ(metric.better != Direction::None,
                  metric.across_scenes == AcrossScenes::GeometricMeanOfRatios)
            << metric.id;
    }
}

TEST(Metrics, MayBeNegativeBecauseTheNoiseOfTheReferenceCancels) {
    const Image image = filled(5, 5, 1.0F);
    EXPECT_DOUBLE_EQ(measure(find_metric("mse"), image, {filled(5, 5, 1.25F), filled(5, 5, 0.75F)}),
                     -0.0625);
}

TEST(Metrics, TrimmedLeavesOutExactlyItsShareOfThePixels) {
    // Of 2000 pixels the largest two go: of five equally bright fireflies three stay.
    Image image = filled(50, 40, 1.0F);
    const Image reference = filled(50, 40, 1.0F);
    for (const std::size_t p : {3U, 500U, 501U, 900U, 1999U}) {
        for (std::size_t c = 0; c < 3; ++c) image.rgb[3 * p + c] = 11.0F;
    }
    const double firefly = 10.0 * 10.0 / 1.01;
    EXPECT_DOUBLE_EQ(measure(find_metric("relmse.eps0.01"), image, {reference, reference}),
                     5 * firefly / 2000);
    EXPECT_DOUBLE_EQ(
        measure(find_metric("relmse.eps0.01.trim0.001"), image, {reference, reference}),
        3 * firefly / 1998);
}

TEST(Metrics, TrimmedOfASmallImageIsTheWholeMean) {
    const Image image = noise(20, 20, 1);
    const Image a = noise(20, 20, 2);
    const Image b = noise(20, 20, 3);
    EXPECT_EQ(measure(find_metric("relmse.eps0.01.trim0.001"), image, {a, b}),
              measure(find_metric("relmse.eps0.01"), image, {a, b}));
}

TEST(Metrics, SumInDoubleInPixelOrder) {
    const Image image = noise(640, 480, 1);
    const Image a = noise(640, 480, 2);
    const Image b = noise(640, 480, 3);
    double sum = 0;
    for (std::size_t p = 0; p < image.n_pixels(); ++p) {
        double pixel = 0;
        for (std::size_t i = 3 * p; i < 3 * p + 3; ++i) {
            const auto value = static_cast<double>(image.rgb[i]);
            pixel +=
                (value - static_cast<double>(a.rgb[i])) * (value - static_cast<double>(b.rgb[i]));
        }
        sum += pixel / 3;
    }
    EXPECT_EQ(measure(find_metric("mse"), image, {a, b}),
              sum / static_cast<double>(image.n_pixels()));
}

TEST(Metrics, UnknownIdIsAnErrorThatListsTheKnown) {
    try {
        find_metric("relmse");
        ADD_FAILURE() << "found";
    } catch (const ParameterError& e) {
        EXPECT_STREQ(e.what(),
                     "unknown metric 'relmse'; known: relmse.eps0.01 relmse.eps0.01.trim0.001 "
                     "mrse.eps0.01 mse smape.eps0.01 flip.ldr.ppd67 flip.hdr.ppd67 "
                     "relmse.eps0.01.worst0.001 mean luminance.rec709 "
                     "luminance.rec709.bias.eps1e-9");
    }
}

}  // namespace
}  // namespace misbench
