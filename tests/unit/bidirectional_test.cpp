// What holds of the bidirectional methods exactly, whatever the random numbers.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <atomic>
#include <cmath>
#include <map>
#include <nlohmann/json.hpp>

#include "renderer/base/error.h"
#include "renderer/methods/catalogue.h"
#include "renderer/methods/render_loop.h"
#include "renderer/paths/sample.h"
#include "renderer/scene/load.h"
#include "tests/support/allocations.h"

namespace misbench {
namespace {

using testing::HasSubstr;
using testing::ThrowsMessage;

constexpr int kWidth = 40;
constexpr int kHeight = 30;

const Scene& scene_of(const std::string& file) {
    static std::map<std::string, LoadedScene> scenes;
    LoadedScene& loaded = scenes[file];
    if (!loaded.scene) loaded = load_scene(std::string(MISBENCH_SCENES) + "/" + file, 1);
    return *loaded.scene;
}
const Scene& cornell() { return scene_of("CornellBox/CornellBox.json"); }
const Scene& glass() { return scene_of("VeachBidir/VeachBidir.json"); }

RenderResult render_with(const Scene& scene, const std::string& method, ParameterMap parameters,
                         std::int64_t samples = 2, SampleObserver* observer = nullptr,
                         int threads = 2) {
    return render(scene, {.method = method,
                          .parameters = std::move(parameters),
                          .width = kWidth,
                          .height = kHeight,
                          .budget = SampleBudget{samples},
                          .seed = 7,
                          .threads = threads,
                          .observer = observer});
}

void expect_same_image(const Image& a, const Image& b) {
    ASSERT_EQ(a.rgb.size(), b.rgb.size());
    for (std::size_t i = 0; i < a.rgb.size(); ++i) {
        ASSERT_NEAR(a.rgb[i], b.rgb[i], 1e-5F * (1 + std::abs(a.rgb[i]))) << i;
    }
}

// The same random numbers in the same order: without light paths nothing else is left of it.
TEST(Bidirectional, IsThePathTracerWithoutLightPaths) {
    for (const Scene* scene : {&cornell(), &glass()}) {
        for (const std::string mis : {"balance", "power2", "maximum"}) {
            const Image path = render_with(*scene, "path", {{"mis", mis}}).image;
            for (const std::string method : {"bdpt", "vcm"}) {
                expect_same_image(
                    path, render_with(*scene, method, {{"mis", mis}, {"light_paths", 0.0}}).image);
            }
        }
    }
}

TEST(Bidirectional, IsItselfWithoutWhatIsSwitchedOff) {
    const ParameterMap off = {{"merge", false}};
    EXPECT_EQ(render_with(glass(), "bdpt", {}).image, render_with(glass(), "vcm", off).image);
    EXPECT_EQ(render_with(glass(), "bdpt", {{"connect", false}}).image,
              render_with(glass(), "bdpt", {{"connections", 0.0}}).image);
    // Without light paths photon mapping sees the lights themselves.
    EXPECT_EQ(render_with(cornell(), "photon", {{"light_paths", 0.0}}).image,
              render_with(cornell(), "path", {{"max_depth", std::int64_t{1}}}).image);
    EXPECT_EQ(render_with(cornell(), "light", {{"light_paths", 0.0}}).image,
              render_with(cornell(), "path", {{"max_depth", std::int64_t{1}}}).image);
}

TEST(Bidirectional, RendersWithAnyNumberOfLightPaths) {
    for (const std::string method : {"light", "bdpt", "photon", "vcm"}) {
        for (const double n : {1e-9, 1.0 / (kWidth * kHeight), 0.37, 3.0}) {
            const RenderResult result = render_with(glass(), method, {{"light_paths", n}});
            EXPECT_TRUE(result.valid) << method << ' ' << n;
            EXPECT_EQ(nlohmann::json::parse(result.description)["light_paths"],
                      std::llround(n * kWidth * kHeight));
        }
    }
    for (const double n : {1.0 / (kWidth * kHeight), 0.37, 3.0}) {
        const ParameterMap paired = {{"light_paths", n}, {"pairing", std::string("path")}};
        EXPECT_TRUE(render_with(glass(), "bdpt", paired).valid) << n;
    }
}

TEST(Bidirectional, RefusesMoreLightPathsThanItCanCount) {
    EXPECT_THAT(
        [] {
            render_with(glass(), "light", {{"light_paths", 1e6}});
        },
        ThrowsMessage<Error>(HasSubstr("light_paths=1000000 of 40x30 pixels: more than")));
}

// Sums of what the observer is shown, by pixel.
class Sums final : public SampleObserver {
 public:
    explicit Sums(bool zeros = false) : zeros_(zeros), sums_(3 * kWidth * kHeight) {}

    bool wants_zeros() const override { return zeros_; }
    void start_phase(std::size_t n_chunks) override { splats_.assign(n_chunks, {}); }
    void observe(const Sample& sample, std::size_t chunk) override {
        if (sample.value == Rgb{}) ++n_zeros_;
        lengths_[static_cast<std::size_t>(sample.path.n_edges())] = true;
        if (!sample.q.empty()) {
            EXPECT_EQ(sample.q.size(),
                      static_cast<std::size_t>(n_techniques(sample.path.n_edges())));
        }
        splats_[chunk].push_back(
            {sample.path.pixel, static_cast<float>(sample.weight) * sample.value});
    }
    void finish_phase() override {
        for (const auto& chunk : splats_) {
            for (const auto& [pixel, value] : chunk) {
                double* sum = &sums_[3 * static_cast<std::size_t>(pixel.y * kWidth + pixel.x)];
                sum[0] += double{value.r};
                sum[1] += double{value.g};
                sum[2] += double{value.b};
            }
        }
    }
    Image mean(int n_passes) const {
        Image image(kWidth, kHeight);
        for (std::size_t i = 0; i < sums_.size(); ++i) {
            image.rgb[i] = static_cast<float>(sums_[i] / n_passes);
        }
        return image;
    }
    std::int64_t n_zeros() const { return n_zeros_; }
    bool has_length(std::size_t n) const { return lengths_[n]; }

 private:
    bool zeros_;
    std::atomic<std::int64_t> n_zeros_ = 0;
    std::array<std::atomic<bool>, 64> lengths_{};
    std::vector<std::vector<std::pair<Pixel, Rgb>>> splats_;
    std::vector<double> sums_;
};

TEST(SampleEvents, AddUpToTheImage) {
    for (const std::string method : {"direct", "light", "bdpt", "photon", "vcm"}) {
        Sums sums;
        const Image image = render_with(glass(), method, {}, 3, &sums).image;
        expect_same_image(image, sums.mean(3));
        EXPECT_EQ(image, render_with(glass(), method, {}, 3).image) << "observers change nothing";
        EXPECT_EQ(sums.n_zeros(), 0) << method;
    }
}

TEST(SampleEvents, HaveZerosWhereTheyAreWanted) {
    const ParameterMap candidates = {{"candidates", std::int64_t{4}}};
    for (const auto& [method, parameters] :
         {std::pair{"bdpt", ParameterMap{}}, std::pair{"direct", candidates}}) {
        Sums sums(/*zeros=*/true);
        const Image image = render_with(glass(), method, parameters, 3, &sums).image;
        expect_same_image(image, sums.mean(3));
        EXPECT_EQ(image, render_with(glass(), method, parameters, 3).image);
        EXPECT_GT(sums.n_zeros(), 500) << method;
    }
}

TEST(SampleEvents, AreOfPathsWithinTheLimitsOfLength) {
    for (const std::string method : {"light", "bdpt", "photon", "vcm"}) {
        Sums sums;
        render_with(glass(), method,
                    {{"min_depth", std::int64_t{3}}, {"max_depth", std::int64_t{5}}}, 3, &sums);
        for (std::size_t n = 1; n < 8; ++n) {
            EXPECT_EQ(sums.has_length(n), n >= 3 && n <= 5) << method << ' ' << n;
        }
    }
}

TEST(SampleEvents, OfThePathTracerAreThoseOfItsImage) {
    for (const bool nee : {true, false}) {
        Sums sums;
        const Image image = render_with(glass(), "path", {{"nee", nee}}, 3, &sums).image;
        expect_same_image(image, sums.mean(3));
        expect_same_image(image, render_with(glass(), "path", {{"nee", nee}}, 3).image);
    }
}

TEST(SampleEvents, AreRefusedByMethodsThatDoNotShowThem) {
    Sums sums;
    EXPECT_THAT(
        [&] {
            render_with(glass(), "path", {{"bsdf", false}}, 1, &sums);
        },
        ThrowsMessage<Error>(HasSubstr("method 'path' does not show its samples")));
}

TEST(Bidirectional, RendersALaterPassAlone) {
    const auto image = [](std::int64_t n, std::optional<std::int64_t> only_pass) {
        return render(glass(), {.method = "vcm",
                                .parameters = {{"radius_shrink", 0.5}},
                                .width = kWidth,
                                .height = kHeight,
                                .budget = SampleBudget{n},
                                .only_pass = only_pass})
            .image;
    };
    Image sum(kWidth, kHeight);
    for (std::int64_t i = 0; i < 3; ++i) {
        const Image one = image(1, i);
        for (std::size_t k = 0; k < sum.rgb.size(); ++k) sum.rgb[k] += one.rgb[k] / 3;
    }
    expect_same_image(image(3, std::nullopt), sum);
}

// Memory is kept from path to path and from pass to pass.
TEST(Bidirectional, AllocatesNothingForAPathOnceItIsWarm) {
    render_with(glass(), "light", {});  // what is made once for all
    for (const std::string method : {"light", "bdpt", "photon", "vcm"}) {
        const auto count = [&](std::int64_t samples) {
            const std::int64_t before = test::n_allocations();
            render_with(glass(), method, {}, samples, nullptr, 1);
            return test::n_allocations() - before;
        };
        const double per_pass = static_cast<double>(count(16) - count(8)) / 8;
        EXPECT_LT(per_pass, 0.02 * kWidth * kHeight) << method;
    }
}

TEST(Bidirectional, RefusesParametersThatCannotBe) {
    const auto refuses = [](const char* method, const char* key, const ParameterValue& value) {
        try {
            find_method(method).effective({{key, value}});
            ADD_FAILURE() << method << ' ' << key << ' ' << to_string(value);
        } catch (const ParameterError& e) {
            EXPECT_EQ(e.key(), key);
        }
    };
    refuses("bdpt", "max_depth", std::int64_t{0});
    refuses("bdpt", "min_depth", std::int64_t{9});
    refuses("bdpt", "rr_depth", std::int64_t{-1});
    refuses("bdpt", "light_paths", -0.1);
    refuses("bdpt", "connections", -1.0);
    refuses("bdpt", "shadow_rays", std::int64_t{0});
    refuses("bdpt", "bsdf_samples", std::int64_t{0});
    refuses("bdpt", "pairing", std::string("cash"));
    refuses("bdpt", "densities", std::string("half"));
    refuses("bdpt", "mis", std::string("ballance"));
    refuses("vcm", "radius", std::string("pixel"));
    refuses("vcm", "radius_scale", 0.0);
    refuses("vcm", "radius_shrink", 1.5);
    refuses("photon", "kernel", std::string("gauss"));
    refuses("light", "light_selection", std::string("dark"));
    EXPECT_THAT(
        [] {
            find_method("bdpt").effective({{"pairing", std::string("path")}, {"connections", 2.0}});
        },
        ThrowsMessage<ParameterError>(HasSubstr("connections must be 1 with pairing=path")));
}

}  // namespace
}  // namespace misbench
