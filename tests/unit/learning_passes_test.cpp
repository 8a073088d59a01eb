// Renders whose weights are learned on the way: which pass uses what, which passes are in the
// image, and that the image's bits depend on nothing else.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <nlohmann/json.hpp>

#include "renderer/methods/render_loop.h"
#include "renderer/paths/technique_images.h"
#include "tests/support/scenes.h"

namespace misbench {
namespace {

constexpr int kWidth = 21;  // no multiple of a tile
constexpr int kHeight = 13;

std::int64_t n(std::int64_t value) { return value; }
std::string text(const char* value) { return value; }

SceneDescription lit_box() {
    SceneDescription scene = test::open_box();
    scene.meshes.push_back(test::ceiling_lamp());
    scene.materials.push_back(test::surface(DielectricMaterial({})));
    scene.quadrics.push_back(test::ball({-0.35F, -0.55F, 0.1F}, 0.4F, 3));
    return scene;
}
const Scene& box() {
    static const Scene scene(lit_box(), 1);
    return scene;
}

// Values of `parameters` win.
RenderRequest request(const std::string& factors, std::int64_t n_passes,
                      ParameterMap parameters = {}) {
    parameters.insert({"factors", factors});
    parameters.insert({"max_depth", n(4)});
    return {.method = "vcm",
            .parameters = std::move(parameters),
            .width = kWidth,
            .height = kHeight,
            .budget = SampleBudget{n_passes},
            .seed = 11,
            .threads = 2};
}
RenderResult render_with(const std::string& factors, std::int64_t n_passes,
                         const ParameterMap& parameters = {}) {
    return render(box(), request(factors, n_passes, parameters));
}
Image pass(const std::string& factors, std::int64_t i, const ParameterMap& parameters = {}) {
    RenderRequest one = request(factors, 0, parameters);
    one.only_pass = i;
    return render(box(), one).image;
}

// As the render loop makes it: in double, in order.
Image mean(const std::vector<Image>& images) {
    Image mean(kWidth, kHeight);
    for (std::size_t i = 0; i < mean.rgb.size(); ++i) {
        double sum = 0;
        for (const Image& image : images) sum += double{image.rgb[i]};
        mean.rgb[i] = static_cast<float>(sum / static_cast<double>(images.size()));
    }
    return mean;
}

// All that can be learned, in names and parameters of its own.
struct Learner {
    std::string factors;
    ParameterMap parameters;
};
const std::vector<Learner>& learners() {
    static const std::vector<Learner> kLearners = {
        {"variance", {{"variance_keep", 1e30}}},
        {"variance", {{"variance_variant", text("hua2025")}}},
        {"variance", {{"variance_update", true}}},
        {"variance",
         {{"variance_factor", text("reciprocal")},
          {"variance_keep", 1e30},
          {"mis", text("constant")}}},
        {"correction", {}},
        {"correction", {{"correction_filter", text("bilateral")}}},
        {"correction",
         {{"correction_groups", text("nee+hit")}, {"correction_candidates", text("1e-30,1e30")}}},
        {"correlation+correction", {{"training", n(2)}}},
        {"variance+correction", {{"variance_keep", 1e30}, {"mis", text("power2")}}},
    };
    return kLearners;
}

TEST(LearningPasses, UseNothingInThePassItWasLearnedFrom) {
    const std::vector<Image> plain = {pass("none", 0), pass("none", 1), pass("none", 2)};
    for (const std::string factors : {"variance", "correction"}) {
        EXPECT_EQ(pass(factors, 0), plain[0]) << factors;
        EXPECT_NE(pass(factors, 1), plain[1]) << factors;
        const ParameterMap two = {{"training", n(2)}};
        EXPECT_EQ(pass(factors, 0, two), plain[0]) << factors;
        EXPECT_EQ(pass(factors, 1, two), plain[1]) << factors;
        EXPECT_NE(pass(factors, 2, two), plain[2]) << factors;
    }
}

TEST(LearningPasses, LearnASecondFactorOnTopOfTheFirst) {
    EXPECT_EQ(pass("variance+correction", 0), pass("none", 0));
    EXPECT_EQ(pass("variance+correction", 1), pass("variance", 1));
    EXPECT_NE(pass("variance+correction", 2), pass("variance", 2));
    EXPECT_EQ(pass("correlation+correction", 0), pass("correlation", 0));
    EXPECT_NE(pass("correlation+correction", 1), pass("correlation", 1));
    // What the second learned is not what it would have learned alone.
    const auto map = [](const std::string& factors, std::int64_t n_passes) {
        for (const NamedImage& image : render_with(factors, n_passes).maps) {
            if (image.name == "correction.merge") return image.image;
        }
        return Image();
    };
    EXPECT_NE(map("variance+correction", 2), Image());
    EXPECT_NE(map("variance+correction", 2), map("correction", 2));
    EXPECT_EQ(map("correction", 2), map("correction", 3)) << "learned from the first pass alone";
}

// The unweighted samples of a pass, of all techniques.
std::vector<TechniqueImage> samples_of(RenderRequest request) {
    TechniqueImages images(kWidth, kHeight);
    request.observer = &images;
    render(box(), request);
    return images.means(1);
}

TEST(LearningPasses, BeforeTheImageLeaveItsRandomNumbersAsTheyAre) {
    for (const std::string factors : {"variance", "correction", "correlation+correction"}) {
        const ParameterMap precomputed = {{"precompute", n(3)}};
        const RenderResult result = render_with(factors, 2, precomputed);
        EXPECT_EQ(result.statistics.precomputed_passes, 3);
        EXPECT_EQ(result.statistics.training_passes, 0);
        EXPECT_EQ(result.statistics.passes, 2);
        EXPECT_NE(result.image, render_with(factors, 2).image);
        const auto plain = samples_of(request("none", 2));
        const auto same = samples_of(request(factors, 2, precomputed));
        ASSERT_EQ(same.size(), plain.size());
        for (std::size_t i = 0; i < plain.size(); ++i) {
            EXPECT_EQ(same[i].unweighted, plain[i].unweighted) << plain[i].name();
        }
    }
    // They are not those of the image.
    EXPECT_NE(pass("correction", 1, {{"precompute", n(1)}}), pass("correction", 1));
    // Two learners have three each.
    EXPECT_EQ(
        render_with("variance+correction", 1, {{"precompute", n(3)}}).statistics.precomputed_passes,
        6);
}

TEST(LearningPasses, OneByOneAddUpToTheImage) {
    for (const Learner& learner : learners()) {
        std::vector<Image> passes;
        for (std::int64_t i = 0; i < 4; ++i) {
            passes.push_back(pass(learner.factors, i, learner.parameters));
        }
        const RenderResult all = render_with(learner.factors, 4, learner.parameters);
        EXPECT_TRUE(all.valid);
        EXPECT_EQ(all.image, mean(passes)) << learner.factors;
    }
}

TEST(LearningPasses, AreLeftOutOfTheImageWhereTheyAreForgotten) {
    const auto all_of = [](const std::string& factors, const ParameterMap& parameters) {
        std::vector<Image> images;
        for (std::int64_t i = 0; i < 4; ++i) images.push_back(pass(factors, i, parameters));
        return images;
    };
    // All of it.
    const ParameterMap drop = {{"correction_keep", false}, {"training", n(2)}};
    auto rest = all_of("correction", drop);
    rest.erase(rest.begin(), rest.begin() + 2);
    RenderResult result = render_with("correction", 4, drop);
    EXPECT_EQ(result.image, mean(rest));
    EXPECT_EQ(result.statistics.passes, 2);
    EXPECT_EQ(result.statistics.training_passes, 2);
    EXPECT_TRUE(result.valid);

    // Some of its pixels, tile by tile.
    const ParameterMap some = {{"variance_keep", 2.0}};
    const auto all = all_of("variance", some);
    const Image kept = mean(all);
    const Image forgot = mean({all[1], all[2], all[3]});
    result = render_with("variance", 4, some);
    EXPECT_TRUE(result.valid);
    std::vector<double> largest(kWidth * kHeight);
    for (const NamedImage& map : result.maps) {
        for (std::size_t i = 0; i < largest.size(); ++i) {
            largest[i] = std::max(largest[i], double{map.image.rgb[3 * i]});
        }
    }
    int n_forgot = 0;
    for (std::size_t i = 0; i < result.image.rgb.size(); ++i) {
        const bool forgets = largest[i / 3] > 2;
        n_forgot += forgets ? 1 : 0;
        EXPECT_EQ(result.image.rgb[i], forgets ? forgot.rgb[i] : kept.rgb[i]) << i;
    }
    EXPECT_GT(n_forgot, 0);
    EXPECT_LT(n_forgot, 3 * kWidth * kHeight);
}

TEST(LearningPasses, MakeARunInvalidThatHasNoOthers) {
    EXPECT_FALSE(render_with("correction", 1, {{"correction_keep", false}}).valid);
    EXPECT_TRUE(render_with("correction", 2, {{"correction_keep", false}}).valid);
    EXPECT_FALSE(render_with("variance", 1, {{"variance_keep", 2.0}}).valid) << "some pixels";
    EXPECT_FALSE(render_with("variance", 1, {{"variance_keep", 0.5}}).valid) << "all pixels";
    EXPECT_TRUE(render_with("variance", 2, {{"variance_keep", 0.5}}).valid);
}

TEST(LearningPasses, GiveTheSameBitsForEveryNumberOfThreads) {
    std::vector<Learner> all = learners();
    for (const std::string name : {"correlation", "popov", "jendersie"}) all.push_back({name, {}});
    for (const Learner& learner : all) {
        RenderRequest of = request(learner.factors, 3, learner.parameters);
        of.threads = 1;
        const RenderResult one = render(box(), of);
        for (const int threads : {2, 7}) {
            of.threads = threads;
            const RenderResult many = render(box(), of);
            EXPECT_EQ(many.image, one.image) << learner.factors << " on " << threads;
            EXPECT_EQ(many.description, one.description);
            ASSERT_EQ(many.maps.size(), one.maps.size());
            for (std::size_t i = 0; i < one.maps.size(); ++i) {
                EXPECT_EQ(many.maps[i].image, one.maps[i].image) << one.maps[i].name;
            }
        }
    }
}

// Asks for everything and looks at nothing.
class Curious final : public SampleObserver {
 public:
    bool wants_zeros() const override { return true; }
    bool wants_weights() const override { return true; }
    void observe(const Sample& /*sample*/, std::size_t /*chunk*/) override {}
};

TEST(LearningPasses, DoNotNoticeAnObserver) {
    for (const Learner& learner : learners()) {
        Curious observer;
        RenderRequest watched = request(learner.factors, 3, learner.parameters);
        const RenderResult before = render(box(), watched);
        watched.observer = &observer;
        const RenderResult after = render(box(), watched);
        EXPECT_EQ(after.image, before.image) << learner.factors;
        EXPECT_EQ(after.description, before.description) << learner.factors;
    }
}

TEST(LearningPasses, AreCountedApart) {
    const RenderResult result = render_with("variance+correction", 7, {{"training", n(2)}});
    EXPECT_EQ(result.statistics.training_passes, 4);
    EXPECT_EQ(result.statistics.passes, 7);
    EXPECT_GT(result.statistics.training_wall_seconds, 0);
    EXPECT_LE(result.statistics.training_wall_seconds, result.statistics.wall_seconds);
    const ParameterMap endless = {{"variance_update", true}};
    EXPECT_EQ(render_with("variance", 5, endless).statistics.training_passes, 5);
    EXPECT_EQ(render_with("popov", 5).statistics.training_passes, 0);
}

// ---- Where there is next to nothing to learn from.

RenderResult render_of(const SceneDescription& description, RenderRequest request) {
    const Scene scene(description, 1);
    return render(scene, request);
}
void expect_finite(const RenderResult& result, const std::string& what) {
    for (const float value : result.image.rgb) ASSERT_TRUE(std::isfinite(value)) << what;
    for (const NamedImage& map : result.maps) {
        for (const float value : map.image.rgb) {
            ASSERT_TRUE(std::isfinite(value) && value > 0) << what << ' ' << map.name;
        }
    }
    EXPECT_EQ(result.statistics.nonfinite_samples, 0) << what;
}

TEST(LearningPasses, OfABlackSceneLeaveItBlack) {
    for (const Learner& learner : learners()) {
        const RenderResult result =
            render_of(test::open_box(), request(learner.factors, 3, learner.parameters));
        EXPECT_EQ(result.image, Image(kWidth, kHeight)) << learner.factors;
        EXPECT_TRUE(result.valid);
        EXPECT_TRUE(result.maps.empty());
    }
}

TEST(LearningPasses, OfImagesOfAnySizeAreFinite) {
    for (const auto& [width, height] : {std::pair{1, 1}, std::pair{1, 40}, std::pair{9, 9}}) {
        for (const Learner& learner : learners()) {
            for (const int tile : {1, 8, 1000}) {
                ParameterMap parameters = learner.parameters;
                parameters["variance_tile"] = n(tile);
                RenderRequest small = request(learner.factors, 4, parameters);
                small.width = width;
                small.height = height;
                const RenderResult result = render(box(), small);
                EXPECT_TRUE(result.valid) << learner.factors;
                expect_finite(result, learner.factors);
            }
        }
    }
}

TEST(LearningPasses, OfVeryLongPathsAreFinite) {
    SceneDescription bright = lit_box();
    for (std::size_t i = 0; i < 3; ++i) {
        bright.materials[i] = test::surface(DiffuseMaterial{{0.99F, 0.99F, 0.99F}});
    }
    for (const std::string factors : {"variance", "correction", "correlation", "popov", "jendersie",
                                      "correlation+correction"}) {
        RenderRequest longest = request(factors, 2,
                                        {{"max_depth", n(100)},
                                         {"rr_depth", n(0)},
                                         {"variance_max_depth", n(100)},
                                         {"variance_keep", 1e30},
                                         {"correlation_bounded", false}});
        longest.width = 4;
        longest.height = 3;
        const RenderResult result = render_of(bright, longest);
        EXPECT_TRUE(result.valid) << factors;
        expect_finite(result, factors);
    }
}

}  // namespace
}  // namespace misbench
