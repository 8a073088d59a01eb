// Filters of estimates against direct sums over each pixel's neighbours.
#include "renderer/weights/filters.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <random>

#include "renderer/methods/thread_pool.h"

namespace misbench {
namespace {

struct Size {
    int width;
    int height;
};
constexpr Size kSizes[] = {{1, 1}, {1, 7}, {40, 1}, {5, 3}, {16, 17}, {33, 40}};

Plane random_plane(Size size, unsigned seed) {
    std::mt19937 rng(seed);
    std::exponential_distribution<float> value;
    Plane plane(size.width, size.height);
    for (float& v : plane.values) v = value(rng);
    return plane;
}

std::size_t index(const Plane& plane, int x, int y) {
    return static_cast<std::size_t>(y * plane.width + x);
}

// Calls visit(u, v) for the pixels of a square around (x, y) that are in the image.
template <class Visit>
void for_each_around(const Plane& plane, int x, int y, int reach, const Visit& visit) {
    for (int v = y - reach; v <= y + reach; ++v) {
        for (int u = x - reach; u <= x + reach; ++u) {
            if (u >= 0 && u < plane.width && v >= 0 && v < plane.height) visit(u, v);
        }
    }
}

template <class PixelFilter>
Plane filtered(const Plane& plane, const PixelFilter& filter) {
    Plane result = plane;
    for (int y = 0; y < plane.height; ++y) {
        for (int x = 0; x < plane.width; ++x) {
            result.values[index(plane, x, y)] = static_cast<float>(filter(x, y));
        }
    }
    return result;
}

Plane means_of_squares(Plane plane, int radius, int passes) {
    for (int pass = 0; pass < passes; ++pass) {
        plane = filtered(plane, [&](int x, int y) {
            double sum = 0;
            int n = 0;
            for_each_around(plane, x, y, radius, [&](int u, int v) {
                sum += double{plane.values[index(plane, u, v)]};
                ++n;
            });
            return sum / n;
        });
    }
    return plane;
}

void expect_near(const Plane& a, const Plane& b, const std::string& what) {
    ASSERT_EQ(a.values.size(), b.values.size());
    for (std::size_t i = 0; i < a.values.size(); ++i) {
        ASSERT_NEAR(a.values[i], b.values[i], 1e-5F * (1 + b.values[i])) << what << ' ' << i;
    }
}

TEST(BoxFilter, IsTheMeanOfASquareWithinTheImage) {
    ThreadPool threads(3);
    for (const Size size : kSizes) {
        for (const int radius : {0, 1, 4, 50}) {
            for (const int passes : {0, 1, 2, 8}) {
                Plane plane = random_plane(size, 1);
                const Plane expected = means_of_squares(plane, radius, passes);
                box_filter(plane, radius, passes, threads);
                expect_near(plane, expected,
                            std::to_string(size.width) + "x" + std::to_string(size.height) +
                                " radius " + std::to_string(radius) + " passes " +
                                std::to_string(passes));
            }
        }
    }
}

TEST(BoxFilter, LeavesOnesAsTheyAre) {
    ThreadPool threads(1);
    Plane plane(37, 21, 1);
    box_filter(plane, 1, 100, threads);
    EXPECT_THAT(plane.values, testing::Each(1));
}

TEST(BoxFilter, OfManyPassesHasTheSpreadThatItSays) {
    ThreadPool threads(1);
    Plane plane(41, 41);
    plane.values[index(plane, 20, 20)] = 1;
    box_filter(plane, 1, 8, threads);
    double variance = 0;
    for (int x = 0; x < 41; ++x) {
        for (int y = 0; y < 41; ++y) {
            variance += (x - 20) * (x - 20) * double{plane.values[index(plane, x, y)]};
        }
    }
    EXPECT_NEAR(variance, 2 * 8 / 3.0, 1e-4);
}

std::vector<PixelFeature> random_features(const Plane& plane, unsigned seed) {
    std::mt19937 rng(seed);
    std::uniform_real_distribution<float> uniform(-1, 1);
    std::vector<PixelFeature> features(plane.values.size());
    for (PixelFeature& feature : features) {
        // Most are nearly alike, some are turned, some see nothing.
        const float turn = rng() % 4 == 0 ? 1 : 0.2F;
        feature.normal = normalized({turn * uniform(rng), turn * uniform(rng), 1});
        feature.distance = rng() % 5 == 0 ? 0 : 10 + 0.6F * uniform(rng);
    }
    return features;
}

Plane by_likeness(const Plane& plane, int passes, const std::vector<PixelFeature>& features) {
    const double sigma = std::sqrt(2.0 * passes / 3);
    return filtered(plane, [&](int x, int y) {
        double sum = 0;
        double sum_of_weights = 0;
        const PixelFeature& a = features[index(plane, x, y)];
        for_each_around(plane, x, y, static_cast<int>(std::ceil(3 * sigma)), [&](int u, int v) {
            const PixelFeature& b = features[index(plane, u, v)];
            double weight =
                std::exp(-((x - u) * (x - u) + (y - v) * (y - v)) / (2 * sigma * sigma));
            if ((a.distance == 0) != (b.distance == 0)) return;
            if (a.distance != 0) {
                const double turned = 1 - double{dot(a.normal, b.normal)};
                const double moved = double{a.distance - b.distance} / (0.05 * double{a.distance});
                weight *= std::exp(-turned * turned / (0.1 * 0.1) - moved * moved);
            }
            sum += weight * double{plane.values[index(plane, u, v)]};
            sum_of_weights += weight;
        });
        return sum / sum_of_weights;
    });
}

TEST(BilateralFilter, WeighsByPlaceNormalAndDistance) {
    ThreadPool threads(3);
    for (const Size size : kSizes) {
        for (const int passes : {1, 8, 20}) {
            Plane plane = random_plane(size, 2);
            const std::vector<PixelFeature> features = random_features(plane, 3);
            const Plane expected = by_likeness(plane, passes, features);
            bilateral_filter(plane, passes, features, threads);
            expect_near(plane, expected, std::to_string(passes));
        }
    }
}

TEST(BilateralFilter, DoesNothingInNoPasses) {
    ThreadPool threads(1);
    Plane plane = random_plane({9, 5}, 4);
    const Plane before = plane;
    bilateral_filter(plane, 0, random_features(plane, 5), threads);
    EXPECT_EQ(plane.values, before.values);
}

TEST(BilateralFilter, KeepsTwoSurfacesApartEvenWhereOneIsInfinite) {
    ThreadPool threads(1);
    Plane plane(16, 4);
    std::vector<PixelFeature> features(plane.values.size());
    for (int y = 0; y < plane.height; ++y) {
        for (int x = 0; x < plane.width; ++x) {
            const bool is_left = x < 8;
            plane.values[index(plane, x, y)] = is_left ? 1 : std::numeric_limits<float>::infinity();
            features[index(plane, x, y)] = {.normal = {0, 0, 1}, .distance = is_left ? 1.0F : 0.0F};
        }
    }
    bilateral_filter(plane, 8, features, threads);
    for (int x = 0; x < 8; ++x) EXPECT_EQ(plane.values[index(plane, x, 2)], 1) << x;
}

}  // namespace
}  // namespace misbench
