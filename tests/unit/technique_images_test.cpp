#include "renderer/paths/technique_images.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "renderer/methods/thread_pool.h"
#include "tests/support/made_up_samples.h"

namespace misbench {
namespace {

using testing::ElementsAre;

constexpr Technique kHit{TechniqueKind::Hit};
constexpr Technique kNextEvent{TechniqueKind::NextEvent};
constexpr Technique kLight{TechniqueKind::Light};
constexpr Technique kConnect1{TechniqueKind::Connect, 1};
constexpr Technique kConnect2{TechniqueKind::Connect, 2};
constexpr Technique kMerge3{TechniqueKind::Merge, 3};

void show(SampleObserver& observer, std::size_t chunk, Pixel pixel, int n_edges,
          Technique technique, Rgb value, double weight) {
    observer.observe(test::MadeUpSample(pixel, n_edges, technique, value, weight).sample, chunk);
}

std::vector<std::string> names(const std::vector<TechniqueImage>& images) {
    std::vector<std::string> names;
    for (const TechniqueImage& image : images) names.push_back(image.name());
    return names;
}

TEST(TechniqueImages, AreThereForWhatHadASampleByPathLengthThenTechnique) {
    TechniqueImages images(2, 1);
    images.start_phase(1);
    for (const auto& [n_edges, technique] :
         std::vector<std::pair<int, Technique>>{{4, kMerge3},
                                                {4, kConnect2},
                                                {1, kHit},
                                                {2, kLight},
                                                {4, kConnect1},
                                                {2, kHit},
                                                {120, {TechniqueKind::Merge, 119}},
                                                {3, kNextEvent}}) {
        show(images, 0, {}, n_edges, technique, {1, 1, 1}, 1);
    }
    images.finish_phase();
    EXPECT_THAT(names(images.means(1)),
                ElementsAre("n1.hit", "n2.hit", "n2.light", "n3.nee", "n4.connect1", "n4.connect2",
                            "n4.merge3", "n120.merge119"));
}

TEST(TechniqueImages, AreMeansOverPassesWithAndWithoutTheWeight) {
    TechniqueImages images(2, 2);
    // Two passes: light paths first, each in a phase of its own.
    for (int pass = 0; pass < 2; ++pass) {
        images.start_phase(3);
        show(images, 2, {1, 1}, 3, kLight, {8, 4, 2}, 0.25);
        show(images, 0, {1, 1}, 3, kLight, {8, 4, 2}, 0.5);
        images.finish_phase();
        images.start_phase(1);
        if (pass == 0) show(images, 0, {0, 1}, 3, kConnect1, {16, 0, 1}, 0.5);
        images.finish_phase();
    }
    const std::vector<TechniqueImage> means = images.means(2);
    ASSERT_THAT(names(means), ElementsAre("n3.light", "n3.connect1"));
    EXPECT_THAT(means[0].weighted.rgb, ElementsAre(0, 0, 0, 0, 0, 0, 0, 0, 0, 6, 3, 1.5F));
    EXPECT_THAT(means[0].unweighted.rgb, ElementsAre(0, 0, 0, 0, 0, 0, 0, 0, 0, 16, 8, 4));
    EXPECT_THAT(means[1].weighted.rgb, ElementsAre(0, 0, 0, 0, 0, 0, 4, 0, 0.25F, 0, 0, 0));
    EXPECT_THAT(means[1].unweighted.rgb, ElementsAre(0, 0, 0, 0, 0, 0, 8, 0, 0.5F, 0, 0, 0));
}

TEST(TechniqueImages, ShowWhatIsNotFinite) {
    TechniqueImages images(1, 1);
    images.start_phase(1);
    show(images, 0, {}, 1, kHit, {std::numeric_limits<float>::infinity(), std::nanf(""), 1}, 1);
    images.finish_phase();
    const std::vector<TechniqueImage> means = images.means(4);
    EXPECT_TRUE(std::isinf(means[0].weighted.rgb[0]));
    EXPECT_TRUE(std::isnan(means[0].weighted.rgb[1]));
    EXPECT_EQ(means[0].weighted.rgb[2], 0.25F);
}

// Large values that cancel, so that sums depend on the order. The chunks are begun from the first
// or from the last.
std::vector<TechniqueImage> images_of_many_samples(int n_threads, bool backwards) {
    constexpr int kSide = 8;
    constexpr std::size_t kChunks = 64;
    ThreadPool threads(n_threads);
    TechniqueImages images(kSide, kSide);
    const auto value = [](int i) {
        const float v = i % 3 == 0 ? 1e30F : i % 3 == 1 ? -1e30F : 1;
        return Rgb{v, v / 3, v / 7};
    };
    const auto for_each_chunk = [&](std::size_t n, const auto& work) {
        images.start_phase(n);
        threads.for_each(
            n, [] { return false; }, [&](std::size_t i) { work(backwards ? n - 1 - i : i); });
        images.finish_phase();
    };
    for_each_chunk(kChunks, [&](std::size_t chunk) {
        for (int i = 0; i < 100; ++i) {
            const int n = static_cast<int>(chunk) + i;
            show(images, chunk, {n % kSide, i % kSide}, 2 + i % 3, kLight, value(n), 1.0 / 3);
        }
    });
    for_each_chunk(kSide, [&](std::size_t chunk) {
        for (int i = 0; i < 1000; ++i) {
            show(images, chunk, {i % kSide, static_cast<int>(chunk)}, 3 + i % 5, kConnect1,
                 value(i), 1.0 / 7);
        }
    });
    return images.means(3);
}

TEST(TechniqueImages, HaveTheSameBitsForEveryNumberOfThreadsAndOrderOfChunks) {
    const std::vector<TechniqueImage> one = images_of_many_samples(1, false);
    ASSERT_EQ(one.size(), 8U);
    for (const int n_threads : {1, 2, 7}) {
        const std::vector<TechniqueImage> many = images_of_many_samples(n_threads, true);
        ASSERT_EQ(names(many), names(one));
        for (std::size_t i = 0; i < one.size(); ++i) {
            EXPECT_EQ(many[i].weighted, one[i].weighted) << one[i].name();
            EXPECT_EQ(many[i].unweighted, one[i].unweighted) << one[i].name();
        }
    }
}

}  // namespace
}  // namespace misbench
